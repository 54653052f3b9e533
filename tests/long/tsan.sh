#!/usr/bin/env bash
# The thread sanitizer over the whole suite, core included: the preset tsan, every test program at once, its races counted.
# Bullet and Pango are the system's, without instrumentation; races that are their own are left out by name
# (threads_of_libraries.txt). Mesa, which is neither, draws on the caller's thread.
# One world on several threads needs a Bullet built for that: threads.sh.
#
#   tests/long/tsan.sh [BUILD_FOLDER [TEST...]]        build/tsan, all of them; an hour and a half on two cores, most of it tests
#
# The last run stands in last_tsan.txt.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
source pd_core/cmake/debian_packages.sh
pd_no_options "$@"
pd_use_ccache

build=${1:-build/tsan}
shift $(($# < 1 ? $# : 1))
tests=("$@")
((${#tests[@]} > 0)) || tests=(test_numeric test_shape test_structure test_planar test_dimension test_contact test_compound
                               test_engine_glue test_audit test_scenes test_oracle test_cli test_demos test_depth)
cmake --preset tsan -B "${build}" --log-level=ERROR "${pd_launcher[@]}" -DPD_PRECOMPILED_HEADERS=OFF
cmake --build "${build}" --target "${tests[@]}"

failed=0
export LP_NUM_THREADS=0
export TSAN_OPTIONS="suppressions=${PWD}/tests/long/threads_of_libraries.txt exitcode=66"
{
  printf 'date %s, commit %s\n' "$(date -u +%F)" "$(git rev-parse --short HEAD)"
  for test in "${tests[@]}"; do
    log=${PWD}/${build}/${test}.log
    begin=${SECONDS}
    verdict=''
    (cd "${build}" && "./${test}" --gtest_brief=1) >"${log}" 2>&1 || verdict=', FAILED'
    [[ -z ${verdict} ]] || failed=$((failed + 1))
    races=$(grep -c 'WARNING: ThreadSanitizer' "${log}" || true)
    passed=$(sed -n 's/^\[  PASSED  \] \(.*\)\.$/\1/p' "${log}")
    printf '%s: %s passed, %s reports of the sanitizer%s (%d s)\n' "${test}" "${passed:-none}" "${races}" "${verdict}" \
      "$((SECONDS - begin))"
  done
  printf '%d failed\n' "${failed}"
} | tee "${build}/last.txt"
((${#tests[@]} < 14)) || cp "${build}/last.txt" tests/long/last_tsan.txt
tail -n 1 "${build}/last.txt" | grep -q '^0 failed'
