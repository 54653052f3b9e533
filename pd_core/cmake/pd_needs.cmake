# Packages that a build cannot do without. Rooms look for them by pd_need; pd_report_missing then names all that are missing at once, with
# their Debian packages and with the options that build without them.

# pd_missing(<what> <Debian package> [<option>...]): what was looked for and not found; with the options off it is not needed.
function(pd_missing what debian_package)
  set(line "  ${what}")
  if(ARGN)
    list(TRANSFORM ARGN REPLACE "(.+)" "-D\\1=OFF")
    list(JOIN ARGN " " options)
    string(APPEND line " (not needed with ${options})")
  endif()
  set_property(GLOBAL APPEND PROPERTY PD_MISSING "${line}")
  set_property(GLOBAL APPEND PROPERTY PD_MISSING_DEBIAN ${debian_package})
endfunction()

# pd_need(<package> <Debian package> [<argument of find_package>...] [UNLESS_OFF <option>...])
macro(pd_need package debian_package)
  cmake_parse_arguments(pd_need "" "" "UNLESS_OFF" ${ARGN})
  find_package(${package} ${pd_need_UNPARSED_ARGUMENTS} QUIET)
  if(NOT ${package}_FOUND)
    list(FILTER pd_need_UNPARSED_ARGUMENTS INCLUDE REGEX "^[0-9]")
    list(JOIN pd_need_UNPARSED_ARGUMENTS " " pd_need_version)
    string(STRIP "${package} ${pd_need_version}" pd_need_what)
    pd_missing("${pd_need_what}" ${debian_package} ${pd_need_UNLESS_OFF})
  endif()
endmacro()

function(pd_report_missing)
  get_property(lines GLOBAL PROPERTY PD_MISSING)
  if(NOT lines)
    return()
  endif()
  get_property(packages GLOBAL PROPERTY PD_MISSING_DEBIAN)
  list(REMOVE_DUPLICATES lines)
  list(REMOVE_DUPLICATES packages)
  list(JOIN lines "\n" lines)
  list(JOIN packages " " packages)
  message(FATAL_ERROR "pdepth needs packages that were not found:\n${lines}\n"
                      "On Debian:\n  apt-get install ${packages}\n"
                      "Elsewhere add their prefixes to CMAKE_PREFIX_PATH.")
endfunction()

# pd_check_option(<option> <value>...): refuses a value that would silently mean another one.
function(pd_check_option option)
  if(NOT "${${option}}" IN_LIST ARGN)
    list(JOIN ARGN ", " values)
    message(FATAL_ERROR "${option} is ${${option}}; it must be one of ${values}")
  endif()
endfunction()
