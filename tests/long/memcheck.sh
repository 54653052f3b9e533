#!/usr/bin/env bash
# valgrind's memcheck over a sample of the release build, what the address sanitizer does not see above all: decisions that hang on
# memory that nobody set. Predicates and numbers, answers of every kind of question, and pairs judged by the oracle.
# Left out: tests that compare with long double, which valgrind computes as double, and long ones of rationals.
#
#   tests/long/memcheck.sh [BUILD_FOLDER]        build/release; a minute or two
#
# The build must have test_numeric, answer_hash and oracle_pairs. The last run stands in last_memcheck.txt.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
source pd_core/cmake/debian_packages.sh
pd_no_options "$@"
build=$(realpath "${1:-build/release}")
work=$(mktemp -d)
trap 'rm -rf "${work}"' EXIT
failed=0

check() {
  local begin=${SECONDS} verdict
  if (cd "${work}" && valgrind --quiet --error-exitcode=99 --leak-check=full --errors-for-leak-kinds=definite \
        "${build}/$1" "${@:2}") >"${work}/log" 2>&1; then
    verdict='no error'
  else
    verdict='FAILED'
    failed=$((failed + 1))
    tail -n 40 "${work}/log" >&2
  fi
  printf '%s: %s (%d s)\n' "$*" "${verdict}" "$((SECONDS - begin))"
}

{
  printf 'date %s, commit %s, %s\n' "$(date -u +%F)" "$(git rev-parse --short HEAD)" "$(valgrind --version)"
  check test_numeric --gtest_brief=1 '--gtest_filter=-Predicates.AgreeWith*:Length.*:Turn.*'
  check answer_hash --pairs 4
  check oracle_pairs --pairs 100 --seed 1
  check oracle_pairs --pairs 200 --seed 2 --bracket certified
  printf '%d failed\n' "${failed}"
} | tee tests/long/last_memcheck.txt
tail -n 1 tests/long/last_memcheck.txt | grep -q '^0 failed'
