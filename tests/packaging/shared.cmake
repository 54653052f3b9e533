# Part of consume.cmake: installs and moves the shared libraries that a stranger's project has built, looks at what they export, and
# lets a stranger's programs use them through find_package and pkg-config.
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
                          -DWORK=${WORK}/by_${way} -DCXX=${CXX} -DLAUNCHER=${LAUNCHER} -DBUILD_TYPE=${BUILD_TYPE}
                          -DFLAGS=${FLAGS} -DBULLET_DOUBLE=${BULLET_DOUBLE} -DWARNINGS_AS_ERRORS=${WARNINGS_AS_ERRORS}
                          -P ${here}/consume.cmake COMMAND_ERROR_IS_FATAL ANY)
endforeach()
