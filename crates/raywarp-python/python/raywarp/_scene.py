"""Scenes, and what is asked of them."""

from __future__ import annotations

import os
import warnings
from typing import TYPE_CHECKING, Any, Optional, Union

import numpy as np

from raywarp import _arrays, _device, _libraries, _nearest, _rays, _raywarp
from raywarp._device import DeviceBatch
from raywarp._hits import AllHits, FoundRoom, Hits, HostRoom
from raywarp._nearest import Nearest
from raywarp._placed import Instances, Mesh, World

if TYPE_CHECKING:
    from raywarp._types import End

Path = Union[str, "os.PathLike[str]"]


class Scene:
    """Meshes on a device, to be asked what rays hit.

    A scene may be asked by several threads at once, and works on all cores; other threads of Python run meanwhile, and
    Ctrl-C ends a long batch.

    Args:
        device: "auto" is the first CUDA device that works, else the CPU. "cpu", "cuda" and "cuda:N" are these or an error.
        build: how good the tree over the triangles is to be: "fast" for scenes that change with every few rays, "medium", "high" for
            those that stay. The answers are the same.
        threads: how many threads of the CPU build and trace; all cores if None.

    Raises:
        DeviceError: there is no such device, or it fails.
        ValueError: `device` or `build` is none of these.
    """

    def __init__(self, device: str = "auto", *, build: str = "medium", threads: Optional[int] = None) -> None:
        self._core = _raywarp.Scene(device, build)
        self._world = World(self._core)
        self._on_cuda = self._core.device != "cpu"
        self.threads = threads

    @staticmethod
    def open(path: Path, device: str = "auto", *, build: str = "medium", threads: Optional[int] = None) -> Scene:
        """Reads a scene from a file: .obj, .ply, .stl, .gltf, .glb, or .toml that puts such together.

        Geometry is numbered as `raywarp query` does, and `names` has a name for each. What the file asks and raywarp does not do is
        a warning of Python.

        Args:
            path: the file.
            device, build, threads: as for `Scene`.

        Raises:
            FileNotFoundError, OSError: the file, or one that it names, cannot be read.
            ValueError: a file breaks its format; the text says where, what was read and what was expected.
            MemoryError: it does not fit in memory.
            DeviceError: there is no such device, or it fails.
        """
        scene = Scene(device, build=build, threads=threads)
        for message in scene._core.read(os.fspath(path)):
            warnings.warn(message, stacklevel=2)
        return scene

    @property
    def device(self) -> str:
        """ "cpu" or "cuda:N": where rays are traced."""
        return self._core.device

    @property
    def threads(self) -> Optional[int]:
        """How many threads of the CPU build and trace; None for all cores."""
        return self._threads

    @threads.setter
    def threads(self, value: Optional[int]) -> None:
        if value is not None and not 1 <= value <= 4096:
            raise ValueError(f"threads is {value}, and 1 to 4096 are possible, or None for all cores")
        self._threads = value

    @property
    def names(self) -> list[str]:
        """A name for each geometry: those of a file as it has them, others empty."""
        self._world.tell_places()
        return self._core.names

    def mesh(self, vertices: Any, faces: Any) -> Mesh:
        """Adds a mesh. It stands where its vertices are, unless `instances` places it.

        Triangles without area, or with a coordinate that is not finite, are never hit, and keep their numbers.

        Args:
            vertices: (V, 3) real numbers, rounded to float32.
            faces: (F, 3) integers: the vertices of each triangle, counter-clockwise seen from outside.

        Returns:
            The mesh. Its place in the order of meshes and instances is its number in `Hits.geometry`.

        Raises:
            TypeError: an array has another type.
            ValueError: an array has another shape, or a face names a vertex that is not there.
        """
        positions = _arrays.vertices(self._world.to_host(vertices))
        triangles = _arrays.faces(self._world.to_host(faces), len(positions))
        return Mesh(self._world, positions, triangles)

    def instances(self, mesh: Mesh, transforms: Any) -> Instances:
        """Places a mesh of this scene: it then stands in these places, and no longer where its vertices are.

        Args:
            mesh: of `Scene.mesh`.
            transforms: (n, 3, 4) or (n, 4, 4) real numbers, or one such matrix: mesh space to world space, for columns.

        Returns:
            The instances. Each has a number in `Hits.geometry`, one after the other.

        Raises:
            TypeError: an array has another type.
            ValueError: an array has another shape, a matrix is not affine, or the mesh is another scene's.
        """
        if mesh._world is not self._world:
            raise ValueError("the mesh belongs to another scene")
        return Instances(mesh, _arrays.transforms(self._world.to_host(transforms)))

    def commit(self) -> None:
        """Builds what is new or changed. A query does so itself where need be; this says when.

        Raises:
            DeviceError: the device fails.
            MemoryError: the scene does not fit.
            ValueError: there are too many triangles for the structure.
        """
        self._world.tell_places()
        self._core.commit(self.threads)
        self._world.changed = False

    def closest(
        self,
        rays: Any,
        directions: Any = None,
        *,
        t_min: End = None,
        t_max: End = None,
        out: Optional[Hits] = None,
        coherent: bool = False,
        stream: Any = None,
    ) -> Hits:
        """The closest hit of each ray; of several at the same distance that of the smallest geometry and primitive.

        Rays on a CUDA device are asked where they lie, on the stream that their library works on, and answered there by arrays of
        the same library. The call enqueues and does not wait. With `out` it allocates nothing if rays have 8 numbers, and a CUDA graph
        may capture it, as it may with libraries whose allocations can be captured (torch).

        Args:
            rays: (..., 6) origin and direction, or (..., 8) origin, t_min, direction, t_max; or (..., 3) origins. Real numbers,
                rounded to float32; on a CUDA device float32.
            directions: (..., 3), where `rays` are origins; the shapes broadcast, so one origin does for all. On a CUDA device there
                are as many, or one origin.
            t_min, t_max: ends of the rays, in units of the direction's length; a number or one a ray, 0 and infinity if None.
                Both belong to the ray. On a CUDA device a number.
            out: hits of a batch of the same shape, to be written over.
            coherent: whether most neighbours among rays on a CUDA device go the same way, as those of a camera do. Changes only
                the speed.
            stream: the CUDA stream for rays on a device: a handle, or a stream of a library. The one that the library of the rays
                works on if None.

        Returns:
            The hits, in the shape of the batch; `out` if that was given.

        Raises:
            TypeError: an array has another type.
            ValueError: an array has another shape, or is on another device than the scene.
            DeviceError, MemoryError: the device fails, or has no room.
        """
        self._commit_changes()
        if _libraries.is_on_cuda(rays):
            return _device.closest(DeviceBatch(self, rays, directions, t_min, t_max, stream), out, coherent)
        batch = _rays.prepare(self, rays, directions, t_min, t_max)
        hits = Hits._in(HostRoom(batch.shape, batch.library)) if out is None else out
        room = hits._room
        if not isinstance(room, HostRoom) or room.shape != batch.shape:
            raise ValueError(
                f"out has room for a batch of the shape {tuple(hits.t.shape)}, and the rays have {batch.shape}"
            )
        t, uv, primitive, geometry = (array.reshape(-1) for array in room.arrays)
        _raywarp.closest(self._core, *batch[:3], t, uv, primitive, geometry, self.threads)
        return hits._about(batch)

    def any(
        self,
        rays: Any,
        directions: Any = None,
        *,
        t_min: End = None,
        t_max: End = None,
        out: Any = None,
        coherent: bool = False,
        stream: Any = None,
    ) -> Any:
        """Whether anything stands between the ends of each ray.

        Args:
            rays, directions, t_min, t_max, coherent, stream: as for `closest`.
            out: an int32 array of the shape of the batch on a CUDA device, to be filled with 0 and 1.

        Returns:
            bool, in the shape of the batch, of the library of the rays and on their device; `out` if that was given.

        Raises:
            As `closest`.
        """
        self._commit_changes()
        if _libraries.is_on_cuda(rays):
            return _device.any(DeviceBatch(self, rays, directions, t_min, t_max, stream), out, coherent)
        _refuse_out(out)
        batch = _rays.prepare(self, rays, directions, t_min, t_max)
        blocked = np.empty(batch.shape, np.bool_)
        _raywarp.any(self._core, *batch[:3], blocked.reshape(-1), self.threads)
        return batch.library.from_host(blocked)

    def count(
        self,
        rays: Any,
        directions: Any = None,
        *,
        t_min: End = None,
        t_max: End = None,
        max_hits: Optional[int] = None,
        out: Any = None,
        stream: Any = None,
    ) -> Any:
        """How many triangles each ray hits, each counted once.

        Args:
            rays, directions, t_min, t_max, stream: as for `closest`.
            max_hits: where counting ends.
            out: an int32 array of the shape of the batch on a CUDA device, to be filled.

        Returns:
            int32, in the shape of the batch, of the library of the rays and on their device; `out` if that was given.

        Raises:
            As `closest`.
        """
        self._commit_changes()
        if _libraries.is_on_cuda(rays):
            batch = DeviceBatch(self, rays, directions, t_min, t_max, stream)
            return _device.count(batch, _limit(max_hits), out)
        _refuse_out(out)
        host = _rays.prepare(self, rays, directions, t_min, t_max)
        counts = np.empty(host.shape, np.int32)
        _raywarp.count(self._core, *host[:3], _limit(max_hits), counts.reshape(-1), self.threads)
        return host.library.from_host(counts)

    def all(
        self,
        rays: Any,
        directions: Any = None,
        *,
        t_min: End = None,
        t_max: End = None,
        max_hits: Optional[int] = None,
        stream: Any = None,
    ) -> AllHits:
        """Every hit of each ray, in order, each triangle once.

        Rays on a CUDA device are counted first, which is waited for: how much room the hits need is not known before.

        Args:
            rays, directions, t_min, t_max, stream: as for `closest`.
            max_hits: how many of each ray are kept, the first ones.

        Returns:
            The hits of all rays one after the other, and where those of each begin.

        Raises:
            As `closest`.
        """
        self._commit_changes()
        if _libraries.is_on_cuda(rays):
            return _device.all(DeviceBatch(self, rays, directions, t_min, t_max, stream), _limit(max_hits))
        batch = _rays.prepare(self, rays, directions, t_min, t_max)
        offsets, *found = _raywarp.all(self._core, *batch[:3], _limit(max_hits), self.threads)
        give = batch.library.from_host
        return AllHits(batch, give(offsets), FoundRoom(batch.library, tuple(found)))

    def nearest(self, points: Any, *, max_distance: float = np.inf, stream: Any = None) -> Nearest:
        """The closest point of the scene's triangles to each of these; of several at the same distance that of the smallest geometry and
        primitive.

        The first call builds a tree for it. Points on a CUDA device are asked there, as by `closest`.

        Args:
            points: (..., 3) real numbers, rounded to float32; on a CUDA device float32.
            max_distance: what is farther is not found.
            stream: as for `closest`.

        Returns:
            The closest points.

        Raises:
            As `closest`.
        """
        self._commit_changes()
        return Nearest(_nearest.asked(self, points, stream), max_distance)

    def signed_distance(self, points: Any, *, rays: int = 3, stream: Any = None) -> Any:
        """How far each point is from the scene, negative inside of it.

        Inside is where a ray hits an odd number of triangles, so meshes are to be closed, and not to overlap. Several rays vote, as one
        may run along a seam of a mesh that is not quite closed.

        Args:
            points: (..., 3), as for `nearest`.
            rays: how many vote; odd.
            stream: as for `closest`.

        Returns:
            float32, in the shape of the batch, of the library of the points and on their device.

        Raises:
            As `closest`.
        """
        self._commit_changes()
        return _nearest.signed_distance(_nearest.asked(self, points, stream), rays)

    def occupancy(self, points: Any, *, rays: int = 3, stream: Any = None) -> Any:
        """Whether each point is inside of the scene, as `signed_distance` says.

        Args:
            points, rays, stream: as for `signed_distance`.

        Returns:
            bool, in the shape of the batch, of the library of the points and on their device.

        Raises:
            As `closest`.
        """
        self._commit_changes()
        return _nearest.occupancy(_nearest.asked(self, points, stream), rays)

    def __repr__(self) -> str:
        return f"Scene({self._core.description}, {len(self.names)} geometries)"

    def _commit_changes(self) -> None:
        if self._world.changed:
            self.commit()


def _refuse_out(out: Any) -> None:
    if out is not None:
        raise ValueError("out is for rays on a CUDA device, and these are on the CPU")


def _limit(max_hits: Optional[int]) -> Optional[int]:
    if max_hits is not None and not 1 <= max_hits < 2**31:
        raise ValueError(f"max_hits is {max_hits}, and has to be 1 to 2147483647")
    return max_hits
