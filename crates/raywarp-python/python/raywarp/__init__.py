"""Ray queries on the CPU and on CUDA.

    import numpy as np
    import raywarp

    scene = raywarp.Scene()                     # on the GPU if there is one: device="cpu", "cuda:1"
    scene.mesh(vertices, faces)                 # (V, 3) float32 and (F, 3) integers
    hits = scene.closest(rays)                  # (..., 6): origin and direction
    hits.t, hits.primitive, hits.geometry       # inf and -1 for a miss

A scene is asked for the closest hit of each ray, whether there is any, their number, or all of them, in order. The answers are
the same to the bit on every device.
"""

from raywarp._hits import AllHits, Hits
from raywarp._nearest import Nearest
from raywarp._placed import Instances, Mesh
from raywarp._raywarp import DeviceError, __version__
from raywarp._scene import Scene

__all__ = ["AllHits", "DeviceError", "Hits", "Instances", "Mesh", "Nearest", "Scene", "__version__"]
