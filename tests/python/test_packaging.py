"""A wheel, and pip install of the source tree: what comes out runs without the tree."""
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tarfile
from xml.etree import ElementTree

import pytest

TOP = pathlib.Path(__file__).resolve().parents[2]
BUILT = TOP / "build" / "release"


def test_colcon_finds_a_package_of_the_same_version():
    package = ElementTree.parse(TOP / "package.xml").getroot()
    assert package.tag == "package" and package.get("format") == "3"
    assert package.findtext("name") == "pdepth" and package.findtext("export/build_type") == "cmake"
    version = re.search(r"project\(pdepth VERSION ([\d.]+)", (TOP / "CMakeLists.txt").read_text())[1]
    assert package.findtext("version") == version
    assert f'version = "{version}"' in (TOP / "pyproject.toml").read_text()
    assert package.find("maintainer").get("email") and package.findtext("license") == "Zlib"
    assert {"eigen", "boost"} <= {each.text for each in package.findall("depend")}


def test_the_module_of_a_distribution_starts_the_command_of_its_prefix(tmp_path):
    module = tmp_path / "lib/python3/dist-packages/pdepth"
    module.mkdir(parents=True)
    shutil.copy(TOP / "demos/python/pdepth/_command.py", module)
    (tmp_path / "bin").mkdir()
    command = tmp_path / "bin/pdepth"

    def run():
        return subprocess.run([sys.executable, "-c", "import _command; _command.main()", "depth"], env={"PYTHONPATH": str(module)},
                              capture_output=True, text=True, timeout=60)

    assert "the module alone" in run().stderr
    command.write_text("#!/bin/sh\nexec false\n")  # as the console script, which would start itself for ever
    command.chmod(0o755)
    assert "the module alone" in run().stderr
    shutil.copy(shutil.which("echo"), command)
    assert run().stdout == "depth\n"


def test_the_archive_of_sources_holds_all_that_cmake_reads(tmp_path):
    def run(*command, cwd):
        done = subprocess.run([str(part) for part in command], cwd=cwd, capture_output=True, text=True)
        assert done.returncode == 0, done.stdout[-3000:] + done.stderr[-3000:]
        return done.stdout

    run(sys.executable, "-m", "build", "--no-isolation", "--sdist", "--outdir", tmp_path, TOP, cwd=TOP)
    archive, = tmp_path.glob("pdepth-*.tar.gz")
    with tarfile.open(archive) as opened:
        opened.extractall(tmp_path)
    tree = tmp_path / archive.name.removesuffix(".tar.gz")
    run("cmake", "-S", tree, "-B", tree / "build/python", "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release", "-DPD_WITH_BULLET=OFF",
        "-DPD_WITH_TESTS=OFF", "-DPD_WITH_BENCH=OFF", "-DPD_SELF_CONTAINED=ON", f"-DPython_EXECUTABLE={sys.executable}", cwd=tree)
    # CMake looks for sources by pattern and would not miss one that is not there.
    if (TOP / ".git").exists():
        sources = run("git", "ls-files", *(f"{room}/*.{kind}" for room in ("pd_core", "engine_glue", "render", "demos")
                                           for kind in ("hpp", "cpp", "h", "cmake", "js", "css", "json")), cwd=TOP).split()
        missing = [name for name in sources if not (tree / name).exists() and not name.startswith("pd_core/docs/")]
        assert len(sources) > 700 and missing == []
        head = run("git", "rev-parse", "HEAD", cwd=TOP)
        assert head.startswith((tree / "build/commit").read_text().split("-")[0].strip())


@pytest.mark.skipif(not (BUILT / "CMakeCache.txt").exists(), reason="needs the objects of build/release")
def test_a_wheel_and_pip_install_run_without_the_source_tree(tmp_path):
    environment = {key: value for key, value in os.environ.items() if key != "PYTHONPATH"}
    environment["PDEPTH_BUILD_DIR"] = str(BUILT)

    def run(*command, cwd=tmp_path):
        done = subprocess.run([str(part) for part in command], cwd=cwd, env=environment, capture_output=True, text=True)
        assert done.returncode == 0, done.stdout[-3000:] + done.stderr[-3000:]
        return done.stdout.strip()

    run(sys.executable, "-m", "venv", "--system-site-packages", tmp_path / "venv")
    python = tmp_path / "venv" / "bin" / "python"
    run(sys.executable, "-m", "build", "--no-isolation", "--outdir", tmp_path, TOP)  # the wheel is made from the archive of sources
    wheel, = tmp_path.glob("pdepth-*.whl")
    assert "-linux_" in wheel.name
    script = ("import pdepth; print(pdepth.__file__, pdepth.depth(pdepth.Sphere(1), pdepth.Sphere(1),"
              " pose_b=pdepth.Pose(translation=[1.5, 0, 0])).depth, len(pdepth.hull(pdepth.Box([1, 1, 1])).facets))")
    for source in ((wheel,), ("--no-build-isolation", TOP)):
        run(python, "-m", "pip", "install", "--no-index", "--no-deps", "--force-reinstall", "--disable-pip-version-check",
            *source)
        place, depth, facets = run(python, "-c", script).split()
        assert place.startswith(str(tmp_path)) and (depth, facets) == ("0.5", "6")
        answer = run(tmp_path / "venv" / "bin" / "pdepth", "depth", "box:1,1,1", "sphere:1", "--pose-b", "1.5,0,0", "--json")
        assert '"depth":0.5,' in answer
    linked = run("ldd", *(tmp_path / "venv").glob("lib/python*/site-packages/pdepth/_core*.so"))
    assert "Bullet" not in linked and "not found" not in linked and str(TOP) not in linked
