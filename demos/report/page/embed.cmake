# Writes page_files.cpp, schema.cpp and, where the commit has changed, report_commit.hpp.
#
#   cmake -DPAGE=<folder page> -DOUT=<folder> -DVERSION=<version> -P embed.cmake         the files
#   cmake -DSCHEMA=<schema.json> -DOUT=<folder> -P embed.cmake                           the protocol's schema
#   cmake -DSOURCE=<source tree> -DOUT=<folder> -DVERSION=<version> -P embed.cmake       the commit
# A source without git's folder is told its commit: -DCOMMIT=<commit>.
# append_literal(<name> <file>): the file's content as a constant, added to `text`. Compilers limit the length of one literal.
macro(append_literal name file)
  file(READ ${file} content)
  string(LENGTH "${content}" length)
  string(APPEND text "const std::string_view ${name} =\n")
  set(from 0)
  while(from LESS length)
    string(SUBSTRING "${content}" ${from} 15000 piece)
    string(APPEND text "    R\"pdepth(${piece})pdepth\"\n")
    math(EXPR from "${from} + 15000")
  endwhile()
  string(APPEND text "    ;\n\n")
endmacro()

if(PAGE)
  set(text "#include \"report/page_files.hpp\"\n\nnamespace pd::report {\n\n")
  foreach(entry kPageCss:page.css kPageJs:page.js kTableJs:table.js kPairJs:pair.js kThreeJs:three.min.js kThreeLicense:three.LICENSE)
    string(REPLACE ":" ";" entry ${entry})
    list(GET entry 0 name)
    list(GET entry 1 file)
    append_literal(${name} ${PAGE}/${file})
  endforeach()
  file(WRITE ${OUT}/page_files.cpp "${text}}  // namespace pd::report\n")
elseif(SCHEMA)
  set(text "#include \"protocol/schema.hpp\"\n\nnamespace pd::query {\n\n")
  append_literal(kSchema ${SCHEMA})
  file(WRITE ${OUT}/schema.cpp "${text}}  // namespace pd::query\n")
else()
  set(commit "unknown")
  if(COMMIT)
    set(commit "${COMMIT}")
  else()
    find_package(Git QUIET)
  endif()
  if(GIT_FOUND)
    execute_process(COMMAND ${GIT_EXECUTABLE} -C ${SOURCE} describe --always --dirty --abbrev=12 --exclude=*
                    OUTPUT_VARIABLE found RESULT_VARIABLE result ERROR_QUIET OUTPUT_STRIP_TRAILING_WHITESPACE)
    if(result EQUAL 0)
      set(commit "${found}")
    endif()
  endif()
  file(CONFIGURE OUTPUT ${OUT}/report_commit.hpp CONTENT "#pragma once
/// @file
/// Written by the build.
namespace pd::report {
inline constexpr const char* kVersion = \"${VERSION}\";
inline constexpr const char* kCommit = \"${commit}\";
}  // namespace pd::report
")
endif()
