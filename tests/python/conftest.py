"""The package under test is the one staged by the release build, or what PYTHONPATH names before it."""
import pathlib
import sys

import numpy as np
import pytest

TOP = pathlib.Path(__file__).resolve().parents[2]
sys.path.append(str(TOP / "build" / "release" / "python"))


def random_rotations(rng, n):
    q = rng.normal(size=(n, 4))
    q /= np.linalg.norm(q, axis=1, keepdims=True)
    w, x, y, z = q.T
    rows = [[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]]
    return np.array(rows).transpose(2, 0, 1)


@pytest.fixture
def poses():
    """poses(n, reach=1.0, seed=1): [n, 4, 4]."""
    def make(n, reach=1.0, seed=1):
        rng = np.random.default_rng(seed)
        matrices = np.tile(np.eye(4), (n, 1, 1))
        matrices[:, :3, :3] = random_rotations(rng, n)
        matrices[:, :3, 3] = rng.uniform(-reach, reach, (n, 3))
        return matrices
    return make
