#!/usr/bin/env bash
# From a fresh Debian 12 to tested binaries: installs the packages that are missing (as root; otherwise it names them), builds
# and tests the release build, the address and undefined-behaviour sanitizers, and engine_glue against Bullet in double
# precision. The last line is `N passed, N failed`; the exit code is 0 when nothing failed.
#
#   tests/run.sh [CMAKE_OPTION...]    options for the release build, e.g. -DPD_WARNINGS_AS_ERRORS=ON
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source pd_core/cmake/debian_packages.sh

printf '== packages\n'
pd_require_packages "${pd_build_packages[@]}" "${pd_demo_packages[@]}" "${pd_test_packages[@]}"
pd_use_ccache

passed=0
failed=0
skipped=0

# Value of an attribute of the first testsuite element of a JUnit file.
junit_count() { sed -n "s/.*[[:space:]]$2=\"\([0-9]*\)\".*/\1/p;/$2=/q" "$1"; }

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
  printf '== %s: build\n' "${preset}"
  if ! { cmake --preset "${preset}" --log-level=WARNING "${pd_launcher[@]}" "$@" &&
         cmake --build --preset "${preset}" "${targets[@]}"; }; then
    printf '%s: the build failed\n' "${preset}" >&2
    failed=$((failed + 1))
    return
  fi
  printf '== %s: test\n' "${preset}"
  local report=${PWD}/build/${preset}/tests.xml status=0
  rm -f "${report}"
  ctest --preset "${preset}" --parallel "$(nproc)" --output-junit "${report}" || status=$?
  if [[ ! -s ${report} ]]; then
    failed=$((failed + 1))
    return
  fi
  local total failures away
  total=$(junit_count "${report}" tests)
  failures=$(junit_count "${report}" failures)
  away=$(($(junit_count "${report}" skipped) + $(junit_count "${report}" disabled)))
  passed=$((passed + total - failures - away))
  failed=$((failed + failures))
  skipped=$((skipped + away))
  if ((status != 0 && failures == 0)); then
    failed=$((failed + 1))
  fi
}

run_preset release -- "$@"
run_preset asan-ubsan --
run_preset double-bullet --target test_engine_glue --

if ((skipped > 0)); then
  printf '%d skipped (listed above)\n' "${skipped}"
fi
printf '%d passed, %d failed\n' "${passed}" "${failed}"
((failed == 0))
