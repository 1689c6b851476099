# SPDX-License-Identifier: BSD-3-Clause
"""Laws, joints, forces and integrators whose code is Python's. They may stand in scenes that are dictionaries."""

from __future__ import annotations

import importlib
import inspect
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, fields
from functools import partial
from typing import Any


@dataclass(frozen=True, eq=False)
class Type:
    """A type of scenes by a function or a class. Calling it calls that."""

    kind: str
    function: Callable[..., Any]
    name: str
    help: str
    keys: list[tuple[str, float | None]] = field(default_factory=list)
    """Its parameters in scenes: name, and default or None."""
    breaks: Sequence[float] = ()
    rows: int = 1
    mask: str = ""
    order: int = 1

    def __call__(self, *args: Any, **kwargs: Any) -> Any:
        return self.function(*args, **kwargs)

    def __reduce__(self) -> tuple[Any, ...]:
        module, name = getattr(self.function, "__module__", ""), getattr(self.function, "__qualname__", "")
        if getattr(sys.modules.get(module), name, None) is self:  # a decorated function of a module
            return _named, (module, name)
        return Type, tuple(getattr(self, f.name) for f in fields(self))


def _named(module: str, name: str) -> Any:
    return getattr(importlib.import_module(module), name)


def _type(kind: str, function: Callable[..., Any], first: int, **more: Any) -> Type:
    name = getattr(function, "__name__", type(function).__name__)
    lines = (inspect.getdoc(function) or "").splitlines()
    return Type(kind, function, kind if name == "<lambda>" else name, lines[0] if lines else f"{kind} of Python",
                _keys(function, first), **more)


def _keys(function: Callable[..., Any], first: int) -> list[tuple[str, float | None]]:
    """The parameters of a function after its first ones."""
    try:
        parameters = inspect.signature(function).parameters
    except ValueError:  # of numpy, such as np.sin
        return []
    return [(p.name, None if p.default is p.empty else float(p.default)) for p in list(parameters.values())[first:]
            if p.kind not in (p.VAR_POSITIONAL, p.VAR_KEYWORD)]


def law(function: Callable[..., Any] | None = None, *, breaks: Sequence[float] = ()) -> Type:
    """A law of motion: a function of the time, s, in the unit of what it drives.

    It is called with a jet, by which its rates are exact, or returns the value and both its derivatives as a tuple.
    Further parameters are keys in the scene. `breaks`: times, s, at which it or a derivative jumps.
    """
    if function is None:
        return partial(law, breaks=breaks)  # type: ignore[return-value]  # a decorator
    return _type("law", function, 1, breaks=tuple(float(t) for t in breaks))


def joint(function: Callable[..., Any] | None = None, *, rows: int = 1, mask: str = "", pairs: int = 1) -> Type:
    """A joint that holds a function of the pose of P relative to S at zero: ls.joint(lambda y: y.x**2 + y.y**2 - 1).

    y has x, y, z (m), e0 ... e3, angle_z (rad, counted) and t (s). A function of `rows` 2 or 3 returns as many numbers.
    `mask`: further constraints, words of x y z e1 e2 e3. A function of 2 or 3 `pairs` takes one argument for each.
    """
    if rows not in (1, 2, 3):
        raise ValueError(f"rows is {rows}; give 1, 2 or 3")
    if function is None:
        return partial(joint, rows=rows, mask=mask, pairs=pairs)  # type: ignore[return-value]
    return _type("joint", function, pairs, rows=rows, mask=mask)


def force(function: Callable[..., Any]) -> Type:
    """A force on P's body at the origin of P, and its opposite on S's body: a function of the markers.

    at.P and at.S have x (m), v (m/s), w (rad/s) in the world, and A; at.t is the time, s. It returns the force (world, N),
    or a dictionary of "force", "torque" (world, N m), "potential" (J) and "dissipation" (W).
    """
    return _type("force", function, 1)


def integrator(function: type | None = None, *, order: int = 1) -> Type:
    """An integrator of fixed steps: a class whose step(system, y, h) returns the state after h, s.

    system.rates(y) solves the equations of motion, y.moved(h, rates) is the state after h at constant rates. The end is
    projected onto the constraints afterwards. begin(), if there is one, is called at starts and after events. Parameters of
    the constructor are keys in the scene. `order`: of convergence.
    """
    if not 1 <= order <= sys.float_info.mant_dig:  # h/2 leaves less than round-off
        raise ValueError(f"order is {order}; give 1 to {sys.float_info.mant_dig}")
    if function is None:
        return partial(integrator, order=order)  # type: ignore[return-value]
    return _type("integrator", function, 0, order=order)


def type_of(given: Callable[..., Any]) -> Type:
    """A Type, or a function of time as a law."""
    return given if isinstance(given, Type) else _type("law", given, 1)
