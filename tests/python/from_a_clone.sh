#!/usr/bin/env bash
# The README's way to the package, in one go, from a fresh clone of HEAD: pip install in a new environment, a wheel, the wheel in
# another environment, the clone removed, and then what either says. Nothing built before is used but what PDEPTH_CMAKE_ARGS names
# (-DCMAKE_CXX_COMPILER_LAUNCHER=ccache).
#
#   tests/python/from_a_clone.sh FOLDER     an empty or absent folder; about a quarter of an hour of one core without a cache
set -euo pipefail
folder=$(realpath -m "${1:?a folder}")
top=$(git -C "$(dirname "$0")" rev-parse --show-toplevel)
python=${PYTHON:-/usr/bin/python3}
[[ ! -e $folder || -z $(ls -A "$folder") ]] || { echo "$folder is not empty"; exit 2; }
mkdir -p "$folder"
git clone -q "$top" "$folder/clone"
cd "$folder/clone"
"$python" -m venv --system-site-packages "$folder/env"
time "$folder/env/bin/pip" install --no-index --disable-pip-version-check --no-build-isolation .
time "$python" -m build --no-isolation --wheel
"$python" -m venv --system-site-packages "$folder/other"
"$folder/other/bin/pip" install --no-index --no-deps --disable-pip-version-check dist/*.whl
ls dist
cd "$folder"
rm -rf "$folder/clone"
for environment in env other; do
  "$folder/$environment/bin/python" - <<'PYTHON'
import subprocess, sys, time
import numpy
wall, spent = time.perf_counter(), time.process_time()
import pdepth
wall, spent = time.perf_counter() - wall, time.process_time() - spent
print(pdepth.__file__)
print(f"import: {1e3 * spent:.0f} ms of the processor, {1e3 * wall:.0f} ms by the clock, beyond numpy")
ball = pdepth.Sphere(1.0)
assert pdepth.depth(ball, ball, pose_b=pdepth.Pose(translation=[1.5, 0, 0])).depth == 0.5
assert len(pdepth.hull(pdepth.Box([1, 1, 1])).facets) == 6
assert pdepth.picture(ball, size=(64, 64)).shape == (64, 64, 3)
from pdepth import _core, _picture, _protocol
for module in (_core, _protocol, _picture):
    linked = subprocess.run(["ldd", module.__file__], capture_output=True, text=True, check=True).stdout
    assert "Bullet" not in linked and "not found" not in linked, linked
    print(module.__name__, "links", len(linked.splitlines()), "libraries, Bullet is none")
PYTHON
done
