"""The rays of a call, in the forms that people have them in."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple, Optional

import numpy as np

from raywarp import _libraries
from raywarp._arrays import along, floats

if TYPE_CHECKING:
    import numpy.typing as npt

    from raywarp._scene import Scene
    from raywarp._types import End, Floats, Library


class Rays(NamedTuple):
    """Rows of rays and the shape of the batch that they are."""

    # (n, 6) or (n, 8); or (n, 3) or (1, 3), with directions.
    origins: Floats
    directions: Optional[Floats]
    # t_min and t_max of rays that have none of their own.
    ends: tuple[float, float]
    shape: tuple[int, ...]
    # Of the arrays that were given.
    library: Library
    scene: Scene

    def to_host(self, array: Any) -> npt.NDArray[Any]:
        """For NumPy."""
        return np.asarray(array)

    def give(self, array: npt.NDArray[Any]) -> Any:
        """An array of NumPy, for the library of the rays."""
        return self.library.from_host(array)

    def at(self, t: Any, ray: Any = None) -> Any:
        """The points at `t` of the rays, or of those with these numbers; for the library of the rays."""
        start, direction = self.starts, self.ways
        if ray is not None:
            start, direction = (ends.reshape(-1, 3)[np.asarray(ray)] for ends in (start, direction))
        return self.give(along(start, direction, np.asarray(t)))

    @property
    def starts(self) -> Floats:
        """Where t is 0, (..., 3)."""
        start = np.broadcast_to(self.origins[:, :3], (self.rows, 3))
        return start.reshape(*self.shape, 3)

    @property
    def ways(self) -> Floats:
        """Where each goes, (..., 3)."""
        if self.directions is not None:
            direction = self.directions
        elif self.origins.shape[1] == 8:
            direction = self.origins[:, 4:7]
        else:
            direction = self.origins[:, 3:]
        return direction.reshape(*self.shape, 3)

    @property
    def rows(self) -> int:
        """How many rays there are."""
        return len(self.origins if self.directions is None else self.directions)


def prepare(scene: Scene, rays: Any, directions: Any, t_min: End, t_max: End) -> Rays:
    """The rays of a call, without a copy where they are as they are needed."""
    library = _libraries.of(rays)
    batch = _whole(scene, rays, library) if directions is None else _parts(scene, rays, directions, library)
    if t_min is None and t_max is None:
        return batch
    _refuse_two_ends(batch)
    low = floats(0.0 if t_min is None else t_min, "t_min")
    high = floats(np.inf if t_max is None else t_max, "t_max")
    if low.ndim == high.ndim == 0:
        return batch._replace(ends=(float(low), float(high)))
    return _with_own_ends(batch, low, high)


def _whole(scene: Scene, rays: Any, library: Library) -> Rays:
    rays = floats(rays, "rays")
    if rays.ndim == 0 or rays.shape[-1] not in (6, 8):
        raise ValueError(
            f"rays have the shape {rays.shape}, and the last axis has to be 6 long (origin, direction) or 8 "
            "(origin, t_min, direction, t_max); with directions apart it is 3 long"
        )
    return Rays(rays.reshape(-1, rays.shape[-1]), None, (0.0, np.inf), rays.shape[:-1], library, scene)


def _parts(scene: Scene, origins: Any, directions: Any, library: Library) -> Rays:
    origins, directions = floats(origins, "origins"), floats(directions, "directions")
    for what, given in (("origins", origins), ("directions", directions)):
        if given.ndim == 0 or given.shape[-1] != 3:
            raise ValueError(f"{what} have the shape {given.shape}, and the last axis has to be 3 long")
    try:
        shape = np.broadcast_shapes(origins.shape, directions.shape)
    except ValueError:
        raise ValueError(
            f"origins of the shape {origins.shape} and directions of the shape {directions.shape} are no pairs"
        ) from None
    directions = np.ascontiguousarray(np.broadcast_to(directions, shape))
    # One origin for all is not repeated.
    if origins.size != 3:
        origins = np.ascontiguousarray(np.broadcast_to(origins, shape))
    return Rays(origins.reshape(-1, 3), directions.reshape(-1, 3), (0.0, np.inf), shape[:-1], library, scene)


def _refuse_two_ends(batch: Rays) -> None:
    if batch.directions is None and batch.origins.shape[1] == 8:
        raise ValueError("rays with 8 numbers have their own t_min and t_max: give no others")


def _with_own_ends(batch: Rays, t_min: Floats, t_max: Floats) -> Rays:
    """The same where each ray has its own ends."""
    rows = np.empty((*batch.shape, 8), np.float32)
    rows[..., :3] = batch.starts
    rows[..., 4:7] = batch.ways
    for column, ends, what in ((3, t_min, "t_min"), (7, t_max, "t_max")):
        try:
            rows[..., column] = ends
        except ValueError:
            raise ValueError(f"{what} has the shape {ends.shape}, and the rays {batch.shape}") from None
    return batch._replace(origins=rows.reshape(-1, 8), directions=None)
