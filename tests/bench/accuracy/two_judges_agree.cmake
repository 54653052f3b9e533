# `pdepth accuracy` and `pdepth-bench accuracy` ask the same engines about the same pairs; the audit and the oracle, which
# share no code, have to count the same answers as missed, phantom and wrong, among them wrong ones.
#
#   cmake -DPDEPTH=<program> -DBENCH=<program> -DWORK=<folder> -P two_judges_agree.cmake
file(MAKE_DIRECTORY ${WORK})
set(asked --families box,sphere,kissing,near_equal_bodies --pairs 3 --engines pdepth-auto,ccd-epa,ccd-mpr,bullet-minkowski)
execute_process(COMMAND ${PDEPTH} accuracy ${asked} --csv ${WORK}/audit.csv RESULT_VARIABLE audited OUTPUT_VARIABLE output)
execute_process(COMMAND ${BENCH} accuracy ${asked} --csv ${WORK}/oracle.csv RESULT_VARIABLE judged OUTPUT_VARIABLE output)
if(NOT audited EQUAL 0 OR NOT judged EQUAL 0)
  message(FATAL_ERROR "exit codes ${audited} and ${judged}\n${output}")
endif()
file(STRINGS ${WORK}/audit.csv audit)
file(STRINGS ${WORK}/oracle.csv oracle)
# The last two columns are the worst error, in doubles, and a time.
list(TRANSFORM audit REPLACE ",[^,]*,[^,]*$" "")
list(TRANSFORM oracle REPLACE ",[^,]*,[^,]*$" "")
list(LENGTH audit lines)
if(lines LESS 5)
  message(FATAL_ERROR "no engine was asked: ${lines} lines")
endif()
foreach(by_audit by_oracle IN ZIP_LISTS audit oracle)
  if(NOT by_audit STREQUAL by_oracle)
    message(SEND_ERROR "engine,family,failed,contacts,missed,phantom,above_1e-6,above_1e-3,no_answer\n"
                       "${by_audit}  by the audit\n${by_oracle}  by the oracle")
  endif()
endforeach()
if(lines GREATER 5 AND NOT "${oracle}" MATCHES ",[1-9][0-9]*,[0-9]+(;|$)")
  message(FATAL_ERROR "no peer was wrong: nothing is shown")
endif()
message("${lines} lines agree")
