"""Contacts of MuJoCo and PyBullet as records for `pdepth.audit`.

    mujoco.mj_step(model, data)
    pdepth.record.mujoco(model, data, "contacts.jsonl")    # this state; again after each step that counts
    print(pdepth.audit("contacts.jsonl").table)

Each call adds one state to the file: the contacts that the engine reports, and the pairs that it looked at and found
apart, without which nothing can be missed. The engine's objects are read by their attributes; no engine is imported.
"""

from __future__ import annotations

import itertools
import os
import sys
import warnings
from typing import Any, Callable, NamedTuple, Union

import numpy as np

from ._core import Pose, Refused
from ._record_file import RecordFile
from ._shapes import Box, Capsule, Compound, ConvexPolytope, Cylinder, Ellipsoid, Sphere

__all__ = ["Recorded", "mujoco", "pybullet"]


class Recorded(NamedTuple):
    """Counts of one call: contacts written, and contacts and pairs left out."""

    contacts: int     #: pairs that the engine reports in contact
    apart: int        #: pairs that the engine looked at and reports apart
    unsupported: int  #: pairs without a shape or pose that a record holds


def _matrices(places: Any, rotations: Any) -> np.ndarray:
    poses = np.tile(np.eye(4), (len(places), 1, 1))
    poses[:, :3, :3], poses[:, :3, 3] = np.reshape(rotations, (-1, 3, 3)), places
    return poses


class _State:
    """Lines of one state: bodies by a key, of which each has an id in the file and a pose once a pair names it."""

    def __init__(self, file: RecordFile, time: Union[float, None], shape_of: Callable):
        self._file, self._time, self._shape_of = file, time, shape_of
        self._poses, self._bodies, self.counts = {}, {}, [0, 0, 0]

    def add_body(self, key: Any, pose: np.ndarray) -> None:
        self._poses[key] = pose

    def _body(self, key: Any) -> Any:
        """None for a body without a shape, or with a pose that is none."""
        if key not in self._bodies:
            shape = self._shape_of(key)
            try:
                placed = None if shape is None else Pose(self._poses[key])
            except Refused:
                placed = None
            self._bodies[key] = None if placed is None else (self._file.shape(shape), placed.matrix)
        return self._bodies[key]

    def add_pair(self, a: Any, b: Any, points: list) -> None:
        """points: (depth, normal from B to A, position on A, position on B); none: apart."""
        known = a in self._poses and b in self._poses
        body_a, body_b = (self._body(a), self._body(b)) if known else (None, None)
        if body_a is None or body_b is None or not np.isfinite([np.hstack(point) for point in points]).all():
            self.counts[2] += 1
            return
        self.counts[0 if points else 1] += 1
        reported = None
        if points:
            deepest = max(points, key=lambda point: point[0])
            reported = {"depth": deepest[0], "normal": list(deepest[1]),
                        "points": [{"depth": depth, "position_a": list(on_a), "position_b": list(on_b)}
                                   for depth, _, on_a, on_b in points]}
        self._file.contact(self._time, body_a, body_b, reported)

    def end(self) -> Recorded:
        self._file.write()
        return Recorded(*self.counts)


# MuJoCo

_PLANE, _SPHERE, _CAPSULE, _ELLIPSOID, _CYLINDER, _BOX, _MESH = 0, 2, 3, 4, 5, 6, 7
_NO_CONSTRAINTS, _NO_CONTACTS, _NO_PARENT_FILTER = 1 << 0, 1 << 4, 1 << 9


def mujoco(model: Any, data: Any, path: Union[str, os.PathLike]) -> Recorded:
    """Adds the contacts of a state of MuJoCo to a record: an MjModel, and its MjData after mj_step or mj_forward.

    The contacts in `data` and the poses of its geoms are those of the last collision. A pair that MuJoCo did not report is
    written as apart if the model's filters let it through and the geoms' bounding spheres meet. Height fields, distance
    fields and flexible bodies are left out and counted. A file that is there must be a record of MuJoCo, and grows.

    Raises Refused: 'unreadable_file' for a file that is none or cannot be written.
    """
    version = getattr(sys.modules.get("mujoco"), "__version__", "")
    scalar = "float32" if np.asarray(model.geom_size).dtype == np.float32 else "float64"
    file = RecordFile(path, f"MuJoCo {version}".strip(), scalar)
    state = _State(file, float(data.time), lambda geom: _geom_shape(model, geom))
    poses = _matrices(np.asarray(data.geom_xpos), np.asarray(data.geom_xmat))
    for geom in range(model.ngeom):
        state.add_body(geom, poses[geom])
    found: dict = {}
    for i in range(data.ncon):
        contact = data.contact[i]
        pair = tuple(int(g) for g in (contact.geom if hasattr(contact, "geom") else (contact.geom1, contact.geom2)))
        normal, middle, gap = np.asarray(contact.frame)[:3], np.asarray(contact.pos), float(contact.dist)
        # MuJoCo's normal leads from the first geom to the second, and its point lies midway between the surfaces.
        found.setdefault(pair, []).append((-gap, -normal, middle - gap / 2 * normal, middle + gap / 2 * normal))
    for (a, b), points in found.items():
        state.add_pair(a, b, points)
    for pair in _pairs_looked_at(model, poses):
        if pair not in found and pair[::-1] not in found:
            state.add_pair(*pair, [])
    return state.end()


def _geom_shape(model: Any, geom: int) -> Any:
    kind, (x, y, z) = int(model.geom_type[geom]), (float(number) for number in model.geom_size[geom])
    try:
        if kind == _PLANE:
            return {"type": "plane", "normal": [0, 0, 1], "offset": 0}
        if kind == _MESH:
            mesh = int(model.geom_dataid[geom])
            first = int(model.mesh_vertadr[mesh])
            vertices = np.asarray(model.mesh_vert, dtype=float).reshape((-1, 3))
            return ConvexPolytope(vertices[first:first + int(model.mesh_vertnum[mesh])])
        made = {_SPHERE: lambda: Sphere(x), _CAPSULE: lambda: Capsule(x, y), _CYLINDER: lambda: Cylinder(x, y),
                _ELLIPSOID: lambda: Ellipsoid([x, y, z]), _BOX: lambda: Box([x, y, z])}
        if kind in made:
            return made[kind]()
        told = f"a record holds no geom of type {kind}"
    except Refused as error:
        told = str(error)
    warnings.warn(f"geom {geom}: {told}; its pairs are left out", stacklevel=2)
    return None


def _pairs_looked_at(model: Any, poses: np.ndarray) -> list:
    """Pairs that MuJoCo's filters hand to its narrow phase, as far as bounding spheres tell."""
    flags, mode = int(model.opt.disableflags), int(getattr(model.opt, "collision", 0))
    if flags & (_NO_CONSTRAINTS | _NO_CONTACTS):
        return []
    body, weld = np.asarray(model.geom_bodyid), np.asarray(model.body_weldid)
    welded = weld[body]
    parent = weld[np.asarray(model.body_parentid)[welded]]
    kind, answers = np.asarray(model.geom_contype), np.asarray(model.geom_conaffinity)
    # Before version 3 a body's number counted from one here. A pair that may be meant by either is no pair that is missed.
    excluded = {int(number) - shift for number in np.reshape(model.exclude_signature, -1) for shift in (0, (1 << 16) + 1)}
    listed = {tuple(sorted((int(a), int(b)))) for a, b in zip(model.pair_geom1, model.pair_geom2)} if mode != 2 else set()
    pairs = []
    for a, b in itertools.combinations(range(model.ngeom), 2):
        if (a, b) not in listed:
            filtered = welded[a] == welded[b] or not (kind[a] & answers[b] or kind[b] & answers[a])
            if not flags & _NO_PARENT_FILTER and welded[a] and welded[b]:
                filtered |= welded[a] == parent[b] or welded[b] == parent[a]
            low, high = sorted((int(body[a]), int(body[b])))
            if filtered or mode == 1 or {(low << 16) + high, (high << 16) + low} & excluded:
                continue
        if _spheres_meet(model, poses, a, b):
            pairs.append((a, b) if model.geom_type[a] <= model.geom_type[b] else (b, a))
    return pairs


def _spheres_meet(model: Any, poses: np.ndarray, a: int, b: int) -> bool:
    radii = [float(model.geom_rbound[geom]) for geom in (a, b)]
    apart = poses[a, :3, 3] - poses[b, :3, 3]
    if min(radii) > 0:
        return bool(np.linalg.norm(apart) <= sum(radii))
    planes = [geom for geom in (a, b) if model.geom_type[geom] == _PLANE]
    if len(planes) != 1:
        return False  # two planes, or a height field
    height = poses[planes[0], :3, 2] @ apart * (1 if planes[0] == b else -1)
    return bool(height <= max(radii))


# PyBullet

_GEOM_SPHERE, _GEOM_BOX, _GEOM_CYLINDER, _GEOM_MESH, _GEOM_PLANE, _GEOM_CAPSULE = range(2, 8)


def pybullet(client: Any, path: Union[str, os.PathLike], *, mesh_hulls: bool = False) -> Recorded:
    """Adds the contacts of a state of PyBullet to a record. client: the module pybullet, or a BulletClient.

    Collisions are detected anew, since after stepSimulation the contacts belong to the poses before the step. Pairs of
    different bodies whose boxes meet without a contact are written as apart; filters between bodies cannot be read, so a
    pair that you filtered counts as missed. Meshes are left out and counted, unless mesh_hulls=True says that all of them
    are convex hulls in PyBullet, too. Links with several shapes are compounds.

    Raises Refused: 'unreadable_file' for a file that is none or cannot be written.
    """
    client.performCollisionDetection()
    shapes: dict = {}
    state = _State(RecordFile(path, "PyBullet", "float64"), None, shapes.get)
    links, boxes, fixed = [], [], []
    for i in range(client.getNumBodies()):
        body = client.getBodyUniqueId(i)
        for link in range(-1, client.getNumJoints(body)):
            shape, place = _link_shape(client, body, link, mesh_hulls)
            if place is None:
                continue  # a link without a collision shape
            shapes[body, link] = shape
            state.add_body((body, link), _link_pose(client, body, link) @ place)
            links.append((body, link))
            boxes.append(client.getAABB(body, link))
            fixed.append(client.getDynamicsInfo(body, link)[0] == 0)
    found: dict = {}
    for point in client.getContactPoints():
        depth, normal = -point[8], np.array(point[7], dtype=float)
        found.setdefault(((point[1], point[3]), (point[2], point[4])), []).append((depth, normal, point[5], point[6]))
    for (a, b), points in found.items():
        state.add_pair(a, b, points)
    low, high = np.array([box[0] for box in boxes]), np.array([box[1] for box in boxes])
    for i, j in itertools.combinations(range(len(links)), 2):
        a, b = links[i], links[j]
        if a[0] == b[0] or (fixed[i] and fixed[j]) or (a, b) in found or (b, a) in found:
            continue
        if (low[i] <= high[j]).all() and (low[j] <= high[i]).all():
            state.add_pair(a, b, [])
    return state.end()


def _pose_of(place: Any, xyzw: Any) -> np.ndarray:
    try:
        return Pose(translation=np.array(place, dtype=float), xyzw=np.array(xyzw, dtype=float)).matrix
    except Refused:
        return np.full((4, 4), np.nan)


def _link_pose(client: Any, body: int, link: int) -> np.ndarray:
    """The frame of the link's centre of mass, in which its shapes stand."""
    return _pose_of(*(client.getBasePositionAndOrientation(body) if link < 0 else client.getLinkState(body, link)[:2]))


def _link_shape(client: Any, body: int, link: int, mesh_hulls: bool) -> Any:
    """Shape and place; (None, place) for a shape that no record holds, (None, None) without a shape."""
    parts = []
    for shape in client.getCollisionShapeData(body, link):
        kind, sizes, place = shape[2], shape[3], _pose_of(shape[5], shape[6])
        if kind == _GEOM_PLANE:
            return {"type": "plane", "normal": list(sizes), "offset": 0}, place
        made = {_GEOM_SPHERE: lambda: Sphere(sizes[0]), _GEOM_BOX: lambda: Box(np.array(sizes) / 2),
                _GEOM_CYLINDER: lambda: Cylinder(sizes[1], sizes[0] / 2),
                _GEOM_CAPSULE: lambda: Capsule(sizes[1], sizes[0] / 2)}
        if kind == _GEOM_MESH and mesh_hulls:
            margin = client.getDynamicsInfo(body, link)[11]
            made[kind] = lambda m=margin: ConvexPolytope(client.getMeshData(body, link)[1], margin=m)
        if kind not in made:
            warnings.warn(f"body {body}, link {link}: a record holds no shape of type {kind}; its pairs are left out", stacklevel=2)
            return None, np.eye(4)
        parts.append((made[kind](), place))
    if len(parts) > 1:
        return Compound([(part, Pose(place)) for part, place in parts]), np.eye(4)
    return parts[0] if parts else (None, None)
