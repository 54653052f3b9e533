# Builds the libraries shared within a stranger's project, installs and moves them, looks at what they export, and lets a stranger's
# programs use them. Folders and flags are those of consume.cmake's subproject: where ccache is, its objects serve here.
#
#   cmake -DSOURCE=<source tree> -DWORK=<folder> -DCXX=<compiler> -DLAUNCHER=<launcher or empty> -DBUILD_TYPE=<kind>
#         -DFLAGS=<compiler flags> -DCOMPONENTS=<list> -DBULLET_DOUBLE=<bool> -DWARNINGS_AS_ERRORS=<bool> -P shared.cmake
cmake_minimum_required(VERSION 3.25)

set(here ${CMAKE_CURRENT_LIST_DIR})
file(REMOVE_RECURSE ${WORK})
foreach(option "PD_WITH_BULLET engine_glue" "PD_WITH_RENDER render")
  separate_arguments(option)
  list(GET option 0 name)
  list(GET option 1 component)
  if(component IN_LIST COMPONENTS)
    list(APPEND options -D${name}=ON)
  else()
    list(APPEND options -D${name}=OFF)
  endif()
endforeach()
execute_process(COMMAND ${CMAKE_COMMAND} -G Ninja -S ${here}/shared -B ${WORK}/build -DPDEPTH_SOURCE=${SOURCE}
                        -DBUILD_SHARED_LIBS=ON -DPD_INSTALL=ON ${options} -DCMAKE_CXX_COMPILER=${CXX}
                        -DCMAKE_CXX_COMPILER_LAUNCHER=${LAUNCHER} -DCMAKE_BUILD_TYPE=${BUILD_TYPE} -DCMAKE_CXX_FLAGS=${FLAGS}
                        -DPD_BULLET_DOUBLE=${BULLET_DOUBLE} -DCMAKE_UNITY_BUILD=ON -DPD_PRECOMPILED_HEADERS=ON
                        -DPD_WARNINGS_AS_ERRORS=${WARNINGS_AS_ERRORS}
                OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${CMAKE_COMMAND} --build ${WORK}/build OUTPUT_VARIABLE output ERROR_VARIABLE output RESULT_VARIABLE result)
if(NOT result EQUAL 0)
  message(FATAL_ERROR "the shared libraries do not build:\n${output}")
endif()
execute_process(COMMAND ${CMAKE_COMMAND} --install ${WORK}/build --prefix ${WORK}/first OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
file(RENAME ${WORK}/first ${WORK}/prefix)

file(GLOB_RECURSE libraries ${WORK}/prefix/*.so)
list(LENGTH libraries count)
list(LENGTH COMPONENTS expected)
if(NOT count EQUAL expected)
  message(FATAL_ERROR "${expected} shared libraries were expected: ${libraries}")
endif()
foreach(library ${libraries})
  execute_process(COMMAND nm -DC --defined-only ${library} OUTPUT_VARIABLE symbols COMMAND_ERROR_IS_FATAL ANY)
  if(NOT symbols MATCHES " pd::")
    message(FATAL_ERROR "${library} exports nothing of namespace pd")
  endif()
  # Eigen's, Boost's and the standard library's templates are nobody else's business.
  string(REGEX MATCHALL "[0-9a-f]+ [A-Z] (Eigen|boost|std|fmt)::[^\n]*" strangers "${symbols}")
  if(strangers)
    list(GET strangers 0 first)
    message(FATAL_ERROR "${library} exports ${first}")
  endif()
  execute_process(COMMAND readelf -d ${library} OUTPUT_VARIABLE dynamic COMMAND_ERROR_IS_FATAL ANY)
  if(NOT dynamic MATCHES "soname: \\[libpdepth_[a-z_]+\\.so\\.[0-9]+\\.[0-9]+\\]")
    message(FATAL_ERROR "${library} has no versioned name: ${dynamic}")
  endif()
  cmake_path(GET library PARENT_PATH folder)
endforeach()

set(ENV{LD_LIBRARY_PATH} ${folder})
foreach(way package pkg_config)
  execute_process(COMMAND ${CMAKE_COMMAND} -DWAY=${way} "-DCOMPONENTS=${COMPONENTS}" -DPREFIX=${WORK}/prefix -DSOURCE=${SOURCE}
                          -DWORK=${WORK}/${way} -DCXX=${CXX} -DLAUNCHER=${LAUNCHER} -DBUILD_TYPE=${BUILD_TYPE}
                          -DFLAGS=${FLAGS} -DBULLET_DOUBLE=${BULLET_DOUBLE} -DWARNINGS_AS_ERRORS=${WARNINGS_AS_ERRORS}
                          -P ${here}/consume.cmake COMMAND_ERROR_IS_FATAL ANY)
endforeach()
file(REMOVE_RECURSE ${WORK})
