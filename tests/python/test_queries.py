"""Queries of pairs: against formulas, against each other, and one by one against a batch."""
import copy
import itertools
import pickle

import numpy as np
import pdepth
import pytest

BOX = pdepth.Box([1, 1, 1])
GEM = pdepth.ConvexPolytope(np.random.default_rng(0).normal(size=(40, 3)))


def at(x, y, z):
    return pdepth.Pose(translation=[x, y, z])


def test_a_box_and_a_ball():
    found = pdepth.depth(BOX, pdepth.Sphere(1.0), pose_b=at(1.5, 0, 0))
    assert (found.contact, found.depth, found.lower, found.upper) == ("overlapping", 0.5, 0.5, 0.5)
    assert found.translation.tolist() == [-0.5, 0, 0] and found.normal.tolist() == [-1, 0, 0]
    assert found.feature_a == ("facet", (1, 3, 7, 5)) and found.feature_b == ("vertex", (0,))
    apart = pdepth.depth(BOX, BOX, pose_b=at(5, 0, 0))
    assert (apart.contact, apart.distance, apart.signed_depth) == ("separated", 3, -3)
    assert pdepth.intersects(BOX, BOX, pose_b=at(2, 0, 0)) and not pdepth.intersects(BOX, BOX, pose_b=at(2.5, 0, 0))


def test_every_way_to_give_a_pose():
    half = np.sqrt(0.5)
    matrix = np.eye(4)
    matrix[:3, 3] = [1.5, 0, 0]
    for pose in (matrix, matrix.tolist(), np.asfortranarray(matrix), (np.eye(3), [1.5, 0, 0]), at(1.5, 0, 0)):
        assert pdepth.depth(BOX, BOX, pose_b=pose).depth == 0.5
    turned = pdepth.Pose(xyzw=[0, 0, half, half], translation=[1.5, 0, 0])
    assert abs(pdepth.depth(BOX, BOX, pose_b=turned).depth - 0.5) < 1e-15


def test_the_translation_separates_and_the_law_of_swapping_holds(poses):
    for pose in poses(50, 1.5):
        one, other = pdepth.depth(GEM, BOX, pose), pdepth.depth(BOX, GEM, pose_b=pose)
        assert one.signed_depth == other.signed_depth and np.array_equal(one.normal, -other.normal)
        moved = pose.copy()
        moved[:3, 3] += one.translation * (1 + 1e-12)
        assert pdepth.depth(GEM, BOX, moved).depth < 1e-12


def test_a_batch_is_its_pairs_for_any_number_of_threads(poses):
    shapes = [GEM, BOX, pdepth.Sphere(0.5), pdepth.Compound([BOX, (BOX, at(2, 0, 0))])]
    a, b = [shapes[i % 4] for i in range(64)], [shapes[i // 4 % 2] for i in range(64)]
    matrices = poses(64, 2)
    found = pdepth.depth(a, b, matrices)
    for name in found:
        assert np.array_equal(found[name], pdepth.depth(a, b, matrices, threads=3)[name], equal_nan=True)
    for i in range(64):
        alone = pdepth.depth(a[i], b[i], matrices[i])
        assert pdepth.CONTACTS[found.contact[i]] == alone.contact
        for name in ("depth", "lower", "upper", "distance", "translation", "normal", "witness_a", "witness_b"):
            assert np.array_equal(found[name][i], getattr(alone, name)), name


def test_bad_rows_are_errors_of_their_own(poses):
    matrices = poses(6)
    matrices[1, 0, 0] = np.nan
    matrices[2, :3, :3] *= -1
    matrices[3] = matrices[3].T
    matrices[4, 0, 3] = 1e301
    found = pdepth.depth(GEM, BOX, matrices)
    assert [pdepth.ERRORS[code] for code in found.error] == ["", "non_finite", "not_a_rotation", "bad_value", "out_of_range", ""]
    assert np.isnan(found.depth[1:5]).all() and not np.isnan(found.depth[[0, 5]]).any()


@pytest.mark.parametrize("call, where", [
    (lambda p: pdepth.depth(GEM, BOX, p[:, :3]), "pose_a"),
    (lambda p: pdepth.depth(GEM, BOX, p.astype(complex)), "pose_a"),
    (lambda p: pdepth.depth(GEM, BOX, p.astype(object)), "pose_a"),
    (lambda p: pdepth.depth(GEM, BOX, None, np.zeros((4, 4, 7))), "pose_b"),
    (lambda p: pdepth.depth(GEM, BOX, pose_b=[1.0, 2.0, 3.0]), "pose_b"),
    (lambda p: pdepth.depth(GEM, BOX, pose_b=[np.eye(3), [1, 0, 0]]), "pose_b"),
    (lambda p: pdepth.depth(GEM, BOX, [None, np.diag([1, 1, -1, 1])]), "pose_a[1]"),
    (lambda p: pdepth.depth(GEM, BOX, np.diag([1, 1, -1, 1])), "pose_a"),
    (lambda p: pdepth.depth(GEM, BOX, p[0].T), "pose_a"),
    (lambda p: pdepth.depth(GEM, BOX, p[0].astype(bool)), "pose_a"),
    (lambda p: pdepth.depth(3, BOX), "a"),
    (lambda p: pdepth.depth(GEM, "box"), "b"),
    (lambda p: pdepth.depth(GEM, BOX, beyond=-1), "beyond"),
    (lambda p: pdepth.depth(GEM, BOX, beyond=np.nan), "beyond"),
    (lambda p: pdepth.depth(GEM, BOX, p, beyond="far"), "beyond"),
    (lambda p: pdepth.contact_manifold(GEM, BOX, breaking_threshold=np.nan), "breaking_threshold"),
    (lambda p: pdepth.derivatives(pdepth.Compound([BOX]), BOX), "a"),
    (lambda p: pdepth.time_of_impact(GEM, BOX, velocity_b=[0, np.nan, 0]), "velocity_b[1]"),
    (lambda p: pdepth.query("depth", a=GEM, b=BOX, pose_b={"translation": [0, 0, np.inf]}), "pose_b.translation[2]"),
    (lambda p: pdepth.polygon_depth([[0, 0], [1, np.nan], [0, 1]], [[0, 0], [1, 0], [0, 1]]), "p.outer[1][1]"),
    (lambda p: pdepth.polygon_depth(np.zeros((2, 5)), [[0, 0], [1, 0], [0, 1]]), "p"),
    (lambda p: pdepth.depth(GEM, BOX, p, p[:2]), "pairs"),
    (lambda p: pdepth.depth([GEM, 3], BOX), "a[1]"),
    (lambda p: pdepth.depth(GEM, BOX, threads=0, pose_a=p), "threads"),
    (lambda p: pdepth.depth(GEM, BOX, p, warm=True, axis=1), "axis"),
    (lambda p: pdepth.depth(GEM, BOX, delta=2), "delta"),
    (lambda p: pdepth.depth(GEM, BOX, method="best"), "method"),
    (lambda p: pdepth.directional_depth(GEM, BOX, [0, 0, 0]), "direction"),
    (lambda p: pdepth.directional_depth(GEM, BOX, [0, 0]), "direction"),
    (lambda p: pdepth.depth(GEM, BOX, np.full((4, 4), np.nan)), "pose_a[0, 0]"),
    (lambda p: pdepth.depth(GEM, BOX, threads=-1), "threads"),
    (lambda p: pdepth.depth(GEM, BOX, threads="all"), "threads"),
    (lambda p: pdepth.depth(GEM, BOX, axis=3), "axis"),
    (lambda p: pdepth.depth(GEM, BOX, p, axis="frames"), "axis"),
    (lambda p: pdepth.depth(GEM, BOX, warm=3), "warm"),
    (lambda p: pdepth.query_many("depth", "abc"), "rows[0]"),
    (lambda p: pdepth.sweep([GEM], np.zeros((1, 2), int), None, out="unused"), "poses"),
    (lambda p: pdepth.save_picture("x.jpg", np.zeros((2, 2, 3), np.uint8)), "path"),
    (lambda p: pdepth.save_picture("x.png", np.zeros((2, 2))), "rgb"),
])
def test_bad_questions_are_refused_by_name(call, where, poses):
    with pytest.raises(pdepth.Refused) as caught:
        call(poses(4))
    assert caught.value.where == where


def test_refusals_hint_at_what_was_meant():
    for pose, hint in (([1.0, 2, 3], "Pose(translation=...)"), (np.zeros(4), "Pose(wxyz=...)"),
                       (np.zeros(7), "Pose(wxyz=..., translation=...)"), (np.zeros((4, 4, 9)), "transposed"),
                       ([np.eye(3), [1, 0, 0]], "(R, t)")):
        with pytest.raises(ValueError) as caught:
            pdepth.depth(BOX, BOX, pose_b=pose)
        assert hint in str(caught.value)
    with pytest.raises(pdepth.Refused, match="transposed"):
        pdepth.depth(BOX, BOX, at(1, 2, 3).matrix.T)


def test_lists_of_poses_in_any_form_and_empty_ones(poses):
    matrix = poses(1)[0]
    mixed = [None, at(1, 0, 0), (np.eye(3), [1, 0, 0]), matrix]
    found = pdepth.depth(GEM, BOX, mixed)
    assert found.depth.tolist() == [pdepth.depth(GEM, BOX, pose).depth for pose in mixed]
    for none in ([], np.zeros((0, 4, 4))):
        empty = pdepth.depth(GEM, BOX, none)
        assert empty.depth.shape == (0,) and empty.normal.shape == (0, 3) and len(empty) == 0
    for same in (np.asfortranarray(poses(6)), np.repeat(poses(6), 2, axis=0)[::2], poses(6).astype(">f8")):
        assert np.array_equal(pdepth.depth(GEM, BOX, same).depth, pdepth.depth(GEM, BOX, poses(6)).depth)


def test_beyond_bodies_farther_apart_are_told_apart_and_no_further(poses):
    matrices = poses(200, 6.0)
    plain, far = pdepth.depth(GEM, BOX, matrices), pdepth.depth(GEM, BOX, matrices, beyond=0.5)
    near = plain.distance <= 0.5
    assert 20 < near.sum() < 180
    for name in ("contact", "depth", "lower", "upper", "distance", "normal", "witness_a"):
        assert np.array_equal(plain[name][near], far[name][near]), name
    assert (far.contact == plain.contact).all() and (far.distance_lower[~near] > 0.5).all()
    assert (far.distance_lower <= plain.distance_upper).all() and (plain.distance_lower <= far.distance_upper).all()
    assert (far.distance_upper > plain.distance_upper)[~near].any()
    for i in range(0, 200, 10):
        assert pdepth.depth(GEM, BOX, matrices[i], beyond=0.5).distance_upper == far.distance_upper[i]
        assert pdepth.intersects(GEM, BOX, matrices[i]) == (plain.contact[i] != 0)
    assert np.array_equal(pdepth.intersects(GEM, BOX, matrices), plain.contact != 0)
    assert pdepth.depth(GEM, BOX, matrices[0], beyond=None).distance == plain.distance[0]


def test_large_unions_that_meet_are_told_without_their_depth():
    # Their depth is refused as limit_exceeded, after seconds.
    gem = pdepth.ConvexPolytope(np.random.default_rng(1).normal(size=(20, 3)) * 0.3)
    places = np.random.default_rng(2).normal(size=(250, 3)) * 1.5
    crowd = pdepth.Compound([(gem, at(*place)) for place in places])
    assert pdepth.intersects(crowd, crowd) and not pdepth.intersects(crowd, crowd, at(30, 0, 0))
    assert pdepth.intersects([crowd], crowd, [at(0.1, 0, 0), at(30, 0, 0)]).tolist() == [True, False]


def test_touching_curved_and_swept_bodies_meet(poses):
    shapes = (pdepth.Sphere(0.5), pdepth.Cylinder(0.5, 1.0), pdepth.Box([1, 1, 1], margin=0.25), GEM,
              pdepth.Compound([BOX, (pdepth.Cone(0.5, 0.5), at(2, 0, 0))]))
    for one, other in itertools.combinations_with_replacement(shapes, 2):
        found = pdepth.depth(one, other, poses(40, 4.0))
        assert np.array_equal(pdepth.intersects(one, other, poses(40, 4.0)), found.contact != 0)
    assert pdepth.intersects(BOX, pdepth.Sphere(0.5), pose_b=at(1.5, 0, 0))


def test_a_quaternion_is_no_matrix_in_a_batch():
    # R turns (0, 2wx, ww - xx) to (0, 0, ww + xx) in real arithmetic, and the matrix of doubles does not.
    w, x = 951794, 440000
    turned = pdepth.Pose(wxyz=np.array([w, x, 0, 0]) / 2.0**20)
    top = float(w * w + x * x)
    shard = pdepth.ConvexPolytope([[0, 0, 0], [2.0**30, 0, 0], [0, 2.0 * w * x, float(w * w - x * x)]])
    wide = 2.0**45
    roof = pdepth.ConvexPolytope([[-wide, -wide, top], [wide, -wide, top], [0, wide, top], [0, 0, 2 * wide]])
    assert pdepth.depth(shard, roof, turned).contact == "touching"
    assert pdepth.depth(shard, roof, pdepth.Pose(turned.matrix)).contact != "touching"
    for many in (pdepth.depth([shard] * 3, roof, turned), pdepth.depth(shard, roof, [turned, turned])):
        assert all(pdepth.CONTACTS[contact] == "touching" for contact in many.contact)
    assert np.array_equal(pdepth.hull([shard], [turned]).vertices, pdepth.hull(shard, turned).vertices)


def test_rows_of_a_batch_by_number(poses):
    found = pdepth.depth(GEM, BOX, poses(6).reshape(2, 3, 4, 4))
    assert found.of_row((1, 2))["depth"] == found.depth[1, 2] and found.of_row(0)["normal"].shape == (3, 3)
    with pytest.raises(KeyError, match="of_row"):
        found[0]


def test_an_answer_keeps_its_shapes_and_can_be_sent_to_another_process():
    answer = pdepth.depth(pdepth.Box([1, 1, 1]), pdepth.Sphere(1.0), pose_b=at(1.5, 0, 0))
    assert repr(answer.shape_a) == "Box(half_extents=[1.0, 1.0, 1.0])" and answer.shape_b == pdepth.Sphere(1.0)
    union = pdepth.depth(pdepth.Compound([BOX, (BOX, at(3, 0, 0))]), GEM, pose_b=at(3, 0, 0))
    names = [name for name in dir(pdepth.Depth) if not name.startswith("_")]
    for one in (answer, union, pdepth.derivatives(GEM, BOX).answer):
        for again in (pickle.loads(pickle.dumps(one)), copy.copy(one), copy.deepcopy(one)):
            for name in names:
                assert repr(getattr(again, name)) == repr(getattr(one, name)), name


def test_warm_rows_are_the_cold_ones_up_to_their_brackets(poses):
    path = np.tile(poses(5, 0.5)[None], (40, 1, 1, 1))
    path[:, :, 0, 3] += np.linspace(0, 0.4, 40)[:, None]
    cold, warm = pdepth.depth(GEM, BOX, path), pdepth.depth(GEM, BOX, path, warm=True)
    assert cold.depth.shape == (40, 5) and warm.warm[1:].mean() > 0.5
    assert (warm.lower <= cold.upper).all() and (cold.lower <= warm.upper).all()
    for name in warm:
        assert np.array_equal(warm[name], pdepth.depth(GEM, BOX, path, warm=True, threads=1)[name])
    turned = pdepth.depth(GEM, BOX, np.ascontiguousarray(np.moveaxis(path, 0, 1)), warm=True, axis=1)
    for name in warm:
        assert np.array_equal(np.moveaxis(turned[name], 1, 0), warm[name]), name
    with pytest.raises(pdepth.Refused, match="axis"):
        pdepth.depth(GEM, BOX, path, warm=True, axis=2)
    memory = pdepth.Warm()
    alone = [pdepth.depth(GEM, BOX, pose, warm=memory) for pose in path[:, 0]]
    assert [each.depth for each in alone] == warm.depth[:, 0].tolist() and memory.nbytes > 0


def test_the_memory_of_a_pair_of_unions():
    cross = pdepth.Compound([pdepth.Box([2, 0.5, 0.5]), pdepth.Box([0.5, 2, 0.5])])
    memory = pdepth.Warm()
    path = [pdepth.Pose(translation=[0.9 + 0.01 * i, 0.1, 0.2]) for i in range(20)]
    cold = [pdepth.depth(cross, cross, pose) for pose in path]
    warm = [pdepth.depth(cross, cross, pose, warm=memory) for pose in path]
    assert all(one.contact == "overlapping" for one in cold) and memory.nbytes > 0
    assert all(a.lower <= b.upper and b.lower <= a.upper for a, b in zip(cold, warm))
    batch = pdepth.depth(cross, cross, path, warm=True)
    assert batch.depth.tolist() == [one.depth for one in warm]
    memory.clear()
    assert pdepth.depth(cross, cross, path[0], warm=memory).depth == warm[0].depth


def test_directional_depths(poses):
    matrices = poses(30, 1.0)
    directions = np.random.default_rng(3).normal(size=(30, 3))
    found = pdepth.directional_depth(GEM, BOX, directions, matrices)
    least = pdepth.depth(GEM, BOX, matrices)
    assert (found.upper >= least.lower).all()
    for i in range(30):
        assert pdepth.directional_depth(GEM, BOX, directions[i], matrices[i]).depth == found.depth[i]
    assert pdepth.directional_depth(BOX, BOX, [0, 2, 0]).depth == 2


def test_the_other_queries():
    assert pdepth.width(pdepth.Box([3, 1, 2])).width == 2
    sums = pdepth.minkowski_difference(BOX, BOX)
    assert sums.K == 6 and np.abs(sums.vertices).max() == 2
    assert len(pdepth.hull(BOX).facets) == 6
    manifold = pdepth.contact_manifold(BOX, BOX, pose_b=at(0, 0, 1.875))
    assert manifold.depth.tolist() == [0.125] * 4 and manifold.position_a.shape == (4, 3)
    impact = pdepth.time_of_impact(BOX, BOX, pose_b=at(5, 0, 0), velocity_a=[2, 0, 0], duration=2.0)
    assert impact.hit and abs(impact.time - 1.5) < 1e-8
    square = [[0, 0], [2, 0], [2, 2], [0, 2]]
    assert pdepth.polygon_depth(square, [[1, 0.5], [3, 0.5], [3, 1.5], [1, 1.5]]).depth == 1
    assert pdepth.polygon_depth(square, {"outer": [[0, 0]], "margin": 0.5}).depth == 0.5
    kernel = pdepth.query("approx_width", a={"points": np.eye(4).tolist() + [[0, 0, 0, 0]]}, epsilon=0.1)
    assert 0 < kernel.width <= 0.5 * 1.2
    with pytest.raises(pdepth.Refused, match="unknown"):
        pdepth.query("dept", a=BOX, b=BOX)


def test_the_protocols_own_forms_of_shapes_and_poses():
    half = np.sqrt(0.5)
    forms = ({"quaternion_wxyz": [half, 0, 0, half], "translation": np.array([1.5, 0, 0])},
             pdepth.Pose(wxyz=[half, 0, 0, half], translation=[1.5, 0, 0]),
             {"rotation_row_major": [0, -1, 0, 1, 0, 0, 0, 0, 1], "translation": [1.5, 0, 0]})
    for pose in forms:
        line = pdepth.query("depth", a=BOX, b={"type": "sphere", "radius": 1}, pose_b=pose)
        assert line.depth == pdepth.query_many("depth", [{"a": BOX, "b": pdepth.Sphere(1), "pose_b": pose}]).depth[0] == 0.5
    union = {"type": "compound", "parts": [{"shape": BOX, "pose": at(3, 0, 0)}, {"shape": BOX, "pose": at(3, 0, 0).matrix}]}
    assert pdepth.query("distance", a=union, b=BOX).distance == 1
    with pytest.raises(pdepth.Refused) as caught:
        pdepth.query("depth", a=BOX, b=BOX, pose_b={"place": [1, 0, 0]})
    assert caught.value.where == "pose_b.place"


def test_manifolds_of_many_pairs(poses):
    matrices = poses(40, 1.5)
    found = pdepth.contact_manifold(GEM, BOX, matrices, breaking_threshold=0.1)
    assert found.position_a.shape == (40, 4, 3) and found["count"].max() > 1
    for i, pose in enumerate(matrices):
        alone = pdepth.contact_manifold(GEM, BOX, pose, breaking_threshold=0.1)
        k = found["count"][i]
        assert k == len(alone.depth) and np.array_equal(found.position_b[i, :k], alone.position_b)
        assert np.array_equal(found.feature_id[i, :k], alone.feature_id) and np.isnan(found.point_depth[i, k:]).all()


def turned_about_own_translation(pose, w):
    angle = np.linalg.norm(w)
    k = w / angle
    cross = np.array([[0, -k[2], k[1]], [k[2], 0, -k[0]], [-k[1], k[0], 0]])
    turned = pose.copy()
    turned[:3, :3] = (np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross) @ pose[:3, :3]
    return turned


def test_derivatives_against_central_differences(poses):
    matrices = poses(40, 1.2, seed=5)
    found = pdepth.derivatives(GEM, BOX, matrices)
    step, checked = 1e-6, 0
    for i, pose in enumerate(matrices):
        alone = pdepth.derivatives(GEM, BOX, pose)
        assert np.array_equal(alone.by_a, found.by_a[i], equal_nan=True) and alone.unique_witness == found.unique_witness[i]
        if not alone.stable_features:
            continue
        differences = np.zeros(6)
        for k in range(6):
            for sign in (1, -1):
                moved = pose.copy()
                if k < 3:
                    moved[k, 3] += sign * step
                else:
                    moved = turned_about_own_translation(pose, sign * step * np.eye(3)[k - 3])
                differences[k] += sign * pdepth.depth(GEM, BOX, moved).signed_depth / (2 * step)
        assert np.linalg.norm(differences - alone.by_a) < 1e-6 * np.linalg.norm(alone.by_a)
        checked += 1
    assert checked > 20


def test_parallel_faces_have_a_direction_and_no_witness():
    found = pdepth.derivatives(BOX, BOX, pose_b=at(0, 0, 1.9))
    assert found.unique_direction and not found.unique_witness
    assert found.by_b[:3].tolist() == [0, 0, -1] and np.isnan(found.by_b[3:]).all()
    tie = pdepth.derivatives(BOX, BOX)
    assert not tie.unique_direction and np.isnan(tie.by_a).all()


def test_the_budget_of_two_solids_is_the_callers(tmp_path):
    n = 7
    u, v = np.meshgrid(*[2 * np.pi * np.arange(n) / n] * 2, indexing="ij")
    r = 1 + 0.05 * np.sin(9 * u + 7 * v)
    points = np.stack([(3 + r * np.cos(v)) * np.cos(u), (3 + r * np.cos(v)) * np.sin(u), r * np.sin(v)], axis=-1)
    at = np.arange(1, n * n + 1).reshape(n, n)
    i, j, k = np.roll(at, -1, 0), np.roll(at, -1, 1), np.roll(at, (-1, -1), (0, 1))
    faces = np.concatenate([np.stack([at, i, k], -1).reshape(-1, 3), np.stack([at, k, j], -1).reshape(-1, 3)])
    path = tmp_path / "torus.obj"
    path.write_text("".join("v {} {} {}\n".format(*p) for p in points.reshape(-1, 3)) +
                    "".join("f {} {} {}\n".format(*f) for f in faces))
    mesh = {"type": "mesh", "path": str(path)}
    found = pdepth.query("depth", a=mesh, b=mesh, pose_b=pdepth.Pose(translation=[2.4, 0, 0]), max_points=2000)
    assert found.bracket_reached is False and found.stats["points"] < 4000
    assert 0 <= found.lower < found.upper
    with pytest.raises(pdepth.Refused) as refused:
        pdepth.query("depth", a=mesh, b=mesh, max_points=0)
    assert (refused.value.code, refused.value.where) == ("bad_value", "max_points")
