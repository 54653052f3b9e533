"""Robots from SDF files: the same arm as URDF gives the same poses and distances; what is not read is refused."""
import inspect
import sys

import numpy as np
import pdepth
import pytest


def urdf():
    turned = '<origin xyz="0.1 0.2 0.3" rpy="0.1 -0.2 0.3"/>'
    return f"""<robot name="arm">
      <link name="base"><collision><geometry><box size="0.4 0.4 0.2"/></geometry></collision></link>
      <link name="upper"><collision>{turned}<geometry><capsule radius="0.05" length="0.6"/></geometry></collision></link>
      <link name="hand"><collision><origin xyz="0 0 0.3"/><geometry><box size="0.1 0.1 0.4"/></geometry></collision></link>
      <joint name="shoulder" type="revolute"><parent link="base"/><child link="upper"/><origin xyz="0 0.1 0.5" rpy="0.3 0.2 0.1"/>
        <axis xyz="0 1 1"/><limit lower="-2" upper="1" effort="9" velocity="1"/></joint>
      <joint name="slide" type="prismatic"><parent link="upper"/><child link="hand"/><origin xyz="0 0 0.8" rpy="-0.4 0 1"/>
        <axis xyz="0 1 0"/><limit lower="0" upper="1" effort="9" velocity="1"/></joint></robot>"""


#: A joint stands in its child's frame by default, and "slide" is moved off it; the hand is given by a frame of the upper arm.
SDF = """<?xml version="1.0"?><sdf version="1.9"><model name="arm">
  <link name="base"><collision name="c"><geometry><box><size>0.4 0.4 0.2</size></box></geometry></collision></link>
  <link name="upper"><pose relative_to="base">0 0.1 0.5 0.3 0.2 0.1</pose>
    <collision name="c"><pose>0.1 0.2 0.3 0.1 -0.2 0.3</pose>
      <geometry><capsule><radius>0.05</radius><length>0.6</length></capsule></geometry></collision></link>
  <frame name="wrist" attached_to="upper"><pose degrees="true">0 0 0.8 0 0 0</pose></frame>
  <link name="hand"><pose relative_to="wrist">0 0 0 -0.4 0 1</pose>
    <collision name="c"><pose relative_to="hand">0 0 0.3 0 0 0</pose>
      <geometry><box><size>0.1 0.1 0.4</size></box></geometry></collision></link>
  <joint name="shoulder" type="revolute"><parent>base</parent><child>upper</child>
    <axis><xyz>0 1 1</xyz><limit><lower>-2</lower><upper>1</upper></limit></axis></joint>
  <joint name="slide" type="prismatic"><pose>0 0 0.1 0 0 0.5</pose><parent>wrist</parent><child>hand</child>
    <axis><xyz expressed_in="hand">0 1 0</xyz><limit><lower>0</lower><upper>1</upper></limit></axis></joint>
</model></sdf>"""


@pytest.fixture
def read(tmp_path):
    def make(text, **options):
        (tmp_path / "arm.sdf").write_text(text)
        return pdepth.Robot.from_sdf(tmp_path / "arm.sdf", **options)
    return make


def test_an_arm_is_the_same_from_both_kinds_of_files(read, tmp_path):
    (tmp_path / "arm.urdf").write_text(urdf())
    known, robot = pdepth.Robot.from_urdf(tmp_path / "arm.urdf"), read(SDF)
    assert (robot.links, robot.coordinates, robot.pairs) == (known.links, known.coordinates, known.pairs)
    assert np.array_equal(robot.limits, known.limits)
    q = np.random.default_rng(2).uniform(*robot.limits.T, (20, 2))
    assert np.allclose(robot.poses(q), known.poses(q), rtol=0, atol=1e-14)
    pairs = [("base", "hand"), ("upper", "base")]
    found, expected = (each.distances(q, pairs=pairs, derivatives=True) for each in (robot, known))
    assert np.allclose(found.signed_distance, expected.signed_distance, rtol=0, atol=1e-12)
    assert np.allclose(found.by_q[found.unique], expected.by_q[found.unique], rtol=0, atol=1e-9)
    # Until version 1.4 axes were those of the model.
    old = read(SDF.replace('"1.9"', '"1.4"').replace(' expressed_in="hand"', "")).poses([0, 0.25])
    assert np.allclose(old[2, :3, 3] - robot.poses([0, 0])[2, :3, 3], [0, 0.25, 0], rtol=0, atol=1e-14)


def test_a_robot_stands_in_the_world_where_its_file_puts_it(read):
    moved = SDF.replace('<link name="base">', '<link name="base"><pose>1 2 3 0 0 0</pose>')
    assert read(moved).links[0] == "__model__"
    assert read(moved).poses([0, 0])[1, :3, 3].tolist() == [1, 2, 3] and read(moved).pairs == (("base", "hand"),)
    ball = read(moved.replace("</model>", '<joint name="hold" type="ball"><parent>world</parent><child>base</child></joint></model>'))
    assert ball.coordinates[:3] == ("hold.rx", "hold.ry", "hold.rz") and "world" in ball.links
    found = ball.poses([0, 0, np.pi / 2, 0, 0])
    assert np.allclose(found[ball.links.index("base")][:3, :3], [[0, -1, 0], [1, 0, 0], [0, 0, 1]], atol=1e-15)


def test_long_chains_need_no_recursion(read):
    limit = sys.getrecursionlimit()
    sys.setrecursionlimit(len(inspect.stack()) + 150)
    links = "".join(f'<link name="l{i}"><pose relative_to="{f"l{i - 1}" if i else ""}">0 0 0.5 0 0 0</pose></link>' for i in range(300))
    joints = "".join(f'<joint name="j{i}" type="fixed"><parent>l{i - 1}</parent><child>l{i}</child></joint>' for i in range(1, 300))
    try:
        robot = read(f'<sdf version="1.9"><model name="chain">{links}{joints}</model></sdf>')
        assert robot.poses([])[-1, 2, 3] == 150 and robot.pairs == ()
    finally:
        sys.setrecursionlimit(limit)


@pytest.mark.parametrize("change, code, told", [
    (('"slide" type="prismatic"', '"slide" type="screw"'), "unsupported", "has the type 'screw'; known: fixed, revolute"),
    (('<frame name="wrist"', '<include><uri>model://x</uri></include><frame name="wrist"'), "unsupported", "one flat model"),
    (('relative_to="wrist"', 'relative_to="elbow"'), "bad_value", "the frame 'elbow' is not there"),
    (('relative_to="base"', 'relative_to="wrist"'), "bad_value", "the frame 'wrist' is given by itself"),
    (("<size>0.4 0.4 0.2</size>", "<size>0.4 0.4</size>"), "bad_value", "<size> must be 3 numbers"),
    (("<size>0.4 0.4 0.2</size>", ""), "missing_field", "<box> needs a <size>"),
    (("<radius>0.05</radius>", "<radius>-1</radius>"), "bad_value", "the sizes of <capsule> must be positive"),
    (("<box><size>0.4 0.4 0.2</size></box>", "<plane/>"), "unsupported", "<plane> is no shape that is read"),
    (("<pose>0.1", '<pose rotation_format="quat_xyzw">0.1'), "unsupported", "roll, pitch and yaw"),
    (("<model", "<world><model"), "unreadable_file", "no XML"),
    (("<xyz>0 1 1</xyz>", "<xyz>0 0 0</xyz>"), "zero_direction", "axis of joint 'shoulder'"),
    (("</sdf>", '<model name="b"/></sdf>'), "unsupported", "holds 2 models"),
])
def test_what_is_not_read_is_refused_with_its_line(read, change, code, told):
    assert change[0] in SDF
    with pytest.raises(pdepth.Refused) as caught:
        read(SDF.replace(*change, 1))
    assert caught.value.code == code and told in str(caught.value) and "arm.sdf line" in caught.value.where, str(caught.value)
