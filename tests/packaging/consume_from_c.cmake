# Builds the C client against an installed copy by pkg-config and by find_package, runs it, and compares what it prints.
#
#   cmake -DPREFIX=<installed copy> -DSOURCE=<source tree> -DCC=<C compiler> -DWORK=<folder> -P consume_from_c.cmake
cmake_minimum_required(VERSION 3.25)

set(client ${SOURCE}/demos/bindings/c/client.c)
file(REMOVE_RECURSE ${WORK})
file(MAKE_DIRECTORY ${WORK}/project)
file(GLOB_RECURSE pc_file ${PREFIX}/*/pdepth.pc)
cmake_path(GET pc_file PARENT_PATH pc_dir)
set(ENV{PKG_CONFIG_PATH} ${pc_dir})
execute_process(COMMAND pkg-config --cflags --libs pdepth OUTPUT_VARIABLE flags COMMAND_ERROR_IS_FATAL ANY)
separate_arguments(flags UNIX_COMMAND "${flags}")
execute_process(COMMAND ${CC} -std=c99 ${client} ${flags} -o ${WORK}/by_pkg_config COMMAND_ERROR_IS_FATAL ANY)

file(WRITE ${WORK}/project/CMakeLists.txt "
cmake_minimum_required(VERSION 3.25)
project(stranger LANGUAGES C)
find_package(pdepth 0.1 REQUIRED COMPONENTS pdepth_c)
add_executable(by_package ${client})
target_link_libraries(by_package PRIVATE pdepth::pdepth_c)
")
execute_process(COMMAND ${CMAKE_COMMAND} -G Ninja -S ${WORK}/project -B ${WORK}/build -DCMAKE_PREFIX_PATH=${PREFIX} -DCMAKE_C_COMPILER=${CC}
                OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${CMAKE_COMMAND} --build ${WORK}/build OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)

cmake_path(GET pc_dir PARENT_PATH libraries)
set(ENV{LD_LIBRARY_PATH} ${libraries})
file(READ ${SOURCE}/demos/bindings/expected.txt expected)
foreach(program ${WORK}/by_pkg_config ${WORK}/build/by_package)
  execute_process(COMMAND ${program} OUTPUT_VARIABLE output COMMAND_ERROR_IS_FATAL ANY)
  if(NOT output STREQUAL expected)
    message(FATAL_ERROR "${program} printed:\n${output}")
  endif()
endforeach()
file(REMOVE_RECURSE ${WORK})
