# What the seam's headers cost a host to include: at most 1.3 times the Bullet headers that they name themselves.
#
#   cmake -DROOT=<source tree> -DCXX=<compiler> "-DFLAGS=<include folders of Bullet, as flags>" -DWORK=<folder> -P header_weight.cmake
#
# Measured is the preprocessed text in bytes, which is the same on every machine with the same packages; parsing time follows it.
cmake_minimum_required(VERSION 3.25)

set(headers install penetration_depth_solver snapshot rollback contact_recorder)
separate_arguments(flags UNIX_COMMAND "${FLAGS}")
file(MAKE_DIRECTORY ${WORK})

# weigh(<source text> <variable>): the bytes that a compiler gets to read.
function(weigh text variable)
  file(WRITE ${WORK}/weighed.cpp "${text}")
  execute_process(COMMAND ${CXX} -std=c++20 -E -P -I${ROOT}/engine_glue/include -I${ROOT}/pd_core/include ${flags}
                          ${WORK}/weighed.cpp OUTPUT_FILE ${WORK}/weighed.txt COMMAND_ERROR_IS_FATAL ANY)
  file(SIZE ${WORK}/weighed.txt bytes)
  set(${variable} ${bytes} PARENT_SCOPE)
endfunction()

# The Bullet headers that a header names, itself or through others of ours.
function(bullet_headers header variable)
  file(STRINGS ${ROOT}/engine_glue/include/pd/bullet/${header}.hpp lines REGEX "^#include")
  set(found "")
  foreach(line ${lines})
    if(line MATCHES "<(Bullet|LinearMath|bt)")
      list(APPEND found "${line}")
    elseif(line MATCHES "pd/bullet/([a-z_]+)\\.hpp")
      bullet_headers(${CMAKE_MATCH_1} inner)
      list(APPEND found ${inner})
    endif()
  endforeach()
  set(${variable} ${found} PARENT_SCOPE)
endfunction()

set(heavy 0)
foreach(header ${headers})
  bullet_headers(${header} own)
  list(JOIN own "\n" own)
  weigh("${own}\n" allowed)
  weigh("#include <pd/bullet/${header}.hpp>\n" bytes)
  math(EXPR hundredths "100 * ${bytes} / ${allowed}")
  message("pd/bullet/${header}.hpp: ${bytes} bytes, ${hundredths} % of the Bullet headers that it names")
  if(hundredths GREATER 130)
    math(EXPR heavy "${heavy} + 1")
  endif()
endforeach()
if(heavy GREATER 0)
  message(FATAL_ERROR "${heavy} headers of the seam weigh more than 130 %")
endif()
