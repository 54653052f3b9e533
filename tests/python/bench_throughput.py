"""Throughput of batches, and the cost of a single call, beside the same pairs in C++, in one run.

    cmake --build build/release --target python_pair_loop pd_python
    PYTHONPATH=build/release/python python3 tests/python/bench_throughput.py build/release/python_pair_loop

Rounds time Python and C++ one after the other, and the least times of the rounds are compared: what else the machine does
lengthens a time and never shortens it. Processor time, of all threads, is compared, too, for a machine that never rests. A
single call is compared with a single call: the same pairs, one by one, poses made before, in pieces of 500 of which each counts
with its least time.
"""
import subprocess
import sys
import tempfile
import time

import numpy as np
import pdepth
from conftest import random_rotations

PIECE, SINGLES = 500, 2000


def seconds_of_a_single_call(shape, rows, rounds=8):
    least = [float("inf")] * (len(rows) // PIECE)
    for _ in range(rounds):
        for piece in range(len(least)):
            start = time.perf_counter()
            for row in rows[piece * PIECE:(piece + 1) * PIECE]:
                pdepth.depth(shape, shape, row)
            least[piece] = min(least[piece], (time.perf_counter() - start) / PIECE)
    return sum(least) / len(least)


def least(times):
    """Of each kind by itself."""
    return [min(kind) for kind in zip(*times)]


def main(program, count=20_000, rounds=15):
    rng = np.random.default_rng(0)
    poses = np.tile(np.eye(4), (count, 1, 1))
    poses[:, :3, :3] = random_rotations(rng, count)
    poses[:, :3, 3] = rng.uniform(-1.5, 1.5, (count, 3))
    rows = [pdepth.Pose(pose) for pose in poses[:SINGLES]]
    cube = np.array([[x, y, z] for x in (-1.0, 1) for y in (-1, 1) for z in (-1, 1)])
    with tempfile.TemporaryDirectory() as folder:
        poses.tofile(f"{folder}/poses")
        for name, points in (("two cubes", cube), ("hulls of 40 points", rng.normal(size=(40, 3)))):
            points.tofile(f"{folder}/points")
            shape = pdepth.ConvexPolytope(points)
            for threads in (1, pdepth.cores()):
                ours, theirs, our_calls, their_calls = [], [], [], []
                for _ in range(rounds):
                    start, processor = time.perf_counter(), time.process_time()
                    found = pdepth.depth(shape, shape, poses, threads=threads)
                    ours.append((time.perf_counter() - start, time.process_time() - processor))
                    singles = SINGLES if threads == 1 else 0
                    told = subprocess.run([program, *[f"{folder}/points"] * 2, f"{folder}/poses", str(threads), str(singles)],
                                          check=True, capture_output=True, text=True).stdout.split()
                    theirs.append((float(told[0]), float(told[3])))
                    if threads == 1:
                        their_calls.append(float(told[2]))
                        our_calls.append(seconds_of_a_single_call(shape, rows))
                signed = found.depth - found.distance
                assert abs(signed.sum() - float(told[1])) < 1e-9 * np.abs(signed).sum()
                for kind, (mine, plain) in zip(("clock", "processor"), zip(least(ours), least(theirs))):
                    print(f"{name}, {threads} threads, by the {kind}: Python {1e6 * mine / count:.2f} us a pair, C++ "
                          f"{1e6 * plain / count:.2f}; throughput {plain / mine:.3f} of C++")
                if our_calls:
                    print(f"{name}, single calls: Python {1e6 * min(our_calls):.2f} us, C++ {1e6 * min(their_calls):.2f}; "
                          f"{1e6 * (min(our_calls) - min(their_calls)):.2f} us more")


if __name__ == "__main__":
    main(sys.argv[1])
