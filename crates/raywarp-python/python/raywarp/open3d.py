"""`RaycastingScene` with the names, shapes and conventions of Open3D's, for a switch in one line:

    from raywarp.open3d import RaycastingScene

instead of `open3d.t.geometry.RaycastingScene`. Open3D itself is not needed. What differs:

- It works on CUDA as well: rays of torch, cupy or jax on a device are answered there.
- Answers are tensors of Open3D for those, and else arrays of the library of the arguments. Those of NumPy have the methods `numpy` and
  `cpu` that tensors have. Numbers of geometry and primitives are uint32 with `INVALID_ID` for none; on a device int32 with -1.
- Normals are turned the way of the triangle's vertices and have unit length, as Open3D's have.
- Which of two triangles is hit at an edge that they share, or where two coincide, is always the same: that of the smaller geometry and
  primitive.
- `list_intersections` lists the hits of a ray in their order, each triangle once.
- Meshes may be added after rays were cast.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from raywarp import _libraries
from raywarp._arrays import array, floats
from raywarp._scene import Scene

if TYPE_CHECKING:
    import numpy.typing as npt


class Array(np.ndarray[Any, np.dtype[Any]]):
    """An array of NumPy with what code for Open3D's tensors calls."""

    def numpy(self) -> npt.NDArray[Any]:
        """The same as a plain array."""
        return np.asarray(self)

    def cpu(self) -> Array:
        """It is there."""
        return self


class RaycastingScene:
    """Meshes that rays are cast at.

    Args:
        nthreads: how many threads of the CPU are used, 0 for all cores.
        device: as for `raywarp.Scene`.
    """

    #: What `geometry_ids` and `primitive_ids` are where there is none.
    INVALID_ID = 2**32 - 1

    def __init__(self, nthreads: int = 0, device: Any = "auto") -> None:
        self.scene = Scene(_device(device))
        self._nthreads = nthreads

    def add_triangles(self, vertex_positions: Any, triangle_indices: Any = None) -> int:
        """Adds a mesh: (N, 3) float32 and (M, 3) uint32, or a `TriangleMesh` of Open3D. Returns its number in `geometry_ids`."""
        if triangle_indices is None:
            mesh = vertex_positions
            vertex_positions, triangle_indices = _parts(mesh)
        added = self.scene.mesh(_taken(vertex_positions), _taken(triangle_indices))
        assert added.geometry is not None
        return added.geometry

    def cast_rays(self, rays: Any, nthreads: int = 0) -> dict[str, Any]:
        """What each ray (..., 6) hits first.

        Returns:
            "t_hit": (...) float32, in units of the direction's length, inf for a miss.
            "geometry_ids", "primitive_ids": (...), `INVALID_ID` for a miss.
            "primitive_uvs": (..., 2) float32, the weights of vertices 1 and 2.
            "primitive_normals": (..., 3) float32, of unit length, 0 for a miss.
        """
        self._use(nthreads)
        give, hits = _giver(rays), self.scene.closest(_rays(rays))
        return {
            "t_hit": give(hits.t),
            "geometry_ids": give(_numbers(hits.geometry)),
            "primitive_ids": give(_numbers(hits.primitive)),
            "primitive_uvs": give(hits.uv),
            "primitive_normals": give(hits.normals),
        }

    def test_occlusions(self, rays: Any, tnear: float = 0.0, tfar: float = np.inf, nthreads: int = 0) -> Any:
        """Whether each ray (..., 6) hits anything between `tnear` and `tfar`: (...) bool."""
        self._use(nthreads)
        return _giver(rays)(self.scene.any(_rays(rays), t_min=tnear, t_max=tfar))

    def count_intersections(self, rays: Any, nthreads: int = 0) -> Any:
        """How many triangles each ray (..., 6) hits: (...) int32."""
        self._use(nthreads)
        return _giver(rays)(self.scene.count(_rays(rays)))

    def list_intersections(self, rays: Any, nthreads: int = 0) -> dict[str, Any]:
        """Everything that the rays (..., 6) hit, ray by ray and in order.

        Returns:
            "ray_splits": (rays + 1); the hits of ray i are those from `ray_splits[i]` to `ray_splits[i + 1]`.
            "ray_ids": (hits); the ray of each.
            "t_hit", "geometry_ids", "primitive_ids", "primitive_uvs": as of `cast_rays`, one a hit.
        """
        self._use(nthreads)
        give, found = _giver(rays), self.scene.all(_rays(rays))
        return {
            "ray_splits": give(_counts(found.offsets)),
            "ray_ids": give(_counts(found.ray)),
            "t_hit": give(found.t),
            "geometry_ids": give(_numbers(found.geometry)),
            "primitive_ids": give(_numbers(found.primitive)),
            "primitive_uvs": give(found.uv),
        }

    def compute_closest_points(self, query_points: Any, nthreads: int = 0) -> dict[str, Any]:
        """The point of the scene that is closest to each of (..., 3).

        Returns:
            "points": (..., 3) float32.
            "geometry_ids", "primitive_ids", "primitive_uvs", "primitive_normals": as of `cast_rays`.
        """
        self._use(nthreads)
        give, found = _giver(query_points), self.scene.nearest(_taken(query_points))
        return {
            "points": give(found.points),
            "geometry_ids": give(_numbers(found.geometry)),
            "primitive_ids": give(_numbers(found.primitive)),
            "primitive_uvs": give(found.uv),
            "primitive_normals": give(found.normals),
        }

    def compute_distance(self, query_points: Any, nthreads: int = 0) -> Any:
        """How far each of (..., 3) is from the scene: (...) float32."""
        self._use(nthreads)
        return _giver(query_points)(self.scene.nearest(_taken(query_points)).distance)

    def compute_signed_distance(self, query_points: Any, nthreads: int = 0, nsamples: int = 1) -> Any:
        """The same, negative within closed meshes; `nsamples` rays of each point vote, an odd number."""
        self._use(nthreads)
        return _giver(query_points)(self.scene.signed_distance(_taken(query_points), rays=nsamples))

    def compute_occupancy(self, query_points: Any, nthreads: int = 0, nsamples: int = 1) -> Any:
        """1 within closed meshes and 0 elsewhere: (...) float32; `nsamples` rays of each point vote, an odd number."""
        self._use(nthreads)
        inside = self.scene.occupancy(_taken(query_points), rays=nsamples)
        return _giver(query_points)(inside.astype(np.float32) if hasattr(inside, "astype") else inside.float())

    @staticmethod
    def create_rays_pinhole(*args: Any, **kwargs: Any) -> Array:
        """Rays (height, width, 6) of a pinhole camera, through the centres of its pixels.

        create_rays_pinhole(fov_deg, center, eye, up, width_px, height_px): the horizontal angle, the point looked at, the place and the
        direction upwards of the camera. As by Open3D the first row is the lowest, and the first column that on the right.

        create_rays_pinhole(intrinsic_matrix, extrinsic_matrix, width_px, height_px): upper triangular (3, 3), and world to camera
        (4, 4), +Z forwards and +Y downwards.
        """
        given = len(args) + len(kwargs)
        if given == 6:
            return _rays_of_view(*args, **kwargs).view(Array)
        if given == 4:
            return _rays_of_matrices(*args, **kwargs).view(Array)
        raise TypeError(f"create_rays_pinhole takes 6 arguments or 4, and not {given}")

    def _use(self, nthreads: int) -> None:
        self.scene.threads = (nthreads or self._nthreads) or None


def _device(device: Any) -> str:
    """As raywarp writes it; devices of Open3D write themselves "CUDA:0"."""
    name = str(device).lower()
    return "cpu" if name.startswith("cpu") else name


def _is_tensor(value: Any) -> bool:
    """Whether this is a tensor of Open3D."""
    return type(value).__module__.startswith("open3d")


def _taken(value: Any) -> Any:
    """An array; tensors of Open3D are NumPy's, of the same memory where that is the CPU's."""
    return value.cpu().numpy() if _is_tensor(value) else value


def _giver(like: Any) -> Callable[[Any], Any]:
    """How answers are given to whom gave this."""
    if _is_tensor(like):
        tensor = sys.modules["open3d"].core.Tensor
        return lambda answer: tensor(np.ascontiguousarray(answer)).to(like.device)
    return lambda answer: answer.view(Array) if isinstance(answer, np.ndarray) else answer


def _parts(mesh: Any) -> tuple[Any, Any]:
    if hasattr(mesh, "vertex"):
        return _taken(mesh.vertex["positions"]), _taken(mesh.triangle["indices"])
    return np.asarray(mesh.vertices), np.asarray(mesh.triangles)


def _rays(rays: Any) -> Any:
    rays = _taken(rays)
    if not _libraries.is_on_cuda(rays):
        rays = rays if hasattr(rays, "shape") else array(rays, "rays")
    if len(rays.shape) == 0 or rays.shape[-1] != 6:
        raise ValueError(f"rays have the shape {tuple(rays.shape)}, and (..., 6) is expected")
    return rays


def _numbers(numbers: Any) -> Any:
    """On the CPU as Open3D has them."""
    return numbers.view(np.uint32) if isinstance(numbers, np.ndarray) else numbers


def _counts(numbers: Any) -> Any:
    """Likewise, where there are not too many."""
    fits = isinstance(numbers, np.ndarray) and (len(numbers) == 0 or numbers[-1] < 2**32)
    return numbers.astype(np.uint32) if fits else numbers


def _rays_of_view(
    fov_deg: float, center: Any, eye: Any, up: Any, width_px: int, height_px: int
) -> npt.NDArray[np.float32]:
    center, eye, up = (floats(_taken(value), "a vector").astype(np.float64) for value in (center, eye, up))
    forward = center - eye
    forward /= np.linalg.norm(forward)
    # As Open3D has it: along rows to the left, and rows one above the other.
    left = np.cross(up, forward)
    left /= np.linalg.norm(left)
    world_to_camera = np.eye(4)
    world_to_camera[:3, :3] = left, np.cross(forward, left), forward
    world_to_camera[:3, 3] = -world_to_camera[:3, :3] @ eye
    focal = 0.5 * width_px / np.tan(0.5 * np.deg2rad(fov_deg))
    intrinsic = np.array([[focal, 0, 0.5 * width_px], [0, focal, 0.5 * height_px], [0, 0, 1]])
    return _rays_of_matrices(intrinsic, world_to_camera, width_px, height_px)


def _rays_of_matrices(
    intrinsic_matrix: Any, extrinsic_matrix: Any, width_px: int, height_px: int
) -> npt.NDArray[np.float32]:
    intrinsic, extrinsic = (np.asarray(_taken(matrix), np.float64) for matrix in (intrinsic_matrix, extrinsic_matrix))
    to_world = np.linalg.inv(extrinsic[:3, :3])
    x, y = np.meshgrid(np.arange(width_px) + 0.5, np.arange(height_px) + 0.5)
    pixels = np.stack([x, y, np.ones_like(x)], axis=-1)
    rays = np.empty((height_px, width_px, 6), np.float32)
    rays[..., :3] = -to_world @ extrinsic[:3, 3]
    rays[..., 3:] = pixels @ (to_world @ np.linalg.inv(intrinsic)).T
    return rays
