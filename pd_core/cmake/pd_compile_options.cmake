# Flags that every target of the project shares.
#
# -ffp-contract=off: a fused multiply-add rounds once where the source rounds twice; error bounds and the promise of the same
# bits on every machine are stated for the source.
function(pd_compile_options target)
  target_compile_options(${target} PRIVATE -ffp-contract=off -Wall -Wextra -Wshadow -Wconversion -Wno-sign-conversion
                                           -Wno-psabi)
  if(PD_WARNINGS_AS_ERRORS)
    target_compile_options(${target} PRIVATE -Werror)
  endif()
endfunction()
