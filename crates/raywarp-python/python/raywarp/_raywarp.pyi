from typing import Final, Optional, final

import numpy as np
import numpy.typing as npt

_Floats = npt.NDArray[np.float32]
_Ints = npt.NDArray[np.int32]
_Ends = tuple[float, float]

__all__ = ["DeviceError", "Scene", "__version__", "all", "any", "closest", "count", "normals", "run"]

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
    def place(self, placements: list[tuple[int, _Floats]]) -> None: ...
    def commit(self, threads: Optional[int]) -> tuple[int, int]: ...

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
def normals(
    scene: Scene, primitive: _Ints, geometry: _Ints, normals: _Floats, threads: Optional[int]
) -> None: ...
def run(words: list[str]) -> int: ...
