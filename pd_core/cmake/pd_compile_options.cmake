# Flags that every target of the project shares.
#
# -ffp-contract=off: a fused multiply-add rounds once where the source rounds twice; error bounds and the promise of the same
# bits on every machine are stated for the source.
# -U__ARM_FEATURE_FMA: what Eigen's NEON kernels look at before they fuse by intrinsics, which -ffp-contract leaves alone.
# -Wno-restrict: GCC 12 reports overlapping copies inside its own std::string (bug 105651) where operator+ is inlined.
# -Wno-maybe-uninitialized: at -O3 GCC 12 reports the limbs of Boost's fixed-size integers beyond their size; Clang's own
# analysis of uninitialised variables and the sanitizers watch instead.
# -Wno-shadow: in a unity build Clang takes a member for a shadow of what another source has in its anonymous namespace.
# -Wno-subobject-linkage: in a unity build GCC takes every source for a header, where a class must not hold what is anonymous.
function(pd_compile_options target)
  target_compile_options(${target} PRIVATE -ffp-contract=off -Wall -Wextra -Wshadow -Wconversion -Wno-sign-conversion
                                           -Wno-psabi $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>
                                           $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>
                                           $<$<AND:$<CXX_COMPILER_ID:GNU>,$<BOOL:$<TARGET_PROPERTY:UNITY_BUILD>>>:-Wno-subobject-linkage>
                                           $<$<AND:$<CXX_COMPILER_ID:Clang>,$<BOOL:$<TARGET_PROPERTY:UNITY_BUILD>>>:-Wno-shadow>)
  if(CMAKE_SYSTEM_PROCESSOR MATCHES "^(aarch64|arm64)$")
    target_compile_options(${target} PRIVATE -U__ARM_FEATURE_FMA)
  endif()
  if(PD_WARNINGS_AS_ERRORS)
    target_compile_options(${target} PRIVATE -Werror)
  endif()
  pd_harden(${target})
endfunction()

# pd_harden(<target>): programs and shared libraries are bound when they start, so that no table of functions can be written to
# afterwards. With PD_HARDENED a function with an array checks its frame, and the C library checks the sizes that it is given.
function(pd_harden target)
  if(NOT APPLE AND NOT WIN32 AND NOT EMSCRIPTEN)
    target_link_options(${target} PRIVATE LINKER:-z,relro LINKER:-z,now)
  endif()
  if(PD_HARDENED)
    target_compile_options(${target} PRIVATE -fstack-protector-strong
                                             $<$<NOT:$<CONFIG:Debug>>:-U_FORTIFY_SOURCE>
                                             $<$<NOT:$<CONFIG:Debug>>:-D_FORTIFY_SOURCE=2>)
  endif()
endfunction()

# pd_unity_by_folder(<target>): where CMAKE_UNITY_BUILD is on, the sources of one folder are compiled as one, whatever batch size
# is set: most of what a source costs is instances of Eigen's and the standard library's templates, the same in every source.
# So a name in an anonymous namespace is its folder's. A source with the property SKIP_UNITY_BUILD_INCLUSION stays alone.
function(pd_unity_by_folder target)
  set_target_properties(${target} PROPERTIES UNITY_BUILD_MODE GROUP)
  get_target_property(sources ${target} SOURCES)
  foreach(source ${sources})
    cmake_path(ABSOLUTE_PATH source OUTPUT_VARIABLE folder)
    cmake_path(GET folder PARENT_PATH folder)
    cmake_path(RELATIVE_PATH folder BASE_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR})
    string(MAKE_C_IDENTIFIER "${folder}" group)
    get_source_file_property(together ${source} UNITY_GROUP)
    if(NOT together)
      set_source_files_properties(${source} PROPERTIES UNITY_GROUP "${group}")
    endif()
  endforeach()
endfunction()

# pd_unity_whole(<target> [<header>...] | <target> REUSE_FROM <other>): where CMAKE_UNITY_BUILD is on, the whole target is one source
# (those with the property SKIP_UNITY_BUILD_INCLUSION aside, and those with a UNITY_GROUP of their own), which parses every header
# once: for targets of which a source takes longer to parse than to compile. So a name in an anonymous namespace is the target's.
# Elsewhere its headers are precompiled.
function(pd_unity_whole target)
  if(CMAKE_UNITY_BUILD)
    set_target_properties(${target} PROPERTIES UNITY_BUILD_MODE GROUP)
    get_target_property(sources ${target} SOURCES)
    foreach(source ${sources})
      get_source_file_property(group ${source} UNITY_GROUP)
      if(NOT group)
        set_source_files_properties(${source} PROPERTIES UNITY_GROUP all)
      endif()
    endforeach()
  else()
    pd_precompile_headers(${target} ${ARGN})
  endif()
endfunction()

# pd_unity_together(<target> <folder>...): before one of the two above, the sources in these folders, named from the target's own, are
# compiled as one, for folders whose sources use the same templates. So a name in an anonymous namespace is theirs together.
function(pd_unity_together target)
  get_target_property(sources ${target} SOURCES)
  string(MAKE_C_IDENTIFIER "${ARGN}" group)
  foreach(source ${sources})
    cmake_path(ABSOLUTE_PATH source OUTPUT_VARIABLE folder)
    cmake_path(GET folder PARENT_PATH folder)
    cmake_path(RELATIVE_PATH folder BASE_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR})
    if(folder IN_LIST ARGN)
      set_source_files_properties(${source} PROPERTIES UNITY_GROUP "${group}")
    endif()
  endforeach()
endfunction()

# pd_optimise_little(<target> <level>): in Release, for code around the loops that are in pd_core: -O1 takes two thirds of the time to
# compile that -O3 takes. GCC takes the level from a precompiled header: where a target reuses one, both have this level.
function(pd_optimise_little target level)
  target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:${level}>)
endfunction()

# pd_precompile_headers(<target> [<header>...] | <target> REUSE_FROM <other>): what nearly every source of the target parses, and
# the headers named, parsed once. Sources include what they use all the same: tests/long/source_by_source.sh builds without.
# Targets that share one (REUSE_FROM) must have the same flags; position-independent code for a library and for a program are two.
function(pd_precompile_headers target)
  if(NOT PD_PRECOMPILED_HEADERS)
    return()
  endif()
  if(ARGV1 STREQUAL REUSE_FROM)
    target_precompile_headers(${target} REUSE_FROM ${ARGV2})
  else()
    target_precompile_headers(${target} PRIVATE <Eigen/Geometry> <algorithm> <array> <cmath> <cstdint> <functional> <map>
                              <memory> <optional> <span> <string> <vector> ${ARGN})
  endif()
  # -fpch-preprocess lets ccache look at a source that starts from a precompiled header. In such a source GCC 12 no longer knows
  # that std::string is a system's and reports sizes inside it (bug 105651 again); a build without precompiled headers has the warnings.
  if(CMAKE_CXX_COMPILER_ID STREQUAL GNU)
    target_compile_options(${target} PRIVATE -fpch-preprocess -Wno-array-bounds -Wno-stringop-overflow -Wno-stringop-overread)
  elseif(CMAKE_CXX_COMPILER_ID STREQUAL Clang)
    # Without the times of headers in it, ccache serves the precompiled header of another build folder.
    target_compile_options(${target} PRIVATE "SHELL:-Xclang -fno-pch-timestamp")
  endif()
endfunction()
