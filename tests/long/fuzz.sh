#!/usr/bin/env bash
# The fuzz targets under libFuzzer or AFL++, with the address and the undefined-behaviour sanitizer and assertions on: the kept
# inputs, then mutations that follow coverage. Ends with the first law that breaks; the input that broke it stands in the folder
# of the findings. Inputs that reach something new are kept in the build folder from run to run.
#
#   [ENGINE=afl] tests/long/fuzz.sh [SECONDS_PER_TARGET [BUILD_FOLDER [TARGET...]]]        2400 build/fuzz pairs lines meshes structures worlds
#
# Needs Clang with its libFuzzer and sanitizers (Debian: clang-14, libclang-rt-14-dev), or afl++. Other fuzzing: run.sh, without
# instrumentation. The last run stands in last_run.txt.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
source pd_core/cmake/debian_packages.sh
pd_no_options "$@"
pd_use_ccache

engine=${ENGINE:-libfuzzer}
seconds=${1:-2400}
build=${2:-build/fuzz}
shift $(($# < 2 ? $# : 2))
targets=("$@")
((${#targets[@]} > 0)) || targets=(pairs lines meshes structures worlds)

# The sanitizers of the preset asan-ubsan.
sanitizers='-fsanitize=address,undefined -fno-sanitize=null,alignment -fno-sanitize-recover=all'
case ${engine} in
  libfuzzer) compiler=clang++-14 coverage='-fsanitize=fuzzer-no-link' ;;
  afl) compiler=afl-clang-fast++ coverage='' ;;  # the compiler's own
  *)
    printf 'ENGINE=%s: libfuzzer or afl were expected\n' "${engine}" >&2
    exit 2
    ;;
esac
cmake -S . -B "${build}" -G Ninja --log-level=ERROR "${pd_launcher[@]}" "-DCMAKE_CXX_COMPILER=${compiler}" \
  -DCMAKE_BUILD_TYPE=Release '-DCMAKE_CXX_FLAGS_RELEASE=-O1 -g1' "-DCMAKE_CXX_FLAGS=${coverage} ${sanitizers} -fno-omit-frame-pointer" \
  -DCMAKE_UNITY_BUILD=ON -DPD_PRECOMPILED_HEADERS=OFF -DPD_FUZZ=ON -DPD_WITH_MUJOCO=OFF -DPD_WITH_FCL=OFF -DPD_WITH_ODE=OFF -DPD_WITH_DART=OFF -DPD_WITH_RENDER=OFF \
  -DPD_WITH_PYTHON=OFF -DPD_WITH_BENCH=OFF
cmake --build "${build}" --target "${targets[@]/#/fuzz_}"

# Each runs one target and says what it reached; fails where something was found.
run_libfuzzer() {
  local target=$1 log=$2 verdict=0
  mkdir -p "${build}/corpus/${target}"
  "${build}/fuzz_${target}" -max_total_time="${seconds}" -timeout=400 -report_slow_units=400 -rss_limit_mb=2500 \
    -print_final_stats=1 -artifact_prefix="${build}/findings/${target}_" "${build}/corpus/${target}" \
    "tests/fuzz/corpus/${target}" >"${log}" 2>&1 || verdict=1
  grep -a 'INITED' "${log}" || true
  grep -a '^#.*cov:' "${log}" | tail -n 1
  return "${verdict}"
}
run_afl() {
  local target=$1 log=$2 out=${build}/afl/$1
  mkdir -p "${build}/afl"
  # A folder that an earlier run filled is gone on from.
  AFL_NO_UI=1 AFL_SKIP_CPUFREQ=1 AFL_NO_AFFINITY=1 AFL_I_DONT_CARE_ABOUT_MISSING_CRASHES=1 AFL_AUTORESUME=1 \
    afl-fuzz -i "tests/fuzz/corpus/${target}" -o "${out}" -V "${seconds}" -t 100000 -m none -- "${build}/fuzz_${target}" \
    >"${log}" 2>&1 || return 1
  grep -E '^(execs_done|corpus_count|edges_found|total_edges|saved_crashes|saved_hangs) ' "${out}/default/fuzzer_stats"
  [[ -z $(find "${out}/default/crashes" "${out}/default/hangs" -name 'id*' -print -quit) ]]
}

mkdir -p "${build}/findings"
export UBSAN_OPTIONS=print_stacktrace=1
for target in "${targets[@]}"; do
  log=${build}/${target}.log
  printf 'fuzz_%s under %s, commit %s, %s s\n' "${target}" "${engine}" "$(git rev-parse --short HEAD)" "${seconds}"
  if "run_${engine}" "${target}" "${log}"; then
    printf 'nothing found\n'
  else
    printf 'FOUND, see %s\n' "${log}"
    exit 1
  fi
done
