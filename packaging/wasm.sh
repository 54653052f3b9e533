#!/usr/bin/env bash
# Builds the C interface as WebAssembly, and the npm package around it, into build/npm.
#
#   packaging/wasm.sh          the module, the package, its tarball and the page to play with (build/npm/play.html)
#   packaging/wasm.sh files    all but the module, around the one that was built before
#
# Debian: apt-get install emscripten cmake ninja-build libeigen3-dev libboost-dev nlohmann-json3-dev nodejs. No fast math and no contraction, so that the
# answers have the bits of every other build. wasm128 vectors take the place of the instruction sets of x86-64: Eigen sees them as
# SSE2, since the order in which it adds the terms of a product depends on the size of its vectors.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source pd_core/cmake/debian_packages.sh
pd_no_options "$@"
for tool in em++ cmake ninja node; do
  command -v "${tool}" >/dev/null || { echo "${tool} is not installed"; exit 1; }
done
out=build/npm
work=build/wasm
if [[ ${1-} != files ]]; then
  # Boost and the reader of JSON alone from the system's headers: the others are those of another machine.
  mkdir -p "${work}/include"
  ln -sfn /usr/include/boost "${work}/include/boost"
  ln -sfn /usr/include/nlohmann "${work}/include/nlohmann"
  # Eigen includes it beside SSE2's header and uses nothing of it; emscripten has none. Every object depends on it, so it is written once.
  [[ -e ${work}/include/mmintrin.h ]] || : >"${work}/include/mmintrin.h"
  # With SSE2 Eigen writes assembler of x86 for GCC up to 6.2, as which Clang reports itself, and other assembler from 6.0 on. Between
  # both, for its arithmetic of versions, lies 5.99.
  # em++ -Os alone inlines no function, which would take three times as long.
  flags='-msimd128 -msse2 -fgnuc-version=5.99 -fwasm-exceptions -fvisibility=hidden'
  emcmake cmake -S . -B "${work}" -G Ninja -DCMAKE_BUILD_TYPE=Release -DCMAKE_CXX_FLAGS="${flags}" \
    -DCMAKE_CXX_FLAGS_RELEASE='-Os -finline-functions -DNDEBUG' -DCMAKE_UNITY_BUILD=ON -DPD_ISA=baseline -DPD_PRECOMPILED_HEADERS=OFF \
    -DPD_HARDENED=OFF -DPD_WITH_BULLET=OFF -DPD_WITH_MUJOCO=OFF -DPD_WITH_FCL=OFF -DPD_WITH_ODE=OFF -DPD_WITH_DART=OFF -DPD_WITH_RENDER=OFF -DPD_WITH_TESTS=OFF -DPD_WITH_DEMOS=OFF -DPD_WITH_PYTHON=OFF \
    -DPD_WITH_RECORDERS=OFF -DPD_INSTALL=OFF -DEigen3_DIR=/usr/share/eigen3/cmake -DBoost_NO_BOOST_CMAKE=ON \
    -DBoost_INCLUDE_DIR="${PWD}/${work}/include" --log-level=WARNING
  cmake --build "${work}" --target pdepth_wasm pdepth_wasm_convex pdepth_wasm_lines -j "${PD_JOBS:-$(nproc)}"
fi
node packaging/npm/build.mjs "${work}" "${out}"
node demos/play/build.mjs "${out}/package/single.js" "${out}/play.html"
