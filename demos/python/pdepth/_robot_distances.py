"""Signed distances of pairs of links for many joint vectors, and their derivatives."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from . import _core
from ._queries import COLD, Batch
from ._robot_bodies import ball_of
from ._robot_motion import compose, cross, dot, turned

_NON_FINITE = _core.ERRORS.index("non_finite")
_SEPARATED = 0
#: Joint vectors of a path that one thread answers in a row, each started from the last. The first of them starts cold.
STRETCH = 64

#: Columns of an answer: their shapes and kinds. by_q has as many numbers as q.
_COLUMNS = {"error": ((), np.uint8), "signed_distance": ((), float), "lower": ((), float), "upper": ((), float),
            "normal": ((3,), float), "witness_a": ((3,), float), "witness_b": ((3,), float)}


class RobotDistances(Batch):
    """Signed distances of pairs of links: a struct of arrays, one row a pair and joint vector.

    signed_distance: positive apart, minus the depth where the links overlap.
    lower, upper: the certified bracket of the signed distance.
    normal: from the second link to the first.
    witness_a, witness_b: a point of each link.
    pair: a row of the pairs that were asked.
    by_q, unique: the derivative by the joint vector, and where it is proved to exist; with derivatives=True.
    error: 0, or an index into pdepth.ERRORS.
    """


class How(NamedTuple):
    bracket: str
    threads: int
    stretches: np.ndarray | None  #: the stretch of a path to which each joint vector belongs; None: all are asked alone

    def of(self, rows):
        return self if self.stretches is None else self._replace(stretches=self.stretches[rows])


def stretches(count, steps=1):
    """Numbers of stretches of paths of so many steps each."""
    return np.cumsum(np.arange(count) % steps % STRETCH == 0)


class Question:
    """All of a call: joint vectors [n, dof], pairs of links by index, and how they are answered."""

    def __init__(self, tree, bodies, q, pairs, how):
        self._tree, self._bodies, self._q, self._pairs, self._how = tree, bodies, q, pairs, how
        self._settings = _core.settings("auto", None, how.bracket, None)
        self._links, self._before = tree.frames(q)
        self._places = {}
        for link in {link for pair in pairs for link in pair}:
            place = bodies[link][1]
            still = (place == np.eye(4)).all()
            self._places[link] = self._links[link] if still else compose(self._links[link], place)

    def all(self, derivatives):
        """Columns [n, pairs]."""
        n, shape = len(self._q), (len(self._q), len(self._pairs))
        columns = self._empty(shape, derivatives)
        columns["pair"] = np.broadcast_to(np.arange(len(self._pairs)), shape).copy()
        for k in range(len(self._pairs)):
            for name, column in self._ask(k, slice(None), derivatives).items():
                columns[name][:, k] = column
        return columns

    def nearest(self, derivatives):
        """Columns [n] of the pair of the least signed distance; of equal ones, the first."""
        n, count = len(self._q), len(self._pairs)
        floor = self._floors()
        best, pair = np.full(n, np.inf), np.full(n, count)
        # The pair whose balls are nearest is asked first, and then every pair whose balls are nearer than its answer.
        first = floor.argmin(axis=0)
        for turn in range(2):
            for k in range(count):
                rows = np.flatnonzero((first == k) if turn == 0 else (first != k) & (floor[k] <= best))
                if len(rows) == 0:
                    continue
                found = self._ask(k, rows, False)["signed_distance"]
                # NaN is nearer than anything, so that what could not be answered is told.
                nearer = ~(found > best[rows]) & (np.isnan(found) | (found < best[rows]) | (k < pair[rows]))
                best[rows[nearer]], pair[rows[nearer]] = found[nearer], k
        columns = self._empty((n,), derivatives)
        columns["pair"] = pair
        for k in range(count):
            rows = np.flatnonzero(pair == k)
            if len(rows):
                for name, column in self._ask(k, rows, derivatives).items():
                    columns[name][rows] = column
        return columns

    def _empty(self, lead, derivatives):
        columns = {name: np.empty((*lead, *shape), dtype=kind) for name, (shape, kind) in _COLUMNS.items()}
        if derivatives:
            columns["by_q"] = np.empty((*lead, self._q.shape[1]))
            columns["unique"] = np.empty(lead, dtype=bool)
        return columns

    def _floors(self):
        """No pair's signed distance lies below these, [pairs, n]: those of balls around the links."""
        balls = {link: ball_of(self._bodies[link]) for link in self._places}
        centres = {link: turned(self._links[link][:, :3, :3], centre[None]) + self._links[link][:, :3, 3]
                   for link, (centre, _) in balls.items()}
        size = {link: np.abs(centre).max(axis=1) for link, centre in centres.items()}
        floors = []
        for a, b in self._pairs:
            apart = centres[b] - centres[a]
            slack = 1e-12 * (size[a] + size[b])  # of rounded centres
            floors.append(np.sqrt(dot(apart, apart)) - balls[a][1] - balls[b][1] - slack)
        return np.array(floors)

    def _starts(self, rows):
        """Places among these rows at which stretches begin."""
        if self._how.stretches is None:
            return COLD
        return np.flatnonzero(np.diff(self._how.stretches[rows], prepend=0))

    def _ask(self, k, rows, derivatives):
        """Columns of the rows of a pair."""
        a, b = self._pairs[k]
        shape_a, shape_b = self._bodies[a][0], self._bodies[b][0]
        poses_a, poses_b = self._places[a][rows], self._places[b][rows]
        proved = derivatives and shape_a.is_convex and shape_b.is_convex
        if proved:
            found = _core.derivative_rows([shape_a], [shape_b], poses_a, poses_b, len(poses_a), self._how.threads)
        else:
            found = _core.depth_rows([shape_a], [shape_b], poses_a, poses_b, len(poses_a), self._settings,
                                     self._starts(rows), self._how.threads)
        apart = found["contact"] == _SEPARATED
        columns = {name: found[name] for name in ("error", "normal", "witness_a", "witness_b")}
        columns["signed_distance"] = np.where(apart, found["distance"], 0.0 - found["depth"])
        columns["lower"] = np.where(apart, found["distance_lower"], 0.0 - found["upper"])
        columns["upper"] = np.where(apart, found["distance_upper"], 0.0 - found["lower"])
        if derivatives:
            columns["unique"] = found["unique_witness"] if proved else np.zeros(len(poses_a), dtype=bool)
            columns["by_q"] = self._by_q(k, rows, columns)
        return columns

    def _by_q(self, k, rows, columns):
        """Along a velocity of the witness points the signed distance grows as they part along the normal."""
        a, b = self._pairs[k]
        by_q = np.zeros((len(columns["error"]), self._q.shape[1]))
        for row, column, factor, (turn, velocity, centre) in self._moves():
            moves_a, moves_b = self._tree.below[row, a], self._tree.below[row, b]
            if moves_a == moves_b:
                continue  # the two move as one, or not at all
            point = columns["witness_a"] if moves_a else columns["witness_b"]
            moved = velocity[rows] + cross(turn[rows], point - centre[rows])
            by_q[:, column] += (factor if moves_a else -factor) * dot(columns["normal"], moved)
        return by_q

    def _moves(self):
        if not hasattr(self, "_velocities"):
            self._velocities = list(self._tree.moves(self._q, self._before))
        return self._velocities


def refuse_rows(columns, bad):
    """Marks the rows of joint vectors that are not finite."""
    for name, column in columns.items():
        if name != "pair":
            column[bad] = _NON_FINITE if name == "error" else np.nan if column.dtype.kind == "f" else 0
