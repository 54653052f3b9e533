#!/usr/bin/env bash
# From a fresh Debian 12 to pictures: installs the packages that are missing (as root; otherwise it names them), builds the
# command into build/release and runs the main job, the demos stacking and rollback. What they make goes to out/.
#
#   demos/run.sh [--steps N]    N steps in each demo, instead of each demo's own number
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source pd_core/cmake/debian_packages.sh

steps=()
if [[ $# -eq 2 && $1 == --steps && $2 =~ ^[1-9][0-9]*$ ]]; then
  steps=(--steps "$2")
elif (($# > 0)); then
  sed -n '2,5s/^# \{0,1\}//p' "${BASH_SOURCE[0]}" >&2
  exit 2
fi

printf '== 1/4 packages\n'
pd_require_packages "${pd_build_packages[@]}" "${pd_demo_packages[@]}"

printf '== 2/4 build\n'
pd_use_ccache
cmake --preset release --log-level=WARNING "${pd_launcher[@]}"
cmake --build --preset release --target pdepth pdepth_c pd_doors

demo_seconds=${SECONDS}
run_demo() {
  local name=$1
  shift
  mkdir -p out
  build/release/pdepth demo "${name}" --out "out/${name}" --video --force "$@" | tee "out/${name}.txt"
}
printf '== 3/4 stacking: solver against solver from the same start\n'
run_demo stacking "${steps[@]}"
printf '== 4/4 rollback: taken back to the exact time of first contact\n'
run_demo rollback "${steps[@]}"

printf '\n== done in %d s (demos %d s)\n' "${SECONDS}" "$((SECONDS - demo_seconds))"
for name in stacking rollback; do
  printf '\n%s\n' "${name}"
  sed 's/^/  /' "out/${name}.txt"
  find "out/${name}" -maxdepth 1 \( -name '*.png' -o -name '*.mp4' -o -name '*.csv' -o -name '*.json' \) |
    sort | sed 's/^/  /'
  find "out/${name}" -mindepth 2 -name '*.png' | sed 's|/[^/]*$||' | sort | uniq -c |
    awk '{printf "  %s/ (%d pictures)\n", $2, $1}'
done
