#!/usr/bin/env bash
# From a fresh Debian 12 to pictures: installs the packages that are missing (as root; otherwise it names them), builds the
# command into build/release and runs the main job, the demos stacking and rollback, both at once. What they make goes to out/.
#
#   demos/run.sh [--steps N]    N steps in each demo, instead of each demo's own number
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source pd_core/cmake/debian_packages.sh

steps=()
if [[ $# -eq 2 && $1 == --steps && $2 =~ ^[1-9][0-9]*$ ]]; then
  steps=(--steps "$2")
elif (($# > 0)); then
  pd_no_options "$@"
  pd_usage >&2
  exit 2
fi

printf '== 1/4 packages\n'
pd_require_packages "${pd_build_packages[@]}" "${pd_demo_packages[@]}"

printf '== 2/4 build\n'
pd_use_ccache
cmake --preset release --log-level=WARNING "${pd_launcher[@]}"
cmake --build --preset release --target pdepth

demo_seconds=${SECONDS}
mkdir -p out
run_demo() {
  build/release/pdepth demo "$1" --out "out/$1" --video --force "${steps[@]}"
}
# The other core runs the second demo, then builds what an installed copy holds beside the command.
{
  run_demo rollback >out/rollback.txt
  cmake --build --preset release -j 1 --target pdepth_c pd_doors >out/build.txt 2>&1 || { cat out/build.txt >&2; exit 1; }
} &
other_core=$!
trap 'kill "${other_core}" 2>/dev/null || true' EXIT
printf '== 3/4 stacking: solver against solver from the same start\n'
run_demo stacking | tee out/stacking.txt
printf '== 4/4 rollback: taken back to the exact time of first contact\n'
wait "${other_core}"
cat out/rollback.txt
demo_seconds=$((SECONDS - demo_seconds))

printf '\n== done in %d s (demos, C library and doors %d s)\n' "${SECONDS}" "${demo_seconds}"
for name in stacking rollback; do
  printf '\n%s\n' "${name}"
  sed 's/^/  /' "out/${name}.txt"
  find "out/${name}" -maxdepth 1 \( -name '*.png' -o -name '*.mp4' -o -name '*.csv' -o -name '*.json' \) |
    sort | sed 's/^/  /'
  find "out/${name}" -mindepth 2 -name '*.png' | sed 's|/[^/]*$||' | sort | uniq -c |
    awk '{printf "  %s/ (%d pictures)\n", $2, $1}'
done
