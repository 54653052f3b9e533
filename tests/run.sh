#!/usr/bin/env bash
# From a fresh Debian 12 to tested binaries: installs the packages that are missing (as root; otherwise it names them), builds
# and tests the release build and its Python package, the address and undefined-behaviour sanitizers (by Clang 14, so that every
# test runs with a second compiler, too), and engine_glue against Bullet in double precision. The last line is `N passed, N failed`; the exit code is 0 when nothing failed.
#
#   tests/run.sh [CMAKE_OPTION...]    options for all builds, e.g. -DPD_WARNINGS_AS_ERRORS=ON
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source pd_core/cmake/debian_packages.sh
for option in "$@"; do
  [[ ${option} == -D?* ]] || { pd_no_options "${option}" && pd_usage >&2 && exit 2; }
done

# heading WORDS: what begins now, and when, so that a log tells what takes long.
heading() {
  printf '== %s (at %d s)\n' "$1" "${SECONDS}"
}

heading packages
pd_require_packages "${pd_build_packages[@]}" "${pd_demo_packages[@]}" "${pd_test_packages[@]}"
pd_use_ccache

passed=0
failed=0
skipped=0
failures_by_name=()

# Configures, builds and tests one preset. A preset that does not build counts as one failed test.
#   run_preset NAME [--target T...] -- [CMAKE_OPTION...]
run_preset() {
  local preset=$1 targets=()
  shift
  while (($# > 0)) && [[ $1 != -- ]]; do
    targets+=("$1")
    shift
  done
  shift
  heading "${preset}: build"
  if ! { cmake --preset "${preset}" --log-level=WARNING "${pd_launcher[@]}" "$@" &&
         cmake --build --preset "${preset}" "${targets[@]}"; }; then
    printf '%s: the build failed\n' "${preset}" >&2
    failed=$((failed + 1))
    failures_by_name+=("${preset}: build")
    return
  fi
  heading "${preset}: test"
  local folder=${PWD}/build/${preset} status=0
  local report=${folder}/tests.xml failures=${folder}/Testing/Temporary/LastTestsFailed.log
  rm -f "${report}" "${failures}"
  ctest --preset "${preset}" --parallel "$(nproc)" --output-junit "${report}" || status=$?
  # The report counts a test that could not be run among the skipped ones; ctest's own list names it as failed.
  local total=0 good=0 bad=0
  if [[ -s ${report} ]]; then
    total=$(grep -c '<testcase ' "${report}" || true)
    good=$(grep -c '<testcase .*status="run"' "${report}" || true)
  fi
  if [[ -s ${failures} ]]; then
    bad=$(wc -l <"${failures}")
    local line
    while read -r line; do
      failures_by_name+=("${preset}: ${line#*:}")
    done <"${failures}"
  elif ((status != 0 || total == 0)); then
    bad=1
    failures_by_name+=("${preset}: ctest itself, exit ${status}")
  fi
  passed=$((passed + good))
  failed=$((failed + bad))
  skipped=$((skipped + (total > good + bad ? total - good - bad : 0)))
}

# count_in FILE PATTERN: how often it stands there; none is no error, which would end the script.
count_in() {
  { grep -oE "$2" "$1" || true; } | wc -l
}

# The Python package that the release build staged: every test of pytest counts as one.
run_python() {
  heading 'Python: test'
  local report=${PWD}/build/release/pytest.xml status=0
  rm -f "${report}"
  if [[ ! -d build/release/python ]]; then
    printf 'the Python package was not built\n' >&2
    failed=$((failed + 1))
    failures_by_name+=('Python: not built')
    return
  fi
  /usr/bin/python3 -B -m pytest -q -p no:cacheprovider --junitxml="${report}" tests/python || status=$?
  local total=0 bad=0 left_out=0
  if [[ -s ${report} ]]; then
    total=$(count_in "${report}" '<testcase ')
    bad=$(count_in "${report}" '<(failure|error) ')
    left_out=$(count_in "${report}" '<skipped ')
  fi
  if ((bad == 0 && (status != 0 || total == 0))); then
    bad=1
    total=$((total + 1))
  fi
  passed=$((passed + total - bad - left_out))
  failed=$((failed + bad))
  if ((bad > 0)); then
    failures_by_name+=("Python: ${bad} of ${total}, named above")
  fi
  skipped=$((skipped + left_out))
}

run_preset release -- "$@"
run_python
# The sample of answer_hash shows that Clang's answers are GCC's, bit for bit. Four undefined behaviours are left out, which cost an
# eighth of the time to compile. The address sanitizer stops at a null pointer, and x86 at a misaligned vector. For object sizes
# and virtual tables looks tests/long/fuzz.sh.
run_preset asan-ubsan -- "$@"
# With the same options, so that the objects that do not see Bullet are the release build's.
run_preset double-bullet --target test_engine_glue -- "$@"

if ((skipped > 0)); then
  printf '%d skipped (listed above)\n' "${skipped}"
fi
if ((failed > 0)); then
  printf 'failed: %s\n' "${failures_by_name[@]}"
fi
printf '%d passed, %d failed\n' "${passed}" "${failed}"
((failed == 0))
