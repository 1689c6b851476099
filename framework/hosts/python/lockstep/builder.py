# SPDX-License-Identifier: BSD-3-Clause
"""Scenes by calls: the keys are those of scenes. An argument loses a trailing underscore, as in from_ and is_."""

from __future__ import annotations

import difflib
from collections.abc import Callable, Mapping, Sequence
from functools import cache, partial
from typing import Any

from lockstep._core import Types
from lockstep.simulation import Simulation

_SHAPES = ("rod", "box", "cylinder", "sphere", "compound")
_OF_BODIES = ("position", "orientation", "velocity", "visual", "omega_world", "omega_body")


@cache
def _names() -> dict[str, list[str]]:
    return Types().names()


class Named:
    """A body, marker, joint or force of a Mechanism. str() is its name; part["angle_z"] names a channel of it."""

    def __init__(self, name: str) -> None:
        self.name = name

    __iter__ = None  # a name has no items

    def __str__(self) -> str:
        return self.name

    def __getitem__(self, quantity: str) -> str:
        return f"{self.name}.{quantity}"

    def __repr__(self) -> str:
        return f"<{self.name}>"


def _plain(value: Any) -> Any:
    """A value of a scene, with names in place of what it names."""
    if isinstance(value, Named):
        return value.name
    if isinstance(value, dict):
        return {k: _plain(v) for k, v in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(v) for v in value]
    return value


def _given(keys: dict[str, Any]) -> dict[str, Any]:
    """Keyword arguments as keys of a scene."""
    return {k.removesuffix("_"): _plain(v) for k, v in keys.items()}


def _of_kind(kind: str, type: Any, name: str) -> Any:
    """A type of this kind: a text, or one of Python. TypeError for a function that is none."""
    if callable(type) and getattr(type, "kind", "") != kind:
        raise TypeError(f"{kind} '{name}': its type is {type!r}; give a name, or ls.{kind}(function)")
    return type


class Mechanism:
    """A scene that is made by calls.

        m = ls.Mechanism("a pendulum", gravity=(0, -9.81, 0))
        rod = m.rod("rod", mass=1, from_=(0, 0, 0), to=(1, 0, 0))
        pin = m.revolute("pin", rod, at=(0, 0, 0))
        run = m.simulation(until="2 s", record=[pin["rz"]])

    Joints and forces of all types are methods: m.revolute(name, p, s, **keys: Any), m.spring_damper(...). Without s
    the second end of a joint is the ground; springs and motors need it: s=m.ground. Errors are those of scenes.
    """

    ground = Named("ground")

    def __init__(self, title: str = "", *, gravity: Sequence[float | str] = (0.0, 0.0, 0.0), **keys: Any) -> None:
        self._scene: dict[str, Any] = {"lockstep": 1, "title": title, "gravity": list(gravity), **_given(keys)}

    def _add(self, group: str, name: str, **keys: Any) -> Named:
        self._scene.setdefault(group, []).append({"name": name, **_given(keys)})
        return Named(name)

    def body(self, name: str, **keys: Any) -> Named:
        """A body by the keys of scenes: mass, center, inertia, position, orientation, velocity, ..."""
        return self._add("bodies", name, **keys)

    def _shape(self, shape: str, name: str, **keys: Any) -> Named:
        own = {k: keys.pop(k) for k in _OF_BODIES if k in keys}
        return self.body(name, **{shape: _given(keys)}, **own)

    def particle(self, name: str, mass: Any, position: Any, **keys: Any) -> Named:
        """A particle: mass, kg, and position, m."""
        return self.body(name, particle=mass, position=position, **keys)

    def fixed(self, name: str, **keys: Any) -> Named:
        """A body that never moves; with p, a joint of the type "fixed"."""
        return self.joint("fixed", name, **keys) if "p" in keys else self.body(name, fixed=True, **keys)

    def marker(self, name: str, body: Any, **keys: Any) -> Named:
        """A frame on a body: at and orientation in its axes, or world_at and world_orientation."""
        return self._add("markers", name, body=body, **keys)

    def joint(self, type: Any, name: str, p: Any = None, s: Any = None, **keys: Any) -> Named:
        """A joint of a type: a name, or a function by ls.joint. Couplings take pairs=[...] in place of p and s."""
        ends = {} if "pairs" in keys else {"p": p, "s": s or self.ground}
        return self._add("joints", name, type=_of_kind("joint", type, name), **ends, **keys)

    def force(self, type: Any, name: str, p: Any = None, s: Any = None, **keys: Any) -> Named:
        """A force of a type: a name, or a function by ls.force."""
        ends = {k: v for k, v in (("p", p), ("s", s)) if v is not None}
        return self._add("forces", name, type=_of_kind("force", type, name), **ends, **keys)

    def event(self, name: str, **keys: Any) -> Named:
        """An event by the keys of scenes."""
        return self._add("events", name, **keys)

    def parameter(self, name: str, value: Any) -> str:
        """A parameter, which formulas read and Simulation(..., name=value) sets. Returns its formula."""
        self._scene.setdefault("parameters", {})[name] = value
        return f"={name}"

    def scene(self) -> dict[str, Any]:
        """The scene as a dictionary, a copy."""
        copied: dict[str, Any] = _plain(self._scene)
        return copied

    def simulation(self, *, record: Sequence[str] | Mapping[str, str] = (), report: bool | None = None,
                   types: Types | None = None, **run: Any) -> Simulation:
        """A run with these run settings: until, output, integrator, tolerance, step, ...; the others are Simulation's."""
        settings = {**self._scene.get("run", {}), **_given(run)}
        return Simulation({**self._scene, "run": settings}, record=record, report=report, types=types)

    def __getattr__(self, name: str) -> Callable[..., Named]:
        if name.startswith("_"):
            raise AttributeError(name)
        if name in _SHAPES:
            return partial(self._shape, name)
        for kind, add in (("joints", self.joint), ("forces", self.force)):
            if name in _names()[kind]:
                return partial(add, name)
        near = difflib.get_close_matches(name, self.__dir__(), 1)
        raise AttributeError(f'no joint, force or shape "{name}"' + (f'; did you mean "{near[0]}"?' if near else ""))

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *_SHAPES, *_names()["joints"], *_names()["forces"]]

    def __repr__(self) -> str:
        counts = {k: len(v) for k, v in self._scene.items() if isinstance(v, list) and k != "gravity"}
        return f"Mechanism of {', '.join(f'{n} {k}' for k, n in counts.items()) or 'nothing'}"
