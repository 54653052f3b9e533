#!/usr/bin/env python3
"""Would the tests notice? Changes decisions, arithmetic and error bounds of pd_core/src one at a time, and runs the tests.

    tests/long/mutate.py [--rooms depth=110,shape=40] [--seed 1] [--jobs 2] [--minutes 210] [--build build/mutants]
                         [--share-of-files 0.22] [--sources 3] [--quick] [--again]

The mutants are drawn by seed from the commit that is checked out and all compiled into one build, in a worktree of its own
(BUILD/source): the environment variable PD_MUTANT names the one that is on. A place whose types have no other operator does
not compile so and is dropped. To compile little, a room's mutants are drawn from few of its files, which are drawn first, and
a header is mutated when at most --sources sources of the core see it.

First every judge (the programs of mutants/judges.py and the tests of the rooms) runs once without a mutant, and notes which
mutants would have changed a value: in a run where none changed, up to its end everything is as it was. A mutant is then shown
to those judges only, the quickest first: of the programs, and of its own room's tests all that it could show in. It is killed
when one fails, crashes, takes more memory than it should or four times the processor time. What survives is to be read by
somebody: it is harmless, and it is said why, or a test is missing.

Each verdict is added to BUILD/mutants.csv at once; a later call goes on from there, and with --again judges the survivors anew:
after tests were added (committed, as the worktree holds the commit). --quick builds and asks the programs alone; a later call
without it asks the tests about what they left alive. BUILD/mutants.md sums up.
"""

import argparse
import concurrent.futures
import csv
import os
import pathlib
import random
import shutil
import subprocess
import threading
import time

from mutants.judges import PROGRAMS, asked_for, judge_mutant, surveyed
from mutants.places import KINDS, draw, mutants_of, sources_that_see, values_of_constants
from mutants.tree import Tree

ROOT = pathlib.Path(__file__).resolve().parents[2]
ROOMS = "depth=110,shape=40,structure=25,contact=15,compound=15,planar=15"
KEY = ["file", "line", "column", "was", "to"]
COLUMNS = KEY + ["kind", "killed_by", "asked", "judges", "seconds", "text"]


class Verdicts:
    """The verdicts of BUILD/mutants.csv, by what was changed; the last of a mutant counts."""

    def __init__(self, path):
        self.path = path
        self.lock = threading.Lock()
        self.rows = {}
        if path.exists():
            with open(path, encoding="utf-8", newline="") as table:
                self.rows = {tuple(row[name] for name in KEY): row for row in csv.DictReader(table)}

    def add(self, mutant, killer, asked, judges, seconds):
        row = dict(zip(COLUMNS, [*mutant.key(), mutant.kind, killer, asked, str(judges), f"{seconds:.1f}", mutant.text]))
        with self.lock:
            begun = self.path.exists()
            self.rows[mutant.key()] = row
            with open(self.path, "a", encoding="utf-8", newline="") as out:
                table = csv.DictWriter(out, COLUMNS)
                if not begun:
                    table.writeheader()
                table.writerow(row)

    def of(self, mutant):
        return self.rows.get(mutant.key())


def counts_of(text):
    return {room: int(count) for room, count in (entry.split("=") for entry in text.split(","))}


def compile_mutants(tree, drawn, options, build):
    """Builds and copies the judges' programs; returns the mutants that compile. What did not compile once is not tried again."""
    rooms = [] if options.quick else list(counts_of(options.rooms))
    dropped_at = build / "dropped.csv"
    dropped = set()
    if dropped_at.exists():
        with open(dropped_at, encoding="utf-8", newline="") as table:
            dropped = set(map(tuple, csv.reader(table)))
    targets = list(dict.fromkeys([judge[0] for judge in PROGRAMS] + [f"test_{room}" for room in rooms]))
    mutants = tree.compiled([m for m in drawn if m.key() not in dropped], options.jobs, targets)
    kept = {m.key() for m in mutants}
    with open(dropped_at, "w", encoding="utf-8", newline="") as table:
        csv.writer(table).writerows(sorted(m.key() for m in drawn if m.key() not in kept))
    for name in targets:
        shutil.copy2(tree.objects / name, build / "programs" / name)
    return mutants


def is_open(mutant, verdicts, options):
    """Whether anybody is left to ask."""
    row = verdicts.of(mutant)
    if row is None:
        return True
    return not row["killed_by"] and (options.again or (row["asked"] == "programs" and not options.quick))


def judge_room(build, room, mutants, verdicts, options, end):
    left = [m for m in mutants if m.room() == room and is_open(m, verdicts, options)]
    if not left or time.monotonic() > end:
        return
    judges = surveyed(build, None if options.quick else room)
    for program in dict.fromkeys(j.program for j in judges):
        of = [j for j in judges if j.program == program]
        print(f"{program}: {len(of)} judges, {sum(j.seconds for j in of):.0f} s", flush=True)

    def judge(mutant):
        if time.monotonic() > end:
            return
        row = verdicts.of(mutant)
        asked = asked_for(judges, mutant, row is not None and row["asked"] == "programs" and not options.again)
        killer, seconds = judge_mutant(build, asked, mutant)
        verdicts.add(mutant, killer, "programs" if options.quick else "all", len(asked), seconds)
        print(f"{mutant.id}  {mutant.place()}  {mutant.change()}: {killer or 'SURVIVES'}  ({len(asked)} judges, {seconds:.0f} s)",
              flush=True)

    print(f"{room}: {len(left)} to judge", flush=True)
    random.Random(options.seed).shuffle(left)  # what is judged when time runs out is a sample
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        for _ in pool.map(judge, left):
            pass


def write_summary(build, tree, options, mutants, drawn, verdicts):
    judged = [(m, verdicts.of(m)) for m in mutants if verdicts.of(m)]
    judged = [(m, row) for m, row in judged if row["killed_by"] or row["asked"] == "all"]
    killed = [(m, row) for m, row in judged if row["killed_by"]]
    rooms = list(counts_of(options.rooms))
    killers = {}
    for _, row in killed:
        program = row["killed_by"].split(":")[0]
        program = program if any(program == judge[0] for judge in PROGRAMS) else "a test"
        killers[program] = killers.get(program, 0) + 1
    with open(build / "mutants.md", "w", encoding="utf-8") as out:
        print(f"`tests/long/mutate.py --rooms {options.rooms} --seed {options.seed} --share-of-files {options.share_of_files} "
              f"--sources {options.sources}`, commit {tree.commit}: {len(killed)} of {len(judged)} mutants killed "
              f"({100 * len(killed) / max(1, len(judged)):.1f} %); {len(drawn)} were drawn, {len(mutants)} compile.\n", file=out)
        print("| room | " + " | ".join(KINDS) + " | killed |\n|---|" + "---|" * (len(KINDS) + 1), file=out)
        for room in rooms:
            cells = []
            for kind in [*KINDS, None]:
                of = [row for m, row in judged if m.room() == room and kind in (m.kind, None)]
                cells.append(f"{sum(1 for row in of if row['killed_by'])} of {len(of)}")
            print(f"| {room} | " + " | ".join(cells) + " |", file=out)
        print("\n| killed by | mutants |\n|---|---|", file=out)
        for killer, count in sorted(killers.items(), key=lambda item: -item[1]):
            print(f"| {killer} | {count} |", file=out)
        print("\n| id | survivor | change | line | judges |\n|---|---|---|---|---|", file=out)
        for m, row in judged:
            if not row["killed_by"]:
                code = m.text.replace("|", "\\|")
                print(f"| {m.id} | {m.place()} | `{m.change()}` | `{code}` | {row['judges']} |", file=out)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rooms", default=ROOMS, help="how many mutants in which room; judged in this order")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--minutes", type=float, default=210, help="no mutant is begun after so long")
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build" / "mutants")
    parser.add_argument("--share-of-files", type=float, default=0.22, help="files that a room's mutants are drawn from, by mutants")
    parser.add_argument("--sources", type=int, default=3, help="headers that more sources of the core see are left alone")
    parser.add_argument("--quick", action="store_true", help="asks the programs alone")
    parser.add_argument("--again", action="store_true", help="judges survivors anew")
    options = parser.parse_args()
    build = options.build.resolve()
    (build / "programs").mkdir(parents=True, exist_ok=True)
    tree = Tree(ROOT, build / "source")
    counts = counts_of(options.rooms)
    seen = sources_that_see(tree.originals)
    texts = {path: text for path, text in tree.originals.items()
             if path.parts[2] in counts and (path.suffix == ".cpp" or seen.get(path, 0) <= options.sources)}
    drawn = draw(mutants_of(texts, values_of_constants(tree.originals)), counts, options.share_of_files, random.Random(options.seed))
    print(f"{len(drawn)} mutants in {len({m.path for m in drawn})} files", flush=True)
    mutants = compile_mutants(tree, drawn, options, build)
    # Answers of the same programs without a mutant.
    subprocess.run([build / "programs" / "answer_hash", *PROGRAMS[0][1:3], "--out", build / "answers.txt"], check=True,
                   stdout=subprocess.DEVNULL)
    verdicts = Verdicts(build / "mutants.csv")
    end = time.monotonic() + 60 * options.minutes
    for room in counts:
        judge_room(build, room, mutants, verdicts, options, end)
    write_summary(build, tree, options, mutants, drawn, verdicts)
    print((build / "mutants.md").read_text(encoding="utf-8"))


if __name__ == "__main__":
    main()
