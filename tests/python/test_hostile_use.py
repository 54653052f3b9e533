"""What no caller should do: objects never made, numbers that are no doubles, arrays without end, Ctrl-C, wrong types."""
import os
import pickle
import signal
import subprocess
import sys
import textwrap
import time

import numpy as np
import pdepth
import pytest

BOX = pdepth.Box([1, 1, 1])
PACKAGE = os.path.dirname(os.path.dirname(pdepth.__file__))


def run(program, *arguments, **options):
    return subprocess.Popen([sys.executable, "-c", textwrap.dedent(program), *arguments], stdout=subprocess.PIPE,
                            stderr=subprocess.PIPE, text=True, env={**os.environ, "PYTHONPATH": PACKAGE}, **options)


UNMADE = """
    import gc, inspect, sys, pdepth
    from pdepth import _core, _picture, _protocol
    # Every class of the package and of its modules, whoever wrote it.
    kinds = sorted({kind for module in (pdepth, _core, _protocol, _picture) for kind in vars(module).values()
                    if inspect.isclass(kind) and kind.__module__.startswith("pdepth")
                    and not issubclass(kind, BaseException)}, key=lambda kind: (kind.__module__, kind.__qualname__))
    # Their bases count, too: pybind11's base has a __new__ of its own.
    kinds += sorted({base for kind in kinds for base in kind.__mro__ if base is not object} - set(kinds), key=repr)
    assert {pdepth.Pose, pdepth.Depth, pdepth.Warm, pdepth.Box, pdepth.Shape, _core.Settings} <= set(kinds)
    box = pdepth.Box([1, 1, 1])
    uses = [repr, str, lambda x: x.vertices, lambda x: x.rotation, lambda x: x.translation, lambda x: x.depth,
            lambda x: x.feature_a, lambda x: x.shape_a, lambda x: x.clear(), lambda x: x.nbytes, lambda x: x.is_convex,
            lambda x: x.facets, lambda x: pdepth.depth(x, box), lambda x: pdepth.depth(box, box, x),
            lambda x: pdepth.depth(box, box, warm=x), lambda x: pdepth.depth([x, box], box), lambda x: x.__getstate__(),
            lambda x: x.__reduce__(), lambda x: pdepth.Compound([x]), lambda x: pdepth.query("hull", a=x),
            lambda x: pdepth.width(x), lambda x: pdepth.picture(x), lambda x: x == x, lambda x: x.matrix, hash, len,
            iter, list, dir, vars, lambda x: x < x, lambda x: x[0],
            lambda x: [getattr(x, name) for name in dir(x) if safe(x, name)]]

    def safe(x, name):
        # Each attribute is read; what raises is refused.
        try:
            return getattr(x, name) is not None
        except (TypeError, AttributeError, ValueError):
            return False
    for kind in kinds:
        for use in uses:
            try:
                made = kind.__new__(kind)
            except TypeError:  # an enumeration
                break
            try:
                use(made)
            except (TypeError, AttributeError, ValueError):  # Refused is a ValueError
                pass
            del made
        gc.collect()
    print("alive")
"""


def test_objects_made_by_new_alone_do_no_harm():
    for _ in range(3):
        ran = run(UNMADE)
        out, err = ran.communicate()
        assert out == "alive\n" and ran.returncode == 0, err


@pytest.mark.parametrize("protocol", range(6))
def test_every_protocol_of_pickle_keeps_the_bits(protocol):
    pose = pdepth.Pose(translation=[0.1, 0.2, 0.3], wxyz=[0.5, 0.5, 0.5, 0.5])
    assert repr(pickle.loads(pickle.dumps(pose, protocol))) == repr(pose)
    found = pdepth.depth(BOX, BOX, pose)
    assert pickle.loads(pickle.dumps(found, protocol)).depth == found.depth
    with pytest.raises(TypeError):
        pickle.dumps(pdepth.Warm(), protocol)


def test_a_pose_made_by_new_alone_is_a_type_error():
    pose = pdepth.Pose.__new__(pdepth.Pose)
    with pytest.raises(TypeError, match="never made"):
        repr(pose)
    with pytest.raises(TypeError):
        pdepth.depth(BOX, BOX, pose)
    shape = pdepth.Box.__new__(pdepth.Box)
    for call in (lambda: pdepth.depth(shape, BOX), lambda: pdepth.depth([shape], BOX), lambda: shape.vertices):
        with pytest.raises(TypeError):
            call()


@pytest.mark.parametrize("threads", [1, 2])
@pytest.mark.parametrize("batch", ["pdepth.depth(a, b, poses, threads={0})", "pdepth.width(a, poses, threads={0})"])
def test_ctrl_c_is_heard_at_once(batch, threads):
    program = f"""
        import signal, numpy as np, pdepth
        signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell's background job starts with it ignored
        points = np.random.default_rng(1).normal(size=(60, 3))
        a, b = pdepth.ConvexPolytope(points), pdepth.ConvexPolytope(points[::-1] * 0.9)
        poses = np.tile(np.eye(4), (800_000, 1, 1))
        print("begun", flush=True)
        try:
            {batch.format(threads)}
        except KeyboardInterrupt:
            print("heard", flush=True)
    """
    ran = run(program)
    assert ran.stdout.readline() == "begun\n"
    time.sleep(0.5)
    asked = time.monotonic()
    ran.send_signal(signal.SIGINT)
    out, err = ran.communicate(timeout=60)
    assert out == "heard\n", err
    assert time.monotonic() - asked < 3  # 0.05 s and a row on a machine with nothing else to do


def test_integers_that_are_no_doubles_are_refused():
    for number in (2**53 + 1, -(2**53) - 1, 2**62 + 1):
        with pytest.raises(pdepth.Refused, match="2\\^53"):
            pdepth.Box([1, 1, number])
    with pytest.raises(pdepth.Refused, match="2\\^53"):
        pdepth.Box(np.array([1, 1, 2**63 + 1], dtype=np.uint64))
    for number in (2**53, 2**53 - 1):
        assert pdepth.Box([1, 1, number]).vertices[-1, 2] == number
    with pytest.raises(pdepth.Refused, match="2\\^53"):
        pdepth.Pose(translation=np.array([0, 0, -(2**53) - 1]))


def test_an_array_that_does_not_fit_is_a_memory_error():
    endless = np.broadcast_to(np.float32(0), (2**44, 3))
    with pytest.raises(MemoryError):
        pdepth.ConvexPolytope(endless)
    with pytest.raises(MemoryError):
        pdepth.depth(BOX, BOX, np.broadcast_to(np.float32(0), (2**42, 4, 4)))


def test_wrong_types_are_type_errors():
    for call in (lambda: pdepth.audit(3), lambda: pdepth.audit([3]), lambda: pdepth.audit(None), lambda: pdepth.picture(3),
                 lambda: pdepth.picture(BOX, 3), lambda: pdepth.picture(None)):
        with pytest.raises(TypeError, match="must be"):
            call()


def test_a_saved_batch_is_whole_or_not_there(tmp_path):
    batch = pdepth.depth(BOX, BOX, np.tile(np.eye(4), (10, 1, 1)))
    target = tmp_path / "batch.npz"
    target.write_bytes(b"older")
    batch.save(target)
    with np.load(target) as loaded:
        assert (loaded["depth"] == 2).all()
    class Unsaveable:
        def __array__(self, *arguments, **options):
            raise RuntimeError("fails half way")

    batch._names, batch.broken = (*batch._names, "broken"), Unsaveable()
    before = target.read_bytes()
    with pytest.raises(RuntimeError, match="half way"):
        batch.save(target)
    assert target.read_bytes() == before and [path.name for path in tmp_path.iterdir()] == ["batch.npz"]
