"""Libraries of arrays: where theirs are, which stream they work on, and how they are given arrays.

None is imported here. Whoever gives an array of a library has imported it, so it is among the modules of the process.
"""

from __future__ import annotations

import importlib
import sys
from typing import TYPE_CHECKING, Any, Optional

import numpy as np

from raywarp import _raywarp

if TYPE_CHECKING:
    import numpy.typing as npt

    from raywarp._types import Library

# DLPack's numbers of memory that the CPU reads, and of memory of CUDA devices.
_HOST = (1, 3)
_CUDA = (2, 13)


class _NumPy:
    """And whatever else NumPy makes an array of."""

    def from_host(self, array: npt.NDArray[Any]) -> Any:
        return array


class _Torch:
    def __init__(self, torch: Any) -> None:
        self._torch = torch
        self._kinds = {"float32": torch.float32, "int32": torch.int32, "int64": torch.int64}

    def stream(self, like: Any) -> int:
        handle: int = self._torch.cuda.current_stream(like.device).cuda_stream
        return handle

    def empty(self, core: _raywarp.Scene, shape: tuple[int, ...], kind: str, like: Any, stream: int) -> Any:
        return self._torch.empty(shape, dtype=self._kinds[kind], device=like.device)

    def integers(self, array: Any) -> Any:
        return array.view(self._torch.int32)

    def finished(self, array: Any) -> Any:
        return array

    def columns(self, array: Any, first: int, count: Optional[int] = None) -> Any:
        return _sliced(array, first, count)

    def take(self, array: _raywarp.DeviceArray) -> Any:
        return self._torch.from_dlpack(array)

    def from_host(self, array: npt.NDArray[Any]) -> Any:
        return self._torch.from_numpy(array)


class _CuPy:
    def __init__(self, cupy: Any) -> None:
        self._cupy = cupy

    def stream(self, like: Any) -> int:
        with like.device:
            handle: int = self._cupy.cuda.get_current_stream().ptr
        return handle

    def empty(self, core: _raywarp.Scene, shape: tuple[int, ...], kind: str, like: Any, stream: int) -> Any:
        with like.device:
            return self._cupy.empty(shape, kind)

    def integers(self, array: Any) -> Any:
        return array.view("int32")

    def finished(self, array: Any) -> Any:
        return array

    def columns(self, array: Any, first: int, count: Optional[int] = None) -> Any:
        return _sliced(array, first, count)

    def take(self, array: _raywarp.DeviceArray) -> Any:
        return self._cupy.from_dlpack(array)

    def from_host(self, array: npt.NDArray[Any]) -> Any:
        return array


class _Other:
    """One that does not make its arrays to be written by others, or that is not known: raywarp makes them, and the library takes
    them by DLPack. They hold what they are answers to, as the library does not know that it is still being read."""

    def __init__(self, from_dlpack: Any) -> None:
        self._from_dlpack = from_dlpack

    def stream(self, like: Any) -> int:
        interface = None if hasattr(like, "__dlpack__") else like.__cuda_array_interface__
        return (interface or {}).get("stream") or 0

    def empty(self, core: _raywarp.Scene, shape: tuple[int, ...], kind: str, like: Any, stream: int) -> Any:
        return _raywarp.DeviceArray(core, shape, kind, stream, None, [like])

    def integers(self, array: Any) -> Any:
        return array.view("int32")

    def finished(self, array: Any) -> Any:
        return array if self._from_dlpack is None else self._from_dlpack(array)

    def columns(self, array: Any, first: int, count: Optional[int] = None) -> Any:
        # Not every library takes arrays whose items lie apart.
        if self._from_dlpack is None:
            return array.columns(first, count)
        return _sliced(self._from_dlpack(array), first, count)

    def take(self, array: _raywarp.DeviceArray) -> Any:
        return self.finished(array)

    def from_host(self, array: npt.NDArray[Any]) -> Any:
        return array if self._from_dlpack is None else self._from_dlpack(array)


_NUMPY = _NumPy()
_known: dict[type, Any] = {np.ndarray: _NUMPY}


def of(value: Any) -> Library:
    """The library of an array."""
    kind = type(value)
    library = _known.get(kind)
    if library is None:
        library = _known[kind] = _find(kind, value)
    found: Library = library
    return found


def _find(kind: type, value: Any) -> Any:
    # Tensors of torch may be of classes of others.
    names = {base.__module__.partition(".")[0] for base in kind.__mro__}
    if "torch" in names:
        return _Torch(sys.modules["torch"])
    if "cupy" in names:
        return _CuPy(sys.modules["cupy"])
    if "numpy" in names or not hasattr(value, "__dlpack__") and not hasattr(value, "__cuda_array_interface__"):
        return _NUMPY
    return _Other(_from_dlpack(names))


def _from_dlpack(names: set[str]) -> Any:
    """The function by which a library takes arrays of others; none where it is not known."""
    if names & {"jax", "jaxlib"}:
        # Arrays of jax are of a class of jaxlib, and so are their tracers.
        return importlib.import_module("jax.dlpack").from_dlpack
    for name in sorted(names):
        function = getattr(sys.modules.get(name), "from_dlpack", None)
        if function is not None:
            return function
    return None


def is_on_cuda(value: Any) -> bool:
    """Whether an array is in the memory of a CUDA device."""
    if isinstance(value, np.ndarray):
        return False
    device = getattr(value, "__dlpack_device__", None)
    if device is not None:
        return device()[0] in _CUDA
    return hasattr(value, "__cuda_array_interface__")


def stream_of(value: Any, chosen: Any) -> int:
    """The handle of the stream for a call with an array: the one that was chosen, or the library's own."""
    if chosen is None:
        return of(value).stream(value)
    if isinstance(chosen, int):
        return chosen
    for name in ("cuda_stream", "ptr", "handle"):
        handle = getattr(chosen, name, None)
        if isinstance(handle, int):
            return handle
    protocol = getattr(chosen, "__cuda_stream__", None)
    if protocol is not None:
        _, handle = protocol() if callable(protocol) else protocol
        return int(handle)
    raise TypeError(f"stream is {type(chosen).__name__}, and has to be a stream of CUDA or its handle")


def to_host(core: _raywarp.Scene, value: Any, stream: Optional[int] = None) -> npt.NDArray[Any]:
    """A copy of an array on a CUDA device, once it has been made."""
    words, kind, shape = _raywarp.fetch(core, value, of(value).stream(value) if stream is None else stream)
    return words.view(kind).reshape(shape)


def to_device(core: _raywarp.Scene, value: npt.NDArray[Any], like: Any, stream: int) -> Any:
    """An array of NumPy on the device and of the library of another one."""
    words = np.ascontiguousarray(value).reshape(-1).view(np.uint32)
    return of(like).take(_raywarp.DeviceArray(core, value.shape, value.dtype.name, stream, words, []))


def _sliced(array: Any, first: int, count: Optional[int]) -> Any:
    return array[..., first] if count is None else array[..., first : first + count]
