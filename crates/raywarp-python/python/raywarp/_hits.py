"""What rays hit."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from raywarp import _raywarp
from raywarp._arrays import Floats, Ints
from raywarp._rays import Rays

if TYPE_CHECKING:
    from raywarp._scene import Scene


class Hits:
    """The closest hit of each ray. Arrays have the shape of the batch.

    Attributes:
        t: float32; the distance in units of the length of the ray's direction. `inf` for a miss.
        uv: (..., 2) float32; the weights of the triangle's vertices 1 and 2. Vertex 0 weighs `1 - u - v`. 0 for a miss.
        primitive: int32; the number of the triangle in its mesh. -1 for a miss.
        geometry: int32; the number of the mesh or the instance in the scene. -1 for a miss.
    """

    __slots__ = ("_rays", "_scene", "geometry", "primitive", "t", "uv")

    t: Floats
    uv: Floats
    primitive: Ints
    geometry: Ints

    def __init__(self, shape: tuple[int, ...]) -> None:
        """Room for the hits of a batch of this shape, to be filled by `Scene.closest(..., out=hits)`."""
        self.t = np.empty(shape, np.float32)
        self.uv = np.empty((*shape, 2), np.float32)
        self.primitive = np.empty(shape, np.int32)
        self.geometry = np.empty(shape, np.int32)

    def _about(self, scene: Scene, rays: Rays) -> Hits:
        self._scene, self._rays = scene, rays
        return self

    @property
    def hit(self) -> npt.NDArray[np.bool_]:
        """bool; whether the ray hit anything."""
        return self.primitive >= 0

    @property
    def points(self) -> Floats:
        """(..., 3) float32; where the ray hit, `origin + t * direction`. NaN for a miss."""
        return _points(self._rays.start, self._rays.direction, self.t)

    @property
    def normals(self) -> Floats:
        """(..., 3) float32; the unit normal of the triangle, on the side where its vertices run counter-clockwise. 0 for a miss."""
        return _normals(self._scene, self.primitive, self.geometry)

    def __repr__(self) -> str:
        return f"Hits(shape={self.t.shape}, hits={np.count_nonzero(self.hit)})"


class AllHits:
    """Every hit of each ray. Those of ray i are the items `offsets[i]` to `offsets[i + 1]`, by `t`; where that is the same, by geometry
    and primitive. Each triangle is hit once.

    Attributes:
        offsets: (n + 1,) int64, of the n rays in the order of their batch.
        t: (hits,) float32, as in `Hits`.
        uv: (hits, 2) float32, as in `Hits`.
        primitive: (hits,) int32, as in `Hits`.
        geometry: (hits,) int32, as in `Hits`.
    """

    __slots__ = ("_rays", "_scene", "geometry", "offsets", "primitive", "t", "uv")

    def __init__(self, scene: Scene, rays: Rays, found: tuple[Any, Floats, Floats, Ints, Ints]) -> None:
        self._scene, self._rays = scene, rays
        self.offsets: npt.NDArray[np.int64]
        self.offsets, self.t, uv, self.primitive, self.geometry = found
        self.uv = uv.reshape(-1, 2)

    @property
    def ray(self) -> npt.NDArray[np.int64]:
        """(hits,) int64; which ray each hit is of, in the order of the batch."""
        return np.repeat(np.arange(len(self.offsets) - 1), np.diff(self.offsets))

    @property
    def points(self) -> Floats:
        """(hits, 3) float32; where the ray hit, `origin + t * direction`."""
        ray = self.ray
        start, direction = (end.reshape(-1, 3)[ray] for end in (self._rays.start, self._rays.direction))
        return _points(start, direction, self.t)

    @property
    def normals(self) -> Floats:
        """(hits, 3) float32, as in `Hits`."""
        return _normals(self._scene, self.primitive, self.geometry)

    def __len__(self) -> int:
        return len(self.t)

    def __repr__(self) -> str:
        return f"AllHits(rays={len(self.offsets) - 1}, hits={len(self)})"


def _points(start: Floats, direction: Floats, t: Floats) -> Floats:
    with np.errstate(invalid="ignore"):
        points: Floats = start + t[..., np.newaxis] * direction
    points[np.isinf(t)] = np.nan
    return points


def _normals(scene: Scene, primitive: Ints, geometry: Ints) -> Floats:
    normals = np.empty((*primitive.shape, 3), np.float32)
    _raywarp.normals(scene._core, np.ravel(primitive), np.ravel(geometry), normals.reshape(-1), scene.threads)
    return normals
