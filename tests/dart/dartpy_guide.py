"""The sample of the guide "pdepth in DART" for Python, run: a stack of boxes under pdepth's detector, its record, and
what the module refuses. Says at the end that all of it held."""
import os
import sys
import tempfile

# [python]
import dartpy
import pdepth_dart


def box(world, name, sides, place, moves=True):
    skeleton = dartpy.dynamics.Skeleton(name)
    make = skeleton.createFreeJointAndBodyNodePair if moves else skeleton.createWeldJointAndBodyNodePair
    joint, body = make()
    node = body.createShapeNode(dartpy.dynamics.BoxShape(sides))
    node.createVisualAspect(), node.createCollisionAspect(), node.createDynamicsAspect()
    pose = dartpy.math.Isometry3()
    pose.set_translation(place)
    if moves:
        joint.setTransform(pose)
    else:
        joint.setTransformFromParentBodyNode(pose)
    world.addSkeleton(skeleton)
    return body


world = dartpy.simulation.World()
world.setGravity([0, 0, -9.81])
box(world, "ground", [4, 4, 0.5], [0, 0, -0.25], moves=False)
bodies = [box(world, f"box{i}", [0.2, 0.2, 0.2], [0, 0, 0.1 + 0.2 * i]) for i in range(3)]

detector = pdepth_dart.detector()
solver = world.getConstraintSolver()
solver.setCollisionDetector(detector)
for _ in range(500):
    world.step()
print([round(body.getTransform().translation()[2], 4) for body in bodies], pdepth_dart.report(detector))
# [/python]

heights = [body.getTransform().translation()[2] for body in bodies]
assert all(abs(z - 0.1 - 0.2 * i) < 2e-3 for i, z in enumerate(heights)), heights
counts = pdepth_dart.report(detector)
assert counts["answered"] >= 3 * 500 and counts["contact_points"] >= 4 * 3 * 500, counts
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
