"""Builds the compiled modules and the command with CMake and packs them. Run by pdepth_backend from the project's top level.

PDEPTH_BUILD_DIR names a build folder to use (one of tests/run.sh has all objects); default build/python. The archive of the sources
(sdist) holds everything that CMake reads for them, so that a wheel can be built wherever it is unpacked.
"""

import os
import pathlib
import shutil
import subprocess
import sys

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext
from setuptools.command.sdist import sdist

TOP = pathlib.Path.cwd()
SOURCES = ("CMakeLists.txt", "CMakePresets.json", "LICENSE", "pd_core", "engine_glue", "render", "demos")
NO_SOURCES = (("demos", "pictures"), ("pd_core", "docs"))
COMMIT = pathlib.Path("build", "commit")  # in an unpacked archive: which commit it holds


def source_files():
    """Files that CMake reads, by their names from the top level; pictures and pages are no part of a build."""
    for name in SOURCES:
        paths = sorted((TOP / name).rglob("*")) if (TOP / name).is_dir() else [TOP / name]
        for path in paths:
            part = path.relative_to(TOP)
            if path.is_file() and "__pycache__" not in part.parts and part.parts[:2] not in NO_SOURCES:
                yield str(part)


def commit():
    """The commit of an unpacked archive; of a clone CMake asks git itself, in every build."""
    return (TOP / COMMIT).read_text().strip() if (TOP / COMMIT).exists() else ""


def commit_of_clone():
    if not (TOP / ".git").exists() or not shutil.which("git"):
        return ""
    return subprocess.run(["git", "-C", TOP, "describe", "--always", "--dirty", "--abbrev=12", "--exclude=*"],
                          capture_output=True, text=True).stdout.strip()


class SourceArchive(sdist):
    def make_distribution(self):
        self.filelist.extend(source_files())
        super().make_distribution()

    def make_release_tree(self, base_dir, files):
        super().make_release_tree(base_dir, files)
        (pathlib.Path(base_dir) / COMMIT).write_text((commit() or commit_of_clone()) + "\n")


class CMakeBuild(build_ext):
    """One extension stands for the modules that CMake builds."""

    def run(self):
        folder = pathlib.Path(os.environ.get("PDEPTH_BUILD_DIR", TOP / "build" / "python")).resolve()
        if not (folder / "CMakeCache.txt").exists():
            subprocess.run(["cmake", "-S", TOP, "-B", folder, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release",
                            "-DPD_WITH_BULLET=OFF", "-DPD_WITH_TESTS=OFF", "-DPD_WITH_BENCH=OFF", "-DPD_SELF_CONTAINED=ON",
                            f"-DPython_EXECUTABLE={sys.executable}", f"-DPD_COMMIT={commit()}",
                            *os.environ.get("PDEPTH_CMAKE_ARGS", "").split()],
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
setup(ext_modules=[Extension("pdepth._core", sources=[])], cmdclass={"build_ext": CMakeBuild, "sdist": SourceArchive},
      options={"egg_info": {"egg_base": "build/egg"}, "build": {"build_base": "build/egg"}})
