"""Runs the lines of documents and compares what they print: `run_lines.py FOLDER_OF_PROGRAMS FILE...`.

A block of code marked `console` holds commands after "$ ", each followed by what it prints. In a line of JSON `...` stands for
members that are not shown. The text around it must stand in what is printed, in that order, and the members shown must have these values.
"""
import json
import os
import re
import subprocess
import sys
import tempfile

BLOCK = re.compile(r"^```console\n(.*?)^```$", re.M | re.S)


def commands(text):
    for block in BLOCK.findall(text):
        command, expected = None, []
        for line in block.splitlines():
            if line.startswith("$ "):
                if command:
                    yield command, expected
                command, expected = line[2:], []
            elif line.startswith("> "):
                command += "\n" + line[2:]
            else:
                expected.append(line)
        if command:
            yield command, expected


def differs(shown, printed):
    if "..." not in shown:
        return [] if shown == printed else [f"{printed!r} instead of {shown!r}"]
    wanted, got = json.loads(re.sub(r",?\.\.\.", "", shown)), json.loads(printed)
    complaints = [f"{key}: {got.get(key)!r} instead of {value!r}" for key, value in wanted.items() if key not in got or got[key] != value]
    pieces = map(re.escape, shown.split("..."))
    if not complaints and not re.fullmatch(".*".join(pieces), printed):
        complaints.append(f"the text is {printed!r} instead of {shown!r}")
    return complaints


def main(programs, files):
    environment = dict(os.environ, PATH=programs + os.pathsep + os.environ["PATH"])
    run = wrong = 0
    for name in files:
        with open(name, encoding="utf-8") as file:
            text = file.read()
        for command, expected in commands(text):
            with tempfile.TemporaryDirectory() as folder:
                done = subprocess.run(["bash", "-c", command], env=environment, cwd=folder, capture_output=True, text=True,
                                      timeout=60)
            printed = done.stdout.splitlines()
            complaints = [done.stderr] if done.returncode else []
            if len(printed) != len(expected):
                complaints.append(f"{len(printed)} lines instead of {len(expected)}")
            for shown, line in zip(expected, printed):
                complaints += differs(shown, line)
            run += 1
            if complaints:
                wrong += 1
                print(f"{name}: $ {command}\n  " + "\n  ".join(complaints))
    print(f"{run} commands run, {wrong} print something else")
    return 1 if wrong or not run else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1], sys.argv[2:]))
