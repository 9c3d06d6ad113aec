"""Arguments as the arrays that they are meant to be.

float32 is taken as it is, without a copy where its items lie in order; other real numbers are rounded to it. Faces may be
integers of any size. Everything else is an error that says what was given and what was expected.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    import numpy.typing as npt

    from raywarp._types import Floats


def array(value: Any, what: str) -> npt.NDArray[Any]:
    """What NumPy makes of `value`: an array of NumPy, of another library on the CPU, or nested sequences."""
    if not isinstance(value, np.ndarray) and hasattr(value, "__dlpack_device__"):
        return _from_other_library(value, what)
    try:
        return np.asarray(value)
    except ValueError as error:
        raise ValueError(f"{what} cannot be made an array: {error}") from None


def _from_other_library(value: Any, what: str) -> npt.NDArray[Any]:
    device, _ = value.__dlpack_device__()
    if device not in _HOST:
        raise TypeError(
            f"{what} are in the memory of a device of DLPack's kind {int(device)}, which raywarp cannot read"
        )
    try:
        return np.from_dlpack(value)
    except (BufferError, RuntimeError):
        # Read-only arrays that NumPy's older versions refuse, and tensors that require gradients.
        return np.asarray(value)


# kDLCPU and kDLCUDAHost.
_HOST = (1, 3)


def floats(value: Any, what: str) -> Floats:
    """As float32, in order in memory."""
    given = array(value, what)
    if given.dtype.kind not in "fiu":
        raise TypeError(f"{what} are {given.dtype}, and have to be real numbers, best float32")
    with np.errstate(over="ignore"):
        return np.ascontiguousarray(given, np.float32)


def vertices(value: Any) -> Floats:
    """Positions (V, 3)."""
    given = floats(value, "vertices")
    if given.ndim != 2 or given.shape[1] != 3:
        raise ValueError(f"vertices have the shape {given.shape}, and (V, 3) is expected")
    return given


def faces(value: Any, vertex_count: int) -> npt.NDArray[np.uint32]:
    """Triangles (F, 3), each index below the number of vertices."""
    given = array(value, "faces")
    if given.dtype.kind not in "iu" and given.size > 0:
        raise TypeError(f"faces are {given.dtype}, and have to be integers")
    if given.size == 0 and given.ndim < 2:
        given = given.reshape(0, 3)
    if given.ndim != 2 or given.shape[1] != 3:
        raise ValueError(f"faces have the shape {given.shape}, and (F, 3) is expected: triangles")
    wrong = (given < 0) | (given >= vertex_count)
    if wrong.any():
        row, column = np.argwhere(wrong)[0]
        raise ValueError(
            f"face {row} names vertex {given[row, column]}, and there are {vertex_count} vertices, counted from 0"
        )
    return np.ascontiguousarray(given, np.uint32)


def transforms(value: Any) -> Floats:
    """Affine maps as (n, 3, 4), given as such, as (n, 4, 4), or as one of either."""
    given = floats(value, "transforms")
    if given.ndim == 2:
        given = given[np.newaxis]
    if given.ndim != 3 or given.shape[1:] not in ((3, 4), (4, 4)):
        raise ValueError(f"transforms have the shape {given.shape}, and (n, 3, 4) or (n, 4, 4) is expected")
    if given.shape[1] == 4 and not (given[:, 3] == (0, 0, 0, 1)).all():
        raise ValueError("transforms have a last row other than 0, 0, 0, 1, and only affine maps place a mesh")
    return np.ascontiguousarray(given[:, :3])


def along(start: Any, direction: Any, t: Any) -> Any:
    """Points at `t`, NaN where that is infinite; of arrays of any library."""
    with np.errstate(invalid="ignore"):
        # NaN where it is infinite, and itself elsewhere.
        t = t + 0 * t
        return start + t[..., None] * direction
