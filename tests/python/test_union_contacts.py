"""Contacts of unions and of meshes as sheets: one body each."""
import pickle

import numpy as np
import pytest

import pdepth

BOX = pdepth.Box([0.2, 0.2, 0.2])


def at(x, y, z):
    return pdepth.Pose(translation=[x, y, z])


def floor(cells=8):
    """The square [-1, 1]^2 at z = 0 in cells of two triangles each, facing up."""
    side = np.linspace(-1, 1, cells + 1)
    vertices = [[x, y, 0] for x in side for y in side]
    faces = []
    for i in range(cells):
        for j in range(cells):
            corner = (cells + 1) * i + j
            faces += [[corner, corner + cells + 1, corner + cells + 2], [corner, corner + cells + 2, corner + 1]]
    return pdepth.Sheet(vertices, faces)


def slab():
    part = pdepth.Box([0.5, 1, 0.5])
    return pdepth.Compound([(part, at(i - 1.0, 0, -0.5)) for i in range(3)])


@pytest.mark.parametrize("ground", [floor(), slab()])
def test_a_box_over_inner_edges_stands(ground):
    for x in (0.0, 0.05, 0.05001, 0.29999, 0.305):
        found = pdepth.contact_manifold(BOX, ground, at(x, 0.013, 0.19))
        assert len(found.patches) == 1 and np.allclose(found.depth, 0.01, rtol=0, atol=1e-12), x
        assert np.array_equal(found.normals, np.tile([0, 0, 1], (4, 1))) and (found.piece_a == 0).all()
        assert np.array_equal(found.position_b, found.patches[0].position_b)


def test_contacts_that_are_covered_are_counted():
    assert pdepth.contact_manifold(BOX, slab(), at(0.305, 0, 0.19)).covered == 1
    assert pdepth.contact_manifold(BOX, slab(), at(0.1, 0, 0.19)).covered == 0


def test_the_numbers_are_those_of_the_line():
    ground = slab()
    found = pdepth.contact_manifold(BOX, ground, at(0.305, 0.1, 0.19), breaking_threshold=0.02)
    line = pdepth.query("contact_manifold", a=BOX, b=ground, pose_a=at(0.305, 0.1, 0.19), breaking_threshold=0.02)
    assert [point["depth"] for point in line.points] == found.depth.tolist()
    assert [point["piece_b"] for point in line.points] == found.piece_b.tolist()
    assert line.covered == found.covered


def test_one_side_or_two():
    ground = pickle.loads(pickle.dumps(floor(2)))
    below = at(0.3, 0.3, -0.1)
    assert pdepth.contact_manifold(BOX, ground, below).normal.tolist() == [0, 0, -1]
    assert pdepth.contact_manifold(BOX, ground, below, one_sided=True).normal.tolist() == [0, 0, 1]
    none = pdepth.contact_manifold(BOX, ground, at(0, 0, 5))
    assert none.patches == [] and none.position_a.shape == (0, 3) and not none.normal.any()


@pytest.mark.parametrize("ask, code, where", [
    (lambda: pdepth.contact_manifold(floor(), floor()), "unsupported", "a"),
    (lambda: pdepth.contact_manifold(BOX, BOX, one_sided=True), "unsupported", "one_sided"),
    (lambda: pdepth.contact_manifold([BOX, BOX], BOX, one_sided=True), "unsupported", "one_sided"),
    (lambda: pdepth.contact_manifold(BOX, floor(), breaking_threshold=-1), "bad_value", "breaking_threshold"),
    (lambda: pdepth.contact_manifold(BOX, floor(), np.tile(np.eye(4), (3, 1, 1))), "unsupported", "a"),
    (lambda: pdepth.Sheet([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 3]]), "bad_faces", "faces[0]"),
    (lambda: pdepth.Sheet([[0, 0, 0], [1, 0, 0], [0, np.inf, 0]], [[0, 1, 2]]), "non_finite", "vertices[2]"),
    (lambda: pdepth.Sheet([[0, 0, 0], [1, 0, 0], [2, 0, 0]], [[0, 1, 2]]), "too_few_points", "faces"),
    (lambda: pdepth.Sheet([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]], margin=-1), "bad_value", "margin"),
])
def test_bad_input_is_refused_by_name(ask, code, where):
    with pytest.raises(pdepth.Refused) as caught:
        ask()
    assert caught.value.code == code and caught.value.where.startswith(where), (caught.value.code, caught.value.where)
