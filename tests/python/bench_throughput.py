"""Throughput of batches, and the cost of a single call, beside the same pairs in C++, in one run.

    cmake --build build/release --target python_pair_loop pd_python
    PYTHONPATH=build/release/python python3 tests/python/bench_throughput.py build/release/python_pair_loop

Each round times Python and C++ one after the other; the medians of the rounds are compared.
"""
import statistics
import subprocess
import sys
import tempfile
import time

import numpy as np
import pdepth
from conftest import random_rotations


def main(program, count=20_000, rounds=7):
    rng = np.random.default_rng(0)
    poses = np.tile(np.eye(4), (count, 1, 1))
    poses[:, :3, :3] = random_rotations(rng, count)
    poses[:, :3, 3] = rng.uniform(-1.5, 1.5, (count, 3))
    cube = np.array([[x, y, z] for x in (-1.0, 1) for y in (-1, 1) for z in (-1, 1)])
    with tempfile.TemporaryDirectory() as folder:
        poses.tofile(f"{folder}/poses")
        for name, points in (("two cubes", cube), ("hulls of 40 points", rng.normal(size=(40, 3)))):
            points.tofile(f"{folder}/points")
            shape = pdepth.ConvexPolytope(points)

            def plain(threads):
                told = subprocess.run([program, *[f"{folder}/points"] * 2, f"{folder}/poses", str(threads)], check=True,
                                      capture_output=True, text=True).stdout.split()
                return float(told[0]), float(told[1])

            for threads in (1, pdepth.cores()):
                ours, theirs, singles = [], [], []
                for _ in range(rounds):
                    start = time.perf_counter()
                    found = pdepth.depth(shape, shape, poses, threads=threads)
                    ours.append(time.perf_counter() - start)
                    seconds, total = plain(threads)
                    theirs.append(seconds)
                    if threads == 1:
                        rows = [pdepth.Pose(pose) for pose in poses[:5000]]
                        start = time.perf_counter()
                        for row in rows:
                            pdepth.depth(shape, shape, row)
                        singles.append((time.perf_counter() - start) / len(rows))
                        start = time.perf_counter()
                        pdepth.depth(shape, shape, poses[:5000], threads=1)
                        singles[-1] -= (time.perf_counter() - start) / len(rows)
                signed = found.depth - found.distance
                assert abs(signed.sum() - total) < 1e-9 * np.abs(signed).sum()
                ratio = statistics.median(theirs) / statistics.median(ours)
                print(f"{name}, {threads} threads: Python {1e6 * statistics.median(ours) / count:.2f} us a pair, C++ "
                      f"{1e6 * statistics.median(theirs) / count:.2f}; throughput {ratio:.3f} of C++"
                      + (f"; a single call costs {1e6 * statistics.median(singles):.2f} us more" if singles else ""))


if __name__ == "__main__":
    main(sys.argv[1])
