"""Programs and tests that may object to a mutant, and which of them it could show in."""

import dataclasses
import hashlib
import json
import os
import pathlib
import re
import resource
import shutil
import signal
import subprocess
import tempfile

MEMORY = 4 << 30  # bytes of address space: some mutants would take all there is
BATCH = 5  # seconds of tests that one process runs

# Program and arguments; tests that measure or run other programs are left out.
PROGRAMS = [
    ["answer_hash", "--pairs", "300", "--check", "{reference}"],
    ["bound_ratios", "--evaluations", "10000"],
    ["oracle_pairs", "--pairs", "1500", "--seed", "1"],
    ["oracle_pairs", "--pairs", "1500", "--seed", "2", "--bracket", "certified"],
    ["grid_pairs", "--pairs", "200000", "--seed", "1"],
    ["oracle_pairs", "--pairs", "1500", "--seed", "3", "--method", "overlay"],
    ["oracle_pairs", "--pairs", "1500", "--seed", "4", "--method", "decomposition"],
]


@dataclasses.dataclass
class Judge:
    program: str
    arguments: list
    test: str = ""  # of GoogleTest
    seconds: float = 0  # of processor time, without a mutant
    reached: frozenset = frozenset()  # the mutants by which a value of its run would have changed

    def name(self):
        return self.test or " ".join([self.program, *self.arguments])


def run(build, program, arguments, limit, variables, folder):
    """Returns what objected, or nothing, and the seconds of processor time taken, of at most `limit`."""
    command = [str(build / "programs" / program)] + [a.format(reference=build / "answers.txt") for a in arguments]

    def bounded():
        resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
        resource.setrlimit(resource.RLIMIT_CPU, (limit, limit))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))

    with tempfile.TemporaryFile(mode="w+", errors="replace") as output:
        process = subprocess.Popen(command, env=dict(os.environ, **variables), cwd=folder, stdout=output, stderr=subprocess.STDOUT,
                                   preexec_fn=bounded)
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = code = os.waitstatus_to_exitcode(status)
        output.seek(0)
        failed = re.search(r"\[  FAILED  \] (\S+?)[\s,(]", output.read())
    seconds = usage.ru_utime + usage.ru_stime
    if code == 0:
        return "", seconds
    if failed:
        return failed.group(1), seconds
    if code < 0:
        return f"{program}: {'no end' if seconds >= limit - 1 else signal.Signals(-code).name}", seconds
    return program, seconds


def tests_of(build, program):
    """Names of the tests of a program of GoogleTest."""
    listed = subprocess.run([build / "programs" / program, "--gtest_list_tests"], check=True, capture_output=True, text=True).stdout
    names, suite = [], ""
    for line in listed.splitlines():
        name = line.split("#")[0].strip()
        if line.startswith(" "):
            names += [] if "DISABLED_" in suite + name else [suite + name]
        elif name.endswith("."):
            suite = name
    return names


def surveyed(build, room):
    """The programs and the tests of a room, if one is named, each run once to see how long it takes and which mutants show in it; kept per program."""
    kept_at = build / "reached.json"
    kept = json.loads(kept_at.read_text(encoding="utf-8")) if kept_at.exists() else {}
    asked = [(arguments[0], arguments[1:], "") for arguments in PROGRAMS]
    if room:
        asked += [(f"test_{room}", [], test) for test in tests_of(build, f"test_{room}")]
    hashes = {program: hashlib.sha256((build / "programs" / program).read_bytes()).hexdigest() for program, _, _ in asked}
    judges = []
    for program, arguments, test in asked:
        judge = Judge(program, arguments, test)
        known = kept.get(program, {})
        if known.get("hash") != hashes[program]:
            known = kept[program] = {"hash": hashes[program], "judges": {}}
        if judge.name() not in known["judges"]:
            notes = build / "notes.txt"
            notes.unlink(missing_ok=True)
            objection, seconds = run(build, program, arguments or [f"--gtest_filter={test}"], 3600,
                                     {"PD_MUTANT": "-1", "PD_MUTANT_REACHED": str(notes)}, build)
            if objection:
                raise SystemExit(f"fails without a mutant: {objection}")
            reached = sorted(set(map(int, notes.read_text(encoding="ascii").split()))) if notes.exists() else []
            known["judges"][judge.name()] = [seconds, reached]
            if seconds > 1 or not test:
                kept_at.write_text(json.dumps(kept), encoding="utf-8")
        judge.seconds, reached = known["judges"][judge.name()]
        judge.reached = frozenset(reached)
        judges.append(judge)
    kept_at.write_text(json.dumps(kept), encoding="utf-8")
    return judges


def asked_for(judges, mutant, tests_only):
    """Judges in which the mutant could show: the hash of answers first, then the quickest."""
    of = [j for j in judges if mutant.id in j.reached and (j.test or not tests_only)]
    return sorted(of, key=lambda j: (j.program != "answer_hash", j.seconds))


def batches(judges):
    """Consecutive tests of one program, as many as take `BATCH` seconds, run as one process."""
    found = []
    for judge in judges:
        last = found[-1] if found else None
        if last and judge.test and last[0].program == judge.program and sum(j.seconds for j in last) + judge.seconds < BATCH:
            last.append(judge)
        else:
            found.append([judge])
    return found


def judge_mutant(build, judges, mutant):
    """Returns who of the judges, asked in order, objects to the mutant, or nothing, and the seconds of processor time taken."""
    folder = build / "work" / str(mutant.id)
    folder.mkdir(parents=True, exist_ok=True)
    killer, total = "", 0.0
    for batch in batches(judges):
        tests = ":".join(j.test for j in batch)
        arguments = [f"--gtest_filter={tests}", "--gtest_fail_fast", "--gtest_brief=1"] if tests else batch[0].arguments
        limit = int(4 * sum(j.seconds for j in batch)) + 5
        killer, seconds = run(build, batch[0].program, arguments, limit, {"PD_MUTANT": str(mutant.id)}, folder)
        total += seconds
        if killer:
            break
    shutil.rmtree(folder, ignore_errors=True)
    return killer, total
