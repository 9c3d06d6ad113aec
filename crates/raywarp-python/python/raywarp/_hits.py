"""What rays hit."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Union

import numpy as np

from raywarp import _libraries, _raywarp
from raywarp._rays import Rays

if TYPE_CHECKING:
    import numpy.typing as npt

    from raywarp._device import DeviceBatch
    from raywarp._types import Asked, AskedOnDevice, Library, Room


class HostRoom:
    """Arrays of NumPy, one for each of the numbers, given as those of the library of the rays."""

    def __init__(self, shape: tuple[int, ...], library: Library) -> None:
        self.shape = shape
        self.library = library
        self.arrays: tuple[npt.NDArray[Any], ...] = (
            np.empty(shape, np.float32),
            np.empty((*shape, 2), np.float32),
            np.empty(shape, np.int32),
            np.empty(shape, np.int32),
        )
        self.t, self.uv, self.primitive, self.geometry = map(library.from_host, self.arrays)


class DeviceRoom:
    """Arrays on a device, as kernels write them: t, u, v and the bits of the primitive of a hit side by side, the geometry apart. What
    people see are views."""

    def __init__(self, batch: AskedOnDevice, shape: Any = None) -> None:
        self.shape = batch.shape if shape is None else shape
        self.library = batch.library
        self.records = batch.empty((*self.shape, 4), "float32")
        self.instances = batch.empty(self.shape, "int32")
        # What a kernel may still read that nobody else has.
        self.holds: Any = None

    @property
    def t(self) -> Any:
        return self.library.columns(self.records, 0)

    @property
    def uv(self) -> Any:
        return self.library.columns(self.records, 1, 2)

    @property
    def primitive(self) -> Any:
        return self.library.columns(self.library.integers(self.records), 3)

    @property
    def geometry(self) -> Any:
        return self.library.finished(self.instances)


class Hits:
    """The closest hit of each ray. Arrays have the shape of the batch, and are of the library of the rays and on their device."""

    __slots__ = ("__weakref__", "_rays", "_room")

    def __init__(self, shape: tuple[int, ...]) -> None:
        """Room on the CPU for the hits of a batch of this shape, to be filled by `Scene.closest(..., out=hits)`."""
        self._room: Room = HostRoom(shape, _libraries.of(np.empty(0)))

    @classmethod
    def _in(cls, room: Room) -> Hits:
        hits = cls.__new__(cls)
        hits._room = room
        return hits

    def _about(self, rays: Union[Rays, DeviceBatch]) -> Hits:
        self._rays = rays
        return self

    @property
    def t(self) -> Any:
        """(...) float32; the distance in units of the length of the ray's direction. `inf` for a miss."""
        return self._room.t

    @property
    def uv(self) -> Any:
        """(..., 2) float32; the weights of the triangle's vertices 1 and 2. Vertex 0 weighs `1 - u - v`. 0 for a miss."""
        return self._room.uv

    @property
    def primitive(self) -> Any:
        """(...) int32; the number of the triangle in its mesh. -1 for a miss."""
        return self._room.primitive

    @property
    def geometry(self) -> Any:
        """(...) int32; the number of the mesh or the instance in the scene. -1 for a miss."""
        return self._room.geometry

    @property
    def hit(self) -> Any:
        """(...) bool; whether the ray hit anything."""
        return self.geometry >= 0

    @property
    def points(self) -> Any:
        """(..., 3) float32; where the ray hit, `origin + t * direction`. NaN for a miss."""
        return self._rays.at(self.t)

    @property
    def normals(self) -> Any:
        """(..., 3) float32; the unit normal of the triangle, on the side where its vertices run counter-clockwise. 0 for a miss. Hits on a
        CUDA device are waited for."""
        return surface_normals(self._rays, self._room)

    def __repr__(self) -> str:
        return f"Hits(shape={tuple(self.t.shape)})"


class AllHits:
    """Every hit of each ray. Those of ray i are the items `offsets[i]` to `offsets[i + 1]`, by `t`; where that is the same, by geometry
    and primitive. Each triangle is hit once. Arrays are of the library of the rays and on their device."""

    __slots__ = ("__weakref__", "_rays", "_room", "offsets")

    def __init__(self, rays: Union[Rays, DeviceBatch], offsets: Any, room: Room) -> None:
        self._rays, self._room = rays, room
        #: (n + 1,) int64, of the n rays in the order of their batch.
        self.offsets = offsets

    @property
    def t(self) -> Any:
        """(hits,) float32, as in `Hits`."""
        return self._room.t

    @property
    def uv(self) -> Any:
        """(hits, 2) float32, as in `Hits`."""
        return self._room.uv

    @property
    def primitive(self) -> Any:
        """(hits,) int32, as in `Hits`."""
        return self._room.primitive

    @property
    def geometry(self) -> Any:
        """(hits,) int32, as in `Hits`."""
        return self._room.geometry

    @property
    def ray(self) -> Any:
        """(hits,) int64; which ray each hit is of, in the order of the batch. Hits on a CUDA device are waited for."""
        offsets = self._rays.to_host(self.offsets)
        return self._rays.give(np.repeat(np.arange(len(offsets) - 1), np.diff(offsets)))

    @property
    def points(self) -> Any:
        """(hits, 3) float32; where the ray hit, `origin + t * direction`."""
        return self._rays.at(self.t, self.ray)

    @property
    def normals(self) -> Any:
        """(hits, 3) float32, as in `Hits`."""
        return surface_normals(self._rays, self._room)

    def __len__(self) -> int:
        return len(self.t)

    def __repr__(self) -> str:
        return f"AllHits(rays={len(self.offsets) - 1}, hits={len(self)})"


class FoundRoom:
    """Hits that were found on the CPU, as many as there are."""

    def __init__(self, library: Library, found: tuple[npt.NDArray[Any], ...]) -> None:
        t, uv, primitive, geometry = found
        self.t, self.uv, self.primitive, self.geometry = map(
            library.from_host, (t, uv.reshape(-1, 2), primitive, geometry)
        )


def surface_normals(asked: Asked, room: Room) -> Any:
    """The unit normals of triangles."""
    primitive, geometry = (np.ravel(asked.to_host(array)) for array in (room.primitive, room.geometry))
    normals = np.empty((len(primitive), 3), np.float32)
    _raywarp.normals(asked.scene._core, primitive, geometry, normals.reshape(-1), asked.scene.threads)
    return asked.give(normals.reshape(*room.geometry.shape, 3))


def surface_points(asked: Asked, room: Room) -> Any:
    """Where points of triangles are."""
    primitive, geometry, uv = (np.ravel(asked.to_host(array)) for array in (room.primitive, room.geometry, room.uv))
    points = np.empty((*room.geometry.shape, 3), np.float32)
    _raywarp.surface_points(asked.scene._core, primitive, geometry, uv, points.reshape(-1), asked.scene.threads)
    return asked.give(points)
