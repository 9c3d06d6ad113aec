"""`RayMeshIntersector` with the names, shapes and conventions of trimesh's, for a switch in one line:

    mesh.ray = raywarp.trimesh.RayMeshIntersector(mesh)

trimesh itself is not needed: anything with `vertices` and `faces` is a mesh. What differs from `trimesh.ray.ray_pyembree`:

- All hits of a ray are found at once. No ray is shot again from an offset, so no hit is lost where triangles are closer to each other than
  that, and none comes twice; `max_hits` bounds the hits of a ray, and none are lost by default.
- Hits are sorted by ray, and then by distance; trimesh sorts them by how often it had to shoot.
- Locations are where the ray meets the triangle's plane, in double precision.
- `contains_points` counts the hits of three rays from each point, which vote. The originals shoot one forwards and one backwards.
- `scale_to_box` is taken and of no matter: what is close and what is parallel depends on no scale.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Optional

import numpy as np

from raywarp._scene import Scene

if TYPE_CHECKING:
    import numpy.typing as npt

    from raywarp._types import Doubles, Longs


class RayMeshIntersector:
    """Asks a mesh what rays hit.

    Args:
        geometry: has `vertices` (n, 3) and `faces` (m, 3). They are taken over with the first question; where they have changed since,
            make another.
        scale_to_box: of no matter.
        device: as for `raywarp.Scene`.
        threads: as for `raywarp.Scene`.
    """

    def __init__(
        self, geometry: Any, scale_to_box: bool = True, *, device: str = "auto", threads: Optional[int] = None
    ) -> None:
        self.mesh = geometry
        self._wishes: dict[str, Any] = {"device": device, "threads": threads}
        self._made: Optional[Scene] = None

    def intersects_location(
        self, ray_origins: Any, ray_directions: Any, multiple_hits: bool = True
    ) -> tuple[Doubles, Longs, Longs]:
        """Where rays hit.

        Args:
            ray_origins, ray_directions: (n, 3) real numbers.
            multiple_hits: whether all hits of a ray are wanted, or the first one.

        Returns:
            The locations (hits, 3) float64, and of each the index of its ray and of its triangle (hits,) int64.
        """
        index_tri, index_ray, locations = self.intersects_id(
            ray_origins, ray_directions, multiple_hits, return_locations=True
        )
        return locations, index_ray, index_tri

    def intersects_id(
        self,
        ray_origins: Any,
        ray_directions: Any,
        multiple_hits: bool = True,
        max_hits: Optional[int] = None,
        return_locations: bool = False,
    ) -> tuple[Any, ...]:
        """Which triangles rays hit.

        Args:
            ray_origins, ray_directions: (n, 3) real numbers.
            multiple_hits: whether all hits of a ray are wanted, or the first one.
            max_hits: how many of each ray at most.
            return_locations: whether to say where.

        Returns:
            Of each hit the index of its triangle and of its ray (hits,) int64, and where asked for the locations (hits, 3) float64.
        """
        origins, directions = _rays(ray_origins, ray_directions)
        found = self._scene.all(origins, directions, max_hits=max_hits if multiple_hits else 1)
        ray: Longs = found.ray
        triangle: Longs = found.primitive.astype(np.int64)
        if not return_locations:
            return triangle, ray
        return triangle, ray, self._locations(triangle, origins[ray], directions[ray], found.t)

    def intersects_first(self, ray_origins: Any, ray_directions: Any) -> Longs:
        """The triangle that each ray hits first: (n,) int64, -1 for none."""
        hits = self._scene.closest(*_rays(ray_origins, ray_directions))
        first: Longs = hits.primitive.astype(np.int64)
        return first

    def intersects_any(self, ray_origins: Any, ray_directions: Any) -> npt.NDArray[np.bool_]:
        """Whether each ray hits anything: (n,) bool."""
        hit: npt.NDArray[np.bool_] = self._scene.any(*_rays(ray_origins, ray_directions))
        return hit

    def contains_points(self, points: Any) -> npt.NDArray[np.bool_]:
        """Whether each of (n, 3) points is within the mesh, which is to be closed: (n,) bool."""
        points = np.asarray(points, np.float64)
        if points.ndim != 2 or points.shape[1] != 3:
            raise ValueError(f"points have the shape {points.shape}, and (n, 3) is expected")
        inside: npt.NDArray[np.bool_] = self._scene.occupancy(points, rays=3)
        return inside

    def _locations(self, triangle: Longs, origins: Doubles, directions: Doubles, t: Any) -> Doubles:
        """Where rays meet the planes of triangles; at `t`, which has single precision, where they run along them."""
        corners = np.asarray(self.mesh.vertices, np.float64)[np.asarray(self.mesh.faces)[triangle]]
        normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        slope = (normals * directions).sum(axis=1)
        with np.errstate(divide="ignore", invalid="ignore"):
            exact = (normals * (corners[:, 0] - origins)).sum(axis=1) / slope
        distance = np.where(np.abs(exact - t) <= 1e-4 * np.abs(t), exact, t)
        locations: Doubles = origins + distance[:, np.newaxis] * directions
        return locations

    @property
    def _scene(self) -> Scene:
        if self._made is None:
            self._made = Scene(**self._wishes)
            self._made.mesh(np.asarray(self.mesh.vertices), np.asarray(self.mesh.faces))
        return self._made

    def __getstate__(self) -> dict[str, Any]:
        # A scene is of this process and its device.
        return {**self.__dict__, "_made": None}

    def __copy__(self) -> RayMeshIntersector:
        return RayMeshIntersector(self.mesh, **self._wishes)

    def __deepcopy__(self, memo: Any) -> RayMeshIntersector:
        return self.__copy__()


def _rays(origins: Any, directions: Any) -> tuple[Doubles, Doubles]:
    """In double precision, with directions of unit length."""
    origins, directions = np.asarray(origins, np.float64), np.asarray(directions, np.float64)
    if origins.shape != directions.shape or origins.ndim != 2 or origins.shape[1] != 3:
        raise ValueError(
            f"origins have the shape {origins.shape} and directions {directions.shape}, and (n, 3) is expected of both"
        )
    length = np.linalg.norm(directions, axis=1, keepdims=True)
    return origins, directions / np.where(length > 0, length, 1)
