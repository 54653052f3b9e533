"""Shapes: each is made from numbers, and says by them how to make it again (repr, pickle, copy, the line protocol)."""

from __future__ import annotations

import itertools
import os
import warnings

import numpy as np

from . import _core
from ._errors import file_name, number_array, refused

_AXES = {"x": 0, "y": 1, "z": 2}


def _plain(value):
    """Numbers as lists and floats: what repr, pickle and JSON take."""
    if isinstance(value, np.ndarray):
        return value.tolist()
    if isinstance(value, np.generic):
        return value.item()
    if isinstance(value, (list, tuple)):
        return [_plain(each) for each in value]
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    return value


def _hashable(value):
    """Equal numbers are equal here, whatever the sign of a zero."""
    return tuple(_hashable(each) for each in value) if isinstance(value, (list, tuple)) else value


def _numbers(value):
    """An argument in the form in which a shape keeps it: words, and numbers as floats."""
    if isinstance(value, str):
        return value
    return np.asarray(value, dtype=float).tolist()


def _vertices(vertices):
    """Vertices of a mesh as an array [n, 3]."""
    points = number_array(vertices, "mesh.vertices", "[n, 3]").astype(float)
    if points.ndim != 2 or points.shape[1] != 3:
        raise refused(f"mesh.vertices: has shape {points.shape}, needs [n, 3] (bad_value)")
    return points


def _loops(faces, argument="faces", count=None):
    """Faces as lists of row numbers, which are whole and no words. count: the number of rows, where it is known."""
    if isinstance(faces, np.ndarray) and faces.ndim == 2 and faces.dtype.kind in "iu":
        return _require_rows(faces.tolist(), argument, count)
    try:
        loops = [list(face) for face in faces]
    except TypeError:
        raise refused(f"{argument}: must be a list of faces, each a list of row numbers of vertices (bad_value)") from None
    for i, loop in enumerate(loops):
        for each in loop:
            whole = isinstance(each, (int, np.integer)) or isinstance(each, (float, np.floating)) and float(each).is_integer()
            if not whole or isinstance(each, bool):
                raise refused(f"{argument}[{i}]: row numbers of vertices are integers from 0, not {each!r} (bad_faces)")
    return _require_rows([[int(each) for each in loop] for loop in loops], argument, count)


def _require_rows(loops, argument, count):
    for i, loop in enumerate(loops if count is not None else ()):
        if loop and not 0 <= min(loop) <= max(loop) < count:
            raise refused(f"{argument}[{i}]: vertices are numbered 0 to {count - 1} (out_of_range)")
    return loops


def _keep(shape, name, value):
    """Sets an attribute that is not one of the numbers that the shape is made of."""
    if name in shape.__dict__.get("_arguments", ()):
        raise AttributeError(f"{type(shape).__name__} is immutable: make another one with the new {name}")
    object.__setattr__(shape, name, value)


def _require_unmade(shape):
    """Python lets a caller make an object a second time."""
    if "_arguments" in shape.__dict__:
        raise AttributeError(f"{type(shape).__name__} is immutable: make another one with the new numbers")


def _axis(axis):
    if not isinstance(axis, str) or axis not in _AXES:
        raise refused(f"axis: must be 'x', 'y' or 'z', not {axis!r} (bad_value)")
    return _AXES[axis]


def pose_fields(pose, argument="pose"):
    """A pose as the line protocol writes it."""
    pose = as_pose(pose, argument)
    fields = pose._keywords()
    named = {}
    if "wxyz" in fields:
        named["quaternion_wxyz"] = list(fields["wxyz"])
    elif "rotation" in fields:
        named["rotation_row_major"] = [x for row in fields["rotation"] for x in row]
    if "translation" in fields:
        named["translation"] = fields["translation"]
    return named


def as_pose(pose, argument="pose"):
    """A Pose of anything that stands for one: None, a Pose, a 4x4 matrix, (R, t)."""
    if isinstance(pose, _core.Pose):
        return pose
    if pose is None:
        return _core.Pose()
    if isinstance(pose, tuple) and len(pose) == 2:
        return _core.Pose(rotation=pose[0], translation=pose[1])
    try:
        return _core.Pose(pose)
    except _core.Refused as error:
        raise refused(str(error).replace("matrix", argument, 1)) from None


class Shape(_core.Shape):
    """A body in a frame of its own, immutable.

    Equal when made from the same numbers. `repr` can be pasted; pickle and copy keep every bit. `margin` >= 0 sweeps the
    body by a ball of that radius (in the unit of the world, whatever the pose). Lengths are in one unit of the caller's.

    What is no such body is Refused, a ValueError whose `.where` names the argument and index: 'bad_value' (a wrong shape,
    dtype or sign), 'non_finite', 'out_of_range' (beyond 1e300).
    """

    def __init__(self, kind, numbers, margin, arguments):
        _require_unmade(self)
        super().__init__(kind, numbers, margin)  # which refuses what is no number
        self._arguments = {name: _numbers(value) for name, value in arguments.items()}
        if margin:
            self._arguments["margin"] = _numbers(margin)

    @property
    def margin(self):
        """Radius of the ball that the body is swept by."""
        return self._arguments.get("margin", 0.0)

    def protocol(self):
        """The shape as a dictionary of the line protocol, for `pdepth query` and contact records."""
        return {"type": self._type, **{key: _plain(value) for key, value in self._arguments.items()}}

    def __setattr__(self, name, value):
        _keep(self, name, value)

    def __repr__(self):
        inner = ", ".join(f"{name}={value!r}" for name, value in self._arguments.items())
        return f"{type(self).__name__}({inner})"

    def __eq__(self, other):
        return type(self) is type(other) and self._arguments == other._arguments

    def __hash__(self):
        return hash((type(self), *((name, _hashable(value)) for name, value in self._arguments.items())))

    def __reduce__(self):
        return _reduced(self)

    def __copy__(self):
        return self

    def __deepcopy__(self, memo):
        return self

    def _repr_png_(self):
        from ._picture_call import png, picture

        return png(picture(self))


class Sheet(_core.Sheet):
    """The triangles of a mesh as a sheet without an inside, for contact_manifold alone.

    vertices: [n, 3]; faces: loops of row numbers; a face of more than three corners is cut into triangles. The mesh need
    be neither closed nor manifold; faces without an area are left out. `margin` >= 0 makes the sheet thicker on both
    sides. Immutable.

    Raises Refused: 'bad_faces' at faces[i], 'non_finite' or 'out_of_range' at vertices[i], 'too_few_points' if no face
    has an area, 'bad_value'.
    """

    def __init__(self, vertices, faces, *, margin=0.0):
        _require_unmade(self)
        faces = _loops(faces)
        super().__init__(vertices, faces, margin)
        self._arguments = {"vertices": _numbers(vertices), "faces": faces}
        if margin:
            self._arguments["margin"] = float(margin)

    def __setattr__(self, name, value):
        _keep(self, name, value)

    def __repr__(self):
        return f"{type(self).__name__}({', '.join(f'{name}={value!r}' for name, value in self._arguments.items())})"

    __eq__, __hash__ = Shape.__eq__, Shape.__hash__

    def __reduce__(self):
        return _reduced(self)


def shape_fields(shape, argument):
    """A shape as the line protocol writes it."""
    if not isinstance(shape, Shape):
        raise TypeError(f"{argument}: must be a shape of pdepth, not {type(shape).__name__}")
    return shape.protocol()


def _reduced(shape):
    """The numbers of a shape, and what a caller's class keeps beside them."""
    kept = {name: value for name, value in shape.__dict__.items() if name != "_arguments"}
    return (_again, (type(shape), shape._arguments), *([kept] if kept else []))


def _again(kind, arguments):
    """A shape of its numbers. A caller's class may take other arguments; the class of pdepth below it takes these."""
    shape = kind.__new__(kind)
    next(each for each in kind.__mro__ if each.__module__ == __name__).__init__(shape, **arguments)
    return shape


class ConvexPolytope(Shape):
    """The convex hull of points, exact on the stored doubles.

    points: [n, 3], n >= 1, finite; numpy array or nested lists. Flat hulls (points, segments, polygons) are bodies.
    Raises Refused (a ValueError): 'non_finite' at points[i], 'out_of_range', 'too_few_points', 'bad_value' for a wrong
    shape or dtype. Time O(n log n).
    """

    _type = "convex"

    def __init__(self, points, *, margin=0.0):
        super().__init__("points", (points,), margin, {"points": points})

    def protocol(self):
        fields = super().protocol()
        fields["vertices"] = fields.pop("points")
        return fields

    @classmethod
    def from_faces(cls, vertices, faces, *, margin=0.0):
        """A closed convex surface, checked and not trusted: faces are loops of row numbers, counter-clockwise from outside.

        Raises Refused: 'bad_faces', 'not_closed', 'not_convex' or 'not_full_dimensional' at faces[i].
        """
        faces = _loops(faces)
        _core.Shape("faces", (vertices, faces), margin)
        used = sorted({i for face in faces for i in face})
        rows = np.asarray(vertices, dtype=float)
        if len(used) < len(rows):
            raise refused(f"vertices[{min(set(range(len(rows))) - set(used))}]: no face uses it (bad_faces)")
        return cls(rows, margin=margin)

    @classmethod
    def from_halfspaces(cls, planes, *, margin=0.0):
        """The points x with normal . x <= offset for every row (nx, ny, nz, offset) of planes [n, 4].

        Vertices are rounded to the nearest doubles. Raises Refused: 'unbounded', 'bad_value' when empty.
        """
        return cls(_core.Shape("halfspaces", (planes,), 0.0).vertices, margin=margin)

    @classmethod
    def from_mesh(cls, mesh, *, margin=0.0, hull=False):
        """The hull of a mesh: a file (OBJ, STL, PLY, OFF, glTF, XYZ, PCD) or an object with `.vertices` and `.faces` (trimesh's).

        A mesh that is not convex gives a UserWarning, unless hull=True says that its hull is meant.
        Vertices that no face refers to are left out. Feature ids are rows of the points that are kept.
        Raises Refused: 'unreadable_file' with the line or byte at fault.
        """
        from . import _protocol

        reason = ""
        if isinstance(mesh, (str, os.PathLike)):
            name = os.fspath(mesh)
            points, _, reason = _protocol.mesh_points(file_name(mesh, "mesh"), not hull)
        elif hasattr(mesh, "vertices"):
            name, points = "mesh", _vertices(mesh.vertices)
            faces = getattr(mesh, "faces", ())
            if isinstance(faces, np.ndarray) and faces.size and faces.dtype.kind not in "iu":
                raise refused(f"mesh.faces: dtype {faces.dtype} is not taken; give integers (bad_value)")
            loops = _loops(faces, "mesh.faces", len(points))
            if loops:
                flat = np.fromiter(itertools.chain.from_iterable(loops), dtype=np.int64)
                used, rows = np.unique(flat, return_inverse=True)
                points, rows = points[used], iter(rows.tolist())
                if not hull and np.isfinite(points).all():
                    loops = [list(itertools.islice(rows, len(loop))) for loop in loops]
                    reason = _protocol.mesh_points((points, loops), True)[2]
        else:
            raise refused(f"mesh: a path, or an object with .vertices and .faces, not {type(mesh).__name__} (bad_value)")
        shape = cls(points, margin=margin)
        if reason:
            told = f"{name}: {reason}, so that the shape is its convex hull; hull=True says that this is meant"
            warnings.warn(told, stacklevel=2)
        return shape


class Box(Shape):
    """The box [-hx, hx] x [-hy, hy] x [-hz, hz]; half_extents: [3], positive. Vertex ids are the bits of (x, y, z) > 0.

    Raises Refused: 'bad_value' or 'non_finite' at half_extents[i].
    """

    _type = "box"

    def __init__(self, half_extents, *, margin=0.0):
        super().__init__("box", (half_extents,), margin, {"half_extents": half_extents})


class Sphere(Shape):
    """A ball about the origin; radius > 0. Exact. Raises Refused: 'bad_value' or 'non_finite' at radius."""

    _type = "sphere"

    def __init__(self, radius, *, margin=0.0):
        super().__init__("sphere", (radius,), margin, {"radius": radius})


class Ellipsoid(Shape):
    """sum (x_i / radii_i)^2 <= 1; radii: [3], positive. Certified to (1 + delta), not exact.

    Raises Refused: 'bad_value' or 'non_finite' at radii[i].
    """

    _type = "ellipsoid"

    def __init__(self, radii, *, margin=0.0):
        super().__init__("ellipsoid", (radii,), margin, {"radii": radii})


class SphereHull(Shape):
    """The convex hull of spheres: [n, 4] rows of x, y, z, radius, n >= 1, radii >= 0. Certified to (1 + delta).

    Equal radii are exact: a hull of points with a margin. Raises Refused: 'too_few_points' at spheres, 'bad_value' or
    'non_finite' at spheres[i].
    """

    _type = "sphere_hull"

    def __init__(self, spheres, *, margin=0.0):
        super().__init__("sphere_hull", (spheres,), margin, {"spheres": spheres})


class _Round(Shape):
    def __init__(self, radius, half_height, axis="z", *, margin=0.0):
        fields = {"radius": radius, "half_height": half_height, "axis": axis}
        super().__init__(self._type, (radius, half_height, _axis(axis)), margin, fields)


class Capsule(_Round):
    """A segment from -half_height to +half_height along the axis ('x', 'y', 'z'), swept by a ball. Exact.

    Raises Refused: 'bad_value' or 'non_finite' at radius, half_height or axis.
    """

    _type = "capsule"


class Cylinder(_Round):
    """radius about the axis ('x', 'y', 'z'), from -half_height to +half_height. Certified to (1 + delta).

    Raises Refused: 'bad_value' or 'non_finite' at radius, half_height or axis.
    """

    _type = "cylinder"


class Cone(_Round):
    """Base of the radius at -half_height, apex at +half_height along the axis. Certified to (1 + delta).

    Raises Refused: 'bad_value' or 'non_finite' at radius, half_height or axis.
    """

    _type = "cone"


class Compound(Shape):
    """A union of convex parts; parts: a list of shapes or of (shape, pose).

    Poses place parts in the union's frame. Raises Refused: 'too_few_points' without parts, 'bad_value' at parts[i],
    'not_a_rotation' at parts[i].pose.
    """

    _type = "compound"

    def __init__(self, parts, *, margin=0.0):
        placed = []
        if not hasattr(parts, "__iter__"):
            raise refused(f"parts: must be a list of shapes or of (shape, pose), not {type(parts).__name__} (bad_value)")
        for i, part in enumerate(parts):
            shape, pose = part if isinstance(part, (tuple, list)) and len(part) == 2 else (part, None)
            placed.append((shape, as_pose(pose, f"parts[{i}].pose")))
        Shape.__init__(self, "compound", (placed,), margin, {})
        self._arguments = {"parts": placed, **self._arguments}

    @classmethod
    def from_mesh(cls, mesh, *, error=None, side="outer", turn_faces=False, margin=0.0):
        """The convex parts of a closed mesh: a file, or an object with `.vertices` and `.faces` (trimesh's).

        Without an error the parts are the groups of the file: `o` and `g` of an OBJ, meshes of a glTF. A group that is not
        convex is cut into convex parts that are the solid exactly, or it is refused.

        With an error, in the mesh's unit of length, the mesh is one solid, which few convex parts cover
        (side="outer"), or which convex parts lie in (side="inner"). No point is farther off than the error, which is
        certified; `.error` is what was reached.

        Raises Refused: 'open_edge' and the other faults that `pdepth check` names, 'unreadable_file', 'unsupported' for
        a group without exact parts, 'limit_exceeded' where the error is not reached within 20 million steps.
        """
        from . import _protocol

        if side not in ("outer", "inner"):
            raise refused(f"side: must be 'outer' or 'inner', not {side!r} (bad_value)")
        if isinstance(mesh, (str, os.PathLike)):
            source = file_name(mesh, "mesh")
        elif hasattr(mesh, "vertices") and hasattr(mesh, "faces"):
            points = _vertices(mesh.vertices)
            source = (points, _loops(mesh.faces, "mesh.faces", len(points)))
        else:
            raise refused(f"mesh: a path, or an object with .vertices and .faces, not {type(mesh).__name__} (bad_value)")
        parts, reached = _protocol.mesh_parts(source, error, side, bool(turn_faces))
        compound = cls([ConvexPolytope(points) for points in parts], margin=margin)
        compound._error = reached
        return compound

    @property
    def error(self):
        """The certified error of `from_mesh` with an error; None for other compounds. No part of what makes it equal."""
        return getattr(self, "_error", None)

    def protocol(self):
        fields = super().protocol()
        fields["parts"] = [{"shape": shape.protocol(), "pose": pose_fields(pose)} for shape, pose in fields["parts"]]
        return fields


class StarBody(Shape):
    """A closed triangulated surface that every point of is seen from `center`: vertices [n, 3], faces [m, 3], center [3].

    Faces are rows of vertices, counter-clockwise from outside. Raises Refused where the surface is not closed or not seen.
    """

    _type = "star"

    def __init__(self, vertices, faces, center, *, margin=0.0):
        faces = _loops(faces)
        super().__init__("star", (vertices, faces, center), margin, {"vertices": vertices, "center": center})
        self._arguments["faces"] = faces
