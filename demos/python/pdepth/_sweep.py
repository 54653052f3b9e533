"""Many pairs in chunks: on this machine or on a Dask cluster, with the same bytes, resumed from what is on disk."""

from __future__ import annotations

import hashlib
import json
import pathlib
import sys
import time
import warnings
import zipfile

import numpy as np

from . import _queries
from ._core import Shape
from ._errors import refused, whole_number
from ._files import save_arrays


class Sweep:
    """The files of a sweep: `files` in the order of the pairs, `computed` of them by this call, the others kept from before."""

    def __init__(self, folder, files, inputs, computed):
        self.folder, self.files, self.computed = folder, files, computed
        self.count, self._noun, self._empty = inputs.count, inputs.noun, None

    @classmethod
    def of_nothing(cls, folder, inputs, threads, options):
        """A sweep without rows, and so without files, has the columns of a batch without rows."""
        made = cls(folder, [], inputs, 0)
        made._empty = inputs.chunk(inputs.shared, *inputs.rows(0, 0), threads, options)
        return made

    def __iter__(self):
        """The chunks in order, each a dictionary of arrays; one in memory at a time."""
        for file in self.files:
            with np.load(file) as chunk:
                yield {name: chunk[name] for name in chunk.files if name != "inputs"}

    def __getitem__(self, name):
        """One column of all pairs."""
        return np.concatenate([chunk[name] for chunk in (self if self._empty is None else [self._empty])])

    def __repr__(self):
        return f"<Sweep of {self.count} {self._noun} in {len(self.files)} files, {self.computed} of them computed now: {self.folder}>"


def _chunk(shapes, pairs, poses_a, poses_b, threads, options):
    """One chunk's columns; runs on a worker."""
    found = _queries.depth([shapes[i] for i in pairs[:, 0]], [shapes[i] for i in pairs[:, 1]], poses_a, poses_b,
                           threads=threads, **options)
    return {name: found[name] for name in found}


def _inputs_digest(head, rows):
    digest = hashlib.sha256(head)
    for part in rows:
        digest.update(np.ascontiguousarray(part).tobytes())
    return digest.hexdigest()


def _is_done(path, digest):
    try:
        with np.load(path) as chunk:
            return str(chunk["inputs"]) == digest
    except (OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile):  # missing, or cut short
        return False


class _Progress:
    def __init__(self, total, noun, shown):
        self.noun = noun
        self.total, self.shown, self.done, self.start, self.last = total, shown, 0, time.monotonic(), 0.0

    def step(self, pairs):
        self.done += pairs
        now = time.monotonic()
        if self.shown and (now - self.last > 0.5 or self.done == self.total):
            self.last = now
            end = "\n" if self.done == self.total else "\r"
            print(f"{self.done} of {self.total} {self.noun}, {now - self.start:.0f} s", end=end, file=sys.stderr, flush=True)


class _Pairs:
    """Pairs and poses by rows, whether they are arrays (memory-mapped ones stay on disk) or functions.

    A question of a sweep has `count` rows, each a `noun`, of which rows(begin, end) are arrays; `shared`, which a worker gets once; and
    chunk(shared, *rows, threads, options), which answers columns.
    """

    chunk, noun = staticmethod(_chunk), "pairs"

    def __init__(self, shapes, pairs, poses):
        self.shared = list(shapes)
        for i, shape in enumerate(self.shared):
            if not isinstance(shape, Shape):
                raise refused(f"shapes[{i}]: must be a pdepth shape, not {type(shape).__name__} (bad_value)")
        self.pairs = np.asarray(pairs) if not isinstance(pairs, np.memmap) else pairs
        if self.pairs.ndim != 2 or self.pairs.shape[1] != 2 or self.pairs.dtype.kind not in "iu":
            raise refused(f"pairs: has shape {self.pairs.shape} and dtype {self.pairs.dtype}, needs [n, 2] integers (bad_value)")
        outside = (self.pairs < 0) | (self.pairs >= len(self.shared))
        if outside.any():
            row = int(np.argmax(outside.any(axis=1)))
            raise refused(f"pairs[{row}]: shapes are numbered 0 to {len(self.shared) - 1} (out_of_range)")
        self.count = len(self.pairs)
        self.poses = poses
        if not callable(poses):
            if not hasattr(poses, "__len__") or len(poses) != 2:
                raise refused("poses: (poses_a, poses_b), each [n, 4, 4], or a function of (begin, end) (bad_value)")
            for name, column in zip(("poses[0]", "poses[1]"), poses):
                if np.shape(column) != (self.count, 4, 4):
                    raise refused(f"{name}: has shape {np.shape(column)}, needs {(self.count, 4, 4)} (bad_value)")

    def told(self):
        return [shape.protocol() for shape in self.shared]

    def rows(self, begin, end):
        pairs = np.ascontiguousarray(self.pairs[begin:end], dtype=np.int64)
        if begin == end:
            poses_a = poses_b = np.empty((0, 4, 4))
        else:
            poses_a, poses_b = self.poses(begin, end) if callable(self.poses) else (each[begin:end] for each in self.poses)
        return pairs, np.asarray(poses_a, dtype=float), np.asarray(poses_b, dtype=float)


def _run_here(inputs, missing, finish, threads, options):
    for rows, path, digest in missing:
        finish(path, inputs.chunk(inputs.shared, *rows, threads, options), digest, len(rows[0]))


def _run_on(client, inputs, missing, finish, threads, options):
    """Twice as many chunks under way as the cluster has threads: workers never wait, memory stays bounded."""
    from distributed import as_completed

    shared = client.scatter(inputs.shared, broadcast=True, hash=False)
    waiting, known = iter(missing), {}

    def submit():
        work = next(waiting, None)
        if work is None:
            return None
        rows, path, digest = work
        with warnings.catch_warnings():  # rows are large, sent once, and kept here until a worker has answered them
            warnings.filterwarnings("ignore", "Large object", UserWarning)
            future = client.submit(inputs.chunk, shared, *rows, threads, options, pure=False)
        known[future] = (path, digest, len(rows[0]))
        return future

    under_way = max(2, 2 * sum(client.nthreads().values()))
    first = [future for future in (submit() for _ in range(under_way)) if future is not None]
    queue = as_completed(first)
    for future in queue:
        path, digest, pairs = known.pop(future)
        finish(path, future.result(), digest, pairs)
        future.release()
        following = submit()
        if following is not None:
            queue.add(following)


def sweep(shapes, pairs, poses, client=None, *, out, chunk=10_000, threads=None, progress=True, **options):
    """Asks depth for many pairs and writes the answers to `out` as they come.

    shapes: a list.
    pairs: [n, 2], rows of that list.
    poses: (poses_a, poses_b), each [n, 4, 4], or a function of (begin, end) that gives those rows, called once a chunk. An
    np.memmap stays on disk.
    client: a distributed.Client, else this machine.
    out: the folder of the answers.
    chunk: pairs a file.
    threads: cores for one chunk; by default all cores here and 1 on a cluster.
    options: method, delta, bracket and beyond of depth.

    File chunk_K.npz holds the columns of depth's Batch for pairs [K * chunk, (K + 1) * chunk) and `inputs`, the SHA-256
    of what was asked and of pdepth's version. A file whose inputs are the same is kept when the sweep is called again;
    anything else is computed anew. The bytes are the same with and without a cluster. Answers a Sweep.
    """
    how = {"out": out, "chunk": chunk, "threads": threads, "progress": progress}
    return run(_Pairs(shapes, pairs, poses), client, how, options)


def run(inputs, client, how, options):
    """Runs a question of many rows in chunks. how: the arguments out, chunk, threads and progress of `sweep`."""
    out, chunk, threads, progress = (how[name] for name in ("out", "chunk", "threads", "progress"))
    chunk = whole_number(chunk, "chunk", 1)
    folder = pathlib.Path(out)
    folder.mkdir(parents=True, exist_ok=True)
    from . import __version__

    asked = [__version__, inputs.told(), options]
    head = json.dumps(asked, sort_keys=True).encode()
    shown = _Progress(inputs.count, inputs.noun, progress)
    files = [folder / f"chunk_{k:06d}.npz" for k in range(-(-inputs.count // chunk))]
    computed = 0
    if inputs.count == 0:
        return Sweep.of_nothing(folder, inputs, threads or 1, options)

    def missing():
        for k, path in enumerate(files):
            begin, end = k * chunk, min((k + 1) * chunk, inputs.count)
            rows = inputs.rows(begin, end)
            digest = _inputs_digest(head, rows)
            if _is_done(path, digest):
                shown.step(end - begin)
            else:
                yield rows, path, digest

    def finish(path, columns, digest, count):
        nonlocal computed
        save_arrays(path, {**columns, "inputs": np.array(digest)})
        computed += 1
        shown.step(count)

    if client is None:
        _run_here(inputs, missing(), finish, threads, options)
    else:
        _run_on(client, inputs, missing(), finish, threads or 1, options)
    return Sweep(folder, files, inputs, computed)
