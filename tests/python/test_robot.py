"""Robots: files, forward kinematics, signed distances with derivatives, and everything that is refused."""
import pickle
import warnings

import numpy as np
import pdepth
import pytest

TETRA = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"


def shape(inside, origin=""):
    return f"<collision>{origin}<geometry>{inside}</geometry></collision>"


def joint(name, kind, parent, child, inside=""):
    return f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>{inside}</joint>'


ARM = f"""<?xml version="1.0"?>
<robot name="arm">
  <link name="base">{shape('<box size="0.6 0.6 0.2"/>')}</link>
  <link name="column">{shape('<cylinder radius="0.1" length="0.5"/>', '<origin xyz="0 0 0.25"/>')}</link>
  <link name="upper">{shape('<capsule radius="0.08" length="0.6"/>', '<origin xyz="0.4 0 0" rpy="0 1.5707963267948966 0"/>')}</link>
  <link name="fore">{shape('<box size="0.5 0.1 0.1"/>', '<origin xyz="0.3 0 0"/>')}
    {shape('<box size="0.2 0.2 0.2"/>', '<origin xyz="0.6 0 0"/>')}</link>
  <link name="wrist"/>
  <link name="hand">{shape('<mesh filename="package://parts/tetra.obj" scale="0.2 0.2 -0.3"/>')}</link>
  <link name="left">{shape('<box size="0.1 0.08 0.2"/>', '<origin xyz="0 0.1 0.1" rpy="0.1 0.2 0.3"/>')}</link>
  {joint("yaw", "continuous", "base", "column", '<origin xyz="0 0 0.1"/><axis xyz="0 0 2"/>')}
  {joint("shoulder", "revolute", "column", "upper",
         '<origin xyz="0 0 0.5"/><axis xyz="0 1 0"/><limit lower="-2" upper="1.5" effort="1" velocity="1"/>')}
  {joint("elbow", "revolute", "upper", "fore", '<origin xyz="0.8 0 0"/><axis xyz="0 1 0"/><limit lower="-2.5" upper="2.5"/>')}
  {joint("roll", "fixed", "fore", "wrist", '<origin xyz="0.7 0 0" rpy="0.3 -0.2 1"/><axis xyz="0 0 0"/>')}
  {joint("slide", "prismatic", "wrist", "hand", '<origin rpy="0 0.5 0"/><axis xyz="0 0 1"/><limit lower="0" upper="0.2"/>')}
  {joint("grip", "prismatic", "hand", "left",
         '<axis xyz="0 1 0"/><mimic joint="slide" multiplier="-0.5" offset="0.05"/><limit lower="0" upper="0.2"/>')}
</robot>
"""
SRDF = """<robot name="arm"><disable_collisions link1="fore" link2="column" reason="Never"/>
<disable_default_collisions link="left"/><enable_collisions link1="left" link2="base"/></robot>"""


@pytest.fixture
def read(tmp_path):
    """read(text, name="arm.urdf", **options): a Robot from a file whose packages lie in tmp_path / "packages"."""
    (tmp_path / "packages" / "parts").mkdir(parents=True)
    (tmp_path / "packages" / "parts" / "tetra.obj").write_text(TETRA)

    def make(text, **options):
        (tmp_path / "arm.urdf").write_text(text)
        return pdepth.Robot.from_urdf(tmp_path / "arm.urdf", **{"package_roots": tmp_path / "packages", **options})
    return make


def vectors(robot, n=40, seed=3):
    low, high = np.clip(robot.limits, -3, 3).T
    return np.random.default_rng(seed).uniform(low, high, (n, robot.dof))


def rotation(axis, angle):
    """Rodrigues' formula."""
    x, y, z = axis
    skew = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * skew + (1 - np.cos(angle)) * skew @ skew


def move(xyz=(0, 0, 0), turn=np.eye(3)):
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = turn, xyz
    return matrix


X, Y, Z = np.eye(3)


def test_poses_are_those_of_the_closed_form(read):
    robot = read(ARM)
    assert robot.coordinates == ("yaw", "shoulder", "elbow", "slide") and robot.dof == 4
    assert robot.limits.tolist() == [[-np.inf, np.inf], [-2, 1.5], [-2.5, 2.5], [0, 0.2]]
    q = vectors(robot)
    found = robot.poses(q)
    assert found.shape == (40, 7, 4, 4)
    for i, (yaw, shoulder, elbow, slide) in enumerate(q):
        at = {name: found[i, k] for k, name in enumerate(robot.links)}
        column = move((0, 0, 0.1), rotation(Z, yaw))
        upper = column @ move((0, 0, 0.5), rotation(Y, shoulder))
        reach = 0.8 * np.cos(shoulder)
        assert np.allclose(at["fore"][:3, 3], [reach * np.cos(yaw), reach * np.sin(yaw), 0.6 - 0.8 * np.sin(shoulder)], atol=1e-14)
        fore = upper @ move((0.8, 0, 0), rotation(Y, elbow))
        wrist = fore @ move((0.7, 0, 0), rotation(Z, 1) @ rotation(Y, -0.2) @ rotation(X, 0.3))
        hand = wrist @ move(turn=rotation(Y, 0.5)) @ move((0, 0, slide))
        left = hand @ move((0, 0.05 - 0.5 * slide, 0))
        for name, matrix in dict(column=column, upper=upper, fore=fore, wrist=wrist, hand=hand, left=left).items():
            assert np.allclose(at[name], matrix, rtol=0, atol=1e-14), name
    assert np.array_equal(robot.poses(q[7]), found[7])
    assert np.array_equal(robot.poses(q.reshape(4, 10, 4))[1, 3], found[13])


def test_planar_and_floating_joints_and_their_derivatives(read):
    robot = read(f"""<robot name="r"><link name="a">{shape('<box size="1 1 1"/>')}</link><link name="none"/>
      <link name="b">{shape('<drake:ellipsoid a="0.2" b="0.1" c="0.15"/>', '<origin xyz="0.5 0.1 0"/>')}</link>
      <link name="c">{shape('<cylinder radius="0.2" length="1"/>', '<origin xyz="0.1 0.7 0.3"/>')}</link>
      {joint("sheet", "planar", "a", "b", '<origin xyz="0 0 2" rpy="0.1 0.2 0.3"/><axis xyz="1 2 2"/>')}
      {joint("air", "floating", "none", "c", '<origin xyz="0 2 0"/>')}{joint("weld", "fixed", "a", "none")}</robot>""")
    assert robot.coordinates == ("sheet.x", "sheet.y", "sheet.angle", "air.x", "air.y", "air.z", "air.rx", "air.ry", "air.rz")
    q = np.random.default_rng(5).uniform(-1, 1, (30, 9))
    q[0, 6:] = 0
    q[1, 6:] = [1e-9, -1e-3, 1e-9]
    found, n = robot.poses(q), np.array([1, 2, 2]) / 3
    for i, row in enumerate(q):
        c, vector = found[i, 3], row[6:]
        angle = np.linalg.norm(vector)
        turn = rotation(vector / angle, angle) if angle else np.eye(3)
        assert np.allclose(c, move(np.array([0, 2, 0]) + row[3:6], turn), rtol=0, atol=1e-14)
        start = move((0, 0, 2), rotation(Z, 0.3) @ rotation(Y, 0.2) @ rotation(X, 0.1))
        inside = np.linalg.inv(start) @ found[i, 2]
        assert abs(inside[:3, 3] @ n) < 1e-14 and np.isclose(np.linalg.norm(inside[:3, 3]), np.hypot(*row[:2]))
        assert np.allclose(inside[:3, :3], rotation(n, row[2]), atol=1e-14)
    assert robot.pairs == (("b", "c"),)  # c hangs on a by a link without a shape
    check_derivatives(robot, q, pairs=[("a", "b"), ("c", "a"), ("b", "c")])


def check_derivatives(robot, q, step=1e-6, **options):
    found = robot.distances(q, derivatives=True, **options)
    assert found.by_q.shape == (*found.signed_distance.shape, robot.dof) and not found.error.any()
    pieces = []
    for k in range(robot.dof):
        moved = np.eye(robot.dof)[k] * step
        ahead, back = (robot.distances(q + sign * moved, derivatives=True, **options) for sign in (1, -1))
        pieces.append((ahead.signed_distance - back.signed_distance) / (2 * step))
    far = np.abs(np.stack(pieces, axis=-1) - found.by_q).max(axis=-1)
    assert far[found.unique].max() < 2e-4 and found.unique.mean() > 0.5
    assert np.median(far) < 1e-6
    return far, found


def test_derivatives_agree_with_differences(read):
    robot = read(ARM)
    far, found = check_derivatives(robot, vectors(robot, 60))
    compound = np.array([("fore" in pair) for pair in robot.pairs])
    curved = np.array([("column" in pair) for pair in robot.pairs])
    assert not found.unique[:, compound].any() and np.quantile(far[:, compound & ~curved], 0.9) < 1e-4
    # The distance of a cylinder is known to 1e-6, so that its differences over a step of 1e-6 tell something in the mean.
    assert np.median(far[:, compound & curved]) < 1e-4
    assert (found.signed_distance < 0).any() and (found.signed_distance > 0).any()
    assert np.allclose(found.signed_distance, robot.distances(vectors(robot, 60)).signed_distance, rtol=1e-5, atol=1e-7)


def test_distances_are_those_of_single_pairs(read):
    robot = read(ARM)
    q = vectors(robot, 12)
    found, tight, poses = robot.distances(q), robot.distances(q, bracket="tightest"), robot.poses(q)
    assert found.signed_distance.shape == (12, len(robot.pairs)) and found.normal.shape == (12, len(robot.pairs), 3)
    for i in range(len(q)):
        for k, names in enumerate(robot.pairs):
            a, b = (robot.shape(name) for name in names)
            one = pdepth.depth(a, b, *(poses[i, robot.links.index(name)] for name in names))
            distance = pdepth.distance(a, b, *(poses[i, robot.links.index(name)] for name in names))
            # Both brackets are 1e-6 wide at most, with curved links.
            assert np.isclose(max(found.signed_distance[i, k], 0), distance, rtol=1e-6, atol=1e-9)
            signed = one.distance if one.contact == "separated" else -one.depth
            assert np.isclose(found.signed_distance[i, k], signed, rtol=2e-6, atol=1e-9)
            assert found.lower[i, k] - 1e-12 <= signed <= found.upper[i, k] + 1e-6 * abs(signed)
            assert np.isclose(tight.signed_distance[i, k], signed, rtol=2e-6, atol=1e-12)
            assert found.lower[i, k] <= tight.upper[i, k] + 1e-12
            assert found.upper[i, k] >= found.signed_distance[i, k] >= found.lower[i, k]


def test_the_nearest_pair_is_that_of_all_and_threads_change_no_bit(read, monkeypatch):
    robot = read(ARM)
    q = vectors(robot, 200)
    everything = robot.distances(q, threads=1)
    for options in ({}, {"derivatives": True}):
        nearest = robot.distances(q, nearest=True, threads=2, **options)
        assert np.array_equal(nearest.pair, everything.signed_distance.argmin(axis=1))
        if not options:
            assert np.array_equal(nearest.signed_distance, everything.signed_distance.min(axis=1))
            assert np.array_equal(nearest.witness_a, everything.witness_a[np.arange(200), nearest.pair])
    again = pickle.loads(pickle.dumps(robot)).distances(q.reshape(20, 10, 4), threads=2)
    assert np.array_equal(again.signed_distance.reshape(200, -1), everything.signed_distance)
    monkeypatch.setattr("pdepth._robot._AT_ONCE", 64)
    pieces = robot.distances(q, nearest=True, derivatives=True)
    assert np.array_equal(pieces.by_q, nearest.by_q) and np.array_equal(pieces.pair, nearest.pair)
    one = robot.distances(q[3], nearest=True)
    assert one.signed_distance.shape == () and one.of_row(())["pair"] == nearest.pair[3]
    assert robot.distances(np.zeros((0, 4))).signed_distance.shape == (0, len(robot.pairs))


def test_a_warm_path_has_the_answers_of_the_cold_one_on_any_number_of_threads(read, monkeypatch):
    robot = read(ARM)
    begin, end = vectors(robot, 2)
    path = np.stack([np.linspace(begin, end, 150), np.linspace(end, begin, 150)])  # two paths of 150 steps
    seen = []
    ask = pdepth._core.depth_rows
    monkeypatch.setattr(pdepth._core, "depth_rows", lambda *given: seen.append(given[6].tolist()) or ask(*given))
    cold, warm = robot.distances(path), robot.distances(path, warm=True)
    pairs = len(robot.pairs)
    assert seen == [[]] * pairs + [[0, 64, 128, 150, 214, 278]] * pairs
    assert warm.signed_distance.shape == (2, 150, pairs)
    assert (warm.lower <= cold.upper).all() and (cold.lower <= warm.upper).all()
    assert np.abs(warm.signed_distance - cold.signed_distance).max() < 1e-5
    one = robot.distances(path, warm=True, threads=1)
    for name in warm:
        assert np.array_equal(warm[name], one[name]), name
    nearest, best = robot.distances(path, nearest=True, warm=True), cold.signed_distance.min(axis=-1)
    assert np.abs(nearest.signed_distance - best).max() < 1e-5
    monkeypatch.setattr(pdepth._robot, "_AT_ONCE", 100)  # pieces are stretches of their own
    pieces = robot.distances(path, warm=True)
    assert (pieces.lower <= cold.upper).all() and (cold.lower <= pieces.upper).all()


def test_adjacent_links_and_those_of_an_srdf_are_left_out(read, tmp_path):
    robot = read(ARM)
    everything = {frozenset(pair) for pair in robot.pairs}
    shaped = [name for name in robot.links if robot.shape(name) is not None]
    assert shaped == ["base", "column", "upper", "fore", "hand", "left"]
    apart = [("base", "column"), ("column", "upper"), ("upper", "fore"), ("fore", "hand"), ("hand", "left")]  # "wrist" has none
    assert everything == {frozenset((a, b)) for a in shaped for b in shaped if a != b} - {frozenset(pair) for pair in apart}
    (tmp_path / "arm.srdf").write_text(SRDF)
    fewer = {frozenset(pair) for pair in read(ARM, srdf=tmp_path / "arm.srdf").pairs}
    gone = {frozenset(("fore", "column"))} | {pair for pair in everything if "left" in pair and "base" not in pair}
    assert fewer == everything - gone
    (tmp_path / "arm.srdf").write_text(SRDF.replace('link2="column"', 'link2="colum"'))
    with pytest.raises(pdepth.Refused, match="'colum', which the robot 'arm' has not") as caught:
        read(ARM, srdf=tmp_path / "arm.srdf")
    assert caught.value.where == "arm.srdf line 1"


def test_joint_vectors_that_are_not_finite_are_refused_by_row(read):
    robot = read(ARM)
    q = vectors(robot, 5)
    q[2, 1] = np.nan
    found = robot.distances(q, derivatives=True)
    assert [pdepth.ERRORS[code] for code in found.error[:, 0]] == ["", "", "non_finite", "", ""]
    assert np.isnan(found.signed_distance[2]).all() and np.isnan(found.by_q[2]).all() and not found.unique[2].any()
    assert np.isfinite(found.signed_distance[[0, 1, 3, 4]]).all()
    assert robot.distances(q, nearest=True).error.tolist() == [0, 0, 2, 0, 0]
    q[2, 1] = 0
    q[3, 3], q[4, 3] = 1e200, 1e308  # the hand is beyond any distance that has a square
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        far = robot.distances(q, derivatives=True)
        robot.distances(q, nearest=True)
    assert not np.isnan(far.signed_distance[far.error == 0]).any()
    for ask in (robot.poses, robot.distances):
        with pytest.raises(pdepth.Refused) as caught:
            ask([0, np.inf, 0, 0])
        assert (caught.value.code, caught.value.where) == ("non_finite", "q[1]")


ODD = f'<robot name="r"><link name="a">{shape("<box size=&quot;1 1 1&quot;/>")}</link>'.replace("&quot;", '"')


NO_ROBOTS = [
    (ARM.replace('"0.6 0.6 0.2"', '"0.6 0.6"'), "bad_value", "arm.urdf line 3: size of <box> must be 3 numbers"),
    (ARM.replace('"0.6 0.6 0.2"', '"0.6, 0.6, 0.2"'), "bad_value", "must be numbers with blanks between them"),
    (ARM.replace('"0.6 0.6 0.2"', '"0.6 0 0.2"'), "bad_value", "the sizes of <box> must be positive"),
    (ARM.replace('"0.6 0.6 0.2"', '"0.6 1e305 0.2"'), "out_of_range", "arm.urdf line 3: <geometry>: half_extents[1]: "),
    (ARM.replace('"0.6 0.6 0.2"', '"0.6 nan 0.2"'), "non_finite", "must be finite"),
    (ARM.replace('"0.6 0.6 0.2"', '"0.6 0x1 0.2"'), "bad_value", "must be numbers"),
    (ARM.replace('radius="0.1"', ""), "missing_field", '<cylinder> needs the attribute radius="..."'),
    (ARM.replace("0.2 0.2 -0.3", "0.2 0 0.3"), "bad_value", "scale of a mesh must differ from zero"),
    (ARM.replace('<cylinder radius="0.1" length="0.5"/>', ""), "missing_field", "<geometry> is empty"),
    (ARM.replace("<cylinder", "<torus"), "unsupported", "<torus> is no shape that is read; known: box"),
    (ARM.replace('type="continuous"', 'type="screw"'), "unsupported", "joint 'yaw' has the type 'screw'; known: fixed"),
    (ARM.replace('"0 0 2"', '"0 0 0"'), "zero_direction", "axis of joint 'yaw'"),
    (ARM.replace('parent link="column"', 'parent link="pillar"'), "bad_value", "the link 'pillar', which is not there"),
    (ARM.replace('<link name="wrist"/>', '<link name="wrist"/><link name="wrist"/>'), "bad_value", "second link 'wrist'"),
    (ODD + '<link name="b"/>' + joint("x", "revolute", "a", "b", '<limit lower="2" upper="-2"/>') + "</robot>", "bad_value",
     "lower limit 2 of joint 'x' is greater than the upper one, -2"),
    (ODD + '<link name="b"/></robot>', "bad_value", "no joint holds link 'b', and 'a' is a root already"),
    (ARM.replace('mimic joint="slide"', 'mimic joint="grip"'), "bad_value", "mimics itself"),
    (ARM.replace('mimic joint="slide"', 'mimic joint="roll"'), "bad_value", "mimics 'roll', which is fixed"),
    (ARM.replace('mimic joint="slide"', 'mimic joint="nod"'), "bad_value", "mimics 'nod', which is not there"),
    (ARM.replace("package://parts", "package://tools"), "missing_field", 'give package_roots={\'tools\': "/folder/of/it"}'),
    (ARM.replace("package://parts/tetra.obj", "package://parts/../../../secret.obj"), "unreadable_file", "leads out of"),
    (ARM.replace("package://parts/tetra.obj", "/etc/passwd"), "unreadable_file", "leads out of the robot's folder"),
    (ARM.replace("package://parts/tetra.obj", "http://x/y.obj"), "unsupported", "meshes come from files"),
    (ARM.replace("tetra.obj", "none.obj"), "unreadable_file", "arm.urdf line 9: none.obj: "),
    (ARM.replace("</robot>", ""), "unreadable_file", "no XML"),
    (ARM.replace('<robot name="arm">', '<!DOCTYPE r [<!ENTITY a "b">]><robot name="arm">'), "unsupported", "<!DOCTYPE ...>"),
    (ARM.replace('<link name="wrist"/>', "<xacro:arm/>"), "unsupported", "run xacro on the file"),
    ("<sdf/>", "bad_value", "must be a <robot>, not a <sdf>"),
    ("<robot/>", "missing_field", "has no <link>"),
    (ODD + '<link name="b"/>' + joint("x", "fixed", "a", "b") + joint("y", "fixed", "b", "b") + "</robot>", "unsupported",
     "hangs on the joints 'x' and 'y'"),
    (ODD + '<link name="b"/><link name="c"/>' + joint("x", "fixed", "c", "b") + joint("y", "fixed", "b", "c") + "</robot>",
     "unsupported", "part of a ring"),
]


@pytest.mark.parametrize("text, code, told", NO_ROBOTS, ids=[told for _, _, told in NO_ROBOTS])
def test_files_that_are_no_robot_are_refused_with_their_line(read, text, code, told):
    with pytest.raises(pdepth.Refused) as caught:
        read(text)
    assert caught.value.code == code and told in str(caught.value), str(caught.value)


def test_meshes_are_looked_for_below_the_roots_alone(read, tmp_path):
    (tmp_path / "packages" / "parts" / "link.obj").symlink_to("/etc/passwd")
    with pytest.raises(pdepth.Refused, match="leads out"):
        read(ARM.replace("tetra.obj", "link.obj"))
    with pytest.raises(pdepth.Refused, match="package_roots: '.*nowhere' is no folder"):
        read(ARM, package_roots={"parts": tmp_path / "nowhere"})
    by_name = read(ARM, package_roots={"parts": tmp_path / "packages" / "parts"})
    (tmp_path / "tetra.obj").write_text(TETRA)
    beside = read(ARM.replace("package://parts/", ""), package_roots=None)
    assert by_name.shape("hand") == beside.shape("hand")
    assert beside.shape("hand").vertices.min(axis=0).tolist() == [0, 0, -0.3]


def test_a_sweep_is_the_batch_in_files_and_resumes(read, tmp_path):
    robot = read(ARM)
    q = vectors(robot, 90)
    q[57] = np.nan
    options = {"out": tmp_path / "out", "chunk": 40, "progress": False}
    done = robot.sweep(q, nearest=True, **options)
    found = robot.distances(q, nearest=True)
    assert (len(done.files), done.computed, done.count) == (3, 3, 90)
    assert repr(done).startswith("<Sweep of 90 joint vectors in 3 files")
    assert all(np.array_equal(done[name], found[name], equal_nan=True) for name in found)
    done.files[1].unlink()
    assert robot.sweep(q, nearest=True, **options).computed == 1
    assert robot.sweep(q, **options).computed == 3
    assert read(ARM.replace('"0 0 2"', '"0 1 2"')).sweep(q, **options).computed == 3
    assert read(ARM).sweep(q, **options).computed == 3 and read(ARM).sweep(q, **options).computed == 0
    with pytest.raises(pdepth.Refused, match=r"needs \[n, 4\]"):
        robot.sweep(q[0], **options)


def test_a_cluster_writes_the_same_bytes(read, tmp_path):
    distributed = pytest.importorskip("distributed")
    robot, q = read(ARM), vectors(read(ARM), 30)
    here = robot.sweep(q, out=tmp_path / "here", chunk=10, progress=False)
    with distributed.LocalCluster(n_workers=1, threads_per_worker=1, dashboard_address=None, processes=False) as cluster, \
            distributed.Client(cluster) as client:
        there = robot.sweep(q, client, out=tmp_path / "there", chunk=10, progress=False)
    assert [file.read_bytes() for file in here.files] == [file.read_bytes() for file in there.files]


def test_a_picture_shows_the_robot_where_it_is(read):
    pytest.importorskip("pdepth._picture", reason="built without the renderer")
    robot = read(ARM)
    one, other = (robot.picture([0.3, angle, 0.5, 0.1], size=(160, 90)) for angle in (0.2, -1))
    assert one.shape == (90, 160, 3) and (one != other).any(axis=2).mean() > 0.02
    with pytest.raises(pdepth.Refused, match="one joint vector"):
        robot.picture(np.zeros((2, 4)))


def corner(faces=8):
    """A prism over the letter L as OBJ: two arms of length 2 and width 1, of height 1. Fewer faces leave it open."""
    outline = [(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)]
    lines = [f"v {x} {y} {z}" for z in (0, 1) for x, y in outline]
    loops = [[6, 5, 4, 3, 2, 1], [7, 8, 9, 10, 11, 12]] + [[i + 1, (i + 1) % 6 + 1, (i + 1) % 6 + 7, i + 7] for i in range(6)]
    return "\n".join(lines + ["f " + " ".join(map(str, loop)) for loop in loops[:faces]]) + "\n"


def torus(around, tube):
    """A ring about the z axis, of radius 1, whose tube has the radius 0.3."""
    lines, number = [], lambda i, j: i % around * tube + j % tube + 1
    for i in range(around):
        for j in range(tube):
            u, v = 2 * np.pi * i / around, 2 * np.pi * j / tube
            lines.append(f"v {(1 + 0.3 * np.cos(v)) * np.cos(u)} {(1 + 0.3 * np.cos(v)) * np.sin(u)} {0.3 * np.sin(v)}")
    for i in range(around):
        for j in range(tube):
            corners = number(i, j), number(i + 1, j), number(i + 1, j + 1), number(i, j + 1)
            lines += [f"f {corners[0]} {corners[1]} {corners[2]}", f"f {corners[0]} {corners[2]} {corners[3]}"]
    return "\n".join(lines) + "\n"


def test_a_mesh_that_is_not_convex_stays_a_solid(read, tmp_path):
    text = f"""<robot name="r"><link name="a">{shape('<mesh filename="L.obj" scale="1 -0.5 1"/>')}</link><link name="m"/>
      <link name="b">{shape('<sphere radius="0.1"/>')}</link>{joint("x", "prismatic", "a", "m")}
      {joint("y", "prismatic", "m", "b", '<axis xyz="0 1 0"/>')}</robot>"""
    (tmp_path / "L.obj").write_text(corner())
    q, pair = [[1.5, -0.75], [1.0, -0.25], [1.5, -0.55]], [("a", "b")]
    solid = read(text).distances(q, pairs=pair)
    assert np.allclose(solid.signed_distance[:, 0], [0.15, -0.1, -0.05], rtol=0, atol=1e-9)
    hull = read(text, meshes="hull").distances(q, pairs=pair)
    assert hull.signed_distance[0, 0] < 0 and read(text, meshes="hull").shape("a").is_convex
    coarse = read(text, tolerance=2.0)  # one part, which covers the solid
    assert coarse.shape("a").is_convex and coarse.distances(q, pairs=pair).signed_distance[0, 0] < 0
    (tmp_path / "L.obj").write_text(torus(32, 16))
    with pytest.raises(pdepth.Refused, match="tolerance=LENGTH") as caught:  # the exact parts are too many
        read(text)
    assert caught.value.code == "limit_exceeded"
    ring = read(text, tolerance=0.06)
    above = ring.distances([[0.0, 0.0], [1.0, 0.0]], pairs=pair).signed_distance[:, 0]
    assert 0.14 <= above[0] <= 0.25 and -0.52 <= above[1] <= -0.38  # the hole of the ellipse stays open; the tube is met
    (tmp_path / "L.obj").write_text(corner(7))
    with pytest.raises(pdepth.Refused, match="has a hole there") as caught:
        read(text)
    assert caught.value.code == "open_edge" and caught.value.where == "arm.urdf line 1" and 'meshes="hull"' in str(caught.value)
    assert read(text, meshes="hull").shape("a") == read(text.replace("L.obj", "./L.obj"), meshes="hull").shape("a")
    (tmp_path / "L.obj").write_text("\n".join(corner().splitlines()[:12]))
    with pytest.raises(pdepth.Refused, match="no faces"):
        read(text)
    for wrong in ({"meshes": "pieces"}, {"tolerance": -1}, {"tolerance": "1"}):
        with pytest.raises(pdepth.Refused) as caught:
            read(text, **wrong)
        assert caught.value.code == "bad_value" and caught.value.where.startswith(next(iter(wrong)))


def test_each_connected_part_of_a_mesh_may_be_convex_and_links_may_differ(read, tmp_path):
    text = f"""<robot name="r"><link name="a">{shape('<mesh filename="L.obj" scale="-1 1 2"/>')}</link>
      <link name="b">{shape('<mesh filename="two.obj" scale="-1 1 2"/>')}</link>{joint("x", "floating", "a", "b")}</robot>"""
    (tmp_path / "L.obj").write_text(corner())
    # Three tetrahedra. The second one touches the first in an edge; the third one's faces name vertices of their own, as
    # files of triangles do.
    corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    faces = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    points = np.vstack([corners, corners * [1, -1, 1], corners[faces.ravel()] + [4, 0, 0]])
    loops = np.vstack([faces, faces[:, ::-1] + 4, np.arange(8, 20).reshape(4, 3)]) + 1
    lines = [f"v {x} {y} {z}" for x, y, z in points.tolist()] + [f"f {a} {b} {c}" for a, b, c in loops.tolist()]
    (tmp_path / "two.obj").write_text("\n".join(lines))
    robot = read(text, meshes={"b": "parts"})
    low = [[part.vertices.min(axis=0).tolist() for part, _ in robot.shape(link)._arguments["parts"]] for link in "ab"]
    assert len(low[0]) == 2 and low[1] == [[-1, 0, 0], [-1, -1, 0], [-5, 0, 0]]
    assert read(text, meshes={"a": "hull", "b": "parts"}).shape("a").is_convex
    (tmp_path / "two.obj").write_text("\n".join(lines[:-1]))
    with pytest.raises(pdepth.Refused, match=r"the edge from \(-[45].* has 1 face") as caught:
        read(text, meshes={"b": "parts"})
    assert caught.value.code == "open_edge"
    for wrong, where in (({"c": "hull"}, "meshes['c']"), ({"a": "hulls"}, "meshes['a']")):
        with pytest.raises(pdepth.Refused) as caught:
            read(text, meshes=wrong)
        assert caught.value.code == "bad_value" and caught.value.where == where


@pytest.mark.parametrize("ask, code, where", [
    (lambda robot: robot.distances(np.zeros((3, 5))), "bad_value", "q"),
    (lambda robot: robot.distances(0.5), "bad_value", "q"),
    (lambda robot: robot.distances([[0, 0, 0, 0], [0]]), "bad_value", "q"),
    (lambda robot: robot.distances([["a"] * 4]), "bad_value", "q"),
    (lambda robot: robot.poses(np.zeros((4, 3))), "bad_value", "q"),
    (lambda robot: robot.distances(np.zeros(4), pairs=[("base", "fist")]), "bad_value", "pairs[0]"),
    (lambda robot: robot.distances(np.zeros(4), pairs=[("base", "hand"), ("base", "wrist")]), "bad_value", "pairs[1]"),
    (lambda robot: robot.distances(np.zeros(4), pairs=["base"]), "bad_value", "pairs[0]"),
    (lambda robot: robot.distances(np.zeros(4), pairs=[("base", "base")]), "bad_value", "pairs[0]"),
    (lambda robot: robot.distances(np.zeros(4), pairs=[], nearest=True), "bad_value", "pairs"),
    (lambda robot: robot.distances(np.zeros(4), threads=0), "bad_value", "threads"),
    (lambda robot: robot.distances(np.zeros(4), bracket="loose"), "bad_value", "bracket"),
    (lambda robot: robot.distances(np.zeros((2, 4)), warm="yes"), "bad_value", "warm"),
    (lambda robot: robot.shape("fist"), "bad_value", "link"),
])
def test_bad_questions_are_refused_by_name(read, ask, code, where):
    with pytest.raises(pdepth.Refused) as caught:
        ask(read(ARM))
    assert (caught.value.code, caught.value.where) == (code, where)


def test_a_robot_is_read_from_a_file():
    with pytest.raises(TypeError, match="from_urdf"):
        pdepth.Robot("arm.urdf")


def test_a_file_that_cannot_be_read_is_named_by_its_path(tmp_path):
    for path, told in ((tmp_path / "none.urdf", "No such file or directory"), (tmp_path, "must be a regular file")):
        with pytest.raises(pdepth.Refused) as refused:
            pdepth.Robot.from_urdf(path)
        assert str(refused.value) == f"{path}: {told} (unreadable_file)"
