# Test programs compiled in batches: most of what a test costs the compiler is headers and their templates, the same in every test.
#
# A batch is the text of some tests of one folder, one behind the other, each with its anonymous namespace named after its file,
# so that short names of tests do not meet.
#
#   cmake -DOUT=<file> "-DSOURCES=<paths below the folder FOLDER, with commas>" -DFOLDER=<folder of the tests> -P batches.cmake
if(CMAKE_SCRIPT_MODE_FILE STREQUAL CMAKE_CURRENT_LIST_FILE)
  set(batch "// Written by tests/batches.cmake.\n")
  string(REPLACE "," ";" SOURCES "${SOURCES}")
  foreach(source ${SOURCES})
    file(READ ${FOLDER}/${source} text)
    string(MAKE_C_IDENTIFIER "${source}" name)
    string(REPLACE "\nnamespace {\n" "\nnamespace ${name} {\n" text "${text}")
    # A path below the folder, so that the compiler cache serves every copy of the tree.
    string(APPEND batch "#line 1 \"${source}\"\n${text}")
  endforeach()
  file(WRITE ${OUT} "${batch}")
  return()
endif()

set(PD_TESTS_IN_A_BATCH 8)

# pd_batches(<variable> <target> <source>...): the sources that the target is made from. A source that is no test, or that does not
# have exactly one anonymous namespace, stays alone; so do all where CMAKE_UNITY_BUILD was off.
function(pd_batches variable target)
  set(result "")
  set(groups "")
  foreach(source ${ARGN})
    cmake_path(ABSOLUTE_PATH source)
    file(STRINGS ${source} anonymous REGEX "^namespace {$")
    list(LENGTH anonymous count)
    if(NOT PD_TEST_BATCHES OR NOT count EQUAL 1 OR NOT source MATCHES "_test\\.cpp$")
      list(APPEND result ${source})
      continue()
    endif()
    cmake_path(RELATIVE_PATH source BASE_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR})
    cmake_path(GET source PARENT_PATH folder)
    string(MAKE_C_IDENTIFIER "${folder}" group)
    list(APPEND groups ${group})
    list(APPEND sources_${group} ${source})
    set(folder_${group} ${CMAKE_CURRENT_SOURCE_DIR}/${folder})
  endforeach()
  list(REMOVE_DUPLICATES groups)
  foreach(group ${groups})
    set(number 0)
    while(sources_${group})
      list(SUBLIST sources_${group} 0 ${PD_TESTS_IN_A_BATCH} batch)
      list(REMOVE_ITEM sources_${group} ${batch})
      math(EXPR number "${number} + 1")
      set(out ${CMAKE_CURRENT_BINARY_DIR}/batches/${target}_${group}_${number}.cpp)
      list(JOIN batch "," names)
      add_custom_command(
        OUTPUT ${out}
        COMMAND ${CMAKE_COMMAND} -DOUT=${out} -DSOURCES=${names} -DFOLDER=${CMAKE_CURRENT_SOURCE_DIR}
                -P ${CMAKE_CURRENT_SOURCE_DIR}/batches.cmake
        DEPENDS ${batch} ${CMAKE_CURRENT_FUNCTION_LIST_FILE})
      # A test may include what lies beside it.
      set_source_files_properties(${out} PROPERTIES INCLUDE_DIRECTORIES ${folder_${group}})
      list(APPEND result ${out})
    endwhile()
  endforeach()
  set(${variable} ${result} PARENT_SCOPE)
endfunction()
