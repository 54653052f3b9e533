"""Time of the signed distances of all pairs of a 7-joint arm of primitives: bench_robot.py [CONFIGURATIONS [FOLDER]].

With a folder, shapes and poses are left there as `arm.txt` and `poses.f64` for another library.
"""
import pathlib
import sys
import tempfile
import time

import numpy as np

import pdepth

SHAPES = [("box", (0.3, 0.3, 0.2), (0, 0, 0)), ("cylinder", (0.08, 0.3), (0, 0, 0.1)), ("capsule", (0.07, 0.3), (0, 0, 0.15)),
          ("capsule", (0.07, 0.3), (0, 0, 0.15)), ("box", (0.12, 0.12, 0.3), (0, 0, 0.15)), ("capsule", (0.06, 0.25), (0, 0, 0.13)),
          ("sphere", (0.09,), (0, 0, 0.05)), ("box", (0.2, 0.08, 0.1), (0, 0, 0.1))]
AXES = ["0 0 1", "0 1 0", "0 0 1", "0 1 0", "0 0 1", "0 1 0", "0 0 1"]
NAMES = {"box": ("size",), "cylinder": ("radius", "length"), "capsule": ("radius", "length"), "sphere": ("radius",)}


def write_hulls(folder):
    """Meshes of 200 vertices, one for each link."""
    for i in range(len(SHAPES)):
        points = np.random.default_rng(i).normal(size=(200, 3))
        points *= [0.07, 0.06, 0.16] / np.linalg.norm(points, axis=1)[:, None]
        points += [0, 0, 0.16]
        lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in points.tolist()]
        lines += ["f " + " ".join(str(corner + 1) for corner in facet) for facet in pdepth.ConvexPolytope(points).facets]
        (folder / f"l{i}.obj").write_text("\n".join(lines))


def urdf(hulls=False):
    text = '<robot name="arm">'
    for i, (kind, sizes, place) in enumerate(SHAPES):
        values = [" ".join(map(str, sizes))] if kind == "box" else list(map(str, sizes))
        told = " ".join(f'{name}="{value}"' for name, value in zip(NAMES[kind], values))
        if hulls:
            kind, told, place = "mesh", f'filename="l{i}.obj"', (0, 0, 0)
        text += (f'<link name="l{i}"><collision><origin xyz="{" ".join(map(str, place))}"/><geometry><{kind} {told}/></geometry>'
                 "</collision></link>")
    for i, axis in enumerate(AXES):
        text += (f'<joint name="j{i}" type="revolute"><parent link="l{i}"/><child link="l{i + 1}"/>'
                 f'<origin xyz="0 0 {0.1 if i == 0 else 0.32}"/><axis xyz="{axis}"/><limit lower="-2.8" upper="2.8" effort="1" velocity="1"/></joint>')
    return text + "</robot>"


def seconds(ask):
    """Processor time, the least of three."""
    best = np.inf
    for _ in range(3):
        begin = time.process_time()
        found = ask()
        best = min(best, time.process_time() - begin)
    return best, found


def time_path(robot, count):
    """Straight ways between joint vectors, 50 steps each."""
    ways = np.random.default_rng(2).uniform(*robot.limits.T, (max(count // 50, 1) + 1, robot.dof))
    path = np.concatenate([np.linspace(begin, end, 50, endpoint=False) for begin, end in zip(ways, ways[1:])])
    for options in ({}, {"warm": True}, {"nearest": True}, {"nearest": True, "warm": True}):
        taken, found = seconds(lambda: robot.distances(path, threads=1, **options))
        print(f"a path, {' '.join(options) or 'all'}: {taken:.3f} s, "
              f"{1e6 * taken / len(path) / len(robot.pairs):.2f} us a pair and joint vector")


def main(count, folder=None):
    with tempfile.TemporaryDirectory() as place:
        file = pathlib.Path(place) / "arm.urdf"
        file.write_text(urdf())
        robot = pdepth.Robot.from_urdf(file)
        write_hulls(pathlib.Path(place))
        file.write_text(urdf(hulls=True))
        of_hulls = pdepth.Robot.from_urdf(file)
    q = np.random.default_rng(1).uniform(*robot.limits.T, (count, robot.dof))
    print(robot, f"{count} joint vectors")
    taken, poses = seconds(lambda: robot.poses(q))
    print(f"poses {taken:.3f} s")
    for options in ({}, {"nearest": True}, {"derivatives": True}, {"nearest": True, "derivatives": True}):
        taken, found = seconds(lambda: robot.distances(q, threads=1, **options))
        told = " ".join(options) or "all"
        print(f"{told:>20} {taken:.3f} s, {1e6 * taken / count / len(robot.pairs):.2f} us a pair and joint vector, "
              f"{(found.signed_distance < 0).mean():.3f} overlap")
    time_path(robot, count)
    print("with links of 200 vertices:")
    time_path(of_hulls, count)
    if folder:
        lines = [f"{kind} {' '.join(map(str, sizes))}" for kind, sizes, _ in SHAPES]
        pairs = [f"pair {robot.links.index(a)} {robot.links.index(b)}" for a, b in robot.pairs]
        pathlib.Path(folder, "arm.txt").write_text("\n".join(lines + pairs) + "\n")
        for i, (_, _, place) in enumerate(SHAPES):
            poses[:, i, :3, 3] += poses[:, i, :3, :3] @ np.array(place)
        poses.tofile(pathlib.Path(folder, "poses.f64"))
        robot.distances(q).signed_distance.tofile(pathlib.Path(folder, "distances.f64"))


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 10_000, *sys.argv[2:3])
