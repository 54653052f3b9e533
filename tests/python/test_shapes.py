"""Shapes and poses: what they take, what they refuse, and that they can be made again."""
import copy
import pickle
import warnings
from types import SimpleNamespace

import numpy as np
import pdepth
import pytest

CUBE = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], float)
SHAPES = [
    pdepth.ConvexPolytope(CUBE), pdepth.ConvexPolytope([[0.1, 0.2, 0.3]], margin=0.25), pdepth.Box([1, 2, 3]),
    pdepth.Sphere(1 / 3), pdepth.Ellipsoid([1, 2, 3]), pdepth.Capsule(1, 2), pdepth.Cylinder(1, 2, "x"),
    pdepth.Cone(1, 2, "y"), pdepth.Compound([pdepth.Box([1, 1, 1]), (pdepth.Sphere(1), pdepth.Pose(translation=[3, 0, 0]))]),
    pdepth.Compound([(pdepth.Cone(1, 2, margin=0.1), pdepth.Pose(wxyz=[0.5, 0.5, 0.5, 0.5], translation=[0.1, 0, 0])),
                     (pdepth.Ellipsoid([0.1, 0.2, 0.3]), (np.eye(3)[[1, 2, 0]], [1 / 3, 0, 0]))], margin=0.2),
    pdepth.ConvexPolytope.from_halfspaces([[s * (k == 0), s * (k == 1), s * (k == 2), 1 / 3] for k in range(3) for s in (-1, 1)]),
    pdepth.SphereHull([[0, 0, 0, 0.5], [1, 0, 0.25, 0.1], [0, 1, 0, 0.2]], margin=0.1),
    pdepth.SphereHull(np.array([[0, 0, 1, 0.5], [1, 1, 0, 0.5]])), pdepth.Sphere(np.float32(0.1)), pdepth.Box(np.array([1, 2, 3], dtype=np.int16)),
    pdepth.StarBody([[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]], [[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]], [0, 0, 0]),
]


@pytest.mark.parametrize("shape", SHAPES, ids=lambda shape: type(shape).__name__)
def test_shapes_come_back_from_repr_pickle_copy_and_the_protocol(shape):
    assert eval(repr(shape), vars(pdepth)) == shape
    assert pickle.loads(pickle.dumps(shape)) == shape
    assert copy.copy(shape) == shape and copy.deepcopy([shape])[0] == shape
    here = pdepth.depth(shape, pdepth.Box([1, 1, 1]), pose_b=pdepth.Pose(translation=[0.5, 0, 0]))
    line = pdepth.query("depth", a=shape, b=pdepth.Box([1, 1, 1]), pose_b=pdepth.Pose(translation=[0.5, 0, 0]))
    assert (here.contact, here.depth, here.distance) == (getattr(line, "class"), line.depth, line.distance)


def test_poses_come_back_and_name_the_order_of_quaternions():
    half = np.sqrt(0.5)
    for pose in (pdepth.Pose(), pdepth.Pose(wxyz=[half, 0, 0, half], translation=[1, 2, 3]), pdepth.Pose(np.eye(4)),
                 pdepth.Pose(rotation=[[0, -1, 0], [1, 0, 0], [0, 0, 1]])):
        assert eval(repr(pose), vars(pdepth)) == pose
        assert pickle.loads(pickle.dumps(pose)) == pose
        assert np.array_equal(pdepth.Pose(pose.matrix).matrix, pose.matrix)
    assert pdepth.Pose(wxyz=[half, 0, 0, half]) == pdepth.Pose(xyzw=[0, 0, half, half])
    turned = pdepth.Pose(wxyz=[half, 0, 0, half]).rotation @ [1, 0, 0]
    assert np.allclose(turned, [0, 1, 0])


def test_polytopes_from_faces_halfspaces_and_meshes(tmp_path):
    faces = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    assert len(pdepth.ConvexPolytope.from_faces(CUBE, faces).facets) == 6
    planes = [[s * (k == 0), s * (k == 1), s * (k == 2), 1] for k in range(3) for s in (-1, 1)]
    assert np.array_equal(pdepth.ConvexPolytope.from_halfspaces(planes).vertices, CUBE)
    triangles = np.array([f[:3] for f in faces] + [[f[0], f[2], f[3]] for f in faces])
    mesh = SimpleNamespace(vertices=np.vstack([CUBE, [[9, 9, 9]]]), faces=triangles)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert np.array_equal(pdepth.ConvexPolytope.from_mesh(mesh).vertices, CUBE)
    mesh.faces = triangles[1:]  # of an object, too, the hull is told
    with pytest.warns(UserWarning, match="mesh: the mesh has holes, so that the shape is its convex hull") as told:
        assert np.array_equal(pdepth.ConvexPolytope.from_mesh(mesh).vertices, CUBE)
    assert told[0].filename == __file__
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        pdepth.ConvexPolytope.from_mesh(mesh, hull=True)
    file = tmp_path / "cube.obj"
    lines = [f"v {x} {y} {z}" for x, y, z in CUBE] + ["f " + " ".join(str(i + 1) for i in f) for f in faces]
    file.write_text("\n".join(lines) + "\n")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert np.array_equal(pdepth.ConvexPolytope.from_mesh(file).vertices, CUBE)
    file.write_text("\n".join(lines[:-1]) + "\n")  # without its last face
    with pytest.warns(UserWarning, match="cube.obj: the mesh has holes, so that the shape is its convex hull"):
        assert np.array_equal(pdepth.ConvexPolytope.from_mesh(file).vertices, CUBE)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        pdepth.ConvexPolytope.from_mesh(file, hull=True)


def box_lines(low, high, before):
    corners = [[(low, high)[k >> i & 1][i] for i in range(3)] for k in range(8)]
    faces = [[1, 3, 4, 2], [5, 6, 8, 7], [1, 2, 6, 5], [3, 7, 8, 4], [1, 5, 7, 3], [2, 4, 8, 6]]
    return [f"v {x} {y} {z}" for x, y, z in corners] + ["f " + " ".join(str(before + v) for v in f) for f in faces]


def test_compounds_of_meshes(tmp_path):
    # An L of two boxes: as groups of a file they abut, as one prism they are a solid.
    groups = tmp_path / "groups.obj"
    lines = ["o foot", *box_lines((0, 0, 0), (2, 1, 1), 0), "g leg", *box_lines((0, 1, 0), (1, 2, 1), 8)]
    groups.write_text("\n".join(lines) + "\n")
    base = [(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)]
    vertices = np.array([(x, y, z) for z in (0, 1) for x, y in base], float)
    sides = [[i, (i + 1) % 6, 6 + (i + 1) % 6, 6 + i] for i in range(6)]
    prism = SimpleNamespace(vertices=vertices, faces=[[5, 4, 3, 2, 1, 0], [6, 7, 8, 9, 10, 11], *sides])
    cube = pdepth.Box([0.5, 0.5, 0.5])
    notch, deep = pdepth.Pose(translation=[1.75, 1.75, 0.5]), pdepth.Pose(translation=[0.5, 1.0, 0.5])
    for compound, reached in ((pdepth.Compound.from_mesh(groups), None), (pdepth.Compound.from_mesh(prism), None),
                              (pdepth.Compound.from_mesh(prism, error=1e-6), 1e-6),
                              (pdepth.Compound.from_mesh(prism, error=1e-6, side="inner"), 1e-6)):
        assert (compound.error is None) == (reached is None) and (reached is None or 0 <= compound.error <= reached)
        assert pdepth.depth(compound, cube, pose_b=notch).distance == pytest.approx(0.25, abs=1e-6)
        assert pdepth.depth(compound, cube, pose_b=deep).depth == pytest.approx(1, abs=1e-5)
        assert eval(repr(compound), vars(pdepth)) == compound
    one = pdepth.Compound.from_mesh(prism, error=1.0, margin=0.25)
    assert len(one._arguments["parts"]) == 1 and one.margin == 0.25
    # The hull reaches the middle of the notch's diagonal, which lies 0.5 from both of the notch's faces.
    assert 0.5 <= one.error < 0.51
    groups.write_text("\n".join(lines[:-1]) + "\n")
    with pytest.raises(pdepth.Refused, match="groups.obj.*leg") as refused:
        pdepth.Compound.from_mesh(groups)
    assert refused.value.code == "open_edge"
    inside_out = SimpleNamespace(vertices=vertices, faces=[face[::-1] for face in prism.faces])
    with pytest.raises(pdepth.Refused, match="turn_faces=True") as refused:
        pdepth.Compound.from_mesh(inside_out, error=0.1)
    assert refused.value.code == "inside_out"
    assert pdepth.Compound.from_mesh(inside_out, error=0.1, turn_faces=True).error < 0.1


BAD = [
    (lambda: pdepth.SphereHull([[0, 0, 0, 1], [1, 0, 0, -1]]), "spheres[1]", "bad_value", "-1"),
    (lambda: pdepth.ConvexPolytope(CUBE.T), "points", "bad_value", "transposed"),
    (lambda: pdepth.ConvexPolytope(np.zeros((0, 3))), "points", "too_few_points", ""),
    (lambda: pdepth.ConvexPolytope(np.vstack([CUBE, [[0, np.nan, 0]]])), "points[8]", "non_finite", ""),
    (lambda: pdepth.ConvexPolytope(CUBE.astype(complex)), "points", "bad_value", "complex128"),
    (lambda: pdepth.ConvexPolytope(CUBE > 0), "points", "bad_value", "bool"),
    (lambda: pdepth.ConvexPolytope([[1, 2, 3], [4, 5]]), "points", "bad_value", ""),
    (lambda: pdepth.ConvexPolytope(np.full((1, 3), 2**60 + 1)), "points.flat[0]", "bad_value", "2^53"),
    (lambda: pdepth.Box([1, 0, 1]), "half_extents[1]", "bad_value", ""),
    (lambda: pdepth.Sphere(-1), "radius", "bad_value", ""),
    (lambda: pdepth.Sphere(np.inf), "radius", "non_finite", ""),
    (lambda: pdepth.Capsule(1, 1, "w"), "axis", "bad_value", "'x', 'y' or 'z'"),
    (lambda: pdepth.Sphere(1, margin=-1), "margin", "bad_value", ""),
    (lambda: pdepth.Compound([]), "parts", "too_few_points", ""),
    (lambda: pdepth.Compound([(pdepth.Sphere(1), np.diag([1, 1, -1, 1]))]), "parts[0].pose", "not_a_rotation", "reflection"),
    (lambda: pdepth.ConvexPolytope.from_mesh("no/such.obj"), "no/such.obj", "unreadable_file", ""),
    (lambda: pdepth.ConvexPolytope.from_mesh(3), "mesh", "bad_value", "int"),
    (lambda: pdepth.Compound.from_mesh("no/such.obj", error=1), "no/such.obj", "unreadable_file", ""),
    (lambda: pdepth.Compound.from_mesh(3), "mesh", "bad_value", "int"),
    (lambda: pdepth.Compound.from_mesh(SimpleNamespace(vertices=CUBE, faces=[[0, 1, 8]])), "mesh.faces[0]", "out_of_range", ""),
    (lambda: pdepth.Compound.from_mesh(SimpleNamespace(vertices=CUBE, faces=[]), error=1), "mesh", "bad_faces", ""),
    (lambda: pdepth.Compound.from_mesh(SimpleNamespace(vertices=CUBE * np.nan, faces=[[0, 1, 2]])), "mesh", "non_finite", ""),
    (lambda: pdepth.Compound.from_mesh("no/such.obj", error=-1), "error", "bad_value", "greater than 0"),
    (lambda: pdepth.Compound.from_mesh("no/such.obj", error=np.nan), "error", "bad_value", ""),
    (lambda: pdepth.Compound.from_mesh("no/such.obj", side="left"), "side", "bad_value", "left"),
    (lambda: pdepth.ConvexPolytope.from_mesh(SimpleNamespace(vertices=CUBE, faces=np.array([[0, 1, 2], [1, 2, 8]]))),
     "mesh.faces[1]", "out_of_range", "0 to 7"),
    (lambda: pdepth.ConvexPolytope.from_mesh(SimpleNamespace(vertices=CUBE, faces=np.eye(3))), "mesh.faces", "bad_value",
     "float64"),
    (lambda: pdepth.ConvexPolytope.from_halfspaces([[1, 0, 0, 1]] * 4), "planes", "unbounded", ""),
    (lambda: pdepth.Pose(wxyz=[0, 0, 0, 0]), "wxyz", "bad_value", ""),
    (lambda: pdepth.Pose(wxyz=[1, 0, 0]), "wxyz", "bad_value", "needs [4]"),
    (lambda: pdepth.Pose(wxyz=[1, 0, 0, 0], xyzw=[0, 0, 0, 1]), "Pose", "bad_value", "one of"),
    (lambda: pdepth.Pose(pdepth.Pose(translation=[1, 2, 3]).matrix.T), "matrix", "bad_value", "transposed"),
    (lambda: pdepth.Pose(rotation=2 * np.eye(3)), "rotation", "not_a_rotation", ""),
    (lambda: pdepth.ConvexPolytope.from_faces(CUBE, [[0, 1, 3], [4, 6.5, 7]]), "faces[1]", "bad_faces", "not 6.5"),
    (lambda: pdepth.ConvexPolytope.from_faces(CUBE, [[0, "1", 3]]), "faces[0]", "bad_faces", "not '1'"),
    (lambda: pdepth.ConvexPolytope.from_faces(CUBE, [[0, True, 3]]), "faces[0]", "bad_faces", "not True"),
    (lambda: pdepth.ConvexPolytope.from_faces(CUBE, [[0, np.nan, 3]]), "faces[0]", "bad_faces", "not nan"),
    (lambda: pdepth.ConvexPolytope.from_faces(CUBE, None), "faces", "bad_value", "a list of faces"),
    (lambda: pdepth.Sheet(CUBE, [[0, 1, 2.7]]), "faces[0]", "bad_faces", "not 2.7"),
    (lambda: pdepth.StarBody(CUBE, [[0, 1, 2.7]], [0, 0, 0]), "faces[0]", "bad_faces", "not 2.7"),
    (lambda: pdepth.Compound.from_mesh(SimpleNamespace(vertices=CUBE, faces=[[0, 1, 2.7]])), "mesh.faces[0]", "bad_faces", ""),
]


@pytest.mark.parametrize("make, where, code, hint", BAD, ids=[f"{w}-{c}-{i}" for i, (_, w, c, _) in enumerate(BAD)])
def test_bad_input_says_which_argument_and_what_would_be_right(make, where, code, hint):
    with pytest.raises(ValueError) as caught:
        make()
    assert (caught.value.where, caught.value.code) == (where, code)
    assert hint in str(caught.value)


def test_the_numbers_of_a_shape_cannot_be_set():
    for shape, name in ((pdepth.Sphere(1), "radius"), (pdepth.Box([1, 1, 1], margin=0.5), "margin"),
                        (pdepth.ConvexPolytope(CUBE), "points"), (pdepth.Compound([pdepth.Sphere(1)]), "parts"),
                        (pdepth.Sheet(CUBE, [[0, 1, 2]]), "faces")):
        before = repr(shape)
        with pytest.raises(AttributeError):
            setattr(shape, name, 2.0)
        shape.label = "a name of the caller's"
        assert repr(shape) == before and shape.label


def test_faces_of_whole_numbers_in_any_form():
    faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]]
    signs = np.linalg.det(CUBE[[1, 2, 4]] - CUBE[0])
    faces = faces if signs > 0 else [face[::-1] for face in faces]
    for form in (faces, np.array(faces), np.array(faces, dtype=float), np.array(faces, dtype=np.uint8), [tuple(f) for f in faces]):
        assert len(pdepth.ConvexPolytope.from_faces(CUBE[[0, 1, 2, 4]], form).facets) == 4


def test_strided_and_narrow_arrays_mean_the_same_numbers():
    wide = np.zeros((8, 6))
    wide[:, ::2] = CUBE
    for points in (wide[:, ::2], np.asfortranarray(CUBE), CUBE.astype(np.float32), CUBE.astype(int), CUBE.astype(">f8"),
                   CUBE.tolist()):
        assert np.array_equal(pdepth.ConvexPolytope(points).vertices, CUBE)


def test_a_missing_file_is_named_once(tmp_path):
    with pytest.raises(pdepth.Refused) as refused:
        pdepth.ConvexPolytope.from_mesh(tmp_path / "none.obj")
    assert str(refused.value) == f"{tmp_path / 'none.obj'}: there is no such file (unreadable_file)"
