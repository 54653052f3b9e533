"""Holds the processor time of the build: sources and public headers against a reference source compiled in the same run.

    build_cost.py ROOT LIMITS COMPILER [FLAG...]

LIMITS has one line for each sample: a source or a header below ROOT, and the most that it may take, in units of the reference beside
it. Times are user seconds of the compiler itself, so a compiler cache does not change the ratios. A machine that other work shares can
slow one compilation by half, so a sample above its limit is compiled again, right after a reference of its own, and its lowest ratio
counts. The exit code is 1 where a sample takes more in each of these rounds.
"""

import os
import pathlib
import statistics
import subprocess
import sys
import tempfile

ROUNDS = 5  # the most compilations of one sample


def user_seconds(command):
    process = subprocess.Popen(command)
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode != 0:
        raise SystemExit("does not compile: " + " ".join(map(str, command)))
    return usage.ru_utime


def main():
    root, limits, compiler, flags = pathlib.Path(sys.argv[1]), sys.argv[2], sys.argv[3], sys.argv[4:]
    os.environ["CCACHE_DISABLE"] = "1"
    here = pathlib.Path(__file__).parent
    with tempfile.TemporaryDirectory() as work:
        def compile_time(path):
            source = path
            if path.suffix == ".hpp":
                source = pathlib.Path(work) / "header.cpp"
                source.write_text(f'#include "{path}"\n')
            return user_seconds([compiler, "-std=c++20", "-O3", "-DNDEBUG", "-ffp-contract=off", "-w", *flags, "-c", source,
                                 "-o", os.path.join(work, "object.o")])

        samples = [line.split() for line in open(limits) if line.strip() and not line.startswith("#")]
        reference, seconds = [], []
        for name, _ in samples:
            reference.append(compile_time(here / "build_cost_reference.cpp"))
            seconds.append(compile_time(root / name))
        unit = statistics.median(reference)
        print(f"reference {unit:.2f} s (from {min(reference):.2f} to {max(reference):.2f})")
        dear = 0
        for (name, limit), taken in zip(samples, seconds):
            ratios = [taken / unit]
            while min(ratios) > float(limit) and len(ratios) < ROUNDS:
                beside = compile_time(here / "build_cost_reference.cpp")
                ratios.append(compile_time(root / name) / beside)
            above = min(ratios) > float(limit)
            dear += above
            rounds = f" (lowest of {len(ratios)} rounds, first {ratios[0]:.2f})" if len(ratios) > 1 else ""
            print(f"{min(ratios):6.2f} of at most {limit}  {name}{rounds}{'  ABOVE' if above else ''}")
    if dear > 0:
        raise SystemExit(f"{dear} samples take longer to compile than {limits} allows")


main()
