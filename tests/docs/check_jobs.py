"""Runs the jobs that the guide "Audit in CI" shows: `check_jobs.py PDEPTH JOB...`.

Each job is read as YAML. Its shell lines run in an empty folder, apart from those that install packages; the script of the
reader that records contacts is one that copies a record. Without a fault every line must end with 0 and leave the page and
the test results; with a missed contact the line of the audit must end with 3.
"""
import os
import pathlib
import subprocess
import sys
import tempfile

import yaml

HEAD = '{"record":"pdepth-contacts/1","engine":"check_jobs","scalar":"float64","unit":"m"}\n'
SHAPE = '{"shape":"crate","is":{"type":"box","half_extents":[0.5,0.5,0.5]}}\n'
CONTACT = '{"contact":1,"a":"crate","pose_a":{"translation":[0,0.75,0]},"b":"crate","pose_b":{},"reported":%s}\n'
RIGHT = CONTACT % '{"depth":0.25,"normal":[0,1,0],"points":[]}'
MISSED = CONTACT % "null"


def shell_lines(job):
    """Lines of shell of a job of either host, in order."""
    if "jobs" in job:
        steps = [step for one in job["jobs"].values() for step in one["steps"]]
        return [line for step in steps if "run" in step for line in step["run"].strip().split("\n")]
    return [line for one in job.values() for part in ("before_script", "script") for line in one.get(part, [])]


def results(lines, contact, program):
    """The exit code of each line that is no installation, and the files that stand there afterwards."""
    with tempfile.TemporaryDirectory() as folder:
        top = pathlib.Path(folder)
        (top / "ci").mkdir()
        (top / "record").write_text(HEAD + SHAPE + contact)
        script = top / "ci/record_contacts.sh"
        script.write_text('#!/bin/sh\ncp record "$1"\n')
        script.chmod(0o755)
        (top / "bin").mkdir()
        (top / "bin/pdepth").symlink_to(program)
        environment = dict(os.environ, PATH=f"{top / 'bin'}{os.pathsep}{os.environ['PATH']}")
        codes = [subprocess.run(["sh", "-c", line], cwd=top, env=environment, capture_output=True, timeout=60).returncode for line in lines]
        return codes, (top / "audit/report.html").exists() and (top / "audit.xml").exists()


def main(program, jobs):
    wrong = 0
    for name in jobs:
        lines = [line for line in shell_lines(yaml.safe_load(pathlib.Path(name).read_text())) if "apt-get" not in line]
        good, kept = results(lines, RIGHT, program)
        bad, kept_too = results(lines, MISSED, program)
        if len(lines) != 2 or good != [0, 0] or bad != [0, 3] or not (kept and kept_too):
            wrong += 1
            print(f"{name}: {len(lines)} lines, without a fault {good}, with one {bad}, pages kept {kept} {kept_too}")
    print(f"{len(jobs)} jobs, {wrong} wrong")
    return wrong == 0 and jobs


if __name__ == "__main__":
    sys.exit(0 if main(os.path.abspath(sys.argv[1]), sys.argv[2:]) else 1)
