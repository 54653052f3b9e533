"""Is my engine right? A pytest of any engine: record its contacts as dictionaries, let pdepth judge them. Copy and adapt."""
import pdepth
import pytest

BOX = pdepth.Box([0.01, 0.01, 0.01])


def my_engine(pose_a, pose_b):
    """Put your engine's call here. This one knows boxes that are moved along an axis."""
    apart = abs(pose_b.translation - pose_a.translation)
    axis = apart.argmax()
    depth = 0.02 - apart[axis]
    normal = [0.0, 0.0, 0.0]
    normal[axis] = float(pose_a.translation[axis] - pose_b.translation[axis]) or 1.0
    return {"depth": float(depth), "normal": normal} if depth > 0 else None


def records(heights):
    yield {"record": "pdepth-contacts/1", "engine": "mine", "scalar": "float64", "unit": "m"}
    yield {"shape": "box", "is": BOX}
    for number, height in enumerate(heights):
        below, above = pdepth.Pose(), pdepth.Pose(translation=[0, 0, height])
        yield {"contact": number, "a": "box", "pose_a": above, "b": "box", "pose_b": below, "reported": my_engine(above, below)}


@pytest.mark.parametrize("heights", [[0.0199, 0.0195, 0.019], [0.021, 0.03]], ids=["resting", "apart"])
def test_my_engine_misses_nothing_and_invents_nothing(heights):
    verdict = pdepth.audit(records(heights), fail_on="missed=0,phantom=0,depth_error=1e-9,normal_excess=1e-9")
    assert verdict.ok, verdict.table
