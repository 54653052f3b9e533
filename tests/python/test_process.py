"""What a long-lived process needs: flat memory, threads, forks, a quick import, and packages that stand alone."""
import multiprocessing
import os
import resource
import subprocess
import sys
import threading

import numpy as np
import pdepth
import pytest

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


@pytest.mark.parametrize("call", ["pdepth.depth(a, a, poses)", "pdepth.depth(a, a, poses, threads=1)",
                                  "[pdepth.depth(a, a, delta=0.5) for _ in range(10**7)]",
                                  "pdepth.query_many('width', [{'a': a}] * 3000)",
                                  "[pdepth.query('width', a=a) for _ in range(10**6)]"])
def test_python_ends_quietly_while_a_daemon_thread_asks(call):
    script = f"""if True:
        import pdepth, threading, time, numpy as np
        a = pdepth.ConvexPolytope(np.random.RandomState(0).normal(size=(500, 3)))
        poses = np.tile(np.eye(4), (30000, 1, 1))
        threading.Thread(target=lambda: {call}, daemon=True).start()
        time.sleep(0.3)
        print("end")
    """
    for _ in range(3):
        ran = subprocess.run([sys.executable, "-c", script], env={**os.environ, "PYTHONPATH": PACKAGE}, capture_output=True,
                             text=True, timeout=60)
        assert (ran.returncode, ran.stdout, ran.stderr) == (0, "end\n", "")


def test_one_warm_in_two_threads_is_refused():
    """One thread holds it through a long question of unions; others are told so, and nothing is lost."""
    rng = np.random.default_rng(2)
    parts = [(pdepth.ConvexPolytope(rng.normal(size=(40, 3))), pdepth.Pose(translation=4 * rng.normal(size=3))) for _ in range(40)]
    pile, warm, refusals, asked = pdepth.Compound(parts), pdepth.Warm(), [], []

    def ask(each):
        for _ in range(5):
            try:
                asked.append(each())
            except pdepth.Refused as error:
                refusals.append((error.where, error.code))

    calls = [lambda: pdepth.depth(pile, pile, warm=warm).depth] * 4
    threads = [threading.Thread(target=ask, args=(call,)) for call in calls]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert set(refusals) == {("warm", "in_use")} and len(set(asked)) == 1
    assert pdepth.depth(GEM, BOX, warm=warm).depth == pdepth.depth(GEM, BOX).depth and warm.nbytes > 0
    warm.clear()


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
