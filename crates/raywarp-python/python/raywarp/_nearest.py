"""The closest points of a scene, and what is inside of it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Union

import numpy as np

from raywarp import _device, _libraries, _raywarp
from raywarp._arrays import floats
from raywarp._hits import DeviceRoom, HostRoom, surface_normals, surface_points

if TYPE_CHECKING:
    import numpy.typing as npt

    from raywarp._scene import Scene
    from raywarp._types import Floats


class HostPoints:
    """Points of a call, on the CPU."""

    def __init__(self, scene: Scene, points: Any) -> None:
        self.scene = scene
        self.library = _libraries.of(points)
        self.points: Floats = floats(points, "points")
        _check(self.points.shape)
        self.shape = self.points.shape[:-1]

    def room(self, limit: float) -> HostRoom:
        room = HostRoom(self.shape, self.library)
        distance, uv, primitive, geometry = (array.reshape(-1) for array in room.arrays)
        points, threads = self.points.reshape(-1, 3), self.scene.threads
        _raywarp.nearest(self.scene._core, points, limit, distance, uv, primitive, geometry, threads)
        return room

    def votes(self, rays: int) -> npt.NDArray[np.int32]:
        """Of how many of the rays from each point the number of hits is odd."""
        votes = np.zeros(self.shape, np.int32)
        for direction in _directions(rays):
            votes += self.scene.count(self.points, direction) & 1
        return votes

    def to_host(self, array: Any) -> npt.NDArray[Any]:
        return np.asarray(array)

    def give(self, array: npt.NDArray[Any]) -> Any:
        return self.library.from_host(array)


class DevicePoints:
    """Points of a call, on a CUDA device."""

    def __init__(self, scene: Scene, points: Any, stream: Any) -> None:
        _device.refuse_host_scene(scene, "points")
        _check(points.shape)
        self.scene = scene
        self.like = points
        self.library = _libraries.of(points)
        self.stream = _libraries.stream_of(points, stream)
        self.shape = tuple(points.shape[:-1])

    def empty(self, shape: tuple[int, ...], kind: str) -> Any:
        return self.library.empty(self.scene._core, shape, kind, self.like, self.stream)

    def room(self, limit: float) -> DeviceRoom:
        room = DeviceRoom(self)
        core, threads = self.scene._core, self.scene.threads
        _raywarp.enqueue_nearest(core, self.like, limit, room.records, room.instances, self.stream, threads)
        return room

    def votes(self, rays: int) -> Any:
        votes: Any = 0
        for direction in _directions(rays):
            to = _libraries.to_device(self.scene._core, direction, self.like, self.stream)
            votes = votes + (self.scene.count(self.like, to, stream=self.stream) & 1)
        return votes

    def to_host(self, array: Any) -> npt.NDArray[Any]:
        return _libraries.to_host(self.scene._core, array + 0)

    def give(self, array: npt.NDArray[Any]) -> Any:
        return _libraries.to_device(self.scene._core, array, self.like, self.stream)


class Nearest:
    """The closest point of a scene to each of a batch. Arrays have the shape of the batch, and are of the library of the points and on
    their device."""

    __slots__ = ("__weakref__", "_asked", "_room")

    def __init__(self, asked: Union[HostPoints, DevicePoints], limit: float) -> None:
        self._asked = asked
        self._room: Union[HostRoom, DeviceRoom] = asked.room(limit)

    @property
    def distance(self) -> Any:
        """(...) float32; how far it is. `inf` where there is none."""
        return self._room.t

    @property
    def uv(self) -> Any:
        """(..., 2) float32; the weights of the triangle's vertices 1 and 2. Vertex 0 weighs `1 - u - v`. 0 where there is none."""
        return self._room.uv

    @property
    def primitive(self) -> Any:
        """(...) int32; the number of the triangle in its mesh. -1 where there is none."""
        return self._room.primitive

    @property
    def geometry(self) -> Any:
        """(...) int32; the number of the mesh or the instance in the scene. -1 where there is none."""
        return self._room.geometry

    @property
    def points(self) -> Any:
        """(..., 3) float32; where it is. NaN where there is none. Answers on a CUDA device are waited for."""
        return surface_points(self._asked, self._room)

    @property
    def normals(self) -> Any:
        """(..., 3) float32; the unit normal of the triangle, on the side where its vertices run counter-clockwise. 0 where there is none.
        Answers on a CUDA device are waited for."""
        return surface_normals(self._asked, self._room)

    def __repr__(self) -> str:
        return f"Nearest(shape={tuple(self._asked.shape)})"


def asked(scene: Scene, points: Any, stream: Any) -> Union[HostPoints, DevicePoints]:
    """Points where they are."""
    return DevicePoints(scene, points, stream) if _libraries.is_on_cuda(points) else HostPoints(scene, points)


def occupancy(points: Union[HostPoints, DevicePoints], rays: int) -> Any:
    inside = points.votes(_odd(rays)) > rays // 2
    return points.give(inside) if isinstance(points, HostPoints) else inside


def signed_distance(points: Union[HostPoints, DevicePoints], rays: int) -> Any:
    votes = points.votes(_odd(rays))
    distance = Nearest(points, np.inf).distance
    if isinstance(points, HostPoints):
        host = points.to_host(distance)
        return points.give(np.where(votes > rays // 2, -host, host))
    # By what arrays of every library do, and keeps float32.
    return distance * (votes <= rays // 2) - distance * (votes > rays // 2)


def _check(shape: tuple[int, ...]) -> None:
    if len(shape) == 0 or shape[-1] != 3:
        raise ValueError(f"points have the shape {tuple(shape)}, and (..., 3) is expected")


def _odd(rays: int) -> int:
    if rays < 1 or rays % 2 == 0:
        raise ValueError(f"rays is {rays}, and has to be odd: the rays of a point vote")
    return rays


def _directions(count: int) -> list[Floats]:
    """Directions that are spread over the sphere, and along no axis or diagonal: a spiral by the golden angle."""
    step = np.arange(count) + 0.5
    z = 1 - 2 * (step * 0.754877666 % 1)
    angle, radius = 2.399963 * step + 0.7, np.sqrt(1 - z**2)
    return list(np.stack([radius * np.cos(angle), radius * np.sin(angle), z], axis=1).astype(np.float32))
