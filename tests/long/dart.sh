#!/usr/bin/env bash
# The door to DART against Debian's library: installs libdart-dev (130 packages, some 700 MB) and dartpy, builds the door's tests and
# its guides, and runs them. CI leaves the door out, because its packages would take longer than its tests.
#
#   tests/long/dart.sh [BUILD_FOLDER]      build/dart if none is named
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
source pd_core/cmake/debian_packages.sh
pd_no_options "$@"
pd_use_ccache
pd_require_packages "${pd_build_packages[@]}" libgtest-dev libqhull-dev libdart-dev \
  python3-dartpy python3-dev pybind11-dev
build=${1:-build/dart}
cmake -S . -B "${build}" -G Ninja --log-level=WARNING "${pd_launcher[@]}" -DCMAKE_BUILD_TYPE=Release -DCMAKE_UNITY_BUILD=ON \
  -DPD_WITH_DART=ON -DPD_WITH_BULLET=OFF -DPD_WITH_RENDER=OFF -DPD_WITH_BENCH=OFF
cmake --build "${build}" --target test_dart docs_dart_guide pd_python_dart
"${build}/test_dart"
(cd "${build}" && ./docs_dart_guide)
PYTHONPATH=${build}/python /usr/bin/python3 -B tests/dart/dartpy_guide.py
