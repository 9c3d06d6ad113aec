"""Scenes, and what is asked of them."""

from __future__ import annotations

import os
import warnings
from typing import Any, Optional, Union

import numpy as np
import numpy.typing as npt

from raywarp import _arrays, _raywarp, _rays
from raywarp._arrays import Ints
from raywarp._hits import AllHits, Hits
from raywarp._placed import Instances, Mesh, World
from raywarp._rays import End

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
        self.threads = threads

    @staticmethod
    def open(
        path: Path, device: str = "auto", *, build: str = "medium", threads: Optional[int] = None
    ) -> Scene:
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
        """"cpu" or "cuda:N": where rays are traced."""
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
        positions = _arrays.vertices(vertices)
        triangles = _arrays.faces(faces, len(positions))
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
        return Instances(mesh, _arrays.transforms(transforms))

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
    ) -> Hits:
        """The closest hit of each ray; of several at the same distance that of the smallest geometry and primitive.

        Args:
            rays: (..., 6) origin and direction, or (..., 8) origin, t_min, direction, t_max; or (..., 3) origins. Real numbers,
                rounded to float32.
            directions: (..., 3), where `rays` are origins; the shapes broadcast, so one origin does for all.
            t_min, t_max: ends of the rays, in units of the direction's length; a number or one a ray, 0 and infinity if None.
                Both belong to the ray.
            out: hits of a batch of the same shape, to be written over.

        Returns:
            The hits, in the shape of the batch; `out` if that was given.

        Raises:
            TypeError: an array has another type.
            ValueError: an array has another shape.
            DeviceError, MemoryError: the device fails, or has no room.
        """
        batch = _rays.prepare(rays, directions, t_min, t_max)
        hits = Hits(batch.shape) if out is None else out
        if hits.t.shape != batch.shape:
            raise ValueError(f"out has room for a batch of the shape {hits.t.shape}, and the rays have {batch.shape}")
        self._commit_changes()
        _raywarp.closest(
            self._core,
            *batch[:3],
            hits.t.reshape(-1),
            hits.uv.reshape(-1),
            hits.primitive.reshape(-1),
            hits.geometry.reshape(-1),
            self.threads,
        )
        return hits._about(self, batch)

    def any(
        self, rays: Any, directions: Any = None, *, t_min: End = None, t_max: End = None
    ) -> npt.NDArray[np.bool_]:
        """Whether anything stands between the ends of each ray.

        Args:
            rays, directions, t_min, t_max: as for `closest`.

        Returns:
            bool, in the shape of the batch.

        Raises:
            As `closest`.
        """
        batch = _rays.prepare(rays, directions, t_min, t_max)
        blocked = np.empty(batch.shape, np.bool_)
        self._commit_changes()
        _raywarp.any(self._core, *batch[:3], blocked.reshape(-1), self.threads)
        return blocked

    def count(
        self,
        rays: Any,
        directions: Any = None,
        *,
        t_min: End = None,
        t_max: End = None,
        max_hits: Optional[int] = None,
    ) -> Ints:
        """How many triangles each ray hits, each counted once.

        Args:
            rays, directions, t_min, t_max: as for `closest`.
            max_hits: where counting ends.

        Returns:
            int32, in the shape of the batch.

        Raises:
            As `closest`.
        """
        batch = _rays.prepare(rays, directions, t_min, t_max)
        counts = np.empty(batch.shape, np.int32)
        self._commit_changes()
        _raywarp.count(self._core, *batch[:3], _limit(max_hits), counts.reshape(-1), self.threads)
        return counts

    def all(
        self,
        rays: Any,
        directions: Any = None,
        *,
        t_min: End = None,
        t_max: End = None,
        max_hits: Optional[int] = None,
    ) -> AllHits:
        """Every hit of each ray, in order, each triangle once.

        Args:
            rays, directions, t_min, t_max: as for `closest`.
            max_hits: how many of each ray are kept, the first ones.

        Returns:
            The hits of all rays one after the other, and where those of each begin.

        Raises:
            As `closest`.
        """
        batch = _rays.prepare(rays, directions, t_min, t_max)
        self._commit_changes()
        found = _raywarp.all(self._core, *batch[:3], _limit(max_hits), self.threads)
        return AllHits(self, batch, found)

    def __repr__(self) -> str:
        return f"Scene({self._core.description}, {len(self.names)} geometries)"

    def _commit_changes(self) -> None:
        if self._world.changed:
            self.commit()


def _limit(max_hits: Optional[int]) -> Optional[int]:
    if max_hits is not None and not 1 <= max_hits < 2**31:
        raise ValueError(f"max_hits is {max_hits}, and has to be 1 to 2147483647")
    return max_hits

