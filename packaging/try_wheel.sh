#!/usr/bin/env bash
# Installs a wheel in a bare Debian 12 that has Python and numpy, and none of the packages that the wheel was built with, and uses
# the module and the command there. As root. The last line is `N passed, N failed`.
#
#   packaging/try_wheel.sh [WHEEL]     without a WHEEL one is built from the tree, into build/wheel
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
source pd_core/cmake/debian_packages.sh
pd_no_options "$@"
source packaging/bare_system.sh
pd_require_packages mmdebstrap
wheel=${1-}
if [[ -z ${wheel} ]]; then
  pd_require_packages "${pd_build_packages[@]}" python3-dev pybind11-dev python3-numpy python3-setuptools python3-wheel python3-build
  rm -rf build/wheel
  /usr/bin/python3 -m build --no-isolation --wheel --outdir build/wheel .
  wheel=$(echo build/wheel/pdepth-*.whl)
fi
printf 'wheel: %d KB\n' "$(du -k "${wheel}" | cut -f 1)"

root=${pd_workplace}/wheel
bare_system "${root}"
install_into "${root}" python3 python3-numpy python3-venv
cp "${wheel}" "${root}/tmp"
chroot "${root}" sh -c 'python3 -m venv --system-site-packages /env &&
  /env/bin/pip install --quiet --no-index --no-deps --disable-pip-version-check /tmp/pdepth-*.whl'

# try NAME SCRIPT: a script of the shell in the bare system.
try() {
  local status=0
  chroot "${root}" sh -euc "cd /tmp; PATH=/env/bin:\$PATH; $2" || status=$?
  verdict "${status}" "$1"
}
try 'libraries' '
  cd /env/lib/python3*/site-packages/pdepth
  for file in _core*.so _protocol*.so bin/pdepth; do
    others=$(ldd "$file" | grep -vE "linux-vdso|ld-linux|lib(stdc\+\+|m|gcc_s|c)\.so") && echo "$file needs $others" && exit 1
  done; true'
try 'module' 'python - <<END
import numpy, pdepth
assert pdepth.depth(pdepth.Box([1, 1, 1]), pdepth.Sphere(1), pose_b=pdepth.Pose(translation=[1.5, 0, 0])).depth == 0.5
assert len(pdepth.hull(pdepth.Box([1, 1, 1])).facets) == 6
END'
try 'pictures are refused by name' 'python - <<END
import pdepth
try:
    pdepth.picture(pdepth.Sphere(1))
except pdepth.Refused as refusal:
    assert refusal.code == "unsupported" and "lib" in str(refusal), refusal
    print(refusal)
else:
    raise SystemExit("drawn without a renderer?")
END'
try 'query' "echo '{\"query\":\"width\",\"a\":{\"type\":\"box\",\"half_extents\":[1,2,3]}}' | pdepth query | grep '\"width\":2.0'"
try 'depth' 'pdepth depth box:1,1,1 sphere:1 --pose-b 1.5,0,0 --json | grep "\"depth\":0.5,"'
try 'audit' 'printf "%s\n" "{\"record\":\"pdepth-contacts/1\",\"engine\":\"nobody\",\"scalar\":\"float64\"}" \
    "{\"shape\":\"s\",\"is\":{\"type\":\"box\",\"half_extents\":[1,1,1]}}" \
    "{\"contact\":1,\"a\":\"s\",\"b\":\"s\",\"pose_b\":{\"translation\":[1.5,0,0]},\"reported\":null}" >contacts.jsonl
  status=0; pdepth audit contacts.jsonl --fail-on missed=0 || status=$?; [ "$status" -eq 3 ]'
try 'simplify' 'printf "v %s\n" "0 0 0" "1 0 0" "0 1 0" "0 0 1" "0.1 0.1 0.1" >scan.obj; pdepth simplify scan.obj -o hull.obj'
try 'polygon' 'echo "<svg><rect width=\"2\" height=\"2\"/></svg>" >p.svg; pdepth polygon p.svg p.svg --json | grep "\"depth\":2.0"'
last_line
