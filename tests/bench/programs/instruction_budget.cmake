# Counts the instructions of the fixed cases by callgrind and compares them with their budgets.
#
#   cmake -DPROGRAM=<fixed_cases> -DBUDGET=<file> -DWORK=<folder> -P instruction_budget.cmake
# The budget file has a line `name instructions` for each case; # starts a comment. Fails where a count is above its budget. A
# count below 4/5 of it is reported, so that a gain is kept by lowering the budget.
cmake_minimum_required(VERSION 3.25)

find_program(VALGRIND valgrind)
if(NOT VALGRIND)
  message("SKIPPED: valgrind is not installed, so no instructions were counted")
  return()
endif()
# Kernels are chosen at run time; valgrind lets AVX2 through and nothing wider.
if(EXISTS /proc/cpuinfo)
  file(STRINGS /proc/cpuinfo avx2 REGEX "avx2" LIMIT_COUNT 1)
endif()
if(NOT avx2)
  message("SKIPPED: the budgets hold for the AVX2 kernels, which this machine has not")
  return()
endif()
file(MAKE_DIRECTORY ${WORK})
file(STRINGS ${BUDGET} lines REGEX "^[a-z]")
set(over 0)
foreach(line ${lines})
  if(NOT line MATCHES "^([a-z0-9_]+) +([0-9]+)$")
    message(FATAL_ERROR "${BUDGET}: not `name instructions`: ${line}")
  endif()
  set(name ${CMAKE_MATCH_1})
  set(budget ${CMAKE_MATCH_2})
  set(out ${WORK}/callgrind.${name})
  file(REMOVE ${out})
  execute_process(COMMAND ${VALGRIND} --tool=callgrind --toggle-collect=pdepth_counted_call --callgrind-out-file=${out}
                          ${PROGRAM} ${name}
                  RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE errors)
  if(NOT result EQUAL 0)
    message(FATAL_ERROR "${name}: ${errors}")
  endif()
  file(STRINGS ${out} totals REGEX "^(summary|totals): [0-9]+")
  list(GET totals 0 total)
  string(REGEX REPLACE "[^0-9]" "" count "${total}")
  math(EXPR percent "100 * ${count} / ${budget}")
  set(word "")
  if(count GREATER budget)
    set(word "  OVER BUDGET")
    math(EXPR over "${over} + 1")
  elseif(percent LESS 80)
    set(word "  the budget can be lowered")
  endif()
  message("${name}: ${count} of ${budget} instructions (${percent} %)${word}")
endforeach()
if(over GREATER 0)
  message(FATAL_ERROR "${over} cases need more instructions than their budget: make the hot path cheaper again, or raise the "
                      "budget in review and say why")
endif()
