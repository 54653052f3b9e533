# What may stand where, and how long a file may be.
#
#   cmake -DROOT=<source tree> -P file_rules.cmake
# Rules:
#   1. The top level holds the rooms, the files that tools expect there, dotfiles, and nothing else (what git ignores aside).
#   2. No source, script or build file is longer than 500 lines.
#   3. Every header says #pragma once and describes itself with @file.
#   4. A constant of a source has no namesake in another source of its folder: compiled as one they clash, or one hides the
#      other.
#   5. A folder of pd_core/src, engine_glue/src, a door beside it (engine_glue/mujoco/src), render/src or demos holds at most 25
#      units, where a header with its source is one.
cmake_minimum_required(VERSION 3.25)
get_filename_component(ROOT "${ROOT}" ABSOLUTE)  # names of files are relative to it

set(rooms CMakeLists.txt engine_glue pd_core packaging demos tests render README.md)
set(tool_files CMakePresets.json LICENSE CHANGELOG.md CONTRIBUTING.md CITATION.cff package.xml pyproject.toml SECURITY.md)
set(ignored_by_git build out compile_commands.json)
set(max_lines 500)
set(max_units 25)

set(broken 0)
macro(report)
  math(EXPR broken "${broken} + 1")
  message(${ARGN})
endmacro()

file(GLOB entries RELATIVE ${ROOT} ${ROOT}/*)
foreach(entry ${entries})
  if(NOT entry MATCHES "^\\." AND NOT entry IN_LIST rooms AND NOT entry IN_LIST tool_files AND NOT entry IN_LIST ignored_by_git)
    report("${entry}: not an entry of the top level")
  endif()
endforeach()
foreach(entry ${rooms} ${tool_files})
  if(NOT entry IN_LIST entries)
    report("${entry}: missing at the top level")
  endif()
endforeach()

set(patterns "")
foreach(room pd_core engine_glue render demos tests packaging)
  foreach(kind *.cpp *.hpp *.py *.pyi *.cmake *.in *.sh CMakeLists.txt)
    list(APPEND patterns ${ROOT}/${room}/${kind})
  endforeach()
endforeach()
file(GLOB_RECURSE files RELATIVE ${ROOT} ${patterns})
foreach(file ${files})
  file(READ ${ROOT}/${file} text)
  string(REGEX REPLACE "[^\n]+" "" newlines "${text}")
  string(LENGTH "${newlines}" lines)
  if(lines GREATER max_lines)
    report("${file}: ${lines} lines, more than ${max_lines}; split it")
  endif()
  if(file MATCHES "\\.hpp$")
    if(NOT text MATCHES "#pragma once")
      report("${file}: no #pragma once")
    endif()
    if(NOT text MATCHES "/// @file")
      report("${file}: no /// @file comment")
    endif()
  endif()
endforeach()

# Where a source or header of its folder declares constants, outermost or in functions: the names kConstant that follow `pattern`.
function(constants_of text pattern out)
  string(REGEX MATCHALL "\n${pattern}constexpr [^\n;=({]* k[A-Z][A-Za-z0-9]*( =|{)" found "\n${text}")
  list(TRANSFORM found REPLACE "^.* (k[A-Za-z0-9]+)( =|{)$" "\\1")
  list(REMOVE_DUPLICATES found)
  set(${out} "${found}" PARENT_SCOPE)
endfunction()

# In the order in which one unit would hold them.
list(SORT files)
foreach(file ${files})
  if(file MATCHES "^(pd_core/src|engine_glue/([a-z]+/)?src|render/src|demos)/.*\\.(cpp|hpp)$")
    get_filename_component(folder ${file} DIRECTORY)
    file(READ ${ROOT}/${file} text)
    string(REPLACE ";" " " text "${text}")
    constants_of("${text}" "(inline |static )*" outermost)
    constants_of("${text}" " +" inner)
    foreach(constant ${outermost} ${inner})
      if(DEFINED "first_${folder}_${constant}")
        report("${file}: ${constant} is one of ${first_${folder}_${constant}}, too")
      endif()
    endforeach()
    foreach(constant ${outermost})
      set("first_${folder}_${constant}" ${file})
    endforeach()
  endif()
endforeach()

# Units by folder.
set(folders "")
foreach(file ${files})
  if(file MATCHES "^((engine_glue|pd_core|render)/src.*|engine_glue/[a-z]+/src|demos.*)/([^/]+)\\.[ch]pp$")
    list(APPEND folders ${CMAKE_MATCH_1})
    list(APPEND "units_of_${CMAKE_MATCH_1}" ${CMAKE_MATCH_3})
  endif()
endforeach()
list(REMOVE_DUPLICATES folders)
foreach(folder ${folders})
  list(REMOVE_DUPLICATES "units_of_${folder}")
  list(LENGTH "units_of_${folder}" units)
  if(units GREATER max_units)
    report("${folder}: ${units} units, more than ${max_units}; a room is missing")
  endif()
endforeach()

list(LENGTH files file_count)
if(broken GREATER 0)
  message(FATAL_ERROR "${broken} findings in ${file_count} files")
endif()
message("${file_count} files keep the rules")
