#!/usr/bin/env bash
# Compares the interface of two builds of the shared library: programs that were linked with the older one must run with the newer
# one as long as the version that the library's name carries (0.1) stays. Debian: abigail-tools.
#
#   packaging/abi.sh OLD NEW     each a libpdepth_core.so or a libpdepth-core0.1_*.deb; a package of its debug symbols that lies
#                                beside a package is used, too, and lets changed types be found, not only functions that are gone
#
# The exit code is 0 where nothing that a program may use has gone or changed; new functions are no change. 1 where something has:
# then the minor version has to grow (CMakeLists.txt), and with it the name of the library and its package.
set -euo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/../pd_core/cmake/debian_packages.sh"
pd_no_options "$@"
if (($# != 2)); then
  pd_usage >&2
  exit 2
fi
command -v abidiff >/dev/null || { printf 'abidiff is missing: apt-get install abigail-tools\n' >&2 && exit 2; }
workplace=$(mktemp -d)
trap 'rm -rf "${workplace}"' EXIT

# library FILE FOLDER: prints where the library is, and unpacks it there from a package.
library() {
  if [[ $1 != *.deb ]]; then
    printf '%s\n' "$1"
    return
  fi
  local symbols=${1/libpdepth-core0.1_/libpdepth-core0.1-dbgsym_}
  dpkg-deb -x "$1" "$2"
  [[ ! -f ${symbols} ]] || dpkg-deb -x "${symbols}" "$2"
  find "$2" -type f -name 'libpdepth_core.so.*' -print -quit
}
old=$(library "$1" "${workplace}/old")
new=$(library "$2" "${workplace}/new")
for file in "${old}" "${new}"; do
  [[ -f ${file} ]] || { printf 'no library in %s\n' "${file}" >&2 && exit 2; }
done

debug() { [[ ! -d $1 ]] || printf '%s\n' "$2" "$1"; }
mapfile -t debug_folders < <(debug "${workplace}/old/usr/lib/debug" --debug-info-dir1
                             debug "${workplace}/new/usr/lib/debug" --debug-info-dir2)
status=0
abidiff --no-added-syms "${debug_folders[@]}" "${old}" "${new}" || status=$?
# Bits of abidiff's exit code: 1 and 2 an error of its own or of usage, 4 a change, 8 a change that breaks programs.
if ((status & 3)); then
  printf 'abidiff could not compare the two\n' >&2
  exit 2
fi
if ((status & 12)); then
  printf 'The interface has changed: a new minor version is due.\n' >&2
  exit 1
fi
printf 'What was linked with %s runs with %s.\n' "$(basename "$1")" "$(basename "$2")"
