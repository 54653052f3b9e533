#!/usr/bin/env bash
# Checks the packages of packaging/debian.sh, installs them in bare systems and uses them there. As root.
#
#   packaging/try_debian.sh [lintian] [audit] [tests]     all three unless some are named
#
#   lintian  no complaint beyond the overrides, each of which has its reason
#   audit    seconds from `apt install` of the command's package on a bare Debian 12 to a first audit, and kilobytes
#   tests    the programs of packaging/debian/tests, each in a bare system with what its line in tests/control names;
#            PD_TRIALS="fcl ode" runs these alone
# The last line is `N passed, N failed`.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source pd_core/cmake/debian_packages.sh
pd_no_options "$@"
source packaging/bare_system.sh
pd_require_packages mmdebstrap lintian dpkg-dev
out=${PWD}/build/debian
shopt -s nullglob
trees=("${out}"/pdepth-*/)
debs=("${out}"/*.deb)
if ((${#debs[@]} == 0 || ${#trees[@]} != 1)); then
  printf 'build/debian holds no packages: run packaging/debian.sh first\n' >&2
  exit 1
fi
tree=${trees[0]}

# with_packages FOLDER: a bare system in which apt finds our packages as it finds Debian's own.
with_packages() {
  bare_system "$1"
  mkdir "$1/packages"
  cp "${debs[@]}" "$1/packages"
  (cd "$1/packages" && dpkg-scanpackages --multiversion . >Packages 2>/dev/null)
  printf 'deb [trusted=yes] file:/packages ./\n' >"$1/etc/apt/sources.list.d/packages.list"
  chroot "$1" apt-get -qq update
}

try_lintian() {
  local status=0 changes=("${out}"/pdepth_*.changes)
  if ((${#changes[@]} == 0)); then
    printf 'build/debian holds no .changes: packaging/debian.sh did not end\n' >&2
    status=1
  else
    lintian --fail-on warning,error --tag-display-limit 0 "${changes[@]}" || status=$?
  fi
  verdict "${status}" lintian
}

try_audit() {
  local root=${pd_workplace}/audit status=0 begin
  bare_system "${root}"
  cp "${out}"/pdepth_*.deb "${out}"/libpdepth-core*_*.deb "${root}/tmp"
  rm -f "${root}"/tmp/*dbgsym*
  cp "${tree}debian/tests/audit" "${root}/tmp/audit"
  begin=$(date +%s%N)
  { install_into "${root}" $(cd "${root}" && printf '/%s ' tmp/*.deb) &&
      chroot "${root}" env AUTOPKGTEST_TMP=/tmp /tmp/audit; } || status=$?
  printf 'from apt install to a first audit: %d ms\n' "$((($(date +%s%N) - begin) / 1000000))"
  printf 'packages: %d KB; installed: %d KB\n' "$(du -ck "${root}"/tmp/*.deb | awk 'END {print $1}')" \
    "$(chroot "${root}" dpkg-query -W -f '${Installed-Size}\n' pdepth libpdepth-core0.1 | awk '{s += $1} END {print s}')"
  verdict "${status}" 'audit in a bare system'
  rm -rf "${root}"
}

try_tests() {
  local test root depends status
  for test in ${PD_TRIALS:-$(sed -n 's/^Tests: //p' "${tree}debian/tests/control")}; do
    depends=$(awk -v test="${test}" '$1 == "Tests:" {found = $2 == test} $1 == "Depends:" && found {$1 = ""; gsub(",", ""); print}' \
      "${tree}debian/tests/control")
    root=${pd_workplace}/${test}
    status=0
    with_packages "${root}"
    mkdir -p "${root}/tree/debian" "${root}/tree/tests" "${root}/tmp/${test}"
    cp -r "${tree}debian/tests" "${root}/tree/debian/tests"
    cp -r "${tree}tests/packaging" "${root}/tree/tests/packaging"
    # shellcheck disable=SC2086
    { install_into "${root}" ${depends} &&
        chroot "${root}" sh -c "cd /tree && AUTOPKGTEST_TMP=/tmp/${test} debian/tests/${test}"; } || status=$?
    verdict "${status}" "${test}"
    rm -rf "${root}"
  done
}

parts=("$@")
((${#parts[@]} > 0)) || parts=(lintian audit tests)
for part in "${parts[@]}"; do
  case ${part} in
    lintian | audit | tests) "try_${part}" ;;
    *) pd_usage >&2 && exit 2 ;;
  esac
done
last_line
