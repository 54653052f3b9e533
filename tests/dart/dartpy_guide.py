"""The Python sample of the guide "pdepth in DART" (engine_glue/dart/README.md), run: a stack of boxes under pdepth's
detector, its record, and what the module refuses. The marked part is compared with the guide's text."""
import os
import pathlib
import sys
import tempfile

# [python]
import dartpy
import pdepth_dart


def add_box(world, name, sides, place, moves=True):
    skeleton = dartpy.dynamics.Skeleton(name)
    make = skeleton.createFreeJointAndBodyNodePair if moves else skeleton.createWeldJointAndBodyNodePair
    joint, body = make()
    node = body.createShapeNode(dartpy.dynamics.BoxShape(sides))
    node.createCollisionAspect()
    node.createDynamicsAspect()
    pose = dartpy.math.Isometry3()
    pose.set_translation(place)
    joint.setTransformFromParentBodyNode(pose)
    world.addSkeleton(skeleton)
    return body


world = dartpy.simulation.World()
world.setGravity([0, 0, -9.81])
add_box(world, "ground", [4, 4, 0.5], [0, 0, -0.25], moves=False)
boxes = [add_box(world, f"box{i}", [0.2, 0.2, 0.2], [0, 0, 0.1 + 0.2 * i]) for i in range(3)]

detector = pdepth_dart.detector()
world.getConstraintSolver().setCollisionDetector(detector)
for _ in range(500):
    world.step()
print([round(box.getTransform().translation()[2], 4) for box in boxes], pdepth_dart.report(detector))
# [/python]

ROOT = pathlib.Path(__file__).resolve().parents[2]
sample = pathlib.Path(__file__).read_text().split("# [python]\n")[1].split("# [/python]\n")[0]
assert f"```python\n{sample}```" in (ROOT / "engine_glue/dart/README.md").read_text(), "the guide has another sample"

solver = world.getConstraintSolver()
heights = [box.getTransform().translation()[2] for box in boxes]
assert all(abs(z - 0.1 - 0.2 * i) < 2e-3 for i, z in enumerate(heights)), heights
counts = pdepth_dart.report(detector)
assert counts["answered"] >= 3 * 500 and counts["contact_points"] >= 4 * 3 * 490, counts
assert not any(counts["left_to_fcl"].values()) and not counts["first"], counts
assert detector.getType() == solver.getCollisionDetector().getType() == "pdepth"

with tempfile.TemporaryDirectory() as folder:
    path = os.path.join(folder, "contacts.jsonl")
    recorder = pdepth_dart.Recorder(path)
    assert recorder.write(solver.getCollisionGroup(), solver.getCollisionOption(), world.getTime()) >= 3
    recorder.close()
    with open(path, encoding="ascii") as lines:
        assert "DART, detector pdepth" in next(lines)
for refused, error in ((lambda: pdepth_dart.Recorder("/nowhere/contacts.jsonl"), OSError),
                       (lambda: pdepth_dart.report(dartpy.collision.FCLCollisionDetector()), TypeError)):
    try:
        refused()
    except error:
        continue
    sys.exit(f"{error.__name__} was promised")
print("the sample holds")
