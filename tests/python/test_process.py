"""What a long-lived process needs: flat memory, threads, forks, a quick import, and packages that stand alone."""
import multiprocessing
import os
import resource
import subprocess
import sys
import threading

import numpy as np
import pdepth

GEM = pdepth.ConvexPolytope(np.random.default_rng(0).normal(size=(20, 3)))
BOX = pdepth.Box([1, 1, 1])
PACKAGE = os.path.dirname(os.path.dirname(pdepth.__file__))


def resident_bytes():
    with open("/proc/self/statm", encoding="ascii") as file:
        return int(file.read().split()[1]) * resource.getpagesize()


def test_a_million_calls_leave_memory_flat():
    """1e6 pairs in single calls; PDEPTH_LEAK_CALLS sets another number."""
    calls = int(os.environ.get("PDEPTH_LEAK_CALLS", "1000000"))
    ball, pose = pdepth.Sphere(1.0), pdepth.Pose(translation=[1.5, 0, 0])
    bad = pdepth.Pose(translation=[0, 0, 0])

    def some(n):
        for _ in range(n):
            answer = pdepth.depth(ball, ball, bad, pose)
            answer.translation
        try:
            pdepth.Sphere(-1)
        except ValueError:
            pass

    some(20_000)
    before = resident_bytes()
    for _ in range(50):
        some(calls // 50)
    assert resident_bytes() - before < 2 << 20


def test_batches_and_refusals_leave_memory_flat(poses):
    matrices = poses(500)
    matrices[::7, 0, 0] = np.nan
    for round_ in range(40):
        pdepth.depth(GEM, BOX, matrices)
        pdepth.query("hull", a=GEM)
        if round_ == 10:
            before = resident_bytes()
    assert resident_bytes() - before < 4 << 20


def test_threads_share_shapes_and_get_the_same_bits(poses):
    matrices = poses(400)
    expected = pdepth.depth(GEM, BOX, matrices, threads=1)
    wrong = []

    def work(k):
        for i in range(k, 400, 4):
            if pdepth.depth(GEM, BOX, matrices[i]).depth != expected.depth[i]:
                wrong.append(i)
        if not np.array_equal(pdepth.depth(GEM, BOX, matrices, threads=2).normal, expected.normal):
            wrong.append(-1)

    threads = [threading.Thread(target=work, args=(k,)) for k in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not wrong


def test_the_lock_is_released(poses):
    matrices = poses(30_000)
    ticks, done = [], threading.Event()

    def tick():
        while not done.wait(0.002):
            ticks.append(1)

    clock = threading.Thread(target=tick)
    clock.start()
    pdepth.depth(GEM, BOX, matrices, threads=1)
    done.set()
    clock.join()
    assert len(ticks) > 10


def _child(matrices, queue):
    queue.put(pdepth.depth(GEM, BOX, matrices).depth)


def test_a_fork_after_batches_answers_alike(poses):
    matrices = poses(200)
    expected = pdepth.depth(GEM, BOX, matrices).depth
    context = multiprocessing.get_context("fork")
    queue = context.Queue()
    children = [context.Process(target=_child, args=(matrices, queue)) for _ in range(2)]
    for child in children:
        child.start()
    for _ in children:
        assert np.array_equal(queue.get(timeout=60), expected)
    for child in children:
        child.join()


def test_import_costs_less_than_a_tenth_of_a_second_beyond_numpy():
    """Time of the processor: what else the machine does is none of the import's."""
    script = "import numpy, time; t = time.process_time(); import pdepth; print(time.process_time() - t)"
    environment = {**os.environ, "PYTHONPATH": PACKAGE}
    times = [float(subprocess.run([sys.executable, "-c", script], env=environment, capture_output=True, text=True,
                                  check=True).stdout) for _ in range(5)]
    assert min(times) < 0.1
