#!/usr/bin/env bash
# What takes too long for CI: blind mutations of the kept fuzz inputs, and pairs against the exact oracles, random ones and ones
# of small whole numbers, and pairs of all kinds of shapes by laws, on the release build. Ends with the first law that breaks; the input that broke it stands in the folder
# of the findings.
#
#   tests/long/run.sh [SECONDS_PER_TARGET [BUILD_FOLDER [ORACLE_PAIRS [GRID_PAIRS]]]]        600 build/release 180000 6000000
#
# Laws at volume, under three hours on two cores: tests/long/run.sh 1 build/release 10000000 100000000
#
# The last run stands beside this script in last_run.txt, once there was one.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
source pd_core/cmake/debian_packages.sh
pd_no_options "$@"
seconds=${1:-600}
build=${2:-build/release}
oracle_pairs=${3:-$((seconds * 300))}
grid_pairs=${4:-$((seconds * 10000))}
member_pairs=${5:-100000}
findings=$build/fuzz_findings
for program in fuzz_pairs fuzz_lines fuzz_meshes fuzz_structures fuzz_worlds oracle_pairs grid_pairs member_pairs; do
  [[ -x $build/$program ]] || { printf '%s: not built; cmake --build %s --target %s\n' "$build/$program" "$build" "$program" >&2; exit 1; }
done
mkdir -p "$findings"

{
  printf 'date %s, commit %s, %s s a target\n' "$(date -u +%F)" "$(git rev-parse --short HEAD)" "$seconds"
  for target in pairs lines meshes structures worlds; do
    printf 'fuzz_%s: ' "$target"
    "$build/fuzz_$target" --seconds "$seconds" --seed 1 --keep "$findings/$target" "tests/fuzz/corpus/$target"
  done
  # Half of them with each bracket, other pairs for each.
  seed=2
  for bracket in tightest certified; do
    printf 'oracle_pairs --bracket %s --seed %s: ' "$bracket" "$seed"
    (cd "$findings" && "../oracle_pairs" --pairs $((oracle_pairs / 2)) --seed "$seed" --bracket "$bracket" --threads "$(nproc)" | tail -2)
    seed=$((seed + 1))
  done
  printf 'grid_pairs: %s pairs\n' "$grid_pairs"
  (cd "$findings" && "../grid_pairs" --pairs "$grid_pairs" --seed 2 --threads "$(nproc)" | tee grid_pairs.txt | tail -3)
  printf 'member_pairs: '
  "$build/member_pairs" --pairs "$member_pairs" --seed 2 --threads "$(nproc)"
} | tee tests/long/last_run.txt
