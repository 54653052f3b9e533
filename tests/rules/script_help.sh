#!/usr/bin/env bash
# Every script answers --help by the comment at its top and does nothing else, refuses an option that it does not know, and no check
# passes where there is nothing to check.
#
#   tests/rules/script_help.sh ROOT
set -euo pipefail
root=$1
work=$(mktemp -d)
trap 'rm -rf "${work}"' EXIT
# Tools that would do something: whoever calls one is caught.
mkdir "${work}/tools"
for tool in apt-get cmake ctest dpkg-buildpackage em++ git mmdebstrap node valgrind; do
  printf '#!/bin/sh\nprintf "%%s\\n" "$0 $*" >>"%s"\nexit 99\n' "${work}/called" >"${work}/tools/${tool}"
done
chmod +x "${work}"/tools/*
export PATH=${work}/tools:/usr/bin:/bin
cd "${work}"

faults=0
# expect STATUS SCRIPT ARGUMENT...
expect() {
  local wanted=$1 script=$2 status=0
  shift 2
  timeout 60 "${script}" "$@" >"${work}/out" 2>"${work}/err" </dev/null || status=$?
  if ((status != wanted)) || [[ -e ${work}/called ]]; then
    printf '%s %s: exit code %d, not %d\n' "${script#"${root}"/}" "$*" "${status}" "${wanted}"
    { cat "${work}/called" "${work}/err" 2>/dev/null || true; } | head -n 3
    rm -f "${work}/called"
    faults=$((faults + 1))
  fi
}

for script in "${root}"/{demos,tests}/run.sh "${root}"/tests/long/*.sh \
  "${root}"/packaging/{abi,debian,hardening,release,try_debian,try_wheel,wasm}.sh; do
  expect 0 "${script}" --help
  if [[ $(head -n 1 "${work}/out") != "$(sed -n '2s/^# //p' "${script}")" ]]; then
    printf '%s --help does not begin with the comment at its top\n' "${script}"
    faults=$((faults + 1))
  fi
  expect 2 "${script}" --nonsense
done
expect 2 "${root}/tests/run.sh" release
mkdir empty
expect 2 "${root}/packaging/hardening.sh" empty
expect 1 "${root}/tests/long/run.sh" 1 "${work}/empty"
exit $((faults > 0))
