"""Builds the compiled modules and the command with CMake and packs them. Run by pdepth_backend from the project's top level.

PDEPTH_BUILD_DIR names a build folder to use (one of tests/run.sh has all objects); default build/python.
"""

import os
import pathlib
import shutil
import subprocess
import sys

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

TOP = pathlib.Path.cwd()


class CMakeBuild(build_ext):
    """One extension stands for the modules that CMake builds."""

    def run(self):
        folder = pathlib.Path(os.environ.get("PDEPTH_BUILD_DIR", TOP / "build" / "python")).resolve()
        if not (folder / "CMakeCache.txt").exists():
            subprocess.run(["cmake", "-S", TOP, "-B", folder, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release",
                            "-DPD_WITH_BULLET=OFF", "-DPD_WITH_TESTS=OFF", "-DPD_WITH_BENCH=OFF", "-DPD_SELF_CONTAINED=ON",
                            f"-DPython_EXECUTABLE={sys.executable}", *os.environ.get("PDEPTH_CMAKE_ARGS", "").split()],
                           check=True)
        subprocess.run(["cmake", "--build", folder, "--target", "pd_python", "pdepth"], check=True)
        target = pathlib.Path(self.build_lib) / "pdepth"
        target.mkdir(parents=True, exist_ok=True)
        modules = sorted((folder / "python" / "pdepth").glob("*.so"))
        if not modules:
            raise SystemExit("CMake built no module: python3-dev and pybind11-dev are needed")
        for module in modules:
            shutil.copy2(module, target)
        # The command, which pdepth/_command.py starts. Symbols of its own, which only a debugger reads, stay behind.
        (target / "bin").mkdir(exist_ok=True)
        shutil.copy2(folder / "pdepth", target / "bin" / "pdepth")
        if shutil.which("strip"):
            subprocess.run(["strip", target / "bin" / "pdepth"], check=True)

    def get_outputs(self):
        target = pathlib.Path(self.build_lib) / "pdepth"
        return [str(path) for path in (*target.glob("*.so"), target / "bin" / "pdepth")]


(TOP / "build" / "egg").mkdir(parents=True, exist_ok=True)
setup(ext_modules=[Extension("pdepth._core", sources=[])], cmdclass={"build_ext": CMakeBuild},
      options={"egg_info": {"egg_base": "build/egg"}, "build": {"build_base": "build/egg"}})
