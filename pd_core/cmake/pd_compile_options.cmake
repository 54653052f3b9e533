# Flags that every target of the project shares.
#
# -ffp-contract=off: a fused multiply-add rounds once where the source rounds twice; error bounds and the promise of the same
# bits on every machine are stated for the source.
# -Wno-restrict: GCC 12 reports overlapping copies inside its own std::string (bug 105651) where operator+ is inlined.
# -Wno-maybe-uninitialized: at -O3 GCC 12 reports the limbs of Boost's fixed-size integers beyond their size; Clang's own
# analysis of uninitialised variables and the sanitizers watch instead.
function(pd_compile_options target)
  target_compile_options(${target} PRIVATE -ffp-contract=off -Wall -Wextra -Wshadow -Wconversion -Wno-sign-conversion
                                           -Wno-psabi $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>
                                           $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>)
  if(PD_WARNINGS_AS_ERRORS)
    target_compile_options(${target} PRIVATE -Werror)
  endif()
endfunction()
