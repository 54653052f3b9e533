"""Arguments that a stranger gave: each is refused by its name, or taken as meant."""
import os
import pathlib
import pickle
import subprocess
import sys
from types import SimpleNamespace

import numpy as np
import pdepth
import pytest

BOX = pdepth.Box([1, 1, 1])
CORNERS = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
FACES = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]]
SHEET = pdepth.Sheet(CORNERS, FACES)
TWO = np.tile(np.eye(4), (2, 1, 1))
PACKAGE = os.path.dirname(os.path.dirname(pdepth.__file__))
HEAD = {"record": "pdepth-contacts/1", "engine": "test", "scalar": "float64"}
RECORD = [HEAD, {"shape": "box", "is": BOX},
          {"contact": 1, "a": "box", "b": "box", "pose_b": pdepth.Pose(translation=[1.5, 0, 0]), "reported": None}]


def mesh(vertices=CORNERS, faces=FACES):
    return SimpleNamespace(vertices=vertices, faces=faces)


@pytest.mark.parametrize("call,where,code,told", [
    (lambda: pdepth.audit(RECORD, tolerance=-1), "tolerance", "bad_value", "[1e-15, 1]"),
    (lambda: pdepth.audit(RECORD, tolerance=0), "tolerance", "bad_value", "[1e-15, 1]"),
    (lambda: pdepth.audit(RECORD, tolerance=np.nan), "tolerance", "bad_value", "nan"),
    (lambda: pdepth.audit(RECORD, tolerance=np.inf), "tolerance", "bad_value", "inf"),
    (lambda: pdepth.audit(RECORD, threads=1_000_000), "threads", "bad_value", "1 to 1024"),
    (lambda: pdepth.audit(RECORD, threads=-5), "threads", "bad_value", "1 to 1024"),
    (lambda: pdepth.audit(RECORD, threads=0), "threads", "bad_value", "1 to 1024"),
    (lambda: pdepth.audit(RECORD, worst=-1), "worst", "bad_value", "not -1"),
    (lambda: pdepth.audit(RECORD, fail_on=["missed=0"]), "fail_on", "bad_value", "missed=0"),
    (lambda: pdepth.audit([HEAD, {"shape": "s", "is": object()}]), "records[1].is", "bad_value", "object"),
    (lambda: pdepth.save_picture("/tmp/s\0.png", np.zeros((4, 4, 3), np.uint8)), "path", "bad_value", "zero byte"),
    (lambda: pdepth.save_picture("/tmp/s.png", np.zeros((0, 0, 3), np.uint8)), "rgb", "bad_value", "no pixels"),
    (lambda: pdepth.depth(BOX, BOX, threads=True), "threads", "bad_value", "True"),
    (lambda: pdepth.directional_depth([BOX, BOX], BOX, [[1, 0], [1, 0, 0]]), "direction", "bad_value", "lengths"),
    (lambda: pdepth.polygon_depth([[0, 0], [1]], [[0, 0], [1, 0], [0, 1]]), "p", "bad_value", "lengths"),
    (lambda: pdepth.polygon_depth(None, [[0, 0], [1, 0], [0, 1]]), "p", "bad_value", "object"),
    (lambda: pdepth.time_of_impact([BOX, BOX], BOX, velocity_a=[[1, 0], [1, 0, 0]]), "velocity_a", "bad_value", "[2, 3]"),
    (lambda: pdepth.ConvexPolytope.from_mesh(mesh(faces=[0, 1, 2])), "mesh.faces", "bad_value", "list of faces"),
    (lambda: pdepth.ConvexPolytope.from_mesh(mesh(faces=[[0, 1, 2**40]])), "mesh.faces[0]", "out_of_range", "0 to 3"),
    (lambda: pdepth.Compound.from_mesh(mesh(faces=[[0, 1, 2**64 - 1]])), "mesh.faces[0]", "out_of_range", "0 to 3"),
    (lambda: pdepth.Compound.from_mesh(mesh(vertices=[[0, 0], [1]])), "mesh.vertices", "bad_value", "lengths"),
    (lambda: pdepth.Compound.from_mesh(mesh(), side=3), "side", "bad_value", "not 3"),
    (lambda: pdepth.query("hull", a=SHEET), "a", "unsupported", "Sheet"),
    (lambda: pdepth.query("hull", a={"points": (i for i in range(3))}), "a.points", "bad_value", "generator"),
    (lambda: pdepth.query("hull", a={1, 2}), "a", "bad_value", "set"),
    (lambda: pdepth.query("hull", a={"points": [[0, np.inf, 0]]}), "a.points[0][1]", "non_finite", "finite"),
    (lambda: pdepth.query_many("hull", [{"a": BOX}, {"a": {1, 2}}]), "rows[1].a", "bad_value", "set"),
    (lambda: pdepth.width([BOX], method={1}), "method", "bad_value", "set"),
    (lambda: pdepth.Compound(BOX), "parts", "bad_value", "Box"),
    (lambda: pdepth.Cone(1, 1, ["z"]), "axis", "bad_value", "['z']"),
    (lambda: pdepth.contact_manifold(BOX, BOX, breaking_threshold=np.inf), "breaking_threshold", "bad_value", "inf"),
    (lambda: pdepth.contact_manifold(BOX, SHEET, breaking_threshold="1"), "breaking_threshold", "bad_value", "'1'"),
    (lambda: pdepth.contact_manifold(BOX, BOX, breaking_threshold=None), "breaking_threshold", "bad_value", "None"),
])
def test_each_is_refused_by_name(call, where, code, told):
    with pytest.raises(pdepth.Refused) as caught:
        call()
    assert (caught.value.where, caught.value.code) == (where, code) and told in str(caught.value)


def test_numbers_of_numpy_are_taken(tmp_path):
    assert pdepth.depth(BOX, BOX, TWO, threads=np.int64(2)).depth.tolist() == [2, 2]
    done = pdepth.sweep([BOX], np.zeros((3, 2), int), (TWO[[0, 0, 0]],) * 2, out=tmp_path, chunk=np.int64(2), progress=False)
    assert len(done.files) == 2
    file = tmp_path / "one.urdf"
    file.write_text('<robot name="r"><link name="a"/></robot>')
    assert pdepth.Robot.from_urdf(file, tolerance=np.float32(0.1)).links == ("a",)


def test_a_shape_gives_copies_of_its_numbers():
    box = pdepth.Box([1, 2, 3])
    box.protocol()["half_extents"][0] = 77
    assert repr(box) == "Box(half_extents=[1.0, 2.0, 3.0])"
    with pytest.raises(AttributeError, match="immutable"):
        box.__init__([9, 9, 9])
    with pytest.raises(AttributeError, match="immutable"):
        SHEET.__init__(CORNERS, FACES)
    assert pdepth.depth(box, box).depth == 2


def test_a_robot_is_immutable(tmp_path):
    file = tmp_path / "one.urdf"
    file.write_text('<robot name="r"><link name="a"/><link name="b"/><joint name="j" type="revolute"><parent link="a"/>'
                    '<child link="b"/><axis xyz="0 1e200 0"/><limit lower="-1" upper="2"/></joint></robot>')
    robot = pdepth.Robot.from_urdf(file)
    for name in ("limits", "links", "pairs", "dof"):
        with pytest.raises(AttributeError, match="immutable"):
            setattr(robot, name, 3)
    with pytest.raises(ValueError):
        robot.limits[0, 0] = 5
    again = pickle.loads(pickle.dumps(robot))
    assert again.limits.tolist() == [[-1, 2]] and np.array_equal(again.poses([0.5]), robot.poses([0.5]))
    turned = [[np.cos(0.5), 0, np.sin(0.5)], [0, 1, 0], [-np.sin(0.5), 0, np.cos(0.5)]]
    assert np.allclose(robot.poses([0.5])[1, :3, :3], turned, atol=1e-15)  # about y, whatever the axis' length


def test_equal_shapes_have_equal_hashes():
    one = pdepth.ConvexPolytope(CORNERS)
    negative = pdepth.ConvexPolytope([[0, 0, -0.0], *CORNERS[1:]])
    assert one == negative and len({one, negative}) == 1
    assert SHEET == pdepth.Sheet(CORNERS, FACES) and len({SHEET, pdepth.Sheet(CORNERS, FACES)}) == 1
    assert SHEET != pdepth.Sheet(CORNERS, FACES[:3]) and SHEET != one


class Cube(pdepth.Box):
    def __init__(self, s):
        super().__init__([s, s, s])
        self.name = "cube"


def test_a_callers_class_keeps_its_numbers_and_names():
    again = pickle.loads(pickle.dumps(Cube(2.0)))
    assert type(again) is Cube and again == Cube(2.0) and again.name == "cube" and pdepth.depth(again, again).depth == 4


def test_one_in_a_list_is_one_for_all():
    five = np.tile(np.eye(4), (5, 1, 1))
    assert pdepth.depth([BOX], BOX, five).depth.shape == (5,)
    assert pdepth.depth([BOX, BOX, BOX], [BOX], five[:1]).depth.shape == (3,)
    assert pdepth.depth([BOX], BOX, five[:0]).depth.shape == (0,) and pdepth.depth([BOX], [BOX]).depth.shape == (1,)
    assert pdepth.hull([BOX], five).affine_dim.tolist() == [3] * 5
    with pytest.raises(pdepth.Refused, match="one for all"):
        pdepth.depth([BOX, BOX], BOX, five)


def test_rows_count_from_the_end():
    hulls = pdepth.hull([BOX, pdepth.ConvexPolytope(CORNERS)])
    assert hulls.of_row(-1)["vertices"].tolist() == hulls.of_row(1)["vertices"].tolist() and len(hulls.of_row(-1)["facets"]) == 4
    with pytest.raises(IndexError):
        hulls.of_row(2)


def test_batches_without_an_answer_have_their_columns(tmp_path):
    refused = pdepth.query_many("depth", [{"a": {"points": [[np.nan, 0, 0]]}, "b": BOX}])
    assert refused.error.all() and np.isnan(refused.depth).all() and refused.normal.shape == (1, 3)
    done = pdepth.sweep([BOX], np.empty((0, 2), int), lambda begin, end: 1 / 0, out=tmp_path, progress=False)
    assert done["depth"].shape == (0,) and done["normal"].shape == (0, 3) and list(done) == []


def test_one_joint_vector_and_its_nearest_pair_have_a_length(tmp_path):
    file = tmp_path / "two.urdf"
    body = '<collision><geometry><sphere radius="0.1"/></geometry></collision>'
    file.write_text(f'<robot name="r"><link name="a">{body}</link><link name="b">{body}</link><link name="c">{body}</link>'
                    '<joint name="j" type="prismatic"><parent link="a"/><child link="b"/></joint>'
                    '<joint name="k" type="prismatic"><parent link="b"/><child link="c"/></joint></robot>')
    found = pdepth.Robot.from_urdf(file).distances([1.0, 1.0], nearest=True)
    assert len(found) == 1 and found.signed_distance.shape == ()


@pytest.mark.parametrize("part,told", [
    ('<mesh/>', 'filename="..."'), ('<mesh filename="file:///%00"/>', "zero byte"), ('<box size="1_0 1 1"/>', "1_0"),
])
def test_a_robots_file_is_refused_by_its_line(tmp_path, part, told):
    file = tmp_path / "bad.urdf"
    file.write_text(f'<robot name="r">\n<link name="a"><collision><geometry>\n{part}</geometry></collision></link></robot>')
    with pytest.raises(pdepth.Refused) as caught:
        pdepth.Robot.from_urdf(file)
    assert caught.value.where == "bad.urdf line 3" and told in str(caught.value)


def test_a_robots_folder_may_have_any_name(tmp_path):
    folder = os.path.join(os.fsencode(tmp_path), b"\xff")
    os.mkdir(folder)
    with open(os.path.join(folder, b"m.xyz"), "w") as file:
        file.write("0 0 0\n1 0 0\n0 1 0\n0 0 1\n")
    with open(os.path.join(folder, b"r.urdf"), "w") as file:
        file.write('<robot name="r"><link name="a"><collision><geometry><mesh filename="m.xyz"/></geometry></collision></link></robot>')
    path = os.fsdecode(os.path.join(folder, b"r.urdf"))
    assert len(pdepth.Robot.from_urdf(path, meshes="hull").shape("a").vertices) == 4
    with pytest.raises(pdepth.Refused, match="no faces"):
        pdepth.Robot.from_urdf(path)


def test_an_unknown_encoding_is_no_xml(tmp_path):
    file = tmp_path / "bad.urdf"
    file.write_text('<?xml version="1.0" encoding="foo"?>\n<robot name="r"/>')
    with pytest.raises(pdepth.Refused, match="encoding") as caught:
        pdepth.Robot.from_urdf(file)
    assert (caught.value.where, caught.value.code) == ("bad.urdf line 1", "unreadable_file")


def test_a_mesh_of_numbers_that_are_none_is_refused_without_a_warning(recwarn):
    with pytest.raises(pdepth.Refused) as caught:
        pdepth.ConvexPolytope.from_mesh(mesh(vertices=np.array(CORNERS) * [1, 1, np.nan]))
    assert caught.value.code == "non_finite" and not recwarn.list


def test_a_path_is_taken_in_a_line(tmp_path):
    file = tmp_path / "corners.obj"
    file.write_text("".join(f"v {x} {y} {z}\n" for x, y, z in CORNERS) +
                    "".join("f " + " ".join(str(i + 1) for i in face) + "\n" for face in FACES))
    assert len(pdepth.query("hull", a={"type": "mesh", "path": pathlib.Path(file)}).vertices) == 4


def test_a_view_is_refused_by_name():
    pytest.importorskip("pdepth._picture", reason="built without the renderer")
    for options, where in (({"azimuth": np.nan}, "azimuth"), ({"elevation": "up"}, "elevation"), ({"size": (32.7, 32)}, "size"),
                           ({"size": 32}, "size")):
        with pytest.raises(pdepth.Refused) as caught:
            pdepth.picture(BOX, **options)
        assert caught.value.where == where


def test_the_module_is_the_command():
    ran = subprocess.run([sys.executable, "-m", "pdepth", "--version"], env={**os.environ, "PYTHONPATH": PACKAGE},
                         capture_output=True, text=True)
    assert "No module named" not in ran.stderr
    assert ran.returncode == 0 or "this installation has the module alone" in ran.stderr


@pytest.mark.parametrize("call,where,code,told", [
    (lambda: pdepth.Pose(translation=[1e301, 0, 0]), "translation[0]", "out_of_range", "1e+301"),
    (lambda: pdepth.Pose(wxyz=[1, 0, 0, 0], translation=[0, 1e301, 0]), "translation[1]", "out_of_range", "1e+301"),
    (lambda: pdepth.depth(BOX, BOX, (np.eye(3), [0, 0, 1e301])), "pose_a.translation[2]", "out_of_range", "1e+301"),
    (lambda: pdepth.Pose([[1, 0, 0, 0], [0, 1, 0, -1e301], [0, 0, 1, 0], [0, 0, 0, 1]]), "matrix[1, 3]", "out_of_range", "1e+301"),
    (lambda: pdepth.depth(BOX, BOX, np.full((4, 4), np.nan)), "pose_a[0, 0]", "non_finite", "finite"),
    (lambda: pdepth.Pose(np.eye(3), [0, 0, 0]), "Pose", "bad_value", "rotation=R"),
    (lambda: pdepth.depth(BOX, BOX, method=None), "method", "bad_value", "known: auto, "),
    (lambda: pdepth.depth(BOX, BOX, bracket=3), "bracket", "bad_value", "not 3"),
    (lambda: pdepth.ConvexPolytope.from_faces(CORNERS, [[0, 1, 2**40]]), "faces[0]", "bad_faces", "outside 0..3"),
    (lambda: pdepth.StarBody(CORNERS, [[0, 1, 2], [0, 1, 2**64 - 1]], [0, 0, 0]), "faces[1]", "bad_faces", "outside 0..3"),
    (lambda: pdepth.Sheet(CORNERS, [[0, 1, -1]]), "faces[0]", "bad_faces", "outside 0..3"),
    (lambda: pdepth.audit(RECORD, fail_on="foo=0"), "fail_on", "bad_value", "fail_on: there is no \"foo\""),
    (lambda: pdepth.ConvexPolytope.from_mesh(b"/tmp/\xff.obj".decode(errors="surrogateescape")), "/tmp/\udcff.obj",
     "unreadable_file", ""),
    (lambda: pdepth.audit(b"/tmp/\xff.jsonl".decode(errors="surrogateescape")), "/tmp/\udcff.jsonl", "unreadable_file", ""),
])
def test_the_compiled_part_refuses_each_by_name(call, where, code, told):
    test_each_is_refused_by_name(call, where, code, told)


def test_a_pose_that_is_not_finite_has_one_code_in_batches():
    poses = TWO.copy()
    poses[1] = np.nan
    refused = [0, pdepth.ERRORS.index("non_finite")]
    for found in (pdepth.depth(BOX, BOX, poses), pdepth.directional_depth(BOX, BOX, [1, 0, 0], poses),
                  pdepth.contact_manifold(BOX, BOX, poses), pdepth.derivatives(BOX, BOX, poses), pdepth.hull(BOX, poses)):
        assert found.error.tolist() == refused


def test_equal_poses_have_equal_hashes():
    one, other = pdepth.Pose(wxyz=[1, 0, 0, 0]), pdepth.Pose(wxyz=[1, 0, 0, -0.0], translation=[0, -0.0, 0])
    assert one == other and len({one, other}) == 1 and len({one, pdepth.Pose(translation=[1, 0, 0])}) == 2


def test_the_judges_table_names_what_python_was_given():
    table = pdepth.audit(RECORD).table
    assert "--report" not in table and "/tmp/" not in table and "record    records" in table and "worst" in table


def past_doubles():
    """Pairs whose answers hold infinity, NaN, or a bracket that is none."""
    e, z = 1e-100, 1e-200
    union = pdepth.Compound([pdepth.Cone(e, e), (pdepth.Cylinder(e, e), pdepth.Pose(translation=[e, 3 * e, e]))])
    a = pdepth.ConvexPolytope(z * np.array([[-1, -3, -2], [0, -3, -3], [-3, 2, 2], [0, -1, 0]]))
    b = pdepth.ConvexPolytope(z * np.array([[-2, -1, 2], [3, -3, 1], [1, 2, 3], [-3, -1, -2], [-1, 3, -1]]), margin=1e200)
    c = pdepth.ConvexPolytope(1e-100 * np.array([[1, 0, 1], [-2, -1, -1], [1, 2, 1], [-2, -1, -2]]))
    d = pdepth.SphereHull([[-3, 2, 3, 1], [1, 1, 1, 3], [2, -1, -3, 1]], margin=1e100)
    return [(union, pdepth.Box([1.6, 8.9, 1.4]), None), (a, b, pdepth.Pose(wxyz=[0.6, 0, 0.8, 0])), (c, d, None)]


@pytest.mark.parametrize("a,b,pose", past_doubles())
def test_an_answer_past_the_range_of_doubles_is_refused_or_right(a, b, pose):
    """The core may learn to answer these; whatever it says is finite and in its bracket."""
    poses = [pose, pose]
    rows = pdepth.depth(a, b, poses)
    try:
        found = pdepth.depth(a, b, pose)
    except pdepth.Refused as error:
        assert (error.where, error.code) == ("pair", "out_of_range") and "bring the sizes nearer" in str(error)
        assert (rows.error == pdepth.ERRORS.index("out_of_range")).all() and np.isnan(rows.depth).all()
        return
    assert not rows.error.any() and rows.depth[0] == found.depth
    assert 0 < found.lower <= found.depth <= found.upper < np.inf and np.isfinite([*found.witness_a, *found.translation]).all()


def test_a_manifold_past_the_range_of_doubles_is_refused_or_right():
    z = 1e-200
    a = pdepth.ConvexPolytope(z * np.array([[-2, 0, -1], [-3, 2, -2], [1, -2, 0], [0, -2, -1], [3, -3, -1], [1, 3, -3]]), margin=1e200)
    b = pdepth.ConvexPolytope(z * np.array([[-1, 1, 0], [3, 1, 3], [0, -3, 2], [3, 2, 1], [3, -1, -1], [1, -2, -1]]), margin=1e200)
    pose = pdepth.Pose(wxyz=[0.6, 0.8, 0, 0])
    rows = pdepth.contact_manifold(a, b, [pose, None])
    try:
        found = pdepth.contact_manifold(a, b, pose)
    except pdepth.Refused as error:
        assert error.code == "out_of_range" and rows.error[0] == pdepth.ERRORS.index("out_of_range")
        return
    assert rows.error[0] == 0 and np.isfinite(found.position_a).all() and np.isfinite(found.position_b).all()


def test_a_judgement_past_the_range_of_doubles_is_refused():
    tiny = pdepth.Sphere(1e-300)
    record = [HEAD, {"shape": "s", "is": tiny}, {"contact": 1, "a": "s", "b": "s", "reported": {"depth": 1e300, "normal": [1, 0, 0]}}]
    with pytest.raises(pdepth.Refused) as caught:
        pdepth.audit(record)
    assert (caught.value.where, caught.value.code) == ("records", "out_of_range")


def test_a_picture_of_a_size_that_no_camera_holds_is_refused():
    pytest.importorskip("pdepth._picture", reason="built without the renderer")
    for size in (1e-290, 1e200):
        with pytest.raises(pdepth.Refused) as caught:
            pdepth.picture(pdepth.Box([size] * 3), size=(32, 32))
        assert caught.value.code == "out_of_range"
    assert pdepth.picture(pdepth.Box([1e-99] * 3), size=(32, 32)).std() > 5
