"""Arrays on a CUDA device, of torch, cupy and jax. Needs a GPU and these libraries (each test skips without its own):

python -m pytest cuda_arrays.py -rA -s
"""

import os
import subprocess
import sys
import time

import numpy as np
import pytest
import raywarp

try:
    SCENE = raywarp.Scene("cuda")
except raywarp.DeviceError as error:
    pytest.skip(str(error), allow_module_level=True)

COUNT = 20_000


def soup(triangles=4000, seed=7):
    rng = np.random.default_rng(seed)
    corners = rng.uniform(-2, 2, (triangles, 1, 3)) + rng.uniform(-0.3, 0.3, (triangles, 3, 3))
    return corners.reshape(-1, 3).astype(np.float32), np.arange(3 * triangles).reshape(-1, 3)


def random_rays(count=COUNT, seed=8):
    rng = np.random.default_rng(seed)
    start = rng.normal(size=(count, 3))
    start *= 6 / np.linalg.norm(start, axis=1, keepdims=True)
    return np.concatenate([start, rng.uniform(-2, 2, (count, 3)) - start], axis=1).astype(np.float32)


def eight(rays):
    whole = np.zeros((*rays.shape[:-1], 8), np.float32)
    whole[..., :3], whole[..., 4:7], whole[..., 7] = rays[..., :3], rays[..., 3:], np.inf
    return whole


RAYS = random_rays()


@pytest.fixture(scope="module")
def scenes():
    made = []
    for device in ("cuda", "cpu"):
        scene = raywarp.Scene(device)
        scene.mesh(*soup())
        scene.commit()
        made.append(scene)
    return made


def of_torch():
    torch = pytest.importorskip("torch")
    return lambda array: torch.from_numpy(np.ascontiguousarray(array)).cuda(), lambda array: array.cpu().numpy()


def of_cupy():
    cupy = pytest.importorskip("cupy")
    return cupy.asarray, cupy.asnumpy


def of_jax():
    jax = pytest.importorskip("jax")
    if jax.default_backend() != "gpu":
        pytest.skip("jax has no GPU here")
    return jax.numpy.asarray, np.asarray


def of_numba():
    cuda = pytest.importorskip("numba.cuda")
    if not cuda.is_available():
        pytest.skip("numba has no GPU here")
    return cuda.to_device, lambda array: array.copy_to_host() if hasattr(array, "copy_to_host") else to_host(array)


def to_host(array):
    """Of an array that only has the CUDA array interface."""
    return pytest.importorskip("cupy").asnumpy(pytest.importorskip("cupy").asarray(array))


LIBRARIES = {"torch": of_torch, "cupy": of_cupy, "jax": of_jax}
EVERY = pytest.mark.parametrize("library", list(LIBRARIES))


def same_bits(hits, expected, give):
    for name in ("t", "uv", "primitive", "geometry"):
        one, other = give(getattr(hits, name)), getattr(expected, name)
        assert one.shape == other.shape and one.dtype == other.dtype, name
        assert np.ascontiguousarray(one).tobytes() == other.tobytes(), name


@EVERY
@pytest.mark.parametrize("coherent", [False, True])
def test_closest_has_the_bits_of_the_cpu(scenes, library, coherent):
    take, give = LIBRARIES[library]()
    cuda, cpu = scenes
    for rays in (RAYS, RAYS.reshape(100, 200, 6), RAYS[:1], RAYS[:0]):
        expected = cpu.closest(rays)
        hits = cuda.closest(take(rays), coherent=coherent)
        assert type(hits.t) is type(take(rays))
        same_bits(hits, expected, give)
        same_bits(cuda.closest(take(eight(rays)), coherent=coherent), expected, give)
        directions = take(rays[..., 3:])
        same_bits(cuda.closest(take(rays[..., :3]), directions, coherent=coherent), expected, give)
    one = take(RAYS[0, :3])
    same_bits(cuda.closest(one, take(RAYS[:, 3:])), cpu.closest(RAYS[0, :3], RAYS[:, 3:]), give)
    same_bits(cuda.closest(take(RAYS), t_min=4.0, t_max=6.5), cpu.closest(RAYS, t_min=4.0, t_max=6.5), give)


def test_batches_of_every_size_are_answered_again_and_again(scenes):
    """The counters of persistent threads are zero after each launch, whether warps and blocks are full or not."""
    torch = pytest.importorskip("torch")
    for count in (1, 31, 32, 33, 127, 128, 129, 1000, 4097):
        rays = torch.from_numpy(eight(RAYS[:count])).cuda()
        expected = scenes[1].closest(RAYS[:count])
        for _ in range(3):
            hits = scenes[0].closest(rays)
            same_bits(hits, expected, lambda array: array.cpu().numpy())
            np.testing.assert_array_equal(scenes[0].any(rays).cpu().numpy(), expected.hit)


@EVERY
def test_the_other_questions_have_the_bits_of_the_cpu(scenes, library):
    take, give = LIBRARIES[library]()
    cuda, cpu = scenes
    rays = take(RAYS)
    np.testing.assert_array_equal(give(cuda.any(rays)), cpu.any(RAYS))
    np.testing.assert_array_equal(give(cuda.any(rays, coherent=True)), cpu.any(RAYS))
    np.testing.assert_array_equal(give(cuda.count(rays)), cpu.count(RAYS))
    np.testing.assert_array_equal(give(cuda.count(rays, max_hits=2)), cpu.count(RAYS, max_hits=2))
    found, expected = cuda.all(rays), cpu.all(RAYS)
    same_bits(found, expected, give)
    np.testing.assert_array_equal(give(found.offsets), expected.offsets)
    np.testing.assert_array_equal(give(found.ray), expected.ray)
    same_bits(cuda.all(rays, max_hits=1), cpu.all(RAYS, max_hits=1), give)


@EVERY
def test_points_and_normals(scenes, library):
    take, give = LIBRARIES[library]()
    cuda, cpu = scenes
    hits, expected = cuda.closest(take(RAYS)), cpu.closest(RAYS)
    np.testing.assert_allclose(give(hits.points), expected.points, atol=1e-5)
    np.testing.assert_array_equal(give(hits.normals), expected.normals)
    np.testing.assert_array_equal(give(hits.hit), expected.hit)
    found = cuda.all(take(RAYS))
    np.testing.assert_allclose(give(found.points), cpu.all(RAYS).points, atol=1e-5)


def test_numpy_on_a_gpu_has_the_bits_of_the_cpu(scenes):
    cuda, cpu = scenes
    same_bits(cuda.closest(RAYS), cpu.closest(RAYS), np.asarray)
    same_bits(cuda.all(RAYS), cpu.all(RAYS), np.asarray)


def test_arrays_of_numba(scenes):
    take, _ = of_numba()
    hits = scenes[0].closest(take(eight(RAYS)))
    same_bits(hits, scenes[1].closest(RAYS), to_host)


def test_tensors_of_the_cpu_stay_there(scenes):
    torch = pytest.importorskip("torch")
    for scene in scenes:
        hits = scene.closest(torch.from_numpy(RAYS))
        assert isinstance(hits.t, torch.Tensor) and hits.t.device.type == "cpu"
        assert isinstance(scene.any(torch.from_numpy(RAYS)), torch.Tensor)
        same_bits(hits, scenes[1].closest(RAYS), lambda array: array.numpy())


def test_rows_of_wider_arrays(scenes):
    torch = pytest.importorskip("torch")
    wide = torch.zeros(COUNT, 11, device="cuda")
    wide[:, 2:8] = torch.from_numpy(RAYS)
    same_bits(scenes[0].closest(wide[:, 2:8]), scenes[1].closest(RAYS), lambda array: array.cpu().numpy())
    with pytest.raises(ValueError, match="copy it first"):
        scenes[0].closest(wide[:, :6].T.contiguous().T)


def test_what_cannot_be_is_said(scenes):
    torch = pytest.importorskip("torch")
    cuda, cpu = scenes
    rays = torch.from_numpy(RAYS).cuda()
    with pytest.raises(TypeError, match="rays on a device have to be float32, and are float64"):
        cuda.closest(rays.double())
    with pytest.raises(ValueError, match="rays are on a CUDA device, and the scene is on the CPU"):
        cpu.closest(rays)
    with pytest.raises(ValueError, match="no rays"):
        cuda.closest(rays[:, :5])
    with pytest.raises(ValueError, match="directions are on the CPU"):
        cuda.closest(rays[:, :3], rays[:, 3:].cpu())
    with pytest.raises(TypeError, match="t_min and t_max are numbers"):
        cuda.closest(rays, t_max=rays[:, 0])
    with pytest.raises(ValueError, match="answers have the shape"):
        cuda.any(rays, out=torch.zeros(3, dtype=torch.int32, device="cuda"))


def test_meshes_from_the_device(scenes):
    torch = pytest.importorskip("torch")
    vertices, faces = soup()
    scene = raywarp.Scene("cuda")
    mesh = scene.mesh(torch.from_numpy(vertices).cuda(), torch.from_numpy(faces).cuda())
    same_bits(scene.closest(RAYS), scenes[1].closest(RAYS), np.asarray)
    mesh.vertices = torch.from_numpy(vertices).cuda() + 1
    moved = raywarp.Scene("cpu")
    moved.mesh(vertices + np.float32(1), faces)
    same_bits(scene.closest(RAYS), moved.closest(RAYS), np.asarray)
    scene.instances(mesh, torch.eye(4, device="cuda", dtype=torch.float64))
    same_bits(scene.closest(RAYS), moved.closest(RAYS), np.asarray)


def test_the_order_of_torchs_streams_holds(scenes):
    """Rays are made, asked and overwritten by one stream while the device is busy: nothing waits but the stream."""
    torch = pytest.importorskip("torch")
    cuda, cpu = scenes
    batches = [random_rays(seed=seed) for seed in range(4)]
    expected = [cpu.closest(batch).t for batch in batches]
    sources = [torch.from_numpy(eight(batch)).cuda() for batch in batches]
    busy = torch.randn(4096, 4096, device="cuda")
    for stream in (torch.cuda.current_stream(), torch.cuda.Stream(), torch.cuda.Stream()):
        with torch.cuda.stream(stream):
            rays = torch.full_like(sources[0], float("nan"))
            torch.cuda.synchronize()
            seen = []
            for source in sources:
                for _ in range(3):
                    busy = (busy @ busy).clamp(-1, 1)
                rays.copy_(source)
                hits = cuda.closest(rays)
                seen.append(hits.t.clone())
                rays.fill_(float("nan"))
            stream.synchronize()
        for t, other in zip(seen, expected):
            np.testing.assert_array_equal(t.cpu().numpy(), other)


def test_a_stream_can_be_named(scenes):
    torch = pytest.importorskip("torch")
    side = torch.cuda.Stream()
    rays = torch.from_numpy(eight(RAYS)).cuda()
    side.wait_stream(torch.cuda.current_stream())
    for stream in (side, side.cuda_stream):
        hits = scenes[0].closest(rays, stream=stream)
        side.synchronize()
        same_bits(hits, scenes[1].closest(RAYS), lambda array: array.cpu().numpy())
    with pytest.raises(TypeError, match="stream is str"):
        scenes[0].closest(rays, stream="side")


def test_streams_ask_at_once(scenes):
    torch = pytest.importorskip("torch")
    cuda, cpu = scenes
    batches = [random_rays(200_000, seed) for seed in range(8)]
    tensors = [torch.from_numpy(eight(batch)).cuda() for batch in batches]
    streams = [torch.cuda.Stream() for _ in batches]
    torch.cuda.synchronize()
    hits = []
    for _ in range(20):
        hits.clear()
        for stream, rays in zip(streams, tensors):
            with torch.cuda.stream(stream):
                hits.append(cuda.closest(rays))
    torch.cuda.synchronize()
    for found, batch in zip(hits, batches):
        same_bits(found, cpu.closest(batch), lambda array: array.cpu().numpy())


def test_closest_points_have_the_bits_of_the_cpu(scenes):
    torch = pytest.importorskip("torch")
    cuda, cpu = scenes
    points = np.random.default_rng(4).uniform(-3, 3, (5000, 3)).astype(np.float32)
    tensor = torch.from_numpy(points).cuda()
    for limit in (np.inf, 0.25):
        found, expected = cuda.nearest(tensor, max_distance=limit), cpu.nearest(points, max_distance=limit)
        for name in ("distance", "uv", "primitive", "geometry", "points", "normals"):
            one, other = getattr(found, name).cpu().numpy(), getattr(expected, name)
            assert np.ascontiguousarray(one).tobytes() == other.tobytes(), name
    np.testing.assert_array_equal(cuda.occupancy(tensor).cpu().numpy(), cpu.occupancy(points))
    np.testing.assert_array_equal(cuda.signed_distance(tensor).cpu().numpy(), cpu.signed_distance(points))
    same = cuda.nearest(points)
    assert same.distance.tobytes() == cpu.nearest(points).distance.tobytes()


def test_instances_move_on_the_device(scenes):
    torch = pytest.importorskip("torch")
    made = []
    for device in ("cuda", "cpu"):
        scene = raywarp.Scene(device)
        mesh = scene.mesh(*soup(500))
        made.append((scene, scene.instances(mesh, np.tile(np.eye(4), (20, 1, 1)))))
    rays = torch.from_numpy(eight(RAYS)).cuda()
    for seed in range(3):
        rng = np.random.default_rng(seed)
        transforms = np.tile(np.eye(4), (20, 1, 1))
        transforms[:, :3, :3] = np.linalg.qr(rng.normal(size=(20, 3, 3)))[0]
        transforms[:, :3, 3] = rng.uniform(-1, 1, (20, 3))
        for (scene, instances), given in zip(made, (torch.from_numpy(transforms).cuda(), transforms)):
            instances.transforms = given
            scene.commit()
        same_bits(made[0][0].closest(rays), made[1][0].closest(RAYS), lambda array: array.cpu().numpy())
        # Captured anew, as the scene has changed.
        hits = made[0][0].closest(rays)
        graph = torch.cuda.CUDAGraph()
        with torch.cuda.graph(graph):
            made[0][0].closest(rays, out=hits)
        hits.t.fill_(0)
        graph.replay()
        torch.cuda.synchronize()
        same_bits(hits, made[1][0].closest(RAYS), lambda array: array.cpu().numpy())


def test_a_graph_captures_questions(scenes):
    torch = pytest.importorskip("torch")
    cuda, cpu = scenes
    rays = torch.from_numpy(eight(RAYS)).cuda()
    hits = cuda.closest(rays)
    numbers = torch.zeros(COUNT, dtype=torch.int32, device="cuda")
    counts = torch.zeros_like(numbers)
    torch.cuda.synchronize()
    graph = torch.cuda.CUDAGraph()
    with torch.cuda.graph(graph):
        cuda.closest(rays, out=hits)
        cuda.any(rays, out=numbers)
        cuda.count(rays, out=counts)
        # Room of torch's own, and rays that are put together on the way.
        inner = cuda.closest(rays[:, :3], rays[:, 4:7], coherent=True)
    for seed in range(5):
        batch = random_rays(seed=seed)
        rays.copy_(torch.from_numpy(eight(batch)))
        graph.replay()
        # Beside the graph, on the stream that replays it and on another.
        beside = cuda.closest(rays)
        torch.cuda.synchronize()
        expected = cpu.closest(batch)
        for found in (hits, beside, inner):
            same_bits(found, expected, lambda array: array.cpu().numpy())
        np.testing.assert_array_equal(numbers.cpu().numpy() != 0, cpu.any(batch))
        np.testing.assert_array_equal(counts.cpu().numpy(), cpu.count(batch))


def test_ten_thousand_scenes_and_batches_leak_nothing(scenes):
    torch = pytest.importorskip("torch")
    rays = torch.from_numpy(RAYS).cuda()

    def use(times):
        for _ in range(times):
            scenes[0].closest(rays)
        torch.cuda.synchronize()
        return torch.cuda.mem_get_info()[0]

    before = use(100)
    assert before - use(10_000) < 16 << 20
    vertices, faces = soup(50)
    for _ in range(200):
        scene = raywarp.Scene("cuda")
        scene.mesh(vertices, faces)
        scene.closest(rays)
        del scene
    assert before - use(1) < 64 << 20


def test_a_thread_keeps_its_context():
    torch = pytest.importorskip("torch")
    if torch.cuda.device_count() < 2:
        pytest.skip("there is one device")
    scene = raywarp.Scene("cuda:1")
    scene.mesh(*soup())
    torch.cuda.set_device(0)
    rays = torch.from_numpy(RAYS).to("cuda:1")
    scene.closest(rays)
    assert torch.cuda.current_device() == 0 and torch.zeros(1, device="cuda").device.index == 0
    with pytest.raises(ValueError, match="another device"):
        scene.closest(rays.to("cuda:0"))


def test_answers_after_many_small_calls(scenes):
    """How long the host takes to enqueue, and a call with synchronisation: printed, and bounded where the goal is missed by far."""
    torch = pytest.importorskip("torch")
    rays = torch.from_numpy(eight(RAYS[:1000])).cuda()
    hits = scenes[0].closest(rays)

    def microseconds(work, times=2000):
        torch.cuda.synchronize()
        taken = []
        for _ in range(times):
            began = time.perf_counter()
            work()
            taken.append(time.perf_counter() - began)
            if len(taken) % 100 == 0:
                torch.cuda.synchronize()
        return 1e6 * float(np.median(taken))

    def waited():
        scenes[0].closest(rays, out=hits)
        torch.cuda.synchronize()

    enqueue, new = (
        microseconds(lambda: scenes[0].closest(rays, out=hits)),
        microseconds(lambda: scenes[0].closest(rays)),
    )
    wait = microseconds(waited)
    print(
        f"\n1,000 rays: {enqueue:.1f} us to enqueue with out, {new:.1f} us without, {wait:.1f} us with synchronisation"
    )
    assert enqueue < 200


def test_the_rate_of_two_million_rays():
    """The wall time of a call with synchronisation, beside that of one among many that are enqueued at once, which is the kernel's: their
    share is what a caller pays. `RAYWARP_SCENE` names a file to ask instead of triangles at random."""
    torch = pytest.importorskip("torch")
    path = os.environ.get("RAYWARP_SCENE")
    scene = raywarp.Scene.open(path, "cuda", build="high") if path else raywarp.Scene("cuda", build="high")
    if not path:
        scene.mesh(*soup(200_000))
    low, high = bounds(scene)
    rng = np.random.default_rng(1)
    rays = np.concatenate([rng.uniform(low, high, (2_000_000, 3)), rng.normal(size=(2_000_000, 3))], axis=1)
    tensor = torch.from_numpy(eight(rays.astype(np.float32))).cuda()
    hits = scene.closest(tensor)

    def seconds(calls, coherent):
        torch.cuda.synchronize()
        began = time.perf_counter()
        for _ in range(calls):
            scene.closest(tensor, out=hits, coherent=coherent)
        torch.cuda.synchronize()
        return (time.perf_counter() - began) / calls

    for coherent in (False, True):
        single = min(seconds(1, coherent) for _ in range(20))
        kernel = min(seconds(20, coherent) for _ in range(3))
        print(
            f"\n2 million rays, coherent={coherent}: {2 / single:.0f} million a second, {kernel / single:.0%} of the kernel's rate"
        )


def bounds(scene):
    """Low and high corner of what rays from all around hit first."""
    rng = np.random.default_rng(2)
    direction = rng.normal(size=(10_000, 3))
    hits = scene.closest(-1e4 * direction, direction)
    points = hits.points[hits.hit]
    return points.min(axis=0), points.max(axis=0)


def test_sanitizer_finds_nothing():
    """Under compute-sanitizer, where it is installed."""
    import shutil

    if shutil.which("compute-sanitizer") is None:
        pytest.skip("there is no compute-sanitizer")
    pytest.importorskip("torch")
    words = [
        "compute-sanitizer",
        "--error-exitcode",
        "7",
        sys.executable,
        "-m",
        "pytest",
        __file__,
        "-q",
        "-k",
        "bits_of_the_cpu and torch",
    ]
    done = subprocess.run(words, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout[-4000:]
