"""A robot as its files describe it: links with collision shapes, joints in a tree, pairs of links that may be asked."""

from __future__ import annotations

import dataclasses

import numpy as np

from ._errors import refused

#: Coordinates of each kind of joint. A rotation vector is the axis times the angle.
COORDINATES = {
    "fixed": (), "revolute": ("",), "continuous": ("",), "prismatic": ("",), "planar": (".x", ".y", ".angle"),
    "ball": (".rx", ".ry", ".rz"), "floating": (".x", ".y", ".z", ".rx", ".ry", ".rz"),
}
#: Kinds of joint that have an axis; the axis of others is not read, since files give zeros there.
WITH_AXIS = ("revolute", "continuous", "prismatic", "planar")


@dataclasses.dataclass
class Joint:
    """Moves the child's frame: parent frame, `before`, motion, `after`, child frame."""

    name: str
    kind: str
    parent: str
    child: str
    before: np.ndarray
    axis: np.ndarray
    where: str
    after: np.ndarray = dataclasses.field(default_factory=lambda: np.eye(4))
    limits: tuple = (-np.inf, np.inf)
    #: (joint, multiplier, offset) of the joint that this one follows.
    mimic: tuple | None = None


@dataclasses.dataclass
class Link:
    """Collision shapes, each with its pose in the link's frame."""

    name: str
    where: str
    parts: list = dataclasses.field(default_factory=list)


@dataclasses.dataclass
class Model:
    name: str
    links: list
    joints: list
    #: (link, link): never asked.
    disabled: set = dataclasses.field(default_factory=set)


def _unique(items, what):
    known = {}
    for item in items:
        if item.name in known:
            raise refused(f"{item.where}: a second {what} {item.name!r}; names must be unique (bad_value)")
        known[item.name] = item
    return known


def ordered(model):
    """Checks the tree of a model. Returns its joints, each after the joint that moves its parent."""
    links, joints = _unique(model.links, "link"), _unique(model.joints, "joint")
    above = {}
    for joint in model.joints:
        for end in (joint.parent, joint.child):
            if end not in links:
                raise refused(f"{joint.where}: joint {joint.name!r} names the link {end!r}, which is not there (bad_value)")
        if joint.child in above:
            raise refused(f"{joint.where}: link {joint.child!r} hangs on the joints {above[joint.child].name!r} and "
                          f"{joint.name!r}; a robot is a tree, without closed chains (unsupported)")
        above[joint.child] = joint
    _check_mimics(model.joints, joints)
    below = {}
    for joint in model.joints:
        below.setdefault(joint.parent, []).append(joint)
    found, reached = [], [link.name for link in model.links if link.name not in above]
    for name in reached:  # grows while it is read
        found += below.get(name, [])
        reached += [joint.child for joint in below.get(name, [])]
    if len(found) < len(model.joints):
        left = next(joint for joint in model.joints if joint.child not in set(reached))
        raise refused(f"{left.where}: joint {left.name!r} is part of a ring of links; a robot is a tree (unsupported)")
    return found


def _check_mimics(joints, known):
    for joint in joints:
        passed, at = {joint.name}, joint
        while at.mimic is not None:
            target = known.get(at.mimic[0])
            if target is None or not COORDINATES[target.kind]:
                told = "is not there" if target is None else "is fixed"
                raise refused(f"{at.where}: joint {at.name!r} mimics {at.mimic[0]!r}, which {told} (bad_value)")
            if len(COORDINATES[at.kind]) != 1 or len(COORDINATES[target.kind]) != 1:
                raise refused(f"{at.where}: joint {at.name!r} mimics {target.name!r}, and both need to be revolute, "
                              "continuous or prismatic (unsupported)")
            if target.name in passed:
                raise refused(f"{joint.where}: joint {joint.name!r} mimics itself through others (bad_value)")
            passed.add(target.name)
            at = target


def _reached(start, neighbours):
    seen, found = {start}, [start]
    for at in found:  # grows while it is read
        new = [there for there in neighbours(at) if there not in seen]
        seen.update(new)
        found += new
    return seen


def allowed_pairs(model):
    """Pairs of links with shapes, by their indices, that move against each other and are neither adjacent nor disabled.

    Two links are adjacent if a way along joints from one to the other passes no third link with a shape.
    """
    index = {link.name: i for i, link in enumerate(model.links)}
    near, welded = [[] for _ in model.links], [[] for _ in model.links]
    for joint in model.joints:
        ends = index[joint.parent], index[joint.child]
        for here, there in (ends, ends[::-1]):
            near[here].append(there)
            if joint.kind == "fixed":
                welded[here].append(there)
    shaped = [i for i, link in enumerate(model.links) if link.parts]
    disabled = {frozenset(index[name] for name in pair) for pair in model.disabled}
    pairs = []
    for i in shaped:
        adjacent = _reached(i, lambda at, i=i: near[at] if at == i or not model.links[at].parts else ())
        excluded = adjacent | _reached(i, welded.__getitem__)
        pairs += [(i, j) for j in shaped if i < j and j not in excluded and frozenset((i, j)) not in disabled]
    return pairs
