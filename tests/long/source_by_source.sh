#!/usr/bin/env bash
# Every source of the libraries, the command and the benches compiled alone, without precompiled headers, by Clang 14 without
# optimisation: finds one that lacks an include, which CI's builds, folder by folder or from precompiled headers, cannot, and a bench
# that no longer compiles. Warnings are errors.
#
#   tests/long/source_by_source.sh      a quarter of an hour on two cores
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
source pd_core/cmake/debian_packages.sh
pd_no_options "$@"
pd_require_packages "${pd_build_packages[@]}" clang-14
pd_use_ccache

cmake -S . -B build/source_by_source -G Ninja --log-level=WARNING "${pd_launcher[@]}" -DCMAKE_CXX_COMPILER=clang++-14 \
  -DCMAKE_BUILD_TYPE=Debug -DCMAKE_CXX_FLAGS_DEBUG=-O0 -DPD_WARNINGS_AS_ERRORS=ON -DPD_PRECOMPILED_HEADERS=OFF
cmake --build build/source_by_source --target pdepth benches
