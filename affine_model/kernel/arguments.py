"""What the kernel's text is given, in the order of its head: of every name, the type and the number of axes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class Argument:
    """kind: double, i64 or i1, of the number or of the array's elements; axes: 0 for a number."""

    kind: str
    axes: int = 0


_AXES = {
    1: "constants s area second_moment width perimeter Lw w bending A_end servo rail t0",
    2: "parameters W A C wA start start_rate start_past summary",
    3: "WA base start_store out_u out_rate out_force out_past",
    4: "out_store",
}
_ARRAYS = {name: Argument("double", axes) for axes, names in _AXES.items() for name in names.split()}
_COUNTS = dict.fromkeys(("block", "steps", "age", "iterations", "stride", "average_from"), Argument("i64"))
_FLAGS = dict.fromkeys(("free_theta", "free_rail"), Argument("i1"))
ARGUMENTS = {**_ARRAYS, **_COUNTS, **_FLAGS, "active": Argument("i1", 1), "h": Argument("double")}


def packed(names: list[str], values: tuple[Any, ...]) -> tuple[NDArray[np.int64], list[Any]]:
    """One row of 64-bit words for the compiled function: of an array its address and extents, of a number itself.
    Beside it what must live as long as the row is used. ValueError where an array has another type, or is not in C
    order.
    """
    words: list[Any] = []
    for name, value in zip(names, values, strict=True):
        argument = ARGUMENTS[name]
        if argument.axes == 0:
            words.append(np.float64(value).view(np.int64) if argument.kind == "double" else int(value))
            continue
        wanted = np.bool_ if argument.kind == "i1" else np.float64
        if value.ndim != argument.axes or value.dtype != wanted or not value.flags.c_contiguous:
            shape = f"{value.dtype} {value.shape}"
            raise ValueError(f"{name}: {shape}; expected {wanted.__name__} in C order, {argument.axes} axes")
        words += [value.__array_interface__["data"][0], *value.shape]
    return np.array(words, dtype=np.int64), list(values)
