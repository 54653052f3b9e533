#!/usr/bin/env bash
# One world on several threads: builds Bullet from Debian's source package with BT_THREADSAFE (Debian's own is built without),
# the project and its tests of threads against it, all under the thread sanitizer, and runs them.
#
#   tests/long/threads.sh [SANITIZER]        thread; none: the release flags, to see the bits and the time
#
# Some 450 sources are compiled at first. BULLET_SOURCE names an unpacked source tree instead of the package; else the
# package's source comes from the mirrors of /etc/apt, whether or not they list sources. Races that are Bullet's own are
# left out by name (threads_of_libraries.txt). The last run stands in last_threads.txt.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
source pd_core/cmake/debian_packages.sh
pd_no_options "$@"
pd_use_ccache

sanitizer=${1:-thread}
place=$PWD/build/threads-${sanitizer}
mkdir -p "${place}"
flags='-DBT_THREADSAFE=1'
build=(-DCMAKE_BUILD_TYPE=Release)
if [[ ${sanitizer} != none ]]; then
  flags+=" -fsanitize=${sanitizer} -fno-omit-frame-pointer"
  build=(-DCMAKE_BUILD_TYPE=Debug '-DCMAKE_CXX_FLAGS_DEBUG=-O1 -g1')
fi

# Downloads and unpacks the source package by lists of its own; the machine's are left alone.
fetch_source() {
  local lists=${place}/apt
  mkdir -p "${lists}/parts" "${lists}/lists/partial" "${lists}/cache/archives/partial"
  sed 's/^Types: deb$/Types: deb-src/' /etc/apt/sources.list.d/*.sources >"${lists}/parts/source.sources" 2>/dev/null || true
  sed -n 's/^deb /deb-src /p' /etc/apt/sources.list >"${lists}/source.list" 2>/dev/null || true
  local options=(-q -o "Dir::Etc::sourcelist=${lists}/source.list" -o "Dir::Etc::sourceparts=${lists}/parts"
                 -o "Dir::State::lists=${lists}/lists" -o "Dir::Cache=${lists}/cache")
  (cd "${place}" && apt-get "${options[@]}" update && apt-get "${options[@]}" source --download-only bullet &&
     mkdir -p source && tar xf bullet_*.orig.tar.* -C source --strip-components=1)
}

source_tree=${BULLET_SOURCE:-${place}/source}
[[ -f ${source_tree}/CMakeLists.txt ]] || fetch_source
cmake -S "${source_tree}" -B "${place}/bullet" -G Ninja --log-level=ERROR "${pd_launcher[@]}" "${build[@]}" \
  -DCMAKE_CXX_FLAGS="${flags}" -DBULLET2_MULTITHREADING=ON -DBUILD_SHARED_LIBS=OFF -DINSTALL_LIBS=ON \
  -DCMAKE_INSTALL_PREFIX="${place}/installed" -DBUILD_BULLET3=OFF -DBUILD_EXTRAS=OFF -DBUILD_PYBULLET=OFF \
  -DBUILD_BULLET2_DEMOS=OFF -DBUILD_OPENGL3_DEMOS=OFF -DBUILD_CPU_DEMOS=OFF -DBUILD_UNIT_TESTS=OFF
cmake --build "${place}/bullet" --target install

PKG_CONFIG_PATH=$(dirname "$(find "${place}/installed" -name bullet.pc)") \
  cmake -S . -B "${place}/project" -G Ninja --log-level=ERROR "${pd_launcher[@]}" "${build[@]}" \
  -DCMAKE_CXX_FLAGS="${flags}" -DPD_WITH_BENCH=OFF -DPD_WITH_PYTHON=OFF -DPD_WITH_RENDER=OFF
cmake --build "${place}/project" --target test_threads

{
  printf 'date %s, commit %s, sanitizer %s\n' "$(date -u +%F)" "$(git rev-parse --short HEAD)" "${sanitizer}"
  TSAN_OPTIONS="halt_on_error=1 suppressions=$PWD/tests/long/threads_of_libraries.txt" \
    "${place}/project/test_threads"
} 2>&1 | tee tests/long/last_threads.txt
