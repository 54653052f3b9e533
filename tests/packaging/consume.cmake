# Uses pdepth as a stranger would, in one of three ways, and checks what the stranger's programs print.
#
#   cmake -DWAY=package|pkg_config|subproject -DCOMPONENTS=<list> -DPREFIX=<installed copy> -DSOURCE=<source tree>
#         -DWORK=<folder> -DCXX=<compiler> -DLAUNCHER=<launcher or empty> -DBUILD_TYPE=<kind> -DFLAGS=<compiler flags>
#         -DBULLET_DOUBLE=<bool> -P consume.cmake
cmake_minimum_required(VERSION 3.25)

set(here ${CMAKE_CURRENT_LIST_DIR})
file(REMOVE_RECURSE ${WORK})
file(MAKE_DIRECTORY ${WORK})

# Runs a command and stops with its output when it fails.
function(run)
  execute_process(COMMAND ${ARGN} WORKING_DIRECTORY ${WORK} RESULT_VARIABLE result OUTPUT_VARIABLE output
                  ERROR_VARIABLE output)
  if(NOT result EQUAL 0)
    list(JOIN ARGN " " command)
    message(FATAL_ERROR "${command}\n${output}")
  endif()
  set(output "${output}" PARENT_SCOPE)
endfunction()

if(BULLET_DOUBLE)
  set(scalar_bytes 8)
else()
  set(scalar_bytes 4)
endif()
set(expected_core "depth 0.25 in .(0.25|0.2499999999999999[0-9]*), (0.25|0.2500000000000000[0-9]*)., way out .-0.25 0 0.")
set(expected_engine_glue "depth 0.25, scalar of ${scalar_bytes} bytes")
set(expected_render "picture 320 x 180, difference 0")

set(common -G Ninja -DCMAKE_CXX_COMPILER=${CXX} -DCMAKE_CXX_COMPILER_LAUNCHER=${LAUNCHER} -DCMAKE_BUILD_TYPE=${BUILD_TYPE}
    -DCMAKE_CXX_FLAGS=${FLAGS})
if(WAY STREQUAL "package")
  list(JOIN COMPONENTS "\\;" components)
  set(configure ${CMAKE_COMMAND} -S ${here}/package ${common} -DCMAKE_PREFIX_PATH=${PREFIX} "-DCOMPONENTS=${components}")
  run(${configure} -B ${WORK}/build -DWANTED_VERSION=0.1)
  run(${CMAKE_COMMAND} --build ${WORK}/build)
  # Another minor version is another interface; a component that nobody has is refused by name.
  foreach(version 0.0 0.2 1.0)
    execute_process(COMMAND ${configure} -B ${WORK}/refused -DWANTED_VERSION=${version} RESULT_VARIABLE result
                    OUTPUT_QUIET ERROR_VARIABLE output)
    if(result EQUAL 0 OR NOT output MATCHES "compatible with requested version")
      message(FATAL_ERROR "find_package(pdepth ${version}) was not refused: ${output}")
    endif()
  endforeach()
  execute_process(COMMAND ${configure} -B ${WORK}/refused -DWANTED_VERSION=0.1 -DCOMPONENTS=teapot RESULT_VARIABLE result
                  OUTPUT_QUIET ERROR_VARIABLE output)
  if(result EQUAL 0 OR NOT output MATCHES "component teapot")
    message(FATAL_ERROR "the component teapot was not refused: ${output}")
  endif()
  if("engine_glue" IN_LIST COMPONENTS)
    # Bullet has to be found where there is no pkg-config, too.
    run(${CMAKE_COMMAND} -S ${here}/package ${common} -DCMAKE_PREFIX_PATH=${PREFIX} -DCOMPONENTS=engine_glue
        -DWANTED_VERSION=0.1 -DCMAKE_DISABLE_FIND_PACKAGE_PkgConfig=ON -B ${WORK}/without_pkg_config)
    run(${CMAKE_COMMAND} --build ${WORK}/without_pkg_config)
    run(${WORK}/without_pkg_config/stranger_engine_glue)
    if(NOT output MATCHES "${expected_engine_glue}")
      message(FATAL_ERROR "without pkg-config stranger_engine_glue printed: ${output}")
    endif()
  endif()
elseif(WAY STREQUAL "subproject")
  list(JOIN COMPONENTS "\\;" components)
  run(${CMAKE_COMMAND} -S ${here}/subproject -B ${WORK}/build ${common} -DPDEPTH_SOURCE=${SOURCE}
      "-DCOMPONENTS=${components}")
  run(${CMAKE_COMMAND} --build ${WORK}/build)
elseif(WAY STREQUAL "pkg_config")
  file(MAKE_DIRECTORY ${WORK}/build)
  file(GLOB pc_files ${PREFIX}/lib*/pkgconfig/*.pc ${PREFIX}/lib/*/pkgconfig/*.pc)
  list(GET pc_files 0 pc_dir)
  cmake_path(GET pc_dir PARENT_PATH pc_dir)
  set(ENV{PKG_CONFIG_PATH} ${pc_dir})
  separate_arguments(flags UNIX_COMMAND "${FLAGS}")
  foreach(component ${COMPONENTS})
    string(REPLACE pd_ "" name ${component})
    string(REPLACE _ - module pdepth-${name})
    run(pkg-config --modversion ${module})
    run(pkg-config --cflags ${module})
    separate_arguments(cflags UNIX_COMMAND "${output}")
    run(pkg-config --libs ${module})
    separate_arguments(libs UNIX_COMMAND "${output}")
    run(${CXX} -std=c++20 ${flags} ${cflags} ${here}/stranger_${name}.cpp -o ${WORK}/build/stranger_${name} ${libs})
  endforeach()
else()
  message(FATAL_ERROR "WAY is package, pkg_config or subproject")
endif()

foreach(component ${COMPONENTS})
  string(REPLACE pd_ "" name ${component})
  run(${WORK}/build/stranger_${name})
  if(NOT output MATCHES "^(${expected_${name}})")
    message(FATAL_ERROR "stranger_${name} printed: ${output}\nexpected: ${expected_${name}}")
  endif()
  message("${output}")
endforeach()
file(REMOVE_RECURSE ${WORK})
