#!/usr/bin/env bash
# What takes too long for CI: blind mutations of the kept fuzz inputs, and random pairs against the exact oracle, on the release
# build. Ends with the first law that breaks; the input that broke it stands in the folder of the findings.
#
#   tests/long/run.sh [SECONDS_PER_TARGET [BUILD_FOLDER]]        600 build/release
#
# The last run stands beside this script in last_run.txt, once there was one.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
seconds=${1:-600}
build=${2:-build/release}
findings=$build/fuzz_findings
mkdir -p "$findings"

{
  printf 'date %s, commit %s, %s s a target\n' "$(date -u +%F)" "$(git rev-parse --short HEAD)" "$seconds"
  for target in pairs lines meshes; do
    [[ -x $build/fuzz_$target ]] || continue
    printf 'fuzz_%s: ' "$target"
    "$build/fuzz_$target" --seconds "$seconds" --seed 1 --keep "$findings/$target" "tests/fuzz/corpus/$target"
  done
  if [[ -x $build/oracle_pairs ]]; then
    printf 'oracle_pairs: '
    (cd "$findings" && "../oracle_pairs" --pairs $((seconds * 300)) --seed 2 | tail -1)
  fi
} | tee tests/long/last_run.txt
