"""The command pdepth as a console script and as python -m pdepth.

A wheel has the program beside this file in bin/. Debian's package has it in bin/ of the prefix in which this module is installed.
"""

import os
import pathlib
import sys


def _program():
    here = pathlib.Path(__file__).resolve().parent
    prefixes = [folder for folder in here.parents if here.relative_to(folder).parts[0] == "lib"]
    for program in (folder / "bin" / "pdepth" for folder in (here, *prefixes)):
        if program.is_file():
            with program.open("rb") as opened:
                if opened.read(2) != b"#!":  # the console script, which has come here
                    return program
    return None


def main():
    program = _program()
    if program is None:
        sys.exit("pdepth: this installation has the module alone; the command is Debian's package pdepth, or comes with the wheel")
    os.execv(program, ["pdepth", *sys.argv[1:]])
