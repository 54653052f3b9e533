#!/usr/bin/env bash
# Debian 12 packages of the committed tree, into build/debian: libpdepth-core0.1, libpdepth0, libpdepth-dev, libpdepth-bullet-dev,
# libpdepth-mujoco-dev, libpdepth-ode-dev, libpdepth-fcl-dev, pdepth, pdepth-pictures, pdepth-recorders, python3-pdepth and
# pdepth-doc. The top level of the tree has no folder debian: packaging/debian is laid out as dpkg wants it in a copy.
#
#   packaging/debian.sh [--binary-arch]      --binary-arch leaves out pdepth-doc, which needs doxygen and mkdocs
#
# PD_JOBS says how many sources are compiled at once (default: one for each processor), PD_CMAKE_OPTIONS adds options of CMake.
# ccache is used where it is installed.
# packaging/try_debian.sh checks, installs and uses the packages in a bare system.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source pd_core/cmake/debian_packages.sh

[[ ${1-} == --binary-arch ]] || pd_no_options "$@"
build=(--build=full)
if [[ ${1-} == --binary-arch ]]; then
  build=(--build=any)
elif (($# > 0)); then
  pd_usage >&2
  exit 2
fi

pd_require_packages "${pd_build_packages[@]}" "${pd_package_packages[@]}"
version=$(sed -n 's/^project(pdepth VERSION \([0-9.]*\).*/\1/p' CMakeLists.txt)
commit=$(git rev-parse --short=12 HEAD)
if ! git diff --quiet HEAD; then
  printf 'What is not committed is left out of the packages.\n' >&2
fi

out=${PWD}/build/debian
tree=${out}/pdepth-${version}
mkdir -p "${out}"
find "${out}" -maxdepth 1 -type f -delete
# The build folder of an earlier run stays, so that ninja builds only what has changed.
mkdir -p "${tree}"
find "${tree}" -mindepth 1 -maxdepth 1 ! -name build -exec rm -rf {} +
git archive --prefix="pdepth-${version}/" HEAD | gzip -9n >"${out}/pdepth_${version}.orig.tar.gz"
tar -xf "${out}/pdepth_${version}.orig.tar.gz" -C "${out}"
cp -r packaging/debian "${tree}/debian"
printf '%s\n' "${commit}" >"${tree}/debian/commit"

export DEB_BUILD_OPTIONS="parallel=${PD_JOBS:-$(nproc)} ${DEB_BUILD_OPTIONS-}"
if command -v ccache >/dev/null; then
  export PD_CMAKE_OPTIONS="${PD_CMAKE_OPTIONS-} -DCMAKE_CXX_COMPILER_LAUNCHER=ccache"
  export CCACHE_SLOPPINESS="${CCACHE_SLOPPINESS:-pch_defines,time_macros}" CCACHE_BASEDIR="${tree}" CCACHE_NOHASHDIR=1
  export CCACHE_DIR="${CCACHE_DIR:-${HOME-/root}/.cache/ccache}"
fi
(cd "${tree}" && dpkg-buildpackage --no-sign --no-check-builddeps --no-pre-clean "${build[@]}")
printf '\n== hardening (SECURITY.md)\n'
packaging/hardening.sh "${tree}/debian/tmp"
printf '\n== packages\n'
find "${out}" -maxdepth 1 -name '*.deb' -printf '%9s  %P\n' | sort -k 2
