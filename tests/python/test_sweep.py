"""Sweeps: the same bytes however they are run, nothing lost or double when a worker is killed or the sweep is stopped."""
import os
import resource
import signal
import threading
import time
import warnings

import numpy as np
import pdepth
import pytest

RNG = np.random.default_rng(0)
SHAPES = [pdepth.ConvexPolytope(RNG.normal(size=(20, 3))), pdepth.Box([1, 1, 1]), pdepth.Sphere(0.5)]


def question(poses, n):
    pairs = np.random.default_rng(1).integers(0, 3, (n, 2))
    return pairs, (poses(n, 1.5, 2), poses(n, 1.5, 3))


def bytes_of(done):
    return [file.read_bytes() for file in done.files]


def test_a_sweep_is_the_batch_in_files_and_resumes(poses, tmp_path):
    pairs, (poses_a, poses_b) = question(poses, 1050)
    done = pdepth.sweep(SHAPES, pairs, (poses_a, poses_b), out=tmp_path, chunk=100, progress=False)
    assert (len(done.files), done.computed) == (11, 11)
    found = pdepth.depth([SHAPES[i] for i in pairs[:, 0]], [SHAPES[i] for i in pairs[:, 1]], poses_a, poses_b)
    for name in found:
        assert np.array_equal(done[name], found[name], equal_nan=True)
    before = bytes_of(done)
    done.files[3].unlink()
    done.files[5].write_bytes(before[5][:1000])
    asked = []

    def rows(begin, end):
        asked.append(begin)
        return poses_a[begin:end], poses_b[begin:end]

    again = pdepth.sweep(SHAPES, pairs, rows, out=tmp_path, chunk=100, progress=False)
    assert again.computed == 2 and bytes_of(again) == before and asked == list(range(0, 1050, 100))
    poses_a[250, 0, 3] += 1
    assert pdepth.sweep(SHAPES, pairs, (poses_a, poses_b), out=tmp_path, chunk=100, progress=False).computed == 1


def test_answers_of_another_version_are_computed_anew(poses, tmp_path, monkeypatch):
    pairs, both = question(poses, 200)
    assert pdepth.sweep(SHAPES, pairs, both, out=tmp_path, chunk=100, progress=False).computed == 2
    monkeypatch.setattr(pdepth, "__version__", "0.0.0")
    assert pdepth.sweep(SHAPES, pairs, both, out=tmp_path, chunk=100, progress=False).computed == 2


def test_bad_sweeps_are_refused(poses, tmp_path):
    pairs, both = question(poses, 10)
    for bad in (lambda: pdepth.sweep(SHAPES, pairs + 2, both, out=tmp_path), lambda: pdepth.sweep([1], pairs, both, out=tmp_path),
                lambda: pdepth.sweep(SHAPES, pairs.astype(float), both, out=tmp_path),
                lambda: pdepth.sweep(SHAPES, pairs, (both[0][:3], both[1]), out=tmp_path),
                lambda: pdepth.sweep(SHAPES, pairs, both, out=tmp_path, chunk=0)):
        with pytest.raises(pdepth.Refused):
            bad()


def test_a_killed_worker_loses_nothing(poses, tmp_path, monkeypatch):
    distributed = pytest.importorskip("distributed")
    package = os.path.dirname(os.path.dirname(pdepth.__file__))
    monkeypatch.setenv("PYTHONPATH", package)
    pairs, both = question(poses, 40_000)
    alone = pdepth.sweep(SHAPES, pairs, both, out=tmp_path / "alone", chunk=1000, progress=False)
    with distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None,
                                  local_directory=str(tmp_path / "dask")) as cluster, distributed.Client(cluster) as client:
        killed = []

        def kill():
            out = tmp_path / "cluster"
            while len(list(out.glob("*.npz"))) < 5:
                time.sleep(0.005)
            process = next(iter(client.run(os.getpid).values()))
            os.kill(process, signal.SIGKILL)
            killed.append(len(list(out.glob("*.npz"))))

        killer = threading.Thread(target=kill)
        killer.start()
        spread = pdepth.sweep(SHAPES, pairs, both, client, out=tmp_path / "cluster", chunk=1000, progress=False)
        killer.join()
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            large = pdepth.sweep(SHAPES, pairs, both, client, out=tmp_path / "large", chunk=10_000, progress=False)
        assert large.computed == 4 and np.array_equal(large["depth"], alone["depth"])
    assert killed and killed[0] < 40
    assert spread.computed == 40 and bytes_of(spread) == bytes_of(alone)
    assert sorted(path.name for path in (tmp_path / "cluster").iterdir()) == [path.name for path in spread.files]


def test_memory_does_not_grow_with_the_number_of_pairs(tmp_path):
    """PDEPTH_SWEEP_PAIRS sets another number than 1e5; 1e6 take 200 MB of disk."""
    count = int(os.environ.get("PDEPTH_SWEEP_PAIRS", "100000"))
    ball, chunk = pdepth.Sphere(0.5), 5000
    pairs = np.zeros((count, 2), np.int8)
    grid = np.linspace(0, 2, count)

    def poses(begin, end):
        matrices = np.tile(np.eye(4), (end - begin, 1, 1))
        fixed = matrices.copy()
        matrices[:, 0, 3] = grid[begin:end]
        return fixed, matrices

    pdepth.sweep([ball], pairs[:2 * chunk], poses, out=tmp_path, chunk=chunk, progress=False)
    before = peak_bytes()
    done = pdepth.sweep([ball], pairs, poses, out=tmp_path, chunk=chunk, progress=False)
    grown = peak_bytes() - before
    print(f"{count} pairs, peak memory grew by {grown / 1e6:.1f} MB")
    assert done.computed == count // chunk - 2 and grown < 8 << 20
    signed = np.concatenate([part["depth"] - part["distance"] for part in done])
    assert np.abs(signed - (1 - grid)).max() < 1e-15


def peak_bytes():
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024
