#!/usr/bin/env bash
# The fuzz targets under libFuzzer, with the address and the undefined-behaviour sanitizer and assertions on: the kept inputs,
# then mutations that follow coverage. Ends with the first law that breaks; the input that broke it stands in the folder of the
# findings. Inputs that reach something new are kept in the build folder from run to run.
#
#   tests/long/fuzz.sh [SECONDS_PER_TARGET [BUILD_FOLDER [TARGET...]]]        2400 build/fuzz pairs lines meshes
#
# Needs Clang with its libFuzzer and sanitizers (Debian: clang-14, libclang-rt-14-dev). Other fuzzing: run.sh, without
# instrumentation. The last run stands in last_run.txt.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
source pd_core/cmake/debian_packages.sh
pd_use_ccache

seconds=${1:-2400}
build=${2:-build/fuzz}
shift $(($# < 2 ? $# : 2))
targets=("$@")
((${#targets[@]} > 0)) || targets=(pairs lines meshes)

# The sanitizers of the preset asan-ubsan.
sanitizers='-fsanitize=fuzzer-no-link,address,undefined -fno-sanitize=null,alignment -fno-sanitize-recover=all'
cmake -S . -B "${build}" -G Ninja --log-level=ERROR "${pd_launcher[@]}" -DCMAKE_CXX_COMPILER=clang++-14 \
  -DCMAKE_BUILD_TYPE=Release '-DCMAKE_CXX_FLAGS_RELEASE=-O1 -g1' "-DCMAKE_CXX_FLAGS=${sanitizers} -fno-omit-frame-pointer" \
  -DCMAKE_UNITY_BUILD=ON -DPD_PRECOMPILED_HEADERS=OFF -DPD_FUZZ=ON -DPD_WITH_BULLET=OFF -DPD_WITH_RENDER=OFF \
  -DPD_WITH_PYTHON=OFF -DPD_WITH_BENCH=OFF
cmake --build "${build}" --target "${targets[@]/#/fuzz_}"

mkdir -p "${build}/findings"
export UBSAN_OPTIONS=print_stacktrace=1
for target in "${targets[@]}"; do
  mkdir -p "${build}/corpus/${target}"
  log=${build}/${target}.log
  printf 'fuzz_%s, commit %s, %s s\n' "${target}" "$(git rev-parse --short HEAD)" "${seconds}"
  verdict='nothing found'
  "${build}/fuzz_${target}" -max_total_time="${seconds}" -timeout=400 -report_slow_units=400 -rss_limit_mb=2500 \
    -print_final_stats=1 -artifact_prefix="${build}/findings/${target}_" "${build}/corpus/${target}" \
    "tests/fuzz/corpus/${target}" >"${log}" 2>&1 || verdict="FOUND, see ${log}"
  grep -a 'INITED' "${log}" || true
  grep -a '^#.*cov:' "${log}" | tail -n 1
  printf '%s\n' "${verdict}"
  [[ ${verdict} == 'nothing found' ]]
done
