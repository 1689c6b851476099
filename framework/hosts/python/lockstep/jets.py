# SPDX-License-Identifier: BSD-3-Clause
"""Functions of jets and of numbers. numpy's functions work on jets too."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np


def _function(name: str) -> Callable[[Any], Any]:
    of_numbers = getattr(np, name)

    def function(x: Any) -> Any:
        method = getattr(x, name, None)
        return of_numbers(x) if method is None or isinstance(x, np.ndarray) else method()

    function.__name__ = function.__qualname__ = name
    function.__doc__ = f"{name} of a number, a jet or an array."
    return function


sqrt, sin, cos, tan, exp, log = (_function(n) for n in ("sqrt", "sin", "cos", "tan", "exp", "log"))
sinh, cosh, tanh = (_function(n) for n in ("sinh", "cosh", "tanh"))
arcsin, arccos, arctan = (_function(n) for n in ("arcsin", "arccos", "arctan"))


def arctan2(y: Any, x: Any) -> Any:
    """Angle of the point (x, y), rad, in [-pi, pi]; of numbers or jets."""
    if hasattr(y, "arctan2"):
        return y.arctan2(x)
    return type(x)(y).arctan2(x) if hasattr(x, "arctan2") else np.arctan2(y, x)


def norm(v: Any) -> Any:
    """Length of a vector of numbers or jets."""
    square = v[0] * v[0] + v[1] * v[1] + v[2] * v[2]
    return sqrt(square) if square > 0 else 0.0 * square
