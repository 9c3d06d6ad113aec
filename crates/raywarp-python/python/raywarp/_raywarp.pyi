from typing import Any, Final, Optional, final

import numpy as np
import numpy.typing as npt

_Floats = npt.NDArray[np.float32]
_Ints = npt.NDArray[np.int32]
_Ends = tuple[float, float]

__all__ = [
    "DeviceArray",
    "DeviceError",
    "DeviceRays",
    "Scene",
    "__version__",
    "all",
    "any",
    "closest",
    "count",
    "enqueue_all",
    "enqueue_any",
    "enqueue_closest",
    "enqueue_count",
    "enqueue_nearest",
    "fetch",
    "nearest",
    "normals",
    "run",
    "surface_points",
]

__version__: Final[str]

class DeviceError(RuntimeError): ...

@final
class Scene:
    def __new__(cls, device: str, build: Optional[str]) -> Scene: ...
    def read(self, path: str) -> list[str]: ...
    @property
    def device(self) -> str: ...
    @property
    def description(self) -> str: ...
    @property
    def fallback(self) -> Optional[str]: ...
    @property
    def names(self) -> list[str]: ...
    @property
    def of_file(self) -> int: ...
    def add_mesh(self, vertices: _Floats, faces: npt.NDArray[np.uint32]) -> int: ...
    def move_vertices(self, mesh: int, vertices: _Floats) -> None: ...
    def place(self, placements: list[tuple[int, _Floats]], moving: bool) -> None: ...
    def commit(self, threads: Optional[int]) -> None: ...

@final
class DeviceArray:
    def __new__(
        cls,
        scene: Scene,
        shape: tuple[int, ...],
        kind: str,
        stream: int,
        words: Optional[npt.NDArray[np.uint32]] = None,
        holds: list[Any] = ...,
    ) -> DeviceArray: ...
    def view(self, kind: str) -> DeviceArray: ...
    def columns(self, first: int, count: Optional[int] = None) -> DeviceArray: ...
    @property
    def shape(self) -> list[int]: ...
    def __dlpack__(
        self,
        *,
        stream: Optional[Any] = None,
        max_version: Optional[tuple[int, int]] = None,
        dl_device: Optional[tuple[int, int]] = None,
        copy: Optional[bool] = None,
    ) -> Any: ...
    def __dlpack_device__(self) -> tuple[int, int]: ...
    @property
    def __cuda_array_interface__(self) -> dict[str, Any]: ...

@final
class DeviceRays:
    def __new__(cls, scene: Scene, rays: Any, directions: Any, ends: _Ends, room: Any, stream: int) -> DeviceRays: ...
    def __len__(self) -> int: ...

def enqueue_closest(scene: Scene, rays: DeviceRays, records: Any, geometry: Any, coherent: bool) -> None: ...
def enqueue_any(scene: Scene, rays: DeviceRays, numbers: Any, coherent: bool) -> None: ...
def enqueue_count(scene: Scene, rays: DeviceRays, max_hits: Optional[int], numbers: Any) -> None: ...
def enqueue_all(
    scene: Scene, rays: DeviceRays, offsets: DeviceArray, numbers: Any, records: Any, geometry: Any
) -> None: ...
def enqueue_nearest(
    scene: Scene, points: Any, limit: float, records: Any, geometry: Any, stream: int, threads: Optional[int]
) -> None: ...
def fetch(scene: Scene, array: Any, stream: int) -> tuple[npt.NDArray[np.uint32], str, list[int]]: ...
def closest(
    scene: Scene,
    origins: _Floats,
    directions: Optional[_Floats],
    ends: _Ends,
    t: _Floats,
    uv: _Floats,
    primitive: _Ints,
    geometry: _Ints,
    threads: Optional[int],
) -> None: ...
def any(
    scene: Scene,
    origins: _Floats,
    directions: Optional[_Floats],
    ends: _Ends,
    blocked: npt.NDArray[np.bool_],
    threads: Optional[int],
) -> None: ...
def count(
    scene: Scene,
    origins: _Floats,
    directions: Optional[_Floats],
    ends: _Ends,
    max_hits: Optional[int],
    counts: _Ints,
    threads: Optional[int],
) -> None: ...
def all(
    scene: Scene,
    origins: _Floats,
    directions: Optional[_Floats],
    ends: _Ends,
    max_hits: Optional[int],
    threads: Optional[int],
) -> tuple[npt.NDArray[np.int64], _Floats, _Floats, _Ints, _Ints]: ...
def nearest(
    scene: Scene,
    points: _Floats,
    limit: float,
    distance: _Floats,
    uv: _Floats,
    primitive: _Ints,
    geometry: _Ints,
    threads: Optional[int],
) -> None: ...
def surface_points(
    scene: Scene,
    primitive: _Ints,
    geometry: _Ints,
    uv: _Floats,
    points: _Floats,
    threads: Optional[int],
) -> None: ...
def normals(scene: Scene, primitive: _Ints, geometry: _Ints, normals: _Floats, threads: Optional[int]) -> None: ...
def run(words: list[str]) -> int: ...
