"""Queries of pairs: one pair gives an object, many give a struct of arrays."""

from __future__ import annotations

import os

import numpy as np

from . import _core
from ._errors import length, number_array, refused, whole_number
from ._files import save_arrays
from ._core import CLASS_ALONE, DEFAULTS

#: What the numbers of a batch's `contact` mean.
CONTACTS = ("separated", "touching", "overlapping")
#: What the first number of a batch's `feature_a` and `feature_b` means.
FEATURES = ("none", "vertex", "edge", "facet")


class Batch:
    """A struct of arrays, one row a pair; the leading dimensions are those of the poses.

    error: 0 for an answered row, else an index into pdepth.ERRORS. The numbers of such a row are NaN, and no exception is
    raised.
    contact: an index into pdepth.CONTACTS.
    feature_a, feature_b: [..., 4]. First an index into pdepth.FEATURES, then the part of a union, then the shape's own
    numbers: a vertex (row of `shape.vertices`), the two vertices of an edge, or a facet (of `shape.facets`).
    The other columns are named and meant as the attributes of Depth.
    """

    def __init__(self, fields, lead):
        for name, column in fields.items():
            setattr(self, name, column.reshape(lead + column.shape[1:]))
        self._names = tuple(fields)

    def __iter__(self):
        return iter(self._names)

    def __len__(self):
        return len(self.error) if self.error.ndim else 1

    def __getitem__(self, name):
        if name not in self._names:
            raise KeyError(f"no column {name!r}: {', '.join(self._names)}; of_row(i) is a row")
        return getattr(self, name)

    def keys(self):
        return self._names

    def of_row(self, i):
        """One row, or the rows of an index of the leading dimensions, as a dictionary."""
        return {name: self[name][i] for name in self._names}

    def save(self, path):
        """Writes all arrays to an npz file."""
        save_arrays(path, {name: self[name] for name in self._names})

    def __repr__(self):
        failed = int(np.count_nonzero(self.error))
        return f"<Batch of {self.error.size} pairs{f', {failed} refused' if failed else ''}: {', '.join(self._names)}>"


def cores():
    """The number of cores that this process may use."""
    return len(os.sched_getaffinity(0))


_IDENTITY = np.eye(4)[None]


def _listed(pose):
    """True for a list of poses, each in a form of its own."""
    return isinstance(pose, list) and (not pose or any(each is None or isinstance(each, (_core.Pose, tuple)) for each in pose))


def _many(pose):
    if pose is None or isinstance(pose, (tuple, _core.Pose)):
        return False
    if _listed(pose):
        return True
    if not isinstance(pose, list):
        return getattr(pose, "ndim", 0) != 2
    try:
        return np.ndim(pose) != 2
    except ValueError:  # rows of different shapes, which _stack refuses by name
        return True


_HINTS = {(3,): "; a place alone is Pose(translation=...)", (4,): "; a quaternion is Pose(wxyz=...) or Pose(xyzw=...)",
          (7,): "; a quaternion is Pose(wxyz=..., translation=...) or Pose(xyzw=..., translation=...)"}


def _made(poses):
    """Poses in an array as they are: a quaternion stands for numbers that no matrix of doubles holds."""
    array = np.empty(len(poses), dtype=object)
    array[:] = poses
    return array


def _stack(pose, argument):
    """Poses as [n, 4, 4], or as an array of Pose objects, and their leading dimensions (None for a single one)."""
    from ._shapes import as_pose

    if pose is None:
        return _IDENTITY, None
    if _listed(pose):
        return _made([as_pose(each, f"{argument}[{i}]") for i, each in enumerate(pose)]), (len(pose),)
    if isinstance(pose, (tuple, _core.Pose)):
        return _made([as_pose(pose, argument)]), None
    try:
        array = np.asarray(pose)
    except ValueError:
        raise refused(f"{argument}: rows of different shapes; give [n, 4, 4], or a tuple (R, t) (bad_value)") from None
    if array.dtype.kind not in "fiu" or array.dtype.itemsize > 8:
        raise refused(f"{argument}: dtype {array.dtype} is not taken; give float64 (bad_value)")
    if array.ndim < 2 or array.shape[-2:] != (4, 4):
        hint = _HINTS.get(array.shape, "; it looks transposed" if array.shape[:2] == (4, 4) else "")
        raise refused(f"{argument}: has shape {array.shape}, needs [4, 4] or [..., 4, 4]{hint} (bad_value)")
    if array.ndim == 2:
        return array[None], None
    return array.reshape((-1, 4, 4)), array.shape[:-2]


def _bodies(shapes, argument):
    if isinstance(shapes, _core.Shape):
        return [shapes], None
    if not hasattr(shapes, "__iter__") or isinstance(shapes, (str, bytes, dict)):
        raise refused(f"{argument}: must be a pdepth shape, or a list of them, not {type(shapes).__name__} (bad_value)")
    bodies = list(shapes)
    for i, body in enumerate(bodies):
        if not isinstance(body, _core.Shape):
            raise refused(f"{argument}[{i}]: must be a pdepth shape, not {type(body).__name__} (bad_value)")
    return bodies, (len(bodies),)


def _rows(a, b, poses_a, poses_b):
    parts = [_bodies(a, "a"), _bodies(b, "b"), _stack(poses_a, "pose_a"), _stack(poses_b, "pose_b")]
    leads = {name: lead for name, (_, lead) in zip(("a", "b", "pose_a", "pose_b"), parts) if lead is not None}
    many = {name: lead for name, lead in leads.items() if lead != (1,)}  # a list of one is one for all
    leads = many or leads
    if len(set(leads.values())) > 1:
        told = ", ".join(f"{name} {lead}" for name, lead in leads.items())
        raise refused(f"pairs: as many of each, or one for all; got {told} (bad_value)")
    lead = next(iter(leads.values()), (1,))
    return [part for part, _ in parts], lead, int(np.prod(lead))


def _is_batch(a, b, pose_a, pose_b):
    return not (isinstance(a, _core.Shape) and isinstance(b, _core.Shape)) or _many(pose_a) or _many(pose_b)


def _threads(threads):
    if threads is None:
        return cores()
    return whole_number(threads, "threads", 1, 1024)


def _settings(method, delta, bracket, beyond):
    if method == "auto" and delta is None and bracket == "tightest" and beyond is None:
        return DEFAULTS
    return _core.settings(method, delta, bracket, beyond)


#: No stretches: every row of a batch is answered alone.
COLD = np.empty(0, dtype=np.int64)


def depth(a, b, pose_a=None, pose_b=None, *, method="auto", delta=None, bracket="tightest", beyond=None, warm=None, axis=0,
          threads=None):
    """Penetration depth of two bodies with a proof, or their distance when they are apart.

    A moves by `translation`, B stays. World point = R * local + t. Lengths are in the unit of the input. One pair answers
    a Depth, several answer a Batch.

    a, b: shapes, or lists of n shapes.
    pose_a, pose_b: None (the identity), a Pose, a [4, 4] matrix, or (R, t). For many: [n, 4, 4] with any leading
    dimensions, or a list of poses.
    method: 'auto', 'expansion', 'overlay', 'decomposition', 'shallow' or 'grid'. 'auto' is exact for polytopes, swept or
    not, and within 1 + delta for curved bodies and unions.
    delta: the relative error, in (0, 1].
    bracket: 'tightest' (the exact depth rounded down and up), 'certified' (half the time) or 'contact' (bounded cost).
    beyond: a distance from which on you need no distance. A pair that is farther apart may be answered as 'separated' with
    distance_lower > beyond, certified, a wide distance_upper, and witnesses that are not the closest points. Anything
    nearer is answered as ever. Unions take no notice.
    warm: for one pair a Warm, of convex bodies or unions. For a batch, True makes the rows along `axis` frames of one pair, each started from the last;
    other dimensions are pairs of their own.
    axis: a leading dimension of the poses, for warm=True.
    threads: cores that answer a batch, all by default. The interpreter's lock is released, and the bits are the same for
    any number.

    Raises Refused, a ValueError, for bad input; a bad pose in a batch is a row's error. 'out_of_range': the answer is past
    the range of doubles. 'in_use': another thread asks with the same Warm.
    """
    if threads is not None or axis != 0:
        _threads(threads)
        if not isinstance(axis, int) or (axis not in (0, -1) and not _is_batch(a, b, pose_a, pose_b)):
            raise refused(f"axis: must be a leading dimension of the poses, not {axis!r} (out_of_range)")
    if warm is None and delta is None and method == "auto" and bracket == "tightest" and beyond is None:
        found = _core.ask_plain(a, b, pose_a, pose_b)
        if found is not None:
            return found
    return _asked(a, b, pose_a, pose_b, _settings(method, delta, bracket, beyond), warm, axis, threads)


def _asked(a, b, pose_a, pose_b, settings, warm, axis, threads):
    if not _is_batch(a, b, pose_a, pose_b):
        if not (warm is None or warm is False or isinstance(warm, _core.Warm)):
            raise refused(f"warm: one pair takes a pdepth.Warm, not {warm!r}; True is for a batch (bad_value)")
        return _core.ask(a, b, pose_a, pose_b, settings, warm or None)
    (bodies_a, bodies_b, poses_a, poses_b), lead, count = _rows(a, b, pose_a, pose_b)
    if warm not in (None, True, False):
        raise refused("warm: True or False for a batch (bad_value)")
    if not -len(lead) <= axis < len(lead):
        raise refused(f"axis: {axis!r} is none of the {len(lead)} leading dimensions (out_of_range)")
    axis %= len(lead)
    starts, order = COLD, None
    if warm and count:
        starts = np.arange(0, count, lead[axis])
        order = None if axis == len(lead) - 1 else np.moveaxis(np.arange(count).reshape(lead), axis, -1).ravel()
    if order is not None:  # the frames of a pair in a row; what all rows share, a body or a pose, stays as it is
        bodies_a, bodies_b = ([each[i] for i in order] if len(each) > 1 else each for each in (bodies_a, bodies_b))
        poses_a, poses_b = (each[order] if len(each) > 1 else each for each in (poses_a, poses_b))
    fields = _core.depth_rows(bodies_a, bodies_b, poses_a, poses_b, count, settings, starts, _threads(threads))
    if order is not None:
        back = np.argsort(order)
        fields = {name: column[back] for name, column in fields.items()}
    return Batch(fields, lead)


def distance(a, b, pose_a=None, pose_b=None, *, threads=None):
    """Distance of two bodies, 0 when they meet: `distance` of depth, which knows its certified bracket too.

    Shapes and poses as in depth. A float, or [n] for many, NaN where a row is refused. Raises Refused as depth.
    """
    found = depth(a, b, pose_a, pose_b, threads=threads)
    return found.distance


def intersects(a, b, pose_a=None, pose_b=None, *, threads=None):
    """Answers if the bodies have a point in common, exactly for polytopes; touching counts. A bool, or [n] bools for many.

    For many, a row that is refused is False; depth says why. Neither a depth nor a distance is searched for.
    Shapes and poses as in depth. Raises Refused as depth.
    """
    if threads is not None:
        _threads(threads)
    found = _asked(a, b, pose_a, pose_b, CLASS_ALONE, None, 0, threads)
    if isinstance(found, Batch):
        return (found.contact != 0) & (found.error == 0)
    return found.contact != "separated"


class Fields:
    """An answer by names."""

    def __init__(self, fields):
        self.__dict__.update(fields)

    def __repr__(self):
        return f"{type(self).__name__}({', '.join(f'{name}={value!r}' for name, value in self.__dict__.items())})"


class DirectionalDepth(Fields):
    """Depth along a direction: contact, depth, lower <= exact depth <= upper, and the normal of the facet at the exit."""


class Manifold(Fields):
    """Points of a contact, k <= 4 of them.

    normal: [3], unit, from B to A.
    position_a, position_b: [k, 3], on the surfaces. With a margin, as capsules have, the face of the core is moved along
    the normal; where it is not across the normal, all points but the deepest lie a little inside.
    depth: [k], > 0 inside, < 0 a gap.
    feature_id: [k], the same number while the same two features meet.

    A contact of unions or sheets also has:
    normals: [k, 3], one for each point.
    piece_a, piece_b: [k], numbers of parts or faces.
    patches: a list of Manifold, one for each direction of contact; the first holds the deepest point.
    covered: how many contacts of two pieces were dropped or turned because other pieces cover them.
    """


class Derivatives(Fields):
    """answer (a Depth), signed_depth, flags, and derivatives by the two poses; see pdepth.derivatives."""


def directional_depth(a, b, direction, pose_a=None, pose_b=None, *, threads=None):
    """The least t >= 0 for which A moved by t d/|d| is clear of B, certified: contact, depth, lower, upper, normal.

    direction: [3], or [n, 3] for many; shapes and poses as in depth. Refused: 'zero_direction', 'non_finite'.
    """
    along = number_array(direction, "direction", "[3] or [n, 3]")
    if along.ndim <= 1 and not _is_batch(a, b, pose_a, pose_b):
        return DirectionalDepth(_core.directional(a, b, direction, pose_a, pose_b))
    (bodies_a, bodies_b, poses_a, poses_b), lead, count = _rows(a, b, pose_a, pose_b)
    if along.ndim > 1:
        if lead == (1,) and not _is_batch(a, b, pose_a, pose_b):
            lead, count = along.shape[:-1], int(np.prod(along.shape[:-1]))
        elif along.shape[:-1] != lead:
            raise refused(f"direction: has shape {along.shape}, needs {lead + (3,)} (bad_value)")
    if along.shape[-1:] != (3,):
        raise refused(f"direction: has shape {along.shape}, needs [3] or [n, 3] (bad_value)")
    rows = along.reshape((-1, 3))
    return Batch(_core.directional_rows(bodies_a, bodies_b, poses_a, poses_b, rows, count, _threads(threads)), lead)


#: The classes of one body of a contact.
_ONE = (_core.Shape, _core.Sheet)


def contact_manifold(a, b, pose_a=None, pose_b=None, *, breaking_threshold=0.0, one_sided=False, threads=None):
    """At most four pairs of points for each direction in which two bodies meet.

    The normal points from B to A; depth > 0 inside, < 0 a gap of at most breaking_threshold; feature_id is the same while
    the same two features meet. A union is one body: contacts with faces and edges inside of it are dropped or turned.
    One of the bodies may be a Sheet, the triangles of a mesh. one_sided: a sheet is left by its front alone, from which
    the corners of its faces run counter-clockwise. The normal is 0 where a sheet has no contact. See Manifold.

    For many pairs of convex bodies: a Batch with count, normal [n, 3], position_a and position_b [n, 4, 3], point_depth
    [n, 4] and feature_id [n, 4], NaN and 0 beyond count.
    Lengths and frames as in depth. Raises Refused: 'bad_value' at breaking_threshold; 'unsupported' for two sheets, for
    one_sided without a sheet and for unions and sheets in a batch; 'limit_exceeded' where unions of many pieces are deep
    in each other.
    """
    breaking_threshold = length(breaking_threshold, "breaking_threshold")
    one_pair = isinstance(a, _ONE) and isinstance(b, _ONE) and not _many(pose_a) and not _many(pose_b)
    if isinstance(a, _core.Sheet) or isinstance(b, _core.Sheet):
        if not one_pair:
            raise refused("a: sheets are asked pair by pair, not in a batch (unsupported)")
        return _union_manifold(a, b, pose_a, pose_b, breaking_threshold, one_sided)
    if _is_batch(a, b, pose_a, pose_b):
        if one_sided:
            raise refused("one_sided: only a sheet has sides, and sheets are asked pair by pair (unsupported)")
        (bodies_a, bodies_b, poses_a, poses_b), lead, count = _rows(a, b, pose_a, pose_b)
        fields = _core.manifold_rows(bodies_a, bodies_b, poses_a, poses_b, count, breaking_threshold, _threads(threads))
        for name in ("position_a", "position_b"):
            fields[name] = fields[name].reshape((count, 4, 3))
        return Batch(fields, lead)
    if one_sided or not (a.is_convex and b.is_convex):
        return _union_manifold(a, b, pose_a, pose_b, breaking_threshold, one_sided)
    return Manifold(_core.manifold(a, b, pose_a, pose_b, breaking_threshold))


def _union_manifold(a, b, pose_a, pose_b, breaking_threshold, one_sided):
    patches, covered = _core.union_manifold(a, b, pose_a, pose_b, (breaking_threshold, bool(one_sided)))
    patches = [Manifold(fields) for fields in patches]
    return Manifold({**vars(patches[0]), "patches": patches if len(patches[0].depth) else [], "covered": covered})


def derivatives(a, b, pose_a=None, pose_b=None, *, threads=None):
    """The signed depth (> 0 inside, < 0 a gap) of convex bodies and its derivatives by both poses.

    A pose has six numbers: translation, and a rotation vector about the pose's own translation, in the world's axes.

    by_a, by_b: [6]. Numbers that do not exist are NaN.
    unique_direction: the least direction is unique, and the first three of each exist.
    unique_witness: the pair of witnesses is unique, too, and the last three exist. Parallel faces have a unique direction
    without a unique witness.

    For one pair also stable_features and, where it holds, normal_by_a, witness_a_by_b, ...: [3, 6];
    those of curved bodies were measured, not bounded.

    For many: a Batch with signed_depth, the three flags, by_a and by_b beside the columns of depth.
    Raises Refused: 'unsupported' for unions.
    """
    if not _is_batch(a, b, pose_a, pose_b):
        return Derivatives(_core.derivatives(a, b, pose_a, pose_b))
    (bodies_a, bodies_b, poses_a, poses_b), lead, count = _rows(a, b, pose_a, pose_b)
    return Batch(_core.derivative_rows(bodies_a, bodies_b, poses_a, poses_b, count, _threads(threads)), lead)
