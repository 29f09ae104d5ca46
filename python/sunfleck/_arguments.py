# SPDX-FileCopyrightText: 2026 The Sunfleck developers
# SPDX-License-Identifier: Apache-2.0

"""arguments: what a caller passed, as the numbers and arrays that C takes.

Only kinds and shapes are checked here, and that a number fits its C type; ranges are C's to say.
"""

from __future__ import annotations

import math
import operator
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

Vector = tuple[float, float, float]


def integer(name: str, value: Any, bits: int = 64) -> int:
    """A whole number in [0, 2^bits)."""
    if type(value) is int and 0 <= value < 1 << bits:
        return value
    try:
        number = operator.index(value)
    except TypeError:
        raise TypeError(f"{name} is {value!r}; give an integer") from None
    if not 0 <= number < 1 << bits:
        raise ValueError(f"{name} is {number}; give an integer from 0 to {(1 << bits) - 1}")
    return number


def array_of(name: str, value: Any) -> NDArray[Any]:
    """What was given as an array, of whatever kind: the one way in for every array argument.

    A mask would be lost here without a word, so that masked values are refused.
    """
    if type(value) is not np.ndarray:
        refuse_masked(name, value)
    try:
        return np.asarray(value)
    except ValueError as error:
        raise ValueError(f"{name} is not a regular array: {error}") from None


def refuse_masked(name: str, value: Any) -> None:
    """Refuses a masked array of which something is masked, and a sequence that holds one."""
    parts = value if isinstance(value, (list, tuple)) else (value,)
    for part in parts:
        if isinstance(part, (list, tuple)):
            refuse_masked(name, part)
        elif isinstance(part, np.ma.MaskedArray) and np.ma.is_masked(part):
            raise ValueError(
                f"{name} is a masked array, {np.ma.getmaskarray(part).sum()} of its {part.size} values masked; masks "
                f"are not honoured: give .compressed() or .filled(value)"
            )


def vector(name: str, value: Any) -> Vector:
    """Three real numbers, as floats; what they may be is C's to say."""
    refuse_masked(name, value)
    try:
        array = np.asarray(value)
    except ValueError:
        raise ValueError(f"{name} is {value!r}; give three numbers") from None
    if array.dtype.kind not in "fiu":
        raise TypeError(f"{name} is {value!r}; give three numbers")
    if array.shape != (3,):
        raise ValueError(f"{name} has shape {array.shape}; give three numbers")
    x, y, z = array.tolist()
    return float(x), float(y), float(z)


def flag(name: str, value: object) -> bool:
    """True or False, NumPy's too; other values are mistakes."""
    if not isinstance(value, (bool, np.bool_)):
        raise TypeError(f"{name} is {value!r}; give True or False")
    return bool(value)


def number(name: str, value: Any) -> float:
    """A real number, as a float; strings and arrays are refused."""
    if isinstance(value, (bool, str, bytes)):
        raise TypeError(f"{name} is {value!r}; give a number")
    try:
        return float(value)
    except OverflowError:
        raise ValueError(f"{name} is {value!r}, which no float holds") from None
    except (TypeError, ValueError):
        raise TypeError(f"{name} is {value!r}; give a number") from None


def text(name: str, value: Any) -> str:
    """A string."""
    if not isinstance(value, str):
        raise TypeError(f"{name} is {value!r}; give a string")
    if any(c == "\0" or "\ud800" <= c <= "\udfff" for c in value):  # C would end the text there; or it is none
        raise ValueError(f"{name} is {value!r}; it must not hold a null character or half of a surrogate pair")
    return value


def choice(name: str, value: Any, allowed: Iterable[str], lead: str = "choose one of") -> str:
    """The one of the allowed names that a string is; capital letters are as small ones, "-" and " " as "_"."""
    names = tuple(allowed)
    given = text(name, value)
    if given in names:
        return given
    for known in names:
        if _folded(given) == _folded(known):
            return known
    raise ValueError(f"{name} is {given!r}; {lead} {', '.join(names)}")


def spoken(name: str) -> str:
    """A name as it stands in a sentence."""
    return name.replace("_", " ")


def _folded(name: str) -> str:
    return name.lower().replace("-", "_").replace(" ", "_")


def one_of(name: str, value: DTypeLike, allowed: Sequence[str]) -> np.dtype[Any]:
    """A dtype among those allowed."""
    if isinstance(value, str) and value in allowed:
        return np.dtype(value)
    try:
        dtype = np.dtype(value)
    except TypeError:
        raise TypeError(f"{name} is {value!r}; give {' or '.join(allowed)}") from None
    if dtype.type.__name__ not in allowed or not dtype.isnative:
        raise TypeError(f"{name} is {value!r}; give {' or '.join(allowed)}")
    return dtype


def shape_of(name: str, value: Any) -> tuple[int, ...]:
    """A shape: an integer or a sequence of integers, none negative."""
    sizes = value if isinstance(value, (tuple, list)) else (value,)
    shape = tuple(integer(name, size, bits=63) for size in sizes)
    check_size(name, shape)
    return shape


def check_size(name: str, shape: tuple[int, ...]) -> None:
    """Refuses what no machine's memory holds."""
    if math.prod(shape) >= 1 << 60:
        raise MemoryError(f"{name} is {shape}: no memory holds {math.prod(shape)} values")


def real_array(name: str, value: ArrayLike, dtype: np.dtype[Any] | None) -> NDArray[Any]:
    """Real numbers as float32 or float64: as wanted, else float32 stays and the rest is float64."""
    array = array_of(name, value)
    if array.dtype.kind not in "fiu":
        raise TypeError(f"{name} has dtype {array.dtype}; give real numbers")
    if dtype is None:
        dtype = np.dtype(np.float32 if array.dtype == np.float32 else np.float64)
    return np.require(array, dtype, ["C", "A"])


def output_dtype(dtype: DTypeLike | None, out: NDArray[Any] | None, allowed: Sequence[str]) -> np.dtype[Any]:
    """The dtype asked for, else that of `out`, else the first of those allowed."""
    if dtype is not None:
        return one_of("dtype", dtype, allowed)
    if isinstance(out, np.ndarray):
        return one_of("out's dtype", out.dtype, allowed)
    return np.dtype(allowed[0])


def output_array(out: NDArray[Any] | None, shape: tuple[int, ...], dtype: np.dtype[Any]) -> NDArray[Any]:
    """`out`, filled in place by the caller, or a new array; refused where it would need a copy."""
    if out is None:
        return np.empty(shape, dtype)
    if not isinstance(out, np.ndarray):
        raise TypeError(f"out is {type(out).__name__}; give a NumPy array")
    refuse_masked("out", out)
    if out.dtype != dtype:
        raise TypeError(f"out has dtype {out.dtype}; it must be {dtype}")
    if out.shape != shape:
        raise ValueError(f"out has shape {out.shape}; it must be {shape}")
    if not (out.flags.c_contiguous and out.flags.aligned and out.flags.writeable):
        raise ValueError("out is not C-contiguous, aligned and writeable; it can't be filled in place")
    return out
