"""Recorders of engines: small stand-ins with the attributes that the engines' own objects have, judged by the audit."""
import json
import types

import numpy as np
import pdepth
import pytest

TURN = np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]])
LYING = np.array([[0.0, 0, 1], [0, 1, 0], [-1, 0, 0]])
TETRA = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], dtype=np.float32)


def mujoco_model(**changes):
    """A floor, a box, a ball, a mesh and a capsule; the box and the ball are parent and child, and so never collide."""
    model = dict(
        ngeom=5, geom_type=np.array([0, 6, 2, 7, 3]), geom_dataid=np.array([-1, -1, -1, 1, -1]),
        geom_size=np.array([[5, 5, 1], [0.5, 0.4, 0.3], [0.2, 0, 0], [1, 1, 1], [0.1, 0.3, 0]], dtype=float),
        geom_rbound=np.array([0, 0.8, 0.2, 1.8, 0.4]), geom_contype=np.ones(5, int), geom_conaffinity=np.ones(5, int),
        geom_bodyid=np.array([0, 1, 2, 3, 4]), body_weldid=np.arange(5), body_parentid=np.array([0, 0, 1, 0, 0]),
        mesh_vertadr=np.array([0, 2]), mesh_vertnum=np.array([2, 4]), mesh_vert=np.vstack([np.full((2, 3), 9), TETRA]),
        exclude_signature=np.array([(3 << 16) + 4]), pair_geom1=np.array([], int), pair_geom2=np.array([], int),
        opt=types.SimpleNamespace(disableflags=0))
    return types.SimpleNamespace(**{**model, **changes})


def mujoco_data(contacts, **changes):
    places = np.array([[0, 0, 0], [0, 0, 0.28], [0.1, 0, 0.4], [3, 0, -0.05], [3.2, 0.2, 0.15]], dtype=float)
    turns = np.array([np.eye(3), TURN, np.eye(3), np.eye(3), LYING]).reshape(5, 9)
    made = [types.SimpleNamespace(geom1=a, geom2=b, dist=dist, pos=np.array(pos, dtype=float),
                                  frame=np.array([*normal, 0, 0, 0, 0, 0, 0], dtype=float)) for a, b, dist, pos, normal in contacts]
    return types.SimpleNamespace(**{"time": 0.25, "ncon": len(made), "contact": made, "geom_xpos": places,
                                    "geom_xmat": turns, **changes})


#: Floor and box, at two corners; floor and mesh; the mesh and the capsule are excluded.
RIGHT = [(0, 1, -0.02, (0.4, 0.5, -0.01), (0, 0, 1)), (0, 1, -0.02, (-0.4, 0.5, -0.01), (0, 0, 1)),
         (0, 3, -0.05, (3, 0, -0.025), (0, 0, 1))]


def test_a_right_engine_is_found_right(tmp_path):
    path = tmp_path / "contacts.jsonl"
    assert pdepth.record.mujoco(mujoco_model(), mujoco_data(RIGHT), path) == (2, 1, 0)
    found = pdepth.audit(path, fail_on="missed=0,phantom=0,depth_error=1e-12,normal_excess=1e-12,point_error=1e-12")
    assert found.ok and found.contacts == found.judged == 3, found.table
    assert pdepth.record.mujoco(mujoco_model(), mujoco_data(RIGHT[:2], time=0.5), path) == (1, 2, 0)  # the mesh is missed
    lines = [json.loads(line) for line in path.read_text().splitlines()]
    assert [line["contact"] for line in lines if "contact" in line] == list(range(6))
    assert [line["time"] for line in lines if "contact" in line] == [0.25] * 3 + [0.5] * 3
    assert lines[0] == {"record": "pdepth-contacts/1", "engine": "MuJoCo", "scalar": "float64", "unit": "m"}
    assert pdepth.audit(path).missed == 1


def test_filters_tell_which_pairs_are_apart(tmp_path):
    def count(name, model, contacts=()):
        return pdepth.record.mujoco(model, mujoco_data(contacts), tmp_path / name)

    flags = lambda number: types.SimpleNamespace(disableflags=number)  # noqa: E731
    assert count("a", mujoco_model()) == (0, 3, 0)                                    # floor with box, mesh, capsule
    assert count("b", mujoco_model(opt=flags(1 << 9))) == (0, 4, 0)                   # box with ball, too
    assert count("c", mujoco_model(opt=flags(1 << 4))) == (0, 0, 0)                   # nothing was asked
    assert count("d", mujoco_model(geom_contype=np.zeros(5, int))) == (0, 0, 0)
    listed = {"pair_geom1": np.array([4]), "pair_geom2": np.array([3]), "geom_contype": np.zeros(5, int)}
    assert count("e", mujoco_model(**listed)) == (0, 1, 0)
    assert count("f", mujoco_model(body_weldid=np.zeros(5, int))) == (0, 0, 0)


def test_what_a_record_cannot_hold_is_counted(tmp_path):
    model = mujoco_model(geom_type=np.array([0, 6, 2, 1, 3]), geom_size=mujoco_model().geom_size * [[1], [1], [1], [1], [0]])
    data = mujoco_data(RIGHT)
    data.geom_xpos[1] = np.nan
    with pytest.warns(UserWarning) as told:
        assert pdepth.record.mujoco(model, data, tmp_path / "contacts.jsonl") == (0, 0, 3)
    assert [str(each.message).split(":")[0] for each in told] == ["geom 3", "geom 4"]


def test_a_record_goes_on_where_it_ended(tmp_path):
    from pdepth import _record_file

    path = tmp_path / "contacts.jsonl"
    pdepth.record.mujoco(mujoco_model(), mujoco_data(RIGHT), path)
    _record_file._written.clear()  # another process
    pdepth.record.mujoco(mujoco_model(), mujoco_data(RIGHT), path)
    assert pdepth.audit(path).judged == 6 and path.read_text().count('"is"') == 4
    for text, code in (("", None), ("hello\n", "unreadable_file"), ('{"record":1,"engine":"mine"}\n', "bad_value"),
                       (path.read_text()[:-3], "unreadable_file")):
        path.write_text(text)
        if code is None:
            assert pdepth.record.mujoco(mujoco_model(), mujoco_data(RIGHT), path).contacts == 2
            continue
        with pytest.raises(pdepth.Refused) as caught:
            pdepth.record.mujoco(mujoco_model(), mujoco_data(RIGHT), path)
        assert caught.value.code == code and path.read_text() == text
    with pytest.raises(pdepth.Refused, match="unreadable_file"):
        pdepth.record.mujoco(mujoco_model(), mujoco_data(RIGHT), tmp_path / "none" / "contacts.jsonl")


class Bullet:
    """PyBullet's functions for a plane, a box with a ball on an arm, and a cylinder; all bodies' boxes meet the plane's."""

    GEOMETRY = {(0, -1): [(6, (0, 0, 1), (0, 0, 0))], (1, -1): [(3, (1, 0.8, 0.6), (0, 0, 0))],
                (2, -1): [(4, (0.5, 0.2, 0), (0, 0, 0))],
                (1, 0): [(2, (0.2, 0.2, 0.2), (0, 0, 0)), (7, (0.4, 0.1, 0), (0.5, 0, 0))], (3, -1): [(5, (1, 1, 1), (0, 0, 0))]}
    PLACES = {(0, -1): (0, 0, 0), (1, -1): (0, 0, 0.29), (1, 0): (0, 3, 0.5), (2, -1): (0.62, 0, 0.25), (3, -1): (9, 9, 9)}

    def __init__(self, points, bodies=3):
        self.points, self.bodies, self.detected = points, bodies, 0

    def performCollisionDetection(self):
        self.detected += 1

    def getNumBodies(self):
        return self.bodies

    def getBodyUniqueId(self, i):
        return i

    def getNumJoints(self, body):
        return int(body == 1)

    def getCollisionShapeData(self, body, link):
        return [(body, link, kind, sizes, b"", place, (0, 0, 0, 1)) for kind, sizes, place in self.GEOMETRY[body, link]]

    def getBasePositionAndOrientation(self, body):
        half = np.sqrt(0.5)
        return self.PLACES[body, -1], (0, 0, half, half) if body == 1 else (0, 0, 0, 1)

    def getLinkState(self, body, link):
        return (self.PLACES[body, link], (0, 0, 0, 1), None, None)

    def getAABB(self, body, link):
        return (-1, -1, -1), (1, 1, 1)

    def getDynamicsInfo(self, body, link):
        return (float(body > 0), *[0] * 10, 0.25)

    def getMeshData(self, body, link):
        return 4, [tuple(vertex) for vertex in TETRA.tolist()]

    def getContactPoints(self):
        return [(0, a, b, link_a, link_b, on_a, on_b, normal, distance, 0, 0, (0, 0, 0), 0, (0, 0, 0))
                for (a, link_a), (b, link_b), on_a, on_b, normal, distance in self.points]


POINTS = [((1, -1), (0, -1), (0.4, 0.5, -0.01), (0.4, 0.5, 0), (0, 0, 1), -0.01),
          ((2, -1), (0, -1), (0.6, 0, 0), (0.6, 0, 0), (0, 0, 1), 0.0)]


def test_pybullet_is_read_by_its_functions(tmp_path):
    path, client = tmp_path / "contacts.jsonl", Bullet(POINTS)
    # Apart: the arm with the plane and the cylinder, the box with the cylinder. The box and its arm are one body.
    assert pdepth.record.pybullet(client, path) == (2, 3, 0) and client.detected == 1
    found = pdepth.audit(path, fail_on="missed=0,phantom=0,depth_error=1e-12,normal_excess=1e-12,point_error=1e-12", tolerance=1e-6)
    assert found.ok and found.judged == 5, found.table
    assert pdepth.record.pybullet(Bullet(POINTS[1:]), path) == (1, 4, 0) and pdepth.audit(path, tolerance=1e-6).missed == 1


def test_meshes_of_pybullet_are_hulls_where_the_caller_says_so(tmp_path):
    with pytest.warns(UserWarning, match="body 3, link -1: a record holds no shape of type 5"):
        assert pdepth.record.pybullet(Bullet(POINTS, bodies=4), tmp_path / "a").unsupported == 4
    assert pdepth.record.pybullet(Bullet(POINTS, bodies=4), tmp_path / "b", mesh_hulls=True).unsupported == 0
    assert '"margin":0.25' in (tmp_path / "b").read_text()
