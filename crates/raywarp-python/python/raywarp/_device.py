"""Questions of rays on a CUDA device: enqueued on the stream of their library, with answers of the same library there."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, Optional

import numpy as np

from raywarp import _libraries, _raywarp
from raywarp._arrays import along
from raywarp._hits import AllHits, DeviceRoom, Hits

if TYPE_CHECKING:
    import numpy.typing as npt

    from raywarp._scene import Scene


class DeviceBatch:
    """Rays of a call, as kernels take them."""

    def __init__(self, scene: Scene, rays: Any, directions: Any, t_min: Any, t_max: Any, stream: Any) -> None:
        refuse_host_scene(scene, "rays")
        if directions is not None and not _libraries.is_on_cuda(directions):
            raise ValueError("directions are on the CPU, and their origins on a CUDA device")
        self._arrays = (rays, directions)
        self.like = rays
        self.library = _libraries.of(rays)
        self.stream = _libraries.stream_of(rays, stream)
        self.scene = scene
        columns = rays.shape[-1] if len(rays.shape) else 0
        ends = t_min is not None or t_max is not None
        if columns == 8 and ends:
            raise ValueError("rays with 8 numbers have their own t_min and t_max: give no others")
        self.shape = tuple(rays.shape[:-1])
        if directions is not None and math.prod(self.shape) == 1:
            self.shape = tuple(directions.shape[:-1])
        whole = directions is None and columns == 8
        room = None if whole else self.empty((math.prod(self.shape), 8), "float32")
        self.core = _raywarp.DeviceRays(
            scene._core, rays, directions, (_end(t_min, 0.0), _end(t_max, np.inf)), room, self.stream
        )

    def empty(self, shape: tuple[int, ...], kind: str) -> Any:
        return self.library.empty(self.scene._core, shape, kind, self.like, self.stream)

    def to_host(self, array: Any) -> npt.NDArray[Any]:
        """A copy for NumPy."""
        # Of items that lie together: views of records do not.
        return _libraries.to_host(self.scene._core, array + 0)

    def give(self, array: npt.NDArray[Any]) -> Any:
        """An array of NumPy, for the library of the rays."""
        return _libraries.to_device(self.scene._core, array, self.like, self.stream)

    def at(self, t: Any, ray: Any = None) -> Any:
        """The points at `t` of the rays, or of those with these numbers."""
        rays, directions = self._arrays
        if directions is None:
            directions = rays[..., 3:] if rays.shape[-1] == 6 else rays[..., 4:7]
        ends = rays[..., :3], directions
        if ray is not None:
            # One for all stays one.
            ends = tuple(end if math.prod(end.shape) == 3 else end.reshape(-1, 3)[ray] for end in ends)
        return along(*ends, t)


def closest(batch: DeviceBatch, out: Optional[Hits], coherent: bool) -> Hits:
    hits = out
    if hits is None:
        hits = Hits._in(DeviceRoom(batch))
    room = hits._room
    if not isinstance(room, DeviceRoom):
        raise TypeError("out is room on the CPU, and the rays are on a CUDA device")
    _raywarp.enqueue_closest(batch.scene._core, batch.core, room.records, room.instances, coherent)
    return hits._about(batch)


def any(batch: DeviceBatch, out: Any, coherent: bool) -> Any:
    numbers = batch.empty(batch.shape, "int32") if out is None else out
    _raywarp.enqueue_any(batch.scene._core, batch.core, numbers, coherent)
    return batch.library.finished(numbers) != 0 if out is None else out


def count(batch: DeviceBatch, max_hits: Optional[int], out: Any) -> Any:
    numbers = batch.empty(batch.shape, "int32") if out is None else out
    _raywarp.enqueue_count(batch.scene._core, batch.core, max_hits, numbers)
    return batch.library.finished(numbers) if out is None else out


def all(batch: DeviceBatch, max_hits: Optional[int]) -> AllHits:
    core = batch.scene._core
    numbers = batch.empty(batch.shape, "int32")
    _raywarp.enqueue_count(core, batch.core, max_hits, numbers)
    counts = _libraries.to_host(core, numbers, batch.stream)
    offsets = np.concatenate([[0], np.cumsum(counts, dtype=np.int64)])
    if offsets[-1] >= 2**32:
        raise ValueError(
            f"the rays have {offsets[-1]} hits, more than the {2**32 - 1} that fit in one array on a device"
        )
    places = _raywarp.DeviceArray(core, offsets.shape, "int32", batch.stream, offsets.astype(np.uint32), [batch.like])
    room = DeviceRoom(batch, (int(offsets[-1]),))
    _raywarp.enqueue_all(core, batch.core, places, numbers, room.records, room.instances)
    room.holds = places
    return AllHits(batch, _libraries.to_device(core, offsets, batch.like, batch.stream), room)


def _end(end: Any, default: float) -> float:
    if end is None:
        return default
    try:
        return float(end)
    except (TypeError, ValueError):
        raise TypeError(
            "t_min and t_max are numbers where rays are on a device; give rays of 8 numbers to have one for each"
        ) from None


def refuse_host_scene(scene: Scene, what: str) -> None:
    """Where arrays are on a CUDA device, the scene has to be."""
    if not scene._on_cuda:
        raise ValueError(f"{what} are on a CUDA device, and the scene is on the CPU")
