"""Other ray tracers on the rays of `raywarp bench`: one JSON object a line in, one a line out.

    python3 peers.py embree|warp cpu|cuda:N

First it says {"name", "version", "device"}, or {"missing": why}. Then it does as it is told:

    {"do": "scene", "folder": F}                      {"variants": [{"name", "build_seconds"}, ...]}
    {"do": "rays", "folder": F, "any_hit": B}         {"rays": N}
    {"do": "time", "variant": V, "warmup": W, "repeats": R}     {"seconds": [...]}
    {"do": "answers", "variant": V, "file": F}        {}

A scene is `vertices` and `triangles` (n x 3) in a folder; rays are `origins`, `directions` (n x 3) and `limits` (n);
answers are n distances, infinite for a miss, and 0 for a hit where any would do. These files are bare little-endian
numbers of 32 bits, integers for `triangles`, else floats. What fails is {"failed": why}; the end of the input is the end.
"""

import json
import os
import sys
import time
from importlib import metadata

# Libraries print as they like: what is said to raywarp goes out by a way of its own.
TO_RAYWARP = os.fdopen(os.dup(1), "w")
os.dup2(2, 1)


def say(message):
    TO_RAYWARP.write(json.dumps(message) + "\n")
    TO_RAYWARP.flush()


class Missing(Exception):
    """Why a peer cannot run here."""


def module(name, package):
    try:
        return __import__(name), metadata.version(package)
    except ImportError as error:
        raise Missing(f"no Python package {package} ({error}): `pip install {package}`") from error


class Embree:
    """Single rays through Embree, by embreex: the call for each ray is C, the loop around it Cython."""

    # Embree's own infinity is smaller than that of floats.
    FAR = 1e37

    def __init__(self, device):
        if device != "cpu":
            raise Missing("Embree runs on the CPU: --device cpu measures it")
        _, version = module("embreex", "embreex")
        self.about = {"name": "Embree", "version": f"embreex {version}", "device": "CPU, 1 thread"}

    def scene(self, vertices, triangles):
        from embreex import mesh_construction, rtcore_scene

        start = time.perf_counter()
        self.tree = rtcore_scene.EmbreeScene()
        self.mesh = mesh_construction.TriangleMesh(self.tree, vertices, triangles)
        # The first ray builds the tree.
        self.tree.run(vertices[:1], np.array([[0, 1, 0]], dtype="f4"))
        return [{"name": "single rays", "build_seconds": time.perf_counter() - start}]

    def rays(self, origins, directions, limits, any_hit):
        self.batch = (origins, directions, np.minimum(limits, np.float32(self.FAR)), any_hit)

    def ask(self, query):
        origins, directions, limits, _ = self.batch
        limits = limits.copy()
        start = time.perf_counter()
        found = self.tree.run(origins, directions, dists=limits, query=query)
        return found, time.perf_counter() - start

    def time(self, _variant, warmup, repeats):
        query = "OCCLUDED" if self.batch[3] else "INTERSECT"
        return [self.ask(query)[1] for _ in range(warmup + repeats)][warmup:]

    def answers(self, _variant):
        if self.batch[3]:
            return np.where(self.ask("OCCLUDED")[0] < 0, np.inf, 0)
        hit = self.ask("INTERSECT")[0] >= 0
        return np.where(hit, self.ask("DISTANCE")[0], np.inf)


class Warp:
    """NVIDIA Warp's mesh queries, by each of its builders and with several sizes of blocks."""

    BUILDERS = ["sah", "lbvh", "cubql"]
    BLOCKS = [64, 128, 256]

    def __init__(self, device):
        global wp
        wp, version = module("warp", "warp-lang")
        wp.config.quiet = True
        wp.init()
        if device != "cpu" and not wp.is_cuda_available():
            raise Missing("this Warp finds no CUDA device")
        self.device = wp.get_device(device)
        self.kernels = warp_kernels()
        where = "CPU, 1 thread" if self.device.is_cpu else f"{self.device.name} ({device})"
        self.about = {"name": "Warp", "version": f"warp-lang {version}", "device": where}

    def scene(self, vertices, triangles):
        with wp.ScopedDevice(self.device):
            points = wp.array(vertices, dtype=wp.vec3)
            indices = wp.array(triangles.flatten(), dtype=wp.int32)
            # The CPU has one builder and no blocks.
            builders = ["sah"] if self.device.is_cpu else self.BUILDERS
            blocks = [1] if self.device.is_cpu else self.BLOCKS
            self.variants, about = [], []
            for builder in builders:
                wp.synchronize_device()
                start = time.perf_counter()
                mesh = wp.Mesh(points, indices, bvh_constructor=builder)
                wp.synchronize_device()
                seconds = time.perf_counter() - start
                for block in blocks:
                    self.variants.append((mesh, block))
                    name = builder if self.device.is_cpu else f"{builder}, blocks of {block}"
                    about.append({"name": name, "build_seconds": seconds})
        return about

    def rays(self, origins, directions, limits, any_hit):
        with wp.ScopedDevice(self.device):
            self.kernel = self.kernels[any_hit]
            # Infinity times zero is not a number: Warp is given the largest.
            limits = np.minimum(limits, np.finfo(np.float32).max)
            self.batch = [wp.array(origins, dtype=wp.vec3), wp.array(directions, dtype=wp.vec3), wp.array(limits)]
            self.found = wp.zeros(len(limits), dtype=float)

    def launch(self, variant):
        mesh, block = self.variants[variant]
        return wp.launch(
            self.kernel,
            dim=len(self.found),
            inputs=[mesh.id, *self.batch, self.found],
            device=self.device,
            block_dim=block,
            record_cmd=True,
        )

    def time(self, variant, warmup, repeats):
        launch = self.launch(variant).launch
        with wp.ScopedDevice(self.device):
            for _ in range(warmup):
                launch()
            if self.device.is_cpu:
                return [timed(launch) for _ in range(repeats)]
            # All are queued before the first is done, lest Python be part of the time.
            events = [wp.Event(self.device, enable_timing=True) for _ in range(repeats + 1)]
            wp.record_event(events[0])
            for event in events[1:]:
                launch()
                wp.record_event(event)
            wp.synchronize_device()
            pairs = zip(events, events[1:])
            return [wp.get_event_elapsed_time(start, end) * 1e-3 for start, end in pairs]

    def answers(self, variant):
        self.launch(variant).launch()
        return self.found.numpy()


def timed(call):
    start = time.perf_counter()
    call()
    return time.perf_counter() - start


def warp_kernels():
    """By whether any hit will do."""

    @wp.kernel
    def closest(
        mesh: wp.uint64,
        origins: wp.array(dtype=wp.vec3),
        directions: wp.array(dtype=wp.vec3),
        limits: wp.array(dtype=float),
        found: wp.array(dtype=float),
    ):
        i = wp.tid()
        query = wp.mesh_query_ray(mesh, origins[i], directions[i], limits[i])
        t = float(wp.inf)
        if query.result:
            t = query.t
        found[i] = t

    @wp.kernel
    def occluded(
        mesh: wp.uint64,
        origins: wp.array(dtype=wp.vec3),
        directions: wp.array(dtype=wp.vec3),
        limits: wp.array(dtype=float),
        found: wp.array(dtype=float),
    ):
        i = wp.tid()
        t = float(wp.inf)
        if wp.mesh_query_ray_anyhit(mesh, origins[i], directions[i], limits[i]):
            t = 0.0
        found[i] = t

    return {False: closest, True: occluded}


def obey(peer, order):
    def load(name, kind="<f4"):
        return np.fromfile(os.path.join(order["folder"], name), kind)

    if order["do"] == "scene":
        return {"variants": peer.scene(load("vertices").reshape(-1, 3), load("triangles", "<i4").reshape(-1, 3))}
    if order["do"] == "rays":
        limits = load("limits")
        peer.rays(load("origins").reshape(-1, 3), load("directions").reshape(-1, 3), limits, order["any_hit"])
        return {"rays": len(limits)}
    if order["do"] == "time":
        return {"seconds": peer.time(order["variant"], order["warmup"], order["repeats"])}
    peer.answers(order["variant"]).astype("<f4").tofile(order["file"])
    return {}


def main():
    global np
    try:
        np, _ = module("numpy", "numpy")
        peer = {"embree": Embree, "warp": Warp}[sys.argv[1]](sys.argv[2])
    except Missing as reason:
        return say({"missing": str(reason)})
    except Exception as error:  # Whatever a library raises, raywarp goes on without it.
        return say({"missing": f"{type(error).__name__}: {error}"})
    say(peer.about)
    for line in sys.stdin:
        try:
            say(obey(peer, json.loads(line)))
        except Exception as error:
            say({"failed": f"{type(error).__name__}: {error}"})


main()
