#!/usr/bin/env python3
"""Would the tests notice? Changes decisions, arithmetic and error bounds of pd_core/src one at a time, and runs the tests.

    tests/long/mutate.py [--mutants 240] [--seed 1] [--rooms numeric,shape] [--jobs 2] [--minutes 210]
                         [--build build/mutants] [--tree FOLDER] [--sources 8] [--again CSV]

The mutants are drawn by seed from the commit that is checked out, in a worktree of its own, and all compiled into one
build: the environment variable PD_MUTANT names the one that is on. A place whose types have no other operator does not
compile so and is dropped. A mutant is killed when a judge fails, crashes, takes more memory than it should or four times
the processor time: the judges are the programs of JUDGES and the tests, the cheapest first, and the first that objects
ends the mutant. What survives is to be read by somebody: it is harmless, and it is said why, or a test is missing.

--rooms mutates some rooms only and asks their tests, beside the programs that judge answers. A header is mutated when at
most --sources sources see it: the others would have nearly everything compiled anew.

Writes mutants.csv and mutants.md into the build folder. --tree names a worktree to use whose build/release is there
already: its pd_core/src is rewritten while the tool compiles, and then restored. --again takes over what an earlier
mutants.csv killed and judges the rest: after a test was added.
"""

import argparse
import concurrent.futures
import csv
import dataclasses
import os
import pathlib
import random
import re
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
CORE = pathlib.Path("pd_core/src")
MEMORY = 4 << 30  # bytes of address space: some mutants would take all there is

# Program and arguments. Tests that measure or run other programs are left out.
JUDGES = [
    ["answer_hash", "--pairs", "300", "--check", "{reference}"],
    ["bound_ratios", "--evaluations", "10000"],
    ["oracle_pairs", "--pairs", "1500", "--seed", "1"],
    ["oracle_pairs", "--pairs", "1500", "--seed", "2", "--bracket", "certified"],
]
ROOMS = ["numeric", "shape", "structure", "planar", "contact", "depth", "compound", "dimension"]
INCLUDE = re.compile(r'#include "([\w/]+\.hpp)"')

OPERATOR = re.compile(r"(?<=\S) (<=|>=|==|!=|<|>|\+|-|\*|/)(?= |$)")
CONSTANT = re.compile(r"(?<![\w:.])((?:detail::)?k[A-Z]\w*)\b(?!\s*[=({\[<:])")
# Factors that cover the rounding of a bound itself: 2^-50 of it, which no answer could show.
SLACK = re.compile(r"\(1 \+ \d+ \* (?:detail::)?kUnitRoundoff\)")
# What a line that declares, includes or asserts says is no decision of the running program.
NO_CODE = re.compile(r"^\s*(#|//|template|using|static_assert|enum|namespace|requires|\*|PD_ASSERT|constexpr|static constexpr|"
                     r"inline constexpr)|operator")
FLIPS = {"<": ["<=", ">="], "<=": ["<", ">"], ">": [">=", "<="], ">=": [">", "<"], "==": ["!="], "!=": ["=="],
         "+": ["-"], "-": ["+"], "*": ["/"], "/": ["*"]}
# Share of each kind among the mutants.
KINDS = {"comparison": 0.4, "arithmetic": 0.2, "error bound": 0.3, "share or limit": 0.1}

HEADER = """#pragma once
#include <cstdlib>
#include <type_traits>
#include <utility>
namespace pd::mutant {
inline const int active = [] { const char* s = std::getenv("PD_MUTANT"); return s ? std::atoi(s) : 0; }();
template <int Id> constexpr bool on() { return !std::is_constant_evaluated() && active == Id; }
template <class Site, class A> struct Half { A&& a; };
template <int Id> constexpr double scaled(double x, double factor) { return on<Id>() ? factor * x : x; }
}  // namespace pd::mutant
"""
# The operator is written twice round an object of a type of its own: its left half holds the left operand, so that what binds
# how stays as it was. `a < b` becomes `a < Site1{} > b`.
SITE = """namespace pd::mutant {{
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wsign-compare"
#pragma GCC diagnostic ignored "-Wconversion"
struct Site{id} {{}};
template <class A> constexpr Half<Site{id}, A> operator{left}(A&& a, Site{id}) {{ return {{std::forward<A>(a)}}; }}
template <class A, class B> constexpr auto operator{right}(Half<Site{id}, A> h, B&& b) {{
  return on<{id}>() ? h.a {to} b : h.a {was} b;
}}
#pragma GCC diagnostic pop
}}  // namespace pd::mutant
"""
MIRROR = {"<": ">", ">": "<", "<=": ">=", ">=": "<="}


@dataclasses.dataclass
class Mutant:
    kind: str
    path: pathlib.Path
    line: int  # from 0
    start: int
    was: str
    to: str  # an operator, or the factor of a constant
    text: str
    id: int = 0
    judged: bool = False
    killer: str = ""
    seconds: float = 0  # of processor time

    def is_constant(self):
        return self.kind in ("error bound", "share or limit")

    def rewritten(self):
        if self.is_constant():
            return f"::pd::mutant::scaled<{self.id}>({self.was}, {self.to})"
        return f"{self.was} ::pd::mutant::Site{self.id}{{}} {MIRROR.get(self.was, self.was)}"

    def declaration(self):
        if self.is_constant():
            return ""
        return SITE.format(id=self.id, left=self.was, right=MIRROR.get(self.was, self.was), to=self.to, was=self.was)

    def place(self):
        return f"{self.path}:{self.line + 1}"

    def change(self):
        return f"{self.was} -> {self.to}{' x' if self.is_constant() else ''}"

    def key(self):
        return (str(self.path), str(self.line + 1), str(self.start), self.was, self.to)


def values_of_constants(texts):
    """Values of the constants declared as double, as far as plain arithmetic gives them; by name, the last of its name."""
    values = {}
    declared = {}
    for text in texts.values():
        declared.update(re.findall(r"constexpr double (k\w+) = ([^;{]+);", text))
    for _ in range(3):  # constants of constants
        for name, expression in declared.items():
            plain = re.sub(r"0x[0-9a-fA-F.]+p[+-]?\d+", lambda m: repr(float.fromhex(m.group(0))), expression)
            plain = re.sub(r"(?:detail::)?(k[A-Z]\w*)", lambda m: repr(values.get(m.group(1), m.group(1))), plain)
            if re.fullmatch(r"[\d.e+\-*/ ()]+", plain):
                values[name] = eval(plain)  # pylint: disable=eval-used
    return values


def mutants_of(texts, values):
    found = {kind: [] for kind in KINDS}
    for path, text in sorted(texts.items()):
        for number, line in enumerate(text.splitlines()):
            code = line.split("//")[0].rstrip()
            if NO_CODE.search(code) or '"' in code or "[[" in code:
                continue
            for m in OPERATOR.finditer(code):
                kind = "comparison" if m.group(1) in "<=>=!=" else "arithmetic"
                found[kind] += [Mutant(kind, path, number, m.start(1), m.group(1), to, line.strip()) for to in FLIPS[m.group(1)]]
            for m in CONSTANT.finditer(SLACK.sub(lambda m: " " * len(m.group(0)), code)):
                value = values.get(m.group(1).removeprefix("detail::"))
                if value is not None:
                    # Roundings of any length; what is smaller stands for underflow, what is larger for a choice.
                    kind = "error bound" if 1e-35 < abs(value) < 1e-10 else "share or limit"
                    found[kind] += [Mutant(kind, path, number, m.start(1), m.group(1), to, line.strip()) for to in ("0", "0.01")]
    return found


def draw(found, count, dice):
    """At most one mutant a line and kind."""
    drawn = []
    for kind, share in KINDS.items():
        pool = found[kind]
        dice.shuffle(pool)
        taken = {}
        for mutant in pool:
            if len(taken) < share * count:
                taken.setdefault((mutant.path, mutant.line), mutant)
        drawn += taken.values()
    for number, mutant in enumerate(drawn, 1):
        mutant.id = number
    return drawn


def sources_that_see(texts):
    """How many sources each file is compiled in, by the includes between the files of the core's src."""
    reached = {}
    for source in texts:
        if source.suffix == ".cpp":
            seen, queue = set(), [source]
            while queue:
                path = queue.pop()
                if path in seen or path not in texts:
                    continue
                seen.add(path)
                queue += [CORE / name for name in INCLUDE.findall(texts[path])]
            for path in seen:
                reached[path] = reached.get(path, 0) + 1
    return reached


class Tree:
    """A worktree whose core is rewritten, with the texts that it has in the commit."""

    def __init__(self, root):
        self.root = root
        if not root.exists():
            git(ROOT, "worktree", "add", "--detach", root, "HEAD")
        if git(root, "status", "--porcelain", "--", CORE):
            sys.exit(f"{root / CORE} is not as committed")
        self.objects = root / "build" / "release"
        self.commit = git(root, "rev-parse", "--short", "HEAD").strip()
        names = git(root, "ls-files", "--", CORE).splitlines()
        self.originals = {pathlib.Path(name): (root / name).read_text(encoding="utf-8") for name in names}

    def restore(self):
        self.write([])
        (self.root / CORE / "mutant.hpp").unlink()

    def write(self, mutants):
        replace(self.root / CORE / "mutant.hpp", HEADER)
        of = {}
        for mutant in mutants:
            of.setdefault(mutant.path, []).append(mutant)
        for path, original in self.originals.items():
            text = original
            if path in of:
                lines = original.splitlines()
                for mutant in sorted(of[path], key=lambda m: (m.line, -m.start)):
                    before = lines[mutant.line]
                    lines[mutant.line] = (before[:mutant.start] + mutant.rewritten() + before[mutant.start + len(mutant.was):])
                guard = "#pragma once\n" if "#pragma once" in lines else ""
                declarations = "".join(m.declaration() for m in of[path])
                text = f'{guard}#include "mutant.hpp"\n{declarations}#line 1\n' + "\n".join(lines) + "\n"
            replace(self.root / path, text)

    def configure(self):
        launcher = ["-DCMAKE_CXX_COMPILER_LAUNCHER=ccache"] if shutil.which("ccache") else []
        # Warnings are those of the originals; with the flags of CI the compiler cache knows what is not mutated.
        subprocess.run(["cmake", "--preset", "release", "--log-level=ERROR", *launcher, "-DPD_WARNINGS_AS_ERRORS=ON"], cwd=self.root,
                       check=True, stdout=subprocess.DEVNULL)

    def build(self, jobs, targets):
        """Returns what the compiler says, or None when all is built."""
        done = subprocess.run(["cmake", "--build", self.objects, "-j", str(jobs), "--target", *targets, "--", "-k", "0"], text=True,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False)
        return None if done.returncode == 0 else done.stdout


def git(folder, *arguments):
    return subprocess.run(["git", *arguments], cwd=folder, check=True, capture_output=True, text=True).stdout


def replace(path, text):
    """Leaves the time of a file alone whose text stays."""
    if not path.exists() or path.read_text(encoding="utf-8") != text:
        path.write_text(text, encoding="utf-8")


def to_blame(output, mutants):
    """Mutants on lines that the compiler complains about; all of the files named when none is on such a line."""
    places = set(re.findall(r"(pd_core/src/[\w/.]+?):(\d+):", output))
    lines = {(file, int(line) - 1) for file, line in places}
    blamed = [m for m in mutants if (str(m.path), m.line) in lines]
    blamed = blamed or [m for m in mutants if (str(m.path), m.line - 1) in lines or (str(m.path), m.line + 1) in lines]
    return blamed or [m for m in mutants if str(m.path) in {file for file, _ in places}]


def run(build, judge, mutant_id, limit, folder):
    """Returns what objected, or nothing, and the seconds of processor time taken, of at most `limit`."""
    name = judge[0]
    command = [str(build / "programs" / name)] + [a.format(reference=build / "answers.txt") for a in judge[1:]]

    def bounded():
        resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
        resource.setrlimit(resource.RLIMIT_CPU, (limit, limit))

    with tempfile.TemporaryFile(mode="w+", errors="replace") as output:
        process = subprocess.Popen(command, env=dict(os.environ, PD_MUTANT=str(mutant_id)), cwd=folder, stdout=output,
                                   stderr=subprocess.STDOUT, preexec_fn=bounded)
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
        return f"{name}: {'no end' if seconds >= limit - 1 else signal.Signals(-code).name}", seconds
    return name, seconds


def judged(build, judges, mutant, normal, end):
    """Asks the cheap judges, the tests of the mutant's room, and the others; nobody after the end."""
    if time.monotonic() > end:
        return mutant
    mutant.judged = True
    room = f"test_{mutant.path.parts[2]}"
    order = sorted(range(len(judges)), key=lambda j: normal[j] if judges[j][0] != room else min(normal[j], 10))
    folder = build / "work" / str(mutant.id)
    folder.mkdir(parents=True, exist_ok=True)
    for j in order:
        mutant.killer, seconds = run(build, judges[j], mutant.id, int(4 * normal[j]) + 5, folder)
        mutant.seconds += seconds
        if mutant.killer:
            break
    shutil.rmtree(folder, ignore_errors=True)
    return mutant


def compiled(tree, mutants, jobs, targets):
    """Builds the programs with as many of the mutants as compile."""
    tree.write(mutants)
    tree.configure()
    while (output := tree.build(jobs, targets)) is not None:
        blamed = to_blame(output, mutants)
        if not blamed:
            sys.exit(output[-4000:] + "\nthe build fails, and not for a mutant")
        mutants = [m for m in mutants if m not in blamed]
        print(f"{len(blamed)} places do not compile otherwise: {len(mutants)} left", flush=True)
        tree.write(mutants)
    return mutants


def write_reports(build, commit, options, mutants, compiled_count, drawn_count):
    with open(build / "mutants.csv", "w", encoding="utf-8", newline="") as out:
        table = csv.writer(out)
        table.writerow(["file", "line", "column", "was", "to", "kind", "killed_by", "seconds", "text"])
        for m in mutants:
            table.writerow([*m.key(), m.kind, m.killer, f"{m.seconds:.1f}", m.text])
    killers = {}
    for m in mutants:
        if m.killer:
            program = m.killer.split(":")[0]
            program = program if any(program == judge[0] for judge in JUDGES) else "a test"
            killers[program] = killers.get(program, 0) + 1
    with open(build / "mutants.md", "w", encoding="utf-8") as out:
        dead = sum(1 for m in mutants if m.killer)
        print(f"`tests/long/mutate.py --mutants {options.mutants} --seed {options.seed} --rooms {options.rooms}`, "
              f"commit {commit}: {dead} of {len(mutants)} mutants killed "
              f"({100 * dead / max(1, len(mutants)):.1f} %); {drawn_count} were drawn, {compiled_count} compile.\n", file=out)
        print("| kind | killed | of |\n|---|---|---|", file=out)
        for kind in KINDS:
            of = [m for m in mutants if m.kind == kind]
            print(f"| {kind} | {sum(1 for m in of if m.killer)} | {len(of)} |", file=out)
        print("\n| killed by | mutants |\n|---|---|", file=out)
        for killer, count in sorted(killers.items(), key=lambda item: -item[1]):
            print(f"| {killer} | {count} |", file=out)
        print("\n| survivor | change | line |\n|---|---|---|", file=out)
        for m in mutants:
            if not m.killer:
                code = m.text.replace("|", "\\|")
                print(f"| {m.place()} | `{m.change()}` | `{code}` |", file=out)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--mutants", type=int, default=240)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--minutes", type=float, default=210, help="no mutant is begun after so long")
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build" / "mutants")
    parser.add_argument("--tree", type=pathlib.Path, help="a clean worktree to use instead of BUILD/source")
    parser.add_argument("--rooms", default=",".join(ROOMS))
    parser.add_argument("--sources", type=int, default=8)
    parser.add_argument("--again", type=pathlib.Path, help="a mutants.csv: what it killed stays so")
    options = parser.parse_args()
    build = options.build.resolve()
    (build / "programs").mkdir(parents=True, exist_ok=True)
    tree = Tree((options.tree or build / "source").resolve())
    rooms = options.rooms.split(",")
    judges = JUDGES + [[f"test_{room}", "--gtest_fail_fast", "--gtest_brief=1"] for room in rooms]
    targets = list(dict.fromkeys(judge[0] for judge in judges))
    seen = sources_that_see(tree.originals)
    texts = {path: text for path, text in tree.originals.items()
             if path.parts[2] in rooms and (path.suffix == ".cpp" or seen.get(path, 0) <= options.sources)}
    drawn = draw(mutants_of(texts, values_of_constants(tree.originals)), options.mutants, random.Random(options.seed))
    try:
        mutants = compiled(tree, drawn, options.jobs, targets)
        for name in targets:
            shutil.copy2(tree.objects / name, build / "programs" / name)
    finally:
        tree.restore()

    if options.again:
        with open(options.again, encoding="utf-8", newline="") as table:
            killers = {(r["file"], r["line"], r["column"], r["was"], r["to"]): r["killed_by"] for r in csv.DictReader(table)}
        for mutant in mutants:
            mutant.killer = killers.get(mutant.key(), "")
            mutant.judged = bool(mutant.killer)
    subprocess.run([build / "programs" / "answer_hash", *JUDGES[0][1:3], "--out", build / "answers.txt"], check=True,
                   stdout=subprocess.DEVNULL)
    normal = []
    for judge in judges:
        objection, seconds = run(build, judge, 0, 3600, build)
        if objection:
            sys.exit(f"fails without a mutant: {objection}")
        normal.append(seconds)
    print("judges:", ", ".join(f"{judge[0]} {seconds:.0f} s" for judge, seconds in zip(judges, normal)), flush=True)
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        end = time.monotonic() + 60 * options.minutes
        left = [mutant for mutant in mutants if not mutant.killer]
        random.Random(options.seed).shuffle(left)
        runs = [pool.submit(judged, build, judges, mutant, normal, end) for mutant in left]
        for done, future in enumerate(concurrent.futures.as_completed(runs), 1):
            mutant = future.result()
            if not mutant.judged:
                continue
            print(f"{done}/{len(runs)}  {mutant.place()}  {mutant.change()}: {mutant.killer or 'SURVIVES'}  ({mutant.seconds:.0f} s)",
                  flush=True)
    write_reports(build, tree.commit, options, [m for m in mutants if m.judged], len(mutants), len(drawn))
    print((build / "mutants.md").read_text(encoding="utf-8"))


if __name__ == "__main__":
    main()
