# SPDX-License-Identifier: BSD-3-Clause
"""Analyses of a mechanism: statics, kinematics, inverse dynamics, modes, linear equations.

Each takes a scene, as Simulation does, with values for its parameters, and analyses its start. A Simulation in its place
is analysed at its present state.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from operator import index
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from lockstep import _core
from lockstep.errors import Finding
from lockstep.simulation import (Array, Quantity, Simulation, Source, names_of, pairs_of, pairs_of_columns, scene_of,
                                 types_of)
from lockstep.table import Table

Complex = NDArray[np.complex128]


def _subject(scene: Source | Simulation, values: Mapping[str, Quantity], types: _core.Types | None
             ) -> tuple[Any, _core.Types, list[tuple[str, str]], _core.Run | None]:
    """What the functions of the module _core begin with."""
    if isinstance(scene, Simulation):
        if values:
            raise TypeError("a Simulation has its values; give parameters with a scene")
        return scene.subject()
    source = scene_of(scene)
    return source, types_of(source, types), pairs_of(values), None


@dataclass(frozen=True)
class Reaction:
    """What a joint, or its drive, exerts on a body at marker P: force (3, world, N) and moment (3, world, N m).

    `is_unique` is False if the joints are redundant, so that other reactions are equally possible.
    """

    body: str
    force: Array
    moment: Array
    is_unique: bool


@dataclass(frozen=True)
class Pose:
    """Where a body is: its origin x (3, world, m) and its quaternion q (4, scalar first)."""

    x: Array
    q: Array


@dataclass(frozen=True)
class Equilibrium:
    """A mechanism at rest.

    `bodies` and `reactions` by name, of the joint "A" or its drive "A.drive". `t`: time at which laws are taken, s.
    `stability`: "stable", "neutral", "unstable", "sticking", "not judged" or "no free motion". `freedoms`: degrees of
    freedom that no drive holds. `softest`: the lowest stiffness over mass, 1/s^2; if negative a motion grows. `unstable`
    and `neutral`: motions that grow, or have no stiffness, in words, with stiffness over mass, 1/s^2. `energy`: potential, J.
    `unbalanced`: the largest unbalanced force, relative to the largest force on a body. `largest_move`: of a centre of mass
    from the given start, m. `is_singular`: constraints nearly lose rank; reactions may be very large.
    """

    bodies: dict[str, Pose]
    reactions: dict[str, Reaction]
    t: float
    stability: str
    freedoms: int
    softest: float
    unstable: list[tuple[str, float]]
    neutral: list[tuple[str, float]]
    energy: float
    method: str
    held_by_friction: bool
    unbalanced: float
    largest_move: float
    is_singular: bool
    findings: list[Finding]

    def __repr__(self) -> str:
        lines = [f"Equilibrium, {self.stability}, degrees of freedom: {self.freedoms}, found by {self.method}"]
        for name, r in self.reactions.items():
            lines.append(f"  {name} on {r.body}: force {_numbers(r.force)} N, moment {_numbers(r.moment)} N m"
                         + ("" if r.is_unique else ", not unique"))
        return "\n".join(lines)


@dataclass(frozen=True)
class Mode:
    """A motion in which all bodies move as exp(eigenvalue t).

    `kind`: "oscillation", "decay", "growth", or "rigid": without restoring force. `eigenvalue`: 1/s, of a pair that with the
    positive imaginary part. `frequency`: Hz, of the damped motion. `damping`: the ratio, 0 without damping; if negative it
    grows. `bound`: error of the eigenvalue by round-off, 1/s. `shape`: by body, translation of its centre of mass (3, world,
    m) and rotation (3, world axes, rad).
    """

    kind: str
    eigenvalue: complex
    frequency: float
    damping: float
    bound: float
    shape: dict[str, tuple[Complex, Complex]]


@dataclass(frozen=True)
class Modes:
    """The modes of a mechanism: rigid ones first, then by rising size of the eigenvalue.

    `eigenvalues`: all of them, 1/s, pairs as two. `is_complete`: whether these are all modes.
    """

    modes: list[Mode]
    eigenvalues: Complex
    freedoms: int
    is_complete: bool
    findings: list[Finding]

    @property
    def frequencies(self) -> Array:
        """Of each mode, Hz."""
        return np.array([m.frequency for m in self.modes])

    @property
    def damping(self) -> Array:
        """Damping ratio of each mode."""
        return np.array([m.damping for m in self.modes])

    def __len__(self) -> int:
        return len(self.modes)

    def __getitem__(self, k: int) -> Mode:
        return self.modes[k]

    def __iter__(self) -> Iterator[Mode]:
        return iter(self.modes)

    def __repr__(self) -> str:
        lines = [f"Modes: {len(self)}, degrees of freedom: {self.freedoms}"]
        for k, m in enumerate(self.modes):
            value = f"{m.frequency:.6g} Hz" if m.kind == "oscillation" else f"{m.eigenvalue.real:.6g} 1/s"
            lines.append(f"  {k}: {m.kind}, {value}, damping ratio {m.damping:.4g}")
        return "\n".join(lines)


@dataclass(frozen=True)
class LinearSystem:
    """x' = A x + B u, y = C x + D u, deviations from a state. scipy.signal.StateSpace(*system) takes it.

    `states`: "rod.turn_z", displacements, one a degree of freedom, then their rates. `inputs`: a drive has three, "A.rz" and
    its rates "A.rz_d" and "A.rz_dd". `units`: of states, inputs and outputs by name. `accuracy`: relative error of B, C, D.
    """

    A: Array
    B: Array
    C: Array
    D: Array
    states: list[str]
    inputs: list[str]
    outputs: list[str]
    units: dict[str, str]
    accuracy: float
    findings: list[Finding]

    def __iter__(self) -> Iterator[Array]:
        return iter((self.A, self.B, self.C, self.D))

    def __repr__(self) -> str:
        def named(names: list[str]) -> str:
            return ", ".join(f"{n} [{self.units[n]}]" if self.units[n] else n for n in names) or "none"
        return (f"LinearSystem\n  states {named(self.states)}\n  inputs {named(self.inputs)}\n"
                f"  outputs {named(self.outputs)}")


def _numbers(values: Array) -> str:
    return "[" + ", ".join(f"{x:.6g}" for x in values) + "]"


def statics(scene: Source | Simulation, *, friction: bool = True, nearest: bool = False,
            set: Mapping[str, Quantity] | None = None, types: _core.Types | None = None,
            **parameters: Quantity) -> Equilibrium:
    """Finds the equilibrium near the start, with drives held and velocities zero.

    `friction`: whether it may hold the start. `nearest`: accepts an unstable one.
    """
    found = _core.statics(*_subject(scene, {**(set or {}), **parameters}, types), friction, nearest)
    found["bodies"] = {name: Pose(*pose) for name, pose in found["bodies"].items()}
    found["reactions"] = {name: Reaction(*r) for name, r in found["reactions"].items()}
    return Equilibrium(**found)


def _driven(inverse: bool, scene: Source | Simulation, times: ArrayLike | None,
            record: Sequence[str] | Mapping[str, str], values: Mapping[str, Quantity],
            types: _core.Types | None) -> Table:
    at = [] if times is None else np.asarray(times, dtype=float).ravel().tolist()
    if times is not None and not at:
        raise ValueError("times is empty; give at least one time, s")
    if len(wrong := np.flatnonzero(~np.isfinite(at))):
        raise ValueError(f"times[{wrong[0]}] is {at[wrong[0]]}; must be finite")
    title, columns = _core.driven(*_subject(scene, values, types), at, pairs_of_columns(record), inverse)
    return Table.of(columns, title)


def kinematics(scene: Source | Simulation, *, times: ArrayLike | None = None,
               record: Sequence[str] | Mapping[str, str] = (), set: Mapping[str, Quantity] | None = None,
               types: _core.Types | None = None, **parameters: Quantity) -> Table:
    """The motion of a fully driven mechanism at these times, s, without integration. Masses may be missing.

    The columns are those that the scene records, and those of `record`. Default of times: those of the scene. ModelError
    names drives that are missing or too many, AssemblyError the time of a pose that cannot be reached.
    """
    return _driven(False, scene, times, record, {**(set or {}), **parameters}, types)


def inverse(scene: Source | Simulation, *, times: ArrayLike | None = None,
            record: Sequence[str] | Mapping[str, str] = (), set: Mapping[str, Quantity] | None = None,
            types: _core.Types | None = None, **parameters: Quantity) -> Table:
    """The same with columns of the forces and torques of all drives and of all reactions: inverse dynamics."""
    return _driven(True, scene, times, record, {**(set or {}), **parameters}, types)


def modes(scene: Source | Simulation, *, equilibrium: bool = False, count: int = 0, spin: ArrayLike | None = None,
          frozen: bool = False, set: Mapping[str, Quantity] | None = None, types: _core.Types | None = None,
          **parameters: Quantity) -> Modes:
    """Frequencies, damping ratios and shapes about an equilibrium or a steady rotation.

    `equilibrium`: finds the static equilibrium first. `count`: only so many, the lowest. `spin`: angular velocity of the
    axes of a steady rotation (3, rad/s); default: found. `frozen`: takes a state that is neither, which else is a
    ModelError.
    """
    found = _core.modes(*_subject(scene, {**(set or {}), **parameters}, types), spin, frozen, equilibrium,
                        index(count))
    found["modes"] = [Mode(*m) for m in found["modes"]]
    return Modes(**found)


def linearize(scene: Source | Simulation, *, inputs: Sequence[str] = (), outputs: Sequence[str] = (),
              equilibrium: bool = False, spin: ArrayLike | None = None, frozen: bool = False,
              set: Mapping[str, Quantity] | None = None, types: _core.Types | None = None,
              **parameters: Quantity) -> LinearSystem:
    """The linear equations of motion about an equilibrium or a steady rotation.

    `inputs`: joints with a drive, forces ("motor", "push.x") and laws ("rope.length"). `outputs`: recorded columns or
    channels. The others are as for modes().
    """
    found = _core.linearize(*_subject(scene, {**(set or {}), **parameters}, types), spin, frozen, equilibrium,
                            names_of(inputs, "inputs"), names_of(outputs, "outputs"))
    signals = {key: found[key] for key in ("states", "inputs", "outputs")}
    units = {name: unit for each in signals.values() for name, unit in each}
    names = {key: [name for name, _ in each] for key, each in signals.items()}
    return LinearSystem(**{**found, **names}, units=units)
