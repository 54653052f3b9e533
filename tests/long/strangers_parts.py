"""The parts of strangers_input.py: commands that are timed, bodies, judges."""
import json
import math
import os
import random
import resource
import signal
import subprocess
import tempfile

SECONDS, MEGABYTES = 5.0, 1000.0  # the goal of a query of 1,000 points
SMALL = 0.1  # seconds, the goal of a query of up to 64 vertices
MOST_SECONDS = 60  # of processor time: a busy machine ends no row
MOST_CLOCK = 600  # for a command that waits and computes nothing
ROWS = []


class Run:
    """The outcome of a command, measured by GNU time (Debian: `time`): a process that Python starts inherits Python's own peak."""

    def __init__(self, argv, stdin=b"", stdout=None):
        with tempfile.NamedTemporaryFile() as told, tempfile.TemporaryFile() as source, tempfile.TemporaryFile() as out, \
                tempfile.TemporaryFile() as err:
            source.write(stdin)
            source.seek(0)
            timed = ["/usr/bin/time", "--quiet", "-f", "%U %S %M", "-o", told.name, *argv]
            process = subprocess.Popen(timed, stdin=source, stdout=stdout or out, stderr=err, start_new_session=True,
                                       preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU, (MOST_SECONDS, MOST_SECONDS + 5)))
            try:
                self.code = process.wait(MOST_CLOCK)
            except subprocess.TimeoutExpired:
                os.killpg(process.pid, signal.SIGKILL)
                process.wait()
                raise
            out.seek(0)
            err.seek(0)
            self.out, self.err = out.read().decode("utf-8", "replace"), err.read().decode("utf-8", "replace")
            user, system, kilobytes = told.read().split()[-3:]
        self.signal = self.code - 128 if self.code > 128 else 0
        self.seconds = float(user) + float(system)
        self.megabytes = int(kilobytes) / 1024

    def answers(self):
        return [json.loads(line) for line in self.out.splitlines()]


def row(name, seconds=SECONDS, megabytes=MEGABYTES):
    """A row: a function of a place to work in that returns a Run, or several, and a verdict: "" where all is well."""

    def keep(make):
        ROWS.append((name, seconds, megabytes, make))
        return make

    return keep


class Place:
    def __init__(self, program, folder):
        self.program, self.folder = program, folder

    def write(self, name, content):
        path = os.path.join(self.folder, name)
        with open(path, "wb") as file:
            file.write(content if isinstance(content, bytes) else content.encode())
        return path

    def run(self, *arguments, stdin=b""):
        return Run([self.program, *arguments], stdin if isinstance(stdin, bytes) else stdin.encode())

    def ask(self, *lines, options=()):
        text = "\n".join(line if isinstance(line, str) else json.dumps(line) for line in lines) + "\n"
        return self.run("query", *options, stdin=text)


# ---- bodies ---------------------------------------------------------------------------------------------------------

BOX = {"type": "box", "half_extents": [1, 1, 1]}


def at(*place):
    return {"translation": list(place)}


def sphere_points(dimension, count, seed=1):
    source, rows = random.Random(seed), []
    for _ in range(count):
        v = [source.gauss(0, 1) for _ in range(dimension)]
        length = math.sqrt(sum(x * x for x in v))
        rows.append([x / length for x in v])
    return rows


def star(rings, around, seed=7):
    """A star-shaped body with rings * around + 2 vertices, spikes and notches by turns."""
    source = random.Random(seed)
    vertices = [[0, 0, 1]]
    for i in range(rings):
        theta = math.pi * (i + 1) / (rings + 1)
        for j in range(around):
            radius = (0.45 if (i + j) % 2 else 1.0) * source.uniform(0.9, 1.1)
            phi = 2 * math.pi * (j + 0.5 * (i % 2)) / around
            vertices.append([radius * math.sin(theta) * math.cos(phi), radius * math.sin(theta) * math.sin(phi),
                             radius * math.cos(theta)])
    vertices.append([0, 0, -1])
    ring = lambda i, j: 1 + i * around + j % around
    faces = []
    for j in range(around):
        faces.append([0, ring(0, j), ring(0, j + 1)])
        faces.append([len(vertices) - 1, ring(rings - 1, j + 1), ring(rings - 1, j)])
        for i in range(rings - 1):
            # The rings are turned against each other by half a step.
            if i % 2 == 0:
                faces.append([ring(i, j), ring(i + 1, j), ring(i, j + 1)])
                faces.append([ring(i, j + 1), ring(i + 1, j), ring(i + 1, j + 1)])
            else:
                faces.append([ring(i, j), ring(i + 1, j), ring(i + 1, j + 1)])
                faces.append([ring(i, j), ring(i + 1, j + 1), ring(i, j + 1)])
    return {"type": "star", "vertices": vertices, "faces": faces, "center": [0, 0, 0]}


def torus(around=8, across=3, big=1.0, small=0.35):
    text = ""
    for i in range(around):
        for j in range(across):
            u, v = 2 * math.pi * i / around, 2 * math.pi * j / across
            text += f"v {(big + small * math.cos(v)) * math.cos(u)!r} {(big + small * math.cos(v)) * math.sin(u)!r} " \
                    f"{small * math.sin(v)!r}\n"
    number = lambda i, j: 1 + (i % around) * across + j % across
    for i in range(around):
        for j in range(across):
            text += f"f {number(i, j)} {number(i + 1, j)} {number(i + 1, j + 1)}\n"
            text += f"f {number(i, j)} {number(i + 1, j + 1)} {number(i, j + 1)}\n"
    return text


def comb(corners, turned=False, gap=0.45):
    """A comb of about so many corners: a spine and thin teeth."""
    teeth = (corners - 4) // 4
    ring = [[0.0, -1.0], [float(teeth), -1.0], [float(teeth), 0.0]]
    for k in reversed(range(teeth)):
        x = float(k)
        ring += [[x + 1 - gap / 2, 0.0], [x + 1 - gap / 2, 5.0], [x + gap / 2, 5.0], [x + gap / 2, 0.0]]
    ring.append([0.0, 0.0])
    if turned:
        ring = [[-y, x] for x, y in ring]
    return {"outer": ring}


def jagged(corners, seed):
    source, ring = random.Random(seed), []
    for k in range(corners):
        radius, angle = source.uniform(0.3, 1), 2 * math.pi * k / corners
        ring.append([radius * math.cos(angle), radius * math.sin(angle)])
    return {"outer": ring}


def random_union(source):
    """One to three parts, of which the first is curved or swept, some of them thin."""
    size = lambda: 2.0 ** source.uniform(-1, 1)
    kinds = ({"type": "ellipsoid", "radii": [size(), size(), size() * source.choice((1, 2.0 ** -8, 2.0 ** -16))]},
             {"type": "cylinder", "radius": size(), "half_height": source.choice((size(), 2.0 ** -12)), "axis": "z"},
             {"type": "cone", "radius": size(), "half_height": size(), "axis": "z"},
             {"type": "capsule", "radius": size() / 4, "half_height": size(), "axis": "x"},
             {"type": "sphere", "radius": size()},
             {"type": "box", "half_extents": [size(), size(), size()], "margin": 0.1},
             {"type": "box", "half_extents": [size(), size(), size() / 64]})
    parts = []
    for k in range(source.randint(1, 3)):
        turn = [source.gauss(0, 1) for _ in range(4)]
        length = math.sqrt(sum(x * x for x in turn))
        parts.append({"shape": kinds[source.randrange(6 if k == 0 else 7)],
                      "pose": {"translation": [source.uniform(-1, 1) for _ in range(3)],
                               "quaternion_wxyz": [x / length for x in turn]}})
    return {"type": "compound", "parts": parts}


# ---- judges ---------------------------------------------------------------------------------------------------------


def crashed(run):
    return f"signal {run.signal}" if run.signal else ""


def code_of(answer):
    return answer.get("error", {}).get("code", "")


def bracket(run, delta):
    """An answer with a bracket that is as narrow as asked, or says that it is not."""
    if crashed(run):
        return crashed(run), ""
    answer = run.answers()[-1]
    if "error" in answer:
        return "refused: " + code_of(answer), ""
    low, high = answer["lower"], answer["upper"]
    said = f"[{low:.4g}, {high:.4g}]" + (" unreached" if answer.get("bracket_reached") is False else "")
    if not low <= high:
        return "a bracket upside down", said
    wide = high > (1 + delta) * low * (1 + 1e-9) and high - low > 4e-15 * max(1, high)
    if wide and answer.get("bracket_reached") is not False:
        return "wider than asked, and nothing says so", said
    return "", said


def refused(answer, codes):
    return "" if code_of(answer) in codes else f"not refused by name: {json.dumps(answer)[:80]}"


def off_ellipsoid(radii, centre, p):
    """The distance outside of an ellipsoid, to first order; negative inside."""
    away = [x - c for x, c in zip(p, centre)]
    norm = math.sqrt(sum((x / r) ** 2 for x, r in zip(away, radii)))
    slope = math.sqrt(sum((x / r / r) ** 2 for x, r in zip(away, radii))) / norm
    return (norm - 1) / slope
