"""Batches of the queries whose rows have no fixed size: the rows are those of single calls, errors stay in their row."""
import threading
import time

import numpy as np
import pdepth
import pytest

RNG = np.random.default_rng(11)
GEMS = [pdepth.ConvexPolytope(RNG.normal(size=(n, 3))) for n in (6, 12, 20)]
BOX = pdepth.Box([1, 1, 1])


def assert_row(row, alone):
    for name, value in row.items():
        if name == "error":
            assert value == 0
        elif name == "contact":
            assert pdepth.CONTACTS[value] == getattr(alone, "class")
        elif name == "facets":
            assert value == alone.facets
        else:
            assert np.array_equal(np.asarray(value), np.asarray(getattr(alone, name))), name


def test_widths_and_hulls(poses):
    matrices = poses(3)
    widths, hulls = pdepth.width(GEMS, matrices), pdepth.hull(GEMS, matrices)
    assert widths.normal.shape == (3, 3) and hulls.vertices.shape == (hulls.vertices_offsets[-1], 3)
    for i in range(3):
        assert_row(widths.of_row(i), pdepth.width(GEMS[i], matrices[i]))
        assert_row(hulls.of_row(i), pdepth.hull(GEMS[i], matrices[i]))
        begin, end = hulls.facets_offsets[i:i + 2]
        assert [hulls.facets[hulls.facets_loops[k]:hulls.facets_loops[k + 1]].tolist() for k in range(begin, end)] == \
            pdepth.hull(GEMS[i], matrices[i]).facets


def test_differences(poses):
    matrices = poses(6, 2.0)
    found = pdepth.minkowski_difference(GEMS * 2, BOX, matrices)
    for i in range(6):
        assert_row(found.of_row(i), pdepth.minkowski_difference((GEMS * 2)[i], BOX, matrices[i]))
    assert found.K.tolist() == np.diff(found.facets_offsets).tolist()


def test_times_of_impact(poses):
    matrices = poses(20, 0.5)
    matrices[:, 0, 3] -= 6
    speeds = np.zeros((20, 3))
    speeds[:, 0] = np.linspace(1, 6, 20)
    found = pdepth.time_of_impact(GEMS[1], BOX, matrices, velocity_a=speeds, angular_velocity_b=[0, 0, 1], duration=2.0)
    assert 0 < found.hit.sum() < 20 and found.witness_a.shape == (20, 3)
    for i in range(20):
        alone = pdepth.time_of_impact(GEMS[1], BOX, matrices[i], velocity_a=speeds[i], angular_velocity_b=[0, 0, 1], duration=2.0)
        assert (found.hit[i], found.time[i]) == (alone.hit, alone.time)
        assert_row(found.of_row(i), alone)


def test_polygons():
    square = np.array([[0, 0], [2, 0], [2, 2], [0, 2]], dtype=float)
    holed = {"outer": [[-3, -3], [5, -3], [5, 5], [-3, 5]], "holes": [[[-1, -1], [-1, 3], [3, 3], [3, -1]]]}
    places = [square + [x, 0.5] for x in (-3.0, 1.0, 1.5)]
    found = pdepth.polygon_depth(square, places)
    assert found.depth.tolist() == [0, 1, 0.5] and found.translation.shape == (3, 2)
    around = pdepth.polygon_depth([holed, square], [square, square + 5])
    assert [pdepth.CONTACTS[code] for code in around.contact] == ["separated", "separated"]
    for i, place in enumerate(places):
        assert_row(found.of_row(i), pdepth.polygon_depth(square, place))


def test_queries_in_four_dimensions():
    clouds = [RNG.normal(size=(30, 4)) for _ in range(8)]
    found = pdepth.query_many("approx_width", [{"a": {"points": cloud}, "epsilon": 0.1} for cloud in clouds])
    assert found.direction.shape == (8, 4)
    for i, cloud in enumerate(clouds):
        assert_row(found.of_row(i), pdepth.query("approx_width", a={"points": cloud}, epsilon=0.1))


def test_bad_rows_are_errors_and_the_rest_is_answered(poses):
    matrices = poses(5)
    matrices[1, 0, 0] = np.nan
    matrices[2, :3, :3] *= -1
    matrices[3, 3, 0] = 1
    for found in (pdepth.width(GEMS[0], matrices), pdepth.hull(GEMS[0], matrices),
                  pdepth.minkowski_difference(GEMS[0], BOX, matrices), pdepth.time_of_impact(GEMS[0], BOX, matrices)):
        assert [pdepth.ERRORS[code] for code in found.error] == ["", "non_finite", "not_a_rotation", "bad_value", ""]
    assert np.isnan(pdepth.width(GEMS[0], matrices).width).tolist() == [False, True, True, True, False]
    hulls = pdepth.hull(GEMS[0], matrices)
    assert np.diff(hulls.vertices_offsets).tolist() == [6, 0, 0, 0, 6]
    flat = pdepth.polygon_depth([[[0, 0], [1, 0], [0, 1]], [[0, 0], [1, 1], [1, 0], [0, 1]]], [[0, 0], [1, 0], [0, 1]])
    assert flat.error[0] == 0 and flat.error[1] != 0
    with pytest.raises(pdepth.Refused, match="unknown_query"):
        pdepth.query_many("widths", [{"a": BOX}])
    with pytest.raises(pdepth.Refused, match="velocity_a"):
        pdepth.time_of_impact(BOX, BOX, matrices, velocity_a=[[1, 0, 0]] * 4)
    empty = pdepth.width([])
    assert empty.width.shape == (0,) and empty.error.shape == (0,)


def test_any_number_of_threads_gives_the_same_and_the_lock_is_free(poses):
    matrices = poses(400)
    one, two = (pdepth.minkowski_difference(GEMS[2], GEMS[1], matrices, threads=n) for n in (1, 2))
    for name in one:
        assert np.array_equal(one[name], two[name]), name
    turns, stop = [0], threading.Event()

    def count():
        while not stop.is_set():
            turns[0] += 1
            time.sleep(0.0005)

    other = threading.Thread(target=count)
    other.start()
    from pdepth import _protocol
    import json
    line = json.dumps({"query": "minkowski_difference", "a": GEMS[2].protocol(), "b": GEMS[1].protocol()})
    before = turns[0]
    _protocol.answer_many([line] * 2000, 1)
    during = turns[0] - before
    stop.set()
    other.join()
    assert during >= 5, during
