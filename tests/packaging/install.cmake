# Installs the build into a folder and moves that, so that whoever uses it proves that nothing in it names a fixed place.
#
#   cmake -DBUILD=<build folder> -DCONFIG=<kind> -DPREFIX=<folder> -P install.cmake
cmake_minimum_required(VERSION 3.25)

file(REMOVE_RECURSE ${PREFIX} ${PREFIX}_first)
execute_process(COMMAND ${CMAKE_COMMAND} --install ${BUILD} --prefix ${PREFIX}_first --config "${CONFIG}" OUTPUT_QUIET
                COMMAND_ERROR_IS_FATAL ANY)
file(RENAME ${PREFIX}_first ${PREFIX})
