#!/usr/bin/env python3
"""Input of strangers, row by row: slow, huge, malformed and spoilt. Each row is made, run with its time and memory, and judged.

    tests/long/strangers_input.py [PDEPTH [--only PREFIX] [--markdown]]        build/release/pdepth

Prints a table: the row, what it may take, what it took (user and system time, peak memory), and the verdict. Times are of the
processes that the command started, so a busy machine inflates them little. Ends with 1 where a row misses its goal. Rows that need
the library rather than the command (worlds, contact brackets, Python) name the test that holds them. Seeds are fixed.
"""
import argparse
import json
import os
import pathlib
import random
import resource
import subprocess
import sys
import tempfile

from strangers_parts import (BOX, ROWS, SECONDS, SMALL, Place, Run, at, bracket, code_of, comb, crashed, jagged, off_ellipsoid,
                             random_union, refused, row, sphere_points, star, torus)

# ---- A: a service with its limits on --------------------------------------------------------------------------------

BUDGET = ("--max-time", "2000", "--max-memory", "500", "--max-line", "1000000", "--max-vertices", "10000")


@row("A1 a line without b, in a budget", 1)
def _(place):
    run = place.ask('{"id":1,"query":"depth","a":{"type":"box","half_extents":[1,1,1]}}',
                    {"id": 2, "query": "depth", "a": BOX, "b": BOX}, options=("--max-time", "2"))
    answers = run.answers()
    return run, crashed(run) or refused(answers[0], {"missing_field", "limit_exceeded"}) or ("" if len(answers) == 2 else "stream ended")


@row("A1 5,000 points in a budget of 1 ms", 2)
def _(place):
    points = [{"id": i, "query": "depth", "a": {"type": "convex", "vertices": sphere_points(3, 5000)}} for i in range(2)]
    run = place.ask(*points, options=("--max-time", "1", *BUDGET[2:]))
    return run, crashed(run) or ("" if len(run.answers()) == 2 else "stream ended")


def many_objects(bytes_wanted):
    return '{"id":1,"query":"hull","x":[' + ",".join(["{}"] * (bytes_wanted // 3)) + "]}"


@row("A2 57 MB of {} with all limits", 1, 228)
def _(place):
    run = place.ask(many_objects(57_000_000), {"id": 2, "query": "hull", "a": BOX},
                    options=("--max-time", "100", "--max-memory", "100", "--max-vertices", "100"))
    answers = run.answers()
    return run, crashed(run) or refused(answers[0], {"limit_exceeded", "bad_value"}) or \
        ("" if "vertices" in answers[1] else "the next line was refused")


@row("A2 57 MB of {} without limits", 2, 228)
def _(place):
    run = place.ask(many_objects(57_000_000))
    return run, crashed(run) or refused(run.answers()[0], {"limit_exceeded", "bad_value", "missing_field"})


@row("A3 ids come back byte for byte", 1)
def _(place):
    ids = ["12345678901234567890123", '{"translation":[1e0, 2],"bracket_reached":false}', "1E5", '"\\u0041"', "-0"]
    lines = [f'{{"id":{text},"query":"depth","a":{json.dumps(BOX)},"b":{json.dumps(BOX)}}}' for text in ids]
    run = place.ask(*lines, options=BUDGET)
    wrong = [i for i, line in zip(ids, run.out.splitlines()) if not line.startswith('{"id":' + i + ",")]
    return run, crashed(run) or ", ".join(wrong)


# ---- B: answers -----------------------------------------------------------------------------------------------------


@row("B1 a box and an ellipsoid that touch", 1)
def _(place):
    run = place.ask({"id": 1, "query": "depth", "a": BOX, "b": {"type": "ellipsoid", "radii": [1, 0.5, 2]},
                     "pose_b": at(2, 0, 0)})
    answer = run.answers()[0]
    off = max(abs(off_ellipsoid([1, 0.5, 2], [2, 0, 0], answer["witness_b"])),
              max(0, max(abs(x) for x in answer["witness_a"]) - 1))
    return run, crashed(run) or ("" if off < 1e-9 else f"a witness is {off:.2g} off")


@row("B2 ellipsoids at one place", 1)
def _(place):
    radii = ([0.01, 0.1, 2], [2, 2, 2.0 ** -16])
    run = place.ask({"id": 1, "query": "depth", "a": {"type": "ellipsoid", "radii": radii[0]},
                     "b": {"type": "ellipsoid", "radii": radii[1]}})
    answer = run.answers()[0]
    off = max(off_ellipsoid(r, [0, 0, 0], answer[w]) for r, w in zip(radii, ("witness_a", "witness_b")))
    return run, crashed(run) or ("" if off < 2e-9 else f"a witness is {off:.2g} off")


def slim(delta):
    parts = [{"shape": {"type": "convex", "vertices": [[0, 0, 0], [2, 0, 0], [0, 2, 0]]}},
             {"shape": {"type": "convex", "vertices": [[-1, 0, 0.25], [1, 0.5, -0.5]]}}]
    return {"id": 1, "query": "depth", "delta": delta, "b": {"type": "compound", "parts": parts},
            "a": {"type": "cylinder", "radius": 1, "half_height": 2.0 ** -12, "axis": "z"}}


@row("B3 a flat cylinder in a union, delta 1e-2", 1)
def _(place):
    run = place.ask(slim(1e-2))
    return (run, *bracket(run, 1e-2))


@row("B3 width by grid, delta 1e-3", 1)
def _(place):
    run = place.ask({"id": 1, "query": "width", "method": "grid", "delta": 1e-3,
                     "a": {"type": "cylinder", "radius": 1, "half_height": 2.0 ** -20, "axis": "z"}})
    return (run, *bracket(run, 1e-3))


# ---- C: time and memory ---------------------------------------------------------------------------------------------

UNION = {"type": "compound", "parts": [{"shape": BOX}, {"shape": {"type": "convex", "vertices": [
    [0.5, 0.5, 0.5], [2.5, 0.6, 0.4], [0.7, 2.4, 0.5], [0.6, 0.5, 2.6]]}}]}

for k in (8, 10, 12, 24):
    @row(f"C1 an ellipsoid [1, 1, 2^-{k}] on a union", SMALL)
    def _(place, k=k):
        run = place.ask({"id": 1, "query": "depth", "a": {"type": "ellipsoid", "radii": [1, 1, 2.0 ** -k]}, "b": UNION})
        return (run, *bracket(run, 1e-2))

for radius in (0.01, 0.003, 7e-5):
    @row(f"C2 a sphere of {radius:g} in a star of 22", SMALL)
    def _(place, radius=radius):
        run = place.ask({"id": 1, "query": "depth", "a": {"type": "sphere", "radius": radius}, "b": star(4, 5)})
        return (run, *bracket(run, 1e-2))


for first in range(0, 300, 100):
    @row(f"C2 the slowest of 100 pairs of unions with curved parts, from {first}", SMALL)
    def _(place, first=first):
        runs, faults, unreached = [], [], 0
        for seed in range(first, first + 100):
            source = random.Random(seed)
            run = place.ask({"id": seed, "query": "depth", "a": random_union(source), "b": random_union(source),
                             "pose_b": at(*(source.uniform(-0.7, 0.7) for _ in range(3)))})
            fault, said = bracket(run, 1e-2)
            runs.append((run.seconds, seed, run))
            faults += [f"{seed}: {fault}"] * bool(fault)
            unreached += "unreached" in said
        seconds, seed, slowest = max(runs)
        mean = sum(r[0] for r in runs) / len(runs)
        return slowest, "; ".join(faults), f"pair {seed}, mean {mean:.3f} s, {unreached} unreached"


@row("C3 a coin of 2^-12 in a star of 6", SMALL)
def _(place):
    run = place.ask({"id": 1, "query": "depth", "b": star(1, 4),
                     "a": {"type": "cylinder", "radius": 0.2, "half_height": 2.0 ** -12, "axis": "z"}})
    return (run, *bracket(run, 1e-2))

for rings, around, goal in ((4, 6, SMALL), (3, 17, SECONDS)):
    @row(f"C4 minkowski_difference of two stars of {rings * around + 2}", goal)
    def _(place, rings=rings, around=around):
        run = place.ask({"id": 1, "query": "minkowski_difference", "a": star(rings, around), "b": star(rings, around, 8)})
        answer = run.answers()[0] if not run.signal else {}
        return run, crashed(run) or ("" if "facets" in answer or code_of(answer) == "limit_exceeded" else "no answer"), \
            "refused by name" if "error" in answer else f"{len(answer['facets'])} facets"


def dimension_queries(dimension, count, epsilon, backend):
    a, b = ({"points": sphere_points(dimension, count, seed)} for seed in (1, 2))
    each = {
        "approx_directional_width": {"a": a, "directions": [[1.0] + [0.0] * (dimension - 1)], "method": backend},
        "approx_width": {"a": a, "backend": backend},
        "approx_intersect": {"a": a, "b": b, "backend": backend},
        "approx_minkowski_sum": {"a": a, "b": b, "representation": "points", "backend": backend},
        "approx_membership": {"a": a, "points": [[0.1] * dimension], "backend": backend},
        "approximate": {"a": a, "representation": "halfspaces"},
        "epsilon_kernel": {"a": a},
    }
    for name, fields in each.items():
        yield {"id": name, "query": name, "epsilon": epsilon, **fields}


for dimension, count, epsilon in ((5, 17, 0.005), (5, 64, 0.01), (5, 1000, 0.005), (4, 2000, 0.01)):
    for backend in ("macbeath", "kernel"):
        for k in range(7):
            if backend == "kernel" and k < 3:
                continue
            words = ("directional width", "width", "intersect", "sum", "membership", "approximate", "kernel")[k]
            if backend == "macbeath" and k > 4:
                continue
            @row(f"C5 {count} points in R^{dimension}, epsilon {epsilon:g}, {backend}: {words}")
            def _(place, arguments=(dimension, count, epsilon, backend), k=k):
                run = place.ask(list(dimension_queries(*arguments))[k])
                answer = run.answers()[0] if not run.signal else {}
                return run, crashed(run) or ("refused: " + code_of(answer) if "error" in answer else ""), \
                    "unreached" if answer.get("bracket_reached") is False else ""

for name, p, q in (("combs of 260", comb(260), comb(260)), ("a comb of 260 and the same turned", comb(260), comb(260, True)),
                   ("jagged polygons of 400", jagged(400, 1), jagged(400, 2)),
                   ("jagged polygons of 500", jagged(500, 3), jagged(500, 4)), ("combs of 500", comb(500), comb(500)),
                   ("a comb of 500 and the same turned", comb(500), comb(500, True))):
    @row(f"C6 polygon_depth of {name}")
    def _(place, p=p, q=q):
        run = place.ask({"id": 1, "query": "polygon_depth", "p": p, "q": q})
        answer = run.answers()[0] if not run.signal else {}
        return run, crashed(run) or ("" if "depth" in answer or code_of(answer) == "limit_exceeded" else code_of(answer)), \
            "refused by name" if "error" in answer else f"depth {answer['depth']:.4g}"

for thin in (1e-18, 1e-150):
    @row(f"C7 width by grid of a box 1 x 1 x {thin:g}", SMALL)
    def _(place, thin=thin):
        run = place.ask({"id": 1, "query": "width", "method": "grid", "delta": 0.1,
                         "a": {"type": "box", "half_extents": [1, 1, thin]}})
        return (run, *bracket(run, 0.1))


@row("C8 shallow with delta 1.1e-5 on 32 vertices", SMALL)
def _(place):
    a, b = ({"type": "convex", "vertices": sphere_points(3, 32, seed)} for seed in (5, 6))
    run = place.ask({"id": 1, "query": "depth", "method": "shallow", "delta": 1.1e-5, "a": a, "b": b})
    return (run, *bracket(run, 1.1e-5))


@row("C9 two tori of 48 triangles as solids", SMALL)
def _(place):
    file = place.write("torus.obj", torus())
    run = place.ask({"id": 1, "query": "depth", "a": {"type": "mesh", "path": file}, "b": {"type": "mesh", "path": file},
                     "pose_b": at(0.31, 0.17, 0.05)})
    return (run, *bracket(run, 1e-2))


# ---- D: files of strangers ------------------------------------------------------------------------------------------


def ask_mesh(place, path, options=()):
    return place.ask({"id": 1, "query": "hull", "a": {"type": "mesh", "path": path}}, options=options)


def gltf(uri, length=48, nodes=None):
    return json.dumps({
        "asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}], "nodes": nodes or [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"}],
        "bufferViews": [{"buffer": 0, "byteOffset": 0, "byteLength": length}], "buffers": [{"uri": uri, "byteLength": length}]})


UNREADABLE = {"unreadable_file", "limit_exceeded", "unsupported", "bad_value"}

for uri in ("../../../../etc/passwd", "/etc/passwd", "/dev/stdin", "..%2F..%2Fetc%2Fpasswd", "link.bin", "pipe"):
    @row(f"D1 glTF with a buffer {uri}", 0.3, 100)
    def _(place, uri=uri):
        for path, make in (("link.bin", lambda p: os.symlink("/etc/passwd", p)), ("pipe", os.mkfifo)):
            if not os.path.lexists(os.path.join(place.folder, path)):
                make(os.path.join(place.folder, path))
        run = ask_mesh(place, place.write("scene.gltf", gltf(uri)))
        return run, crashed(run) or refused(run.answers()[0], UNREADABLE)


@row("D2 glTF in which each node has its child twice, 22 levels", 0.5, 100)
def _(place):
    nodes = [{"children": [k + 1, k + 1]} for k in range(22)] + [{"mesh": 0}]
    run = ask_mesh(place, place.write("twice.gltf", gltf("part.bin", nodes=nodes)))
    return run, crashed(run) or refused(run.answers()[0], UNREADABLE)


@row("D2 GLB of 28 bytes that claims 2^32 - 1", 0.5, 100)
def _(place):
    claim = (2 ** 32 - 1).to_bytes(4, "little")
    run = ask_mesh(place, place.write("claim.glb", b"glTF\x02\0\0\0" + claim + claim + b"JSON{}  " + b"\0" * 4))
    return run, crashed(run) or refused(run.answers()[0], UNREADABLE)


@row("D2 glTF with 17,421 nodes in a chain", 1, 200)
def _(place):
    nodes = [{"children": [k + 1]} for k in range(17421)] + [{"mesh": 0}]
    run = ask_mesh(place, place.write("chain.gltf", gltf("part.bin", nodes=nodes)))
    return run, crashed(run) or refused(run.answers()[0], UNREADABLE)


@row("D2 glTF with JSON nested 176,000 deep", 1, 200)
def _(place):
    run = ask_mesh(place, place.write("deep.gltf", '{"asset":' + "[" * 176000 + "]" * 176000 + "}"))
    return run, crashed(run) or refused(run.answers()[0], UNREADABLE)

for file in ("/dev/zero", "pipe", "/dev/stdin"):
    @row(f"D3 points_file {file}", 0.5, 100)
    def _(place, file=file):
        path = os.path.join(place.folder, "pipe")
        if not os.path.lexists(path):
            os.mkfifo(path)
        line = {"id": 1, "query": "epsilon_kernel", "epsilon": 0.1, "a": {"points_file": path if file == "pipe" else file}}
        run = place.ask(line, {"id": 2, "query": "hull", "a": BOX}, options=("--max-vertices", "100"))
        answers = run.answers()
        return run, crashed(run) or refused(answers[0], UNREADABLE) or ("" if len(answers) == 2 else "a line was eaten")


@row("D4 .npy of shape (2, 2, 2)", 0.3, 100)
def _(place):
    head = b"{'descr': '<f8', 'fortran_order': False, 'shape': (2, 2, 2), }"
    head += b" " * (118 - len(head) - 1) + b"\n"
    file = place.write("cube.npy", b"\x93NUMPY\x01\x00" + len(head).to_bytes(2, "little") + head + b"\0" * 64)
    run = place.ask({"id": 1, "query": "epsilon_kernel", "epsilon": 0.1, "a": {"points_file": file}})
    return run, crashed(run) or refused(run.answers()[0], UNREADABLE)


@row("D4 a NUL byte in a row of text", 0.3, 100)
def _(place):
    file = place.write("nul.txt", b"0 0\n1 \x000\n0 1\n1 1\n")
    run = place.ask({"id": 1, "query": "epsilon_kernel", "epsilon": 0.1, "a": {"points_file": file}})
    return run, crashed(run) or refused(run.answers()[0], UNREADABLE)


@row("D4 OBJ with a byte order mark", 0.3, 100)
def _(place):
    run = ask_mesh(place, place.write("mark.obj", b"\xef\xbb\xbfv 5 0 0\nv 0 1 0\nv 0 0 1\nv 0 0 0\n"))
    found = run.answers()[0].get("vertices", [])
    return run, crashed(run) or ("" if [5, 0, 0] in found else "the first vertex is lost")


@row("D4 numbers with 500 zeros", 0.3, 100)
def _(place):
    big, small = "1" + "0" * 500 + "e-500", "0." + "0" * 400 + "1e401"
    run = ask_mesh(place, place.write("zeros.obj", f"v {big} 0 0\nv 0 {small} 0\nv 0 0 1\nv 0 0 0\n"))
    found = run.answers()[0].get("vertices", [])
    return run, crashed(run) or ("" if [1, 0, 0] in found and [0, 1, 0] in found else f"read as {found}")


@row("D5 SVG with 14,564 nested groups", 0.5, 200)
def _(place):
    deep = "<g>" * 14564 + "<rect width='1' height='1'/>" + "</g>" * 14564
    file = place.write("deep.svg", "<svg xmlns='http://www.w3.org/2000/svg'>" + deep + "</svg>")
    run = place.run("polygon", file, file)
    return run, crashed(run) or ("" if run.code == 2 and run.err else f"exit {run.code}")


@row("D6 sizes that fit no double, duplicate keys", 0.3, 100)
def _(place):
    run = place.ask('{"id":1,"query":"hull","a":{"type":"sphere","radius":1e999}}',
                    '{"id":2,"query":"hull","a":{"type":"box","half_extents":[1,1,1]},"a":1}')
    codes = [code_of(answer) for answer in run.answers()]
    return run, crashed(run) or ("" if codes == ["bad_json", "bad_json"] else str(codes))


# ---- E: outputs -----------------------------------------------------------------------------------------------------


@row("E1 standard output is full", 0.5, 100)
def _(place):
    with open("/dev/full", "wb") as full:
        runs = [Run([place.program, "depth", "box:1,1,1", "box:1,1,1"], stdout=full),
                Run([place.program, "polygon", place.write("p.json", json.dumps(jagged(5, 1))),
                     place.write("q.json", json.dumps(jagged(5, 2)))], stdout=full)]
    return runs[0], next((f"exit {r.code}" for r in runs if r.code != 1), "")


@row("E2 outputs that are inputs", 0.5, 100)
def _(place):
    lines = place.write("lines", json.dumps({"id": 1, "query": "hull", "a": BOX}) + "\n")
    mesh = place.write("mesh.obj", torus())
    runs = [place.run("query", lines, "--record", lines), place.run("simplify", mesh, "--epsilon", "0.1", "-o", mesh),
            place.run("depth", mesh, mesh, "--trace", mesh)]
    kept = pathlib.Path(mesh).read_text() == torus() and pathlib.Path(lines).read_text().count("\n") == 1
    return runs[0], next((f"exit {r.code}" for r in runs if r.code not in (1, 2)), "" if kept else "an input has changed")


@row("E3 a file name with a newline", 0.5, 100)
def _(place):
    mesh, out = place.write("a\nv 9 9 9.obj", torus()), os.path.join(place.folder, "out.obj")
    run = place.run("simplify", mesh, "--epsilon", "0.5", "-o", out)
    text = pathlib.Path(out).read_text() if os.path.exists(out) else ""
    return run, crashed(run) or ("" if text and "\nv 9 9 9" not in text else "the name has become a vertex, or no file")


# ---- G to I: held by tests ------------------------------------------------------------------------------------------

HELD = (
    ("B4 Bracket::contact on crossed roofs", "test_depth, hard_cases/contact_bracket.jsonl"),
    ("B5 manifold points of all kinds lie on their bodies", "test_depth Members.*, member_pairs --pairs 100000"),
    ("E4 a full disk, a killed process, two writers", "tests/long/outputs.sh"),
    ("G  bodies removed in a step that is cut, 5,000 bodies, snapshots", "test_engine_glue"),
    ("H  objects never made, Ctrl-C, arrays that do not fit", "tests/python/test_hostile_use.py"),
    ("I  three.js's licence stands where its code does", "test_cli Outputs.PagesHoldTheLicenceOfTheCodeInThem"),
    ("I  stack protector, _FORTIFY_SOURCE, -z now", "packaging/hardening.sh"),
)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("program", nargs="?", default="build/release/pdepth")
    parser.add_argument("--only", default="", help="rows whose name begins so")
    parser.add_argument("--markdown", action="store_true", help="a table for the notebook")
    arguments = parser.parse_args()
    program = os.path.abspath(arguments.program)
    for needed in (program, "/usr/bin/time"):
        if not os.access(needed, os.X_OK):
            parser.error(f"{needed} is not there; /usr/bin/time is in Debian's package time")
    resource.setrlimit(resource.RLIMIT_AS, (6 << 30, 6 << 30))  # a row without a bound ends here
    line = "| {} | {} | {} | {} |" if arguments.markdown else "{:<68} {:>14}  {:>16}  {}"
    print(line.format("row", "goal", "took", "verdict"))
    if arguments.markdown:
        print("|---|---:|---:|---|")
    missed = 0
    for name, seconds, megabytes, make in ROWS:
        if not name.startswith(arguments.only):
            continue
        with tempfile.TemporaryDirectory() as folder:
            try:
                run, fault, *more = make(Place(program, folder))
                took = f"{run.seconds:.2f} s, {run.megabytes:.0f} MB"
                slow = ["too slow"] * (run.seconds > seconds) + ["too large"] * (run.megabytes > megabytes)
            except (ValueError, LookupError, OSError, subprocess.TimeoutExpired) as error:
                fault, more, took, slow = f"{type(error).__name__}: {error}", [], "", []
        verdict = "; ".join(filter(None, [fault, *slow])) or "holds"
        missed += verdict != "holds"
        said = ", ".join(filter(None, [verdict, *more]))
        print(line.format(name, f"{seconds:g} s, {megabytes:g} MB", took, said), flush=True)
    for name, where in HELD:
        if name.startswith(arguments.only):
            print(line.format(name, "", "", "held by " + where))
    if missed:
        print(f"\n{missed} rows miss their goal.")
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
