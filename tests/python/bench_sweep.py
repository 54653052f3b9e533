"""A sweep on a Dask cluster of two processes of this machine: seconds, files, and the peak of every process's memory.

    PYTHONPATH=build/release/python python3 tests/python/bench_sweep.py --pairs 1000000
"""
import argparse
import os
import resource
import tempfile
import time

import numpy as np
import pdepth


def peak_megabytes():
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


def poses(begin, end):
    """Poses of these rows: a slow turn, and a way past each other."""
    steps = np.arange(begin, end)
    angles = 1e-3 * steps
    turned = np.tile(np.eye(4), (end - begin, 1, 1))
    turned[:, 0, 0] = turned[:, 1, 1] = np.cos(angles)
    turned[:, 1, 0] = np.sin(angles)
    turned[:, 0, 1] = -turned[:, 1, 0]
    placed = np.tile(np.eye(4), (end - begin, 1, 1))
    placed[:, 0, 3] = steps % 1000 * 4e-3
    return turned, placed


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--pairs", type=int, default=100_000)
    parser.add_argument("--chunk", type=int, default=10_000)
    parser.add_argument("--workers", type=int, default=2)
    options = parser.parse_args()
    from distributed import Client, LocalCluster

    shapes = [pdepth.Box([1, 1, 1]), pdepth.ConvexPolytope(np.random.default_rng(0).normal(size=(20, 3))), pdepth.Sphere(0.5)]
    pairs = np.random.default_rng(1).integers(0, len(shapes), (options.pairs, 2), dtype=np.int8)
    with tempfile.TemporaryDirectory() as folder, LocalCluster(
            n_workers=options.workers, threads_per_worker=1, dashboard_address=None, local_directory=f"{folder}/dask"
    ) as cluster, Client(cluster) as client:
        def memory():
            return peak_megabytes(), sorted(client.run(peak_megabytes).values())

        # Four chunks a thread: from here on nothing is for the first time.
        warm_up = pairs[:8 * options.workers * options.chunk]
        pdepth.sweep(shapes, warm_up, poses, client, out=f"{folder}/warm_up", chunk=options.chunk, progress=False)
        here, there = memory()
        start = time.perf_counter()
        done = pdepth.sweep(shapes, pairs, poses, client, out=f"{folder}/out", chunk=options.chunk, progress=False)
        seconds = time.perf_counter() - start
        here_after, there_after = memory()
        size = sum(os.path.getsize(file) for file in done.files)
        overlapping = sum(int((part["contact"] == 2).sum()) for part in done)
        refused = sum(int((part["error"] != 0).sum()) for part in done)
    print(f"{options.pairs} pairs on {options.workers} workers: {seconds:.0f} s, {len(done.files)} files of {size / 1e6:.0f} MB, "
          f"{overlapping} overlap, {refused} refused")
    print(f"peak memory after {len(warm_up)} pairs and after all: client {here:.0f} -> {here_after:.0f} MB, workers "
          + ", ".join(f"{before:.0f} -> {after:.0f}" for before, after in zip(there, there_after)) + " MB")


if __name__ == "__main__":
    main()
