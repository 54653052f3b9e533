#!/usr/bin/env bash
# The same bits from other compilers, optimisation levels, instruction sets and, emulated, from another machine: builds the
# core and `answer_hash` once a row and compares its answers with the stored sample. GCC's -O3 and Clang 14's -O1 with sanitizers are CI's.
#
#   tests/long/same_bits.sh [ROW...]      all rows, about half an hour on two cores
#
# Rows whose compiler is missing say so and count as failed (Debian: clang-14, clang-19, g++-aarch64-linux-gnu, qemu-user).
# The last run stands in last_same_bits.txt.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
source pd_core/cmake/debian_packages.sh
pd_no_options "$@"
pd_use_ccache

sample=tests/bench/results/answer_hash_sample.txt
core_only=(-DPD_WITH_BULLET=OFF -DPD_WITH_MUJOCO=OFF -DPD_WITH_FCL=OFF -DPD_WITH_ODE=OFF -DPD_WITH_DART=OFF -DPD_WITH_RENDER=OFF -DPD_WITH_DEMOS=OFF -DPD_WITH_PYTHON=OFF -DPD_PRECOMPILED_HEADERS=OFF
           -DCMAKE_UNITY_BUILD=ON)
# Another machine's compiler, this one's headers: of what is found here only headers are used.
aarch64=(-DCMAKE_SYSTEM_NAME=Linux -DCMAKE_SYSTEM_PROCESSOR=aarch64
         "-DCMAKE_PREFIX_PATH=/usr/lib/$(gcc -print-multiarch)/cmake")

# row NAME COMPILER FLAGS RUNNER [CMAKE_OPTION...]
row() {
  names+=("$1")
  local name=$1 compiler=$2 flags=$3 runner=$4 folder=build/bits/$1
  shift 4
  ((${#wanted[@]} == 0)) || [[ " ${wanted[*]} " == *" ${name} "* ]] || return 0
  local verdict='did not build'
  if ! command -v "${compiler}" >/dev/null; then
    verdict="no ${compiler} here"
  elif cmake -S . -B "${folder}" -G Ninja --log-level=ERROR "${pd_launcher[@]}" "${core_only[@]}" -DCMAKE_BUILD_TYPE=Release \
         -DCMAKE_CXX_COMPILER="${compiler}" -DCMAKE_CXX_FLAGS_RELEASE="${flags} -DNDEBUG" "$@" >"${folder}.log" 2>&1 &&
       cmake --build "${folder}" --target answer_hash >>"${folder}.log" 2>&1; then
    if ${runner} "${folder}/answer_hash" --pairs 1000 --check "${sample}" >>"${folder}.log" 2>&1; then
      verdict=equal
    else
      verdict="DIFFERENT, see ${folder}.log"
    fi
  fi
  printf '%-22s %s %s %s: %s\n' "${name}" "${compiler}" "$("${compiler}" -dumpversion 2>/dev/null || true)" "${flags}" "${verdict}"
  [[ ${verdict} == equal ]] || failed=$((failed + 1))
}

wanted=("$@")
names=()
failed=0
mkdir -p build/bits
{
  printf 'date %s, commit %s, answers: %s\n' "$(date -u +%F)" "$(git rev-parse --short HEAD)" "${sample}"
  row gcc-o2 g++ -O2 ''
  row gcc-o3-baseline g++ -O3 '' -DPD_ISA=baseline
  row clang-14-o0 clang++-14 -O0 ''
  row clang-14-o3 clang++-14 -O3 ''
  row clang-19-o3 clang++-19 -O3 ''
  row clang-19-o2 clang++-19 -O2 ''
  row aarch64-gcc-o3 aarch64-linux-gnu-g++ -O3 'qemu-aarch64 -L /usr/aarch64-linux-gnu' "${aarch64[@]}"
  for name in "${wanted[@]}"; do
    [[ " ${names[*]} " == *" ${name} "* ]] || { failed=$((failed + 1)); printf '%s: no such row; there are %s\n' "${name}" "${names[*]}"; }
  done
  printf '%d rows differ or could not be asked\n' "${failed}"
} | tee build/bits/last.txt
((${#wanted[@]} > 0)) || cp build/bits/last.txt tests/long/last_same_bits.txt
tail -n 1 build/bits/last.txt | grep -q '^0 rows'
