"""Every example of the READMEs runs and prints what its comments promise, and the example test file passes."""
import os
import pathlib
import re
import subprocess
import sys

import pdepth
import pytest

ROOM = pathlib.Path(__file__).resolve().parents[2] / "demos" / "python"
BLOCKS = [block for readme in (ROOM / "README.md", ROOM.parents[1] / "README.md")
          for block in re.findall(r"```python\n(.*?)```", readme.read_text(), re.S)]
PACKAGE = os.path.dirname(os.path.dirname(pdepth.__file__))


@pytest.mark.parametrize("block", BLOCKS, ids=[str(i) for i in range(len(BLOCKS))])
def test_examples_print_what_they_say(block, tmp_path):
    if "picture" in block:
        pytest.importorskip("pdepth._picture")
    block = block.replace("/tmp/", f"{tmp_path}/")
    script = tmp_path / "example.py"
    script.write_text(block)
    done = subprocess.run([sys.executable, "-B", script], env={**os.environ, "PYTHONPATH": PACKAGE}, capture_output=True,
                          text=True)
    assert done.returncode == 0, done.stderr
    printed = iter(done.stdout.splitlines())
    for line in block.splitlines():
        if not line.lstrip().startswith("print("):
            continue
        said = next(printed)
        if "  # " in line:
            promised = line.split("  # ")[1].strip()
            assert said.startswith(promised.split(":")[0]) or not re.match(r"[\[(\dTo]", promised), (said, promised)


def test_the_example_test_file_passes_and_can_fail(tmp_path):
    text = (ROOM / "test_my_engine.py").read_text()
    assert len(text.splitlines()) <= 32
    for name, source, code in (("right", text, 0), ("wrong", text.replace("0.02 -", "0.0201 -"), 1)):
        file = tmp_path / f"test_{name}.py"
        file.write_text(source)
        done = subprocess.run([sys.executable, "-B", "-m", "pytest", "-q", "-p", "no:cacheprovider", file], capture_output=True,
                              text=True, cwd=tmp_path, env={**os.environ, "PYTHONPATH": PACKAGE})
        assert done.returncode == code, done.stdout
