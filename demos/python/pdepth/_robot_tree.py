"""Forward kinematics of a tree of joints for many joint vectors at once."""

from __future__ import annotations

import numpy as np

from ._robot_model import COORDINATES, ordered
from ._robot_motion import compose, motion, velocities


class Tree:
    """The joints of a model, parents first, and which numbers of a joint vector move them."""

    def __init__(self, model):
        self.joints = ordered(model)
        self._link = {link.name: i for i, link in enumerate(model.links)}
        self._known = {joint.name: joint for joint in self.joints}
        self._columns, self.coordinates, limits = {}, [], []
        for joint in self.joints:
            if joint.mimic is None:
                names = [joint.name + suffix for suffix in COORDINATES[joint.kind]]
                self._columns[joint.name] = range(len(self.coordinates), len(self.coordinates) + len(names))
                self.coordinates += names
                limits += [joint.limits] * len(names)
        self.limits = np.array(limits, dtype=float).reshape((-1, 2))
        #: [joints, links]: the link moves with the joint.
        self.below = np.zeros((len(self.joints), len(model.links)), dtype=bool)
        above = {joint.child: row for row, joint in enumerate(self.joints)}
        for row in range(len(self.joints) - 1, -1, -1):
            joint = self.joints[row]
            self.below[row, self._link[joint.child]] = True
            if joint.parent in above:
                self.below[above[joint.parent]] |= self.below[row]

    def _values(self, joint, q):
        """The numbers of a joint, the columns of q that they follow, and with which factor."""
        factor, offset = 1.0, 0.0
        while joint.mimic is not None:
            name, multiplier, shift = joint.mimic
            factor, offset, joint = factor * multiplier, offset + factor * shift, self._known[name]
        columns = self._columns[joint.name]
        return q[:, columns.start:columns.stop] * factor + offset, columns, factor

    def frames(self, q):
        """Poses of all links [links, n, 4, 4], and the frame of each joint before its motion [joints, n, 4, 4]."""
        links = np.tile(np.eye(4), (len(self._link), len(q), 1, 1))
        before = np.empty((len(self.joints), len(q), 4, 4))
        for row, joint in enumerate(self.joints):
            before[row] = compose(links[self._link[joint.parent]], joint.before)
            moved = compose(before[row], motion(joint, self._values(joint, q)[0]))
            links[self._link[joint.child]] = compose(moved, joint.after)
        return links, before

    def moves(self, q, before):
        """For each coordinate of each joint: its row of `below`, its column of q, the factor, and its velocities."""
        for row, joint in enumerate(self.joints):
            values, columns, factor = self._values(joint, q)
            if COORDINATES[joint.kind]:
                for column, velocity in zip(columns, velocities(joint, values, before[row])):
                    yield row, column, factor, velocity
