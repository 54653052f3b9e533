"""Robots: links with collision shapes, forward kinematics, and signed distances of their pairs of links."""

from __future__ import annotations

import numpy as np

from ._core import Pose
from ._errors import refused
from ._picture_call import picture
from ._queries import _threads
from ._robot_bodies import body_of, one_shape
from ._robot_distances import How, Question, RobotDistances, refuse_rows, stretches
from ._robot_model import allowed_pairs
from ._robot_motion import QUIET
from ._robot_tree import Tree
from ._shapes import Compound

#: Joint vectors of which all poses are held in memory.
_AT_ONCE = 1 << 14


class Robot:
    """A tree of links and joints with collision shapes, read by from_urdf or from_sdf. Immutable.

    name: the model's.
    links, joints: names.
    coordinates: names of the numbers of a joint vector q, in metres or radians, dof of them.
    limits: [dof, 2]. They bound no question.
    pairs: the pairs of links that `distances` asks. They have shapes that move against each other. Adjacent links, with
    no third link with a shape between them along the joints, are left out, and so are pairs that an SRDF file disables.

    A revolute, continuous or prismatic joint has one coordinate. A planar joint has three: two places in the plane across
    its axis, and an angle. A floating joint has six: a place, and a rotation vector (axis times angle). A joint that
    mimics another has none.
    """

    def __init__(self, model):
        if not hasattr(model, "links"):
            raise TypeError("a robot is read from a file: pdepth.Robot.from_urdf(path) or pdepth.Robot.from_sdf(path)")
        self._tree = Tree(model)
        self._bodies = [body_of(link) for link in model.links]
        self._pairs = allowed_pairs(model)
        self.name = model.name
        self.links = tuple(link.name for link in model.links)
        self.joints = tuple(joint.name for joint in self._tree.joints)
        self.coordinates = tuple(self._tree.coordinates)
        self.pairs = tuple((self.links[i], self.links[j]) for i, j in self._pairs)

    @classmethod
    def from_urdf(cls, path, *, srdf=None, package_roots=None, meshes="solid", tolerance=0.0):
        """Reads a URDF file.

        srdf: an SRDF file, whose disable_collisions leave out pairs.
        package_roots: {package: its folder}, or a folder or a list of folders that hold packages. Meshes lie below these
        or below the file's own folder.
        meshes: for all links one of these words, or {link: word} with "solid" for the links that are not named. The word
        "solid" cuts closed meshes that are not convex into convex parts. The word "hull" takes convex hulls. The word
        "parts" takes the hull of each connected part, for files that hold a convex decomposition.
        tolerance: how far, about, the parts of a "solid" may reach beyond the solid, in metres. A tolerance gives fewer
        parts; curved meshes, which have too many exact ones, need it, and their parts take seconds to find.

        Raises Refused with file and line: 'unreadable_file', 'missing_field' (a package without a root, too), 'bad_value',
        'non_finite', 'unsupported', and what a mesh's reader says.
        """
        from ._robot_meshes import Meshes
        from ._robot_urdf import read_srdf, read_urdf

        model = read_urdf(path, Meshes(path, package_roots, meshes, tolerance))
        if srdf is not None:
            read_srdf(srdf, model)
        return cls(model)

    @classmethod
    def from_sdf(cls, path, *, srdf=None, package_roots=None, meshes="solid", tolerance=0.0):
        """Reads the one model of an SDF file; poses are in the model's frame. Arguments and errors as in from_urdf.

        A link on which no joint leads stands where the file puts it. A ball joint has three coordinates, a rotation
        vector. Models inside of models, and joints with two axes or a screw, are refused as 'unsupported'.
        """
        from ._robot_meshes import Meshes
        from ._robot_sdf import read_sdf
        from ._robot_urdf import read_srdf

        model = read_sdf(path, Meshes(path, package_roots, meshes, tolerance))
        if srdf is not None:
            read_srdf(srdf, model)
        return cls(model)

    def __setattr__(self, name, value):
        if name in self.__dict__ or hasattr(type(self), name):
            raise AttributeError(f"a Robot is immutable: read another one for a new {name}")
        object.__setattr__(self, name, value)

    @property
    def limits(self):
        """[dof, 2], not to be written: the least and the greatest value of each coordinate. They bound no question."""
        limits = self._tree.limits.view()
        limits.flags.writeable = False
        return limits

    @property
    def dof(self):
        """The number of coordinates."""
        return len(self.coordinates)

    def __repr__(self):
        return f"<Robot {self.name!r}: {len(self.links)} links, {self.dof} coordinates, {len(self.pairs)} pairs>"

    def shape(self, link):
        """The collision shape of a link, in the link's frame; None for a link without one."""
        return one_shape(self._bodies[self._link(link, "link")])

    def poses(self, q):
        """Poses of all links for joint vectors: [..., dof] to [..., links, 4, 4], in the root link's frame.

        Raises Refused: 'bad_value' for a wrong number of coordinates, 'non_finite' at q[i].
        """
        q, lead = self._vectors(q)
        _require_finite(q, lead)
        with np.errstate(**QUIET):
            frames, _ = self._tree.frames(q)
        return np.moveaxis(frames, 0, 1).reshape((*lead, len(self.links), 4, 4))

    def distances(self, q, *, pairs=None, nearest=False, derivatives=False, bracket="certified", warm=False, threads=None):
        """Signed distances of pairs of links for joint vectors [..., dof]: positive apart, minus the depth where they overlap.

        Answers RobotDistances [..., pairs]. In a batch, a joint vector that is not finite is its rows' error.

        pairs: pairs of names to ask, instead of the robot's own.
        nearest: True answers for each joint vector the pair of the least signed distance alone. Balls around the links
        tell which pairs need no question.
        derivatives: True adds by_q [..., dof], from normals and witness points, and `unique`, where the derivative is
        proved to exist. If several points are equally near, such as on parallel faces, by_q is that of one pair of them.
        Links of several shapes are never proved unique.
        bracket: "certified" (as narrow as rounding for polytopes and capsules, 1e-6 of the depth for curved bodies), or
        "tightest" or "contact" as in depth. Derivatives have the tightest.
        warm: True takes the joint vectors along the last leading dimension for a path, on which each pair starts from its
        last answer. Answers are as certified as without, but their last bits may differ. Every 64th joint vector of a path
        starts cold, so that all cores have work. Derivatives of convex links start cold, too.
        threads: cores that answer, all by default. The bits are the same for any number.

        Raises Refused: 'bad_value' for a wrong number of coordinates, an unknown link, or a link without a shape.
        """
        q, lead = self._vectors(q)
        asked, threads = self._pairs if pairs is None else self._named(pairs), _threads(threads)
        if not lead:
            _require_finite(q, lead)
        if nearest and not asked:
            raise refused("pairs: there are none, so that none is nearest (bad_value)")
        if warm not in (True, False):
            raise refused(f"warm: must be True or False, not {warm!r} (bad_value)")
        how = How(bracket, threads, stretches(len(q), *lead[-1:]) if warm else None)
        pieces = [self._answer(slice(begin, begin + _AT_ONCE), q, asked, (nearest, derivatives), how)
                  for begin in range(0, max(len(q), 1), _AT_ONCE)]
        columns = {name: np.concatenate([piece[name] for piece in pieces]) for name in pieces[0]}
        own = 1 if nearest else 2  # dimensions of a column that are rows of the batch
        flat = {name: column.reshape((-1, *column.shape[own:])) for name, column in columns.items()}
        return RobotDistances(flat, lead if nearest else (*lead, len(asked)))

    def _answer(self, rows, q, asked, wish, how):
        nearest, derivatives = wish
        q, how = q[rows], how.of(rows)
        bad = ~np.isfinite(q).all(axis=1)
        with np.errstate(**QUIET):
            question = Question(self._tree, self._bodies, np.where(bad[:, None], 0.0, q), asked, how)
            columns = question.nearest(derivatives) if nearest else question.all(derivatives)
        refuse_rows(columns, bad)
        return columns

    def sweep(self, q, client=None, *, out, chunk=10_000, threads=None, progress=True, **options):
        """Asks `distances` for many joint vectors [n, dof] and writes the answers to `out` as they come; see pdepth.sweep.

        q: [n, dof]; an np.memmap stays on disk.
        client: a distributed.Client, else this machine.
        out: the folder of the answers.
        chunk: joint vectors a file, chunk_K.npz, which holds the columns of `distances`.
        options: pairs, nearest, derivatives and bracket of `distances`.

        Answers a Sweep.
        """
        from ._sweep import run

        how = {"out": out, "chunk": chunk, "threads": threads, "progress": progress}
        return run(_JointVectors(self, q), client, how, options)

    def picture(self, q, **view):
        """Draws the robot at one joint vector, as pdepth.picture does with the same size, azimuth and elevation.

        Raises Refused as poses and picture, and 'bad_value' for a robot without shapes.
        """
        q, lead = self._vectors(q)
        _require_finite(q, lead)
        if lead or all(body is None for body in self._bodies):
            raise refused(f"q: a picture shows one joint vector [{self.dof}] of a robot with shapes (bad_value)")
        frames, _ = self._tree.frames(q)
        bodies = [(one_shape(body), Pose(frames[link, 0])) for link, body in enumerate(self._bodies) if body is not None]
        return picture(Compound(bodies), **view)

    def _link(self, name, argument):
        if name not in self.links:
            raise refused(f"{argument}: the robot has no link {name!r}; its links: {', '.join(self.links)} (bad_value)")
        return self.links.index(name)

    def _named(self, pairs):
        asked = []
        for i, pair in enumerate(pairs):
            if isinstance(pair, str) or len(pair) != 2 or pair[0] == pair[1]:
                raise refused(f"pairs[{i}]: must be the names of two links, not {pair!r} (bad_value)")
            asked.append(tuple(self._link(name, f"pairs[{i}]") for name in pair))
            for name, link in zip(pair, asked[-1]):
                if self._bodies[link] is None:
                    raise refused(f"pairs[{i}]: the link {name!r} has no collision shape (bad_value)")
        return asked

    def _told(self):
        """The robot's parts in a form that JSON takes."""
        bodies = [body and [body[0].protocol(), body[1].tolist()] for body in self._bodies]
        joints = [[j.name, j.kind, j.parent, j.child, j.before.tolist(), j.axis.tolist(), j.after.tolist(), j.mimic]
                  for j in self._tree.joints]
        return [self.links, bodies, joints, self.pairs]

    def _vectors(self, q):
        """Joint vectors as [n, dof], and their leading dimensions."""
        try:
            array = np.asarray(q)
        except ValueError:
            raise refused(f"q: rows of different lengths; give [..., {self.dof}] (bad_value)") from None
        if array.dtype.kind not in "fiu" or array.dtype.itemsize > 8:
            raise refused(f"q: dtype {array.dtype} is not taken; give float64 (bad_value)")
        if array.ndim < 1 or array.shape[-1] != self.dof:
            raise refused(f"q: has shape {array.shape}, needs [..., {self.dof}]: {', '.join(self.coordinates)} (bad_value)")
        return array.astype(float).reshape((int(np.prod(array.shape[:-1])), self.dof)), array.shape[:-1]


def _require_finite(q, lead):
    bad = np.argwhere(~np.isfinite(q))
    if len(bad):
        place = (*np.unravel_index(bad[0, 0], lead), bad[0, 1]) if lead else bad[0, 1:]
        raise refused(f"q[{', '.join(str(int(i)) for i in place)}]: must be finite (non_finite)")


class _JointVectors:
    """A question of a sweep: signed distances of a robot, by rows of joint vectors."""

    noun = "joint vectors"

    def __init__(self, robot, q):
        if np.ndim(q) != 2 or np.shape(q)[1] != robot.dof:
            raise refused(f"q: has shape {np.shape(q)}, needs [n, {robot.dof}] (bad_value)")
        self.shared, self._q, self.count = robot, q, len(q)

    def told(self):
        return self.shared._told()

    def rows(self, begin, end):
        return (np.asarray(self._q[begin:end], dtype=float),)

    @staticmethod
    def chunk(robot, q, threads, options):
        found = robot.distances(q, threads=threads, **options)
        return {name: found[name] for name in found}
