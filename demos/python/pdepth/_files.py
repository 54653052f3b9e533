"""Files that are there whole or not at all, whatever happens while they are written."""

import os
import uuid

import numpy as np


def save_arrays(path, arrays):
    """Writes an npz file as np.savez does, under another name in its folder first: no reader sees half of it."""
    path = os.path.realpath(path)
    if not path.endswith(".npz"):
        path += ".npz"
    partial = os.path.join(os.path.dirname(path), f".pdepth-{uuid.uuid4().hex}")
    try:
        with open(partial, "xb") as file:
            np.savez(file, **arrays)
            file.flush()
            os.fsync(file.fileno())
        os.replace(partial, path)
    except BaseException:
        if os.path.exists(partial):
            os.unlink(partial)
        raise
