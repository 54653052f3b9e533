"""The command pdepth as a console script: the program that stands beside this file in bin/."""

import os
import pathlib
import sys


def main():
    program = pathlib.Path(__file__).with_name("bin") / "pdepth"
    if not program.exists():
        sys.exit("pdepth: this installation has the module alone; the command is Debian's package pdepth, or comes with the wheel")
    os.execv(program, ["pdepth", *sys.argv[1:]])
