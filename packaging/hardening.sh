#!/usr/bin/env bash
# Checks that programs and shared libraries are as SECURITY.md promises: a stack protector, checked library calls (_FORTIFY_SOURCE), all
# symbols bound before the first one is used (-z now, -z relro), no stack that runs, addresses that the system chooses.
#
#   packaging/hardening.sh FILE|FOLDER...
#
# It reads ELF files with readelf, and in a folder all programs and shared libraries. It ends with 1 if something is missing,
# and with 2 where there is nothing to check.
# packaging/debian.sh runs it on what it has built.
set -euo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/../pd_core/cmake/debian_packages.sh"
pd_no_options "$@"
(($# > 0)) || { pd_usage >&2; exit 2; }

missing_of() { # one word for each promise that the file breaks
  local dynamic symbols segments
  dynamic=$(readelf -Wd "$1") segments=$(readelf -Wl "$1") symbols=$(readelf -W --dyn-syms "$1")
  grep -qE 'BIND_NOW|FLAGS_1.*NOW' <<<"${dynamic}" || printf ' now'
  grep -q GNU_RELRO <<<"${segments}" || printf ' relro'
  grep -qE 'GNU_STACK.* RW ' <<<"${segments}" || printf ' stack-that-does-not-run'
  grep -qE 'file type is DYN|Shared object|PIE' <<<"${segments}" || printf ' position-independent'
  grep -q __stack_chk_fail <<<"${symbols}" || printf ' stack-protector'
  # Checked copies appear only where the compiler cannot prove the size, and the standard library's own headers call vsnprintf
  # by a pointer: a file that formats text and checks nothing was compiled without.
  if grep -qE ' v?(f|s|sn)?printf@' <<<"${symbols}"; then
    grep -qE ' __[a-z]+_chk@' <<<"${symbols}" || printf ' checked-calls'
  fi
}

status=0
checked=0
while IFS= read -r -d '' file; do
  [[ $(head -c 4 "${file}" | od -An -c | tr -d ' ') == '177ELF' ]] || continue
  readelf -h "${file}" 2>/dev/null | grep -qE 'Type: +(DYN|EXEC)' || continue
  checked=$((checked + 1))
  missing=$(missing_of "${file}")
  printf '%-60s %s\n' "${file##*/}" "${missing:+misses}${missing:-holds}"
  [[ -z ${missing} ]] || status=1
done < <(find "$@" -type f -print0)
if ((checked == 0)); then
  printf 'no program and no shared library: %s\n' "$*" >&2
  exit 2
fi
exit "${status}"
