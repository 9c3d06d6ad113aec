"""The package as a part of a process: threads, signals, memory, start, and the program beside it."""

import os
import resource
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest
import raywarp


@pytest.fixture
def scene(soup):
    scene = raywarp.Scene("cpu")
    scene.mesh(*soup)
    return scene


def python(code, *words, **options):
    """Runs a program of Python and returns what it printed."""
    done = subprocess.run([sys.executable, "-c", code, *words], capture_output=True, text=True, **options)
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.mark.parametrize("mode", ["closest", "any", "count", "all"])
def test_the_program_gives_the_same_bits(tmp_path, soup, rays, mode):
    vertices, faces = soup
    lines = ["v {} {} {}".format(*map(repr, vertex)) for vertex in vertices.tolist()]
    lines += ["f {} {} {}".format(*face) for face in (faces + 1).tolist()]
    (tmp_path / "soup.obj").write_text("\n".join(lines))
    np.save(tmp_path / "rays.npy", rays.reshape(20, 25, 6))
    program = [sys.executable, "-m", "raywarp"]
    words = f"query soup.obj --rays rays.npy --mode {mode} --device cpu -o answers.npz --quiet".split()
    subprocess.run(program + words, cwd=tmp_path, check=True)
    answers = np.load(tmp_path / "answers.npz")

    scene = raywarp.Scene.open(tmp_path / "soup.obj", "cpu")
    answer = getattr(scene, mode)(rays.reshape(20, 25, 6))
    if mode in ("any", "count"):
        arrays = {{"any": "occluded", "count": "count"}[mode]: answer}
    else:
        arrays = {name: getattr(answer, name) for name in answers.files}
    for name in answers.files:
        assert answers[name].shape == arrays[name].shape
        assert answers[name].tobytes() == arrays[name].tobytes(), name


def test_the_program_is_on_the_path():
    script = os.path.join(os.path.dirname(sys.executable), "raywarp")
    for program in ([script], [sys.executable, "-m", "raywarp"]):
        done = subprocess.run([*program, "--version"], capture_output=True, text=True, check=True)
        assert done.stdout.strip() == f"raywarp {raywarp.__version__}"
        done = subprocess.run([*program, "render", "none.obj"], capture_output=True, text=True)
        assert done.returncode == 2 and done.stderr.startswith("error: cannot read none.obj")


def test_several_threads_ask_one_scene(scene, rays):
    expected = scene.closest(rays).t
    seen = []

    def ask():
        seen.extend(np.array_equal(scene.closest(rays).t, expected) for _ in range(20))

    threads = [threading.Thread(target=ask) for _ in range(8)]
    [thread.start() for thread in threads]
    [thread.join() for thread in threads]
    assert seen == [True] * 160


def test_scenes_change_while_others_ask(square):
    scene = raywarp.Scene("cpu")
    mesh = scene.mesh(*square)
    ray = np.float32([0.5, 0.25, 9, 0, 0, -1])
    seen = []
    asking = threading.Thread(target=lambda: seen.extend(float(scene.closest(ray).t) for _ in range(300)))
    asking.start()
    for step in range(100):
        mesh.vertices = square[0] + np.float32([0, 0, step % 2])
        scene.commit()
    asking.join()
    assert set(seen) <= {8.0, 9.0} and len(seen) == 300


def test_threads_are_limited(scene, rays):
    many = np.tile(rays, (400, 1))
    scene.commit()
    for threads in (1, 2):
        scene.threads = threads
        used = time.process_time()
        began = time.perf_counter()
        scene.closest(many)
        used, took = time.process_time() - used, time.perf_counter() - began
        assert used < (threads + 0.5) * took + 0.05
    with pytest.raises(ValueError, match="threads is 0"):
        scene.threads = 0


def test_other_threads_run_meanwhile(scene, rays):
    many = np.tile(rays, (4000, 1))
    scene.commit()
    asking = threading.Thread(target=scene.count, args=(many,))
    asking.start()
    steps = 0
    while asking.is_alive():
        time.sleep(0.001)
        steps += 1
    assert steps > 5


def test_a_forked_process_asks_too(scene, rays):
    expected = scene.closest(rays).t
    child = os.fork()
    if child == 0:
        os._exit(0 if np.array_equal(scene.closest(rays).t, expected) else 1)
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0


LONG = """
import numpy as np, raywarp, sys
scene = raywarp.Scene("cpu", threads=1)
rng = np.random.default_rng(1)
corners = rng.uniform(-2, 2, (1000, 1, 3)) + rng.uniform(-1, 1, (1000, 3, 3))
scene.mesh(corners.reshape(-1, 3), np.arange(3000).reshape(-1, 3))
scene.commit()
rays = rng.normal(size=(4_000_000, 6))
print("asking", flush=True)
try:
    scene.count(rays)
except KeyboardInterrupt:
    print("interrupted")
print(int(scene.any([0, 0, 9, 0, 0, -1])))
"""


def test_ctrl_c_ends_a_long_batch():
    process = subprocess.Popen([sys.executable, "-c", LONG], stdout=subprocess.PIPE, text=True)
    assert process.stdout.readline() == "asking\n"
    time.sleep(0.5)
    began = time.monotonic()
    process.send_signal(signal.SIGINT)
    output, _ = process.communicate(timeout=60)
    assert output.splitlines() == ["interrupted", "1"], "and the scene can still be asked"
    assert time.monotonic() - began < 10


def test_memory_is_bounded():
    code = """
import numpy as np, raywarp, resource
scene = raywarp.Scene("cpu")
scene.mesh([[-1, -1, 0], [1, -1, 0], [0, 1, 0]], [[0, 1, 2]])
rays = np.zeros((10_000_000, 6), np.float32)
rays[:, 2], rays[:, 5] = 2, -1
before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
hits = scene.closest(rays)
assert hits.t.min() == hits.t.max() == 2
answers = sum(array.nbytes for array in (hits.t, hits.uv, hits.primitive, hits.geometry)) / 1024
print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before - answers)
"""
    # KiB beside the answers: a piece of 4 million rays, and what is asked of it at once.
    assert float(python(code)) < 600 * 1024


def test_nothing_leaks(scene, rays):
    def ask(times):
        for _ in range(times):
            scene.closest(rays), scene.all(rays), scene.any(rays)
        return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss

    before = ask(50)
    assert ask(1000) - before < 8 * 1024


def test_the_import_is_quick():
    code = """
import time, numpy
began = time.perf_counter()
import raywarp
print(time.perf_counter() - began)
"""
    assert min(float(python(code)) for _ in range(5)) < 0.06


def test_numpy_is_all_that_is_needed():
    code = "import raywarp, sys; print(*sorted({name.split('.')[0] for name in sys.modules} - sys.stdlib_module_names))"
    loaded = set(python(code).split())
    assert {name for name in loaded if not name.startswith("_")} <= {"numpy", "raywarp", "sitecustomize"}
