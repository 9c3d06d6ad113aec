"""What mypy has to know, and nobody else: imported for its sake alone, as it takes a while."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Optional, Protocol, Union

import numpy as np
import numpy.typing as npt

from raywarp import _raywarp

if TYPE_CHECKING:
    from raywarp._scene import Scene

Floats = npt.NDArray[np.float32]
Ints = npt.NDArray[np.int32]
Doubles = npt.NDArray[np.float64]
Longs = npt.NDArray[np.int64]

# Ends that are the same for all rays, or one a ray.
End = Union[None, float, npt.ArrayLike]


class Library(Protocol):
    """What has to be known of a library."""

    def stream(self, like: Any) -> int:
        """The handle of the CUDA stream on which the library works with an array, 0 for the legacy default stream."""

    def empty(self, core: _raywarp.Scene, shape: tuple[int, ...], kind: str, like: Any, stream: int) -> Any:
        """An array on the device of another one, to be written on a stream."""

    def integers(self, array: Any) -> Any:
        """The same memory as int32."""

    def finished(self, array: Any) -> Any:
        """An array of `empty` as people are given it, once all that writes it was enqueued."""

    def columns(self, array: Any, first: int, count: Optional[int] = None) -> Any:
        """So many columns of such an array of rows, or one."""

    def take(self, array: _raywarp.DeviceArray) -> Any:
        """An array of raywarp's own."""

    def from_host(self, array: npt.NDArray[Any]) -> Any:
        """An array of the CPU, in the memory of one of NumPy."""


class Room(Protocol):
    """Where hits are."""

    @property
    def t(self) -> Any: ...
    @property
    def uv(self) -> Any: ...
    @property
    def primitive(self) -> Any: ...
    @property
    def geometry(self) -> Any: ...


class Asked(Protocol):
    """Rays or points of a call, which know how arrays are given to people and taken from them."""

    @property
    def scene(self) -> Scene: ...
    @property
    def shape(self) -> tuple[int, ...]: ...
    @property
    def library(self) -> Library: ...
    def to_host(self, array: Any) -> npt.NDArray[Any]: ...
    def give(self, array: npt.NDArray[Any]) -> Any: ...


class AskedOnDevice(Protocol):
    """The same on a CUDA device."""

    @property
    def shape(self) -> tuple[int, ...]: ...
    @property
    def library(self) -> Library: ...
    def empty(self, shape: tuple[int, ...], kind: str) -> Any: ...
