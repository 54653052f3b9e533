#!/usr/bin/env python3
"""A record of N contacts between 64 hulls of 32 vertices, written to standard output for `pdepth audit -`.

    python3 tests/bench/programs/hull_contacts.py 1000000 | pdepth audit -

What is reported is made up: what counts here is the time and the memory of judging it.
"""
import math
import random
import sys


def number(x):
    return f"{x:.9g}"


def direction(rng):
    while True:
        v = [rng.uniform(-1, 1) for _ in range(3)]
        size = math.sqrt(sum(x * x for x in v))
        if 0.1 < size <= 1:
            return [x / size for x in v]


def quaternion(rng):
    while True:
        q = [rng.uniform(-1, 1) for _ in range(4)]
        size = math.sqrt(sum(x * x for x in q))
        if 0.1 < size <= 1:
            return ",".join(repr(x / size) for x in q)


def main(count, out):
    rng = random.Random(1)
    out.write('{"record":"pdepth-contacts/1","engine":"made up","scalar":"float32"}\n')
    for k in range(64):
        points = ",".join("[" + ",".join(number(x) for x in direction(rng)) + "]" for _ in range(32))
        out.write(f'{{"shape":"h{k}","is":{{"type":"convex","vertices":[{points}]}}}}\n')
    turns = [quaternion(rng) for _ in range(997)]
    normals = [",".join(number(x) for x in direction(rng)) for _ in range(991)]
    for i in range(count):
        reach = 0.5 + 1.4 * rng.random()
        way = ",".join(number(reach * float(x)) for x in normals[i % 983].split(","))
        out.write(f'{{"contact":{i},"a":"h{i % 64}","pose_a":{{"translation":[0,0,0],"quaternion_wxyz":[{turns[i % 997]}]}},'
                  f'"b":"h{i * 7 % 61}","pose_b":{{"translation":[{way}],"quaternion_wxyz":[{turns[i * 31 % 997]}]}},'
                  f'"reported":{{"depth":{number(1.8 - reach)},"normal":[{normals[i % 991]}]}}}}\n')


if __name__ == "__main__":
    main(int(sys.argv[1]), sys.stdout)
