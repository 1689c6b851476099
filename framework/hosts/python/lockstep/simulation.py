# SPDX-License-Identifier: BSD-3-Clause
"""Runs of scenes."""

from __future__ import annotations

import html
import os
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from functools import cache
from typing import TYPE_CHECKING, Any, Union

import numpy as np
from numpy.typing import NDArray

from lockstep._core import Run as _Run
from lockstep._core import Scene, State, Types
from lockstep._core import seconds as _seconds
from lockstep.errors import Finding, ModelError
from lockstep.table import Table, Value

if TYPE_CHECKING:
    from lockstep.builder import Mechanism

Array = NDArray[np.float64]
Quantity = str | float
"""A number in SI, or a text with a unit: "120 mm"."""


Source = Union[str, "os.PathLike[str]", dict[str, Any], Scene, "Mechanism"]
"""A scene: a path, a JSON text, a dictionary, one that was read by Scene(), or a Mechanism."""


def scene_of(source: Source) -> Any:
    """A scene as the module _core takes it."""
    return source.scene() if hasattr(source, "scene") else source


@cache
def built_in() -> Types:
    """The types of the library. Runs share them, and copy them to add their own."""
    return Types()


def types_of(scene: Any, types: Types | None) -> Types:
    """The types that a scene may name: those given, those it was read with, or those of the library."""
    return types or (scene.types if isinstance(scene, Scene) else built_in())


def number_of(value: Any, name: str, wanted: str = "a number, or a text with a unit") -> float:
    """A number that is no text. TypeError, with its name, for anything else."""
    if not hasattr(value, "__float__") or np.ndim(value) > 0:
        raise TypeError(f"{name} is {value!r}; give {wanted}")
    return float(value)


def name_of(value: Any, what: str) -> str:
    """The name of a part of a Mechanism, or a text. TypeError for anything else."""
    name = getattr(value, "name", value)
    if not isinstance(name, str):
        raise TypeError(f"{what} is {value!r}; give a name")
    return name


def names_of(values: Iterable[Any], what: str) -> list[str]:
    """Names of a list. TypeError for a single text, and for what is no name."""
    if isinstance(values, str) or not isinstance(values, Iterable):
        raise TypeError(f"{what} is {values!r}; give a list of names")
    return [name_of(value, f"{what}[{k}]") for k, value in enumerate(values)]


def text_of(value: Quantity, name: str) -> str:
    """A value of a scene as the program takes it. TypeError for what is no number, text or truth value."""
    if isinstance(value, str):
        return value
    if np.asarray(value).dtype == bool and np.ndim(value) == 0:
        return "true" if value else "false"
    return repr(number_of(value, name))


def pairs_of(values: Mapping[str, Quantity]) -> list[tuple[str, str]]:
    """Values of a scene by name, as texts."""
    return [(name, text_of(value, name)) for name, value in values.items()]


def seconds(t: Quantity) -> float:
    """A time in s: a number, or a text with a unit."""
    return _seconds(t) if isinstance(t, str) else number_of(t, "the time")


def in_notebook() -> bool:
    try:
        return bool(get_ipython().__class__.__name__ == "ZMQInteractiveShell")  # type: ignore[name-defined]
    except NameError:
        return False


def pairs_of_columns(channels: Sequence[str] | Mapping[str, str]) -> list[tuple[str, str]]:
    """Names of columns and their channels."""
    names = names_of(channels, "record")
    return list(zip(names, names_of(channels.values(), "record") if isinstance(channels, Mapping) else names))


class Simulation:
    """A run of a scene: a path, a JSON text, a dictionary, or a Mechanism.

    Further arguments set parameters of the scene: Simulation("four_bar.json", crank="120 mm"). `set` takes paths too:
    {"run.until": "2 s", "bodies.rod.mass": 1.2}. `record`: channels to record in addition, or names of columns with their
    channels or formulas. `report`: whether poses are kept for a report; default: in a notebook. SceneError, ModelError and
    FileError name what is wrong with a scene; a run that fails raises an Error with its time t, s, and keeps its rows.
    """

    def __init__(self, scene: Source, *, set: Mapping[str, Quantity] | None = None,
                 record: Sequence[str] | Mapping[str, str] = (), report: bool | None = None,
                 types: Types | None = None, **parameters: Quantity) -> None:
        read = scene if isinstance(scene, Scene) else Scene(scene, types or built_in())  # once, also for analyses
        known = types_of(read, types if read is scene else None)
        self._subject = read, known, pairs_of({**(set or {}), **parameters})
        self._report = in_notebook() if report is None else report
        self._run = _Run(*self._subject, pairs_of_columns(record), self._report)

    def record(self, channels: Sequence[str] | Mapping[str, str]) -> None:
        """Adds columns before the run begins: channels, or names with channels or formulas."""
        self._run.record(pairs_of_columns(channels))

    def begin(self) -> _Run:
        """Assembles the start. Called by whatever needs it."""
        self._run.begin()
        return self._run

    def until(self, t: Quantity) -> Table:
        """Runs to the time t, and returns the table so far. May be called again."""
        self.advance_to(seconds(t))
        return self.table

    def run(self) -> Table:
        """Runs to the end that the scene gives."""
        self.advance_to(None)
        return self.table

    def advance_to(self, t: float | None) -> None:
        """Runs to the time t, s, or None: to the end that the scene gives."""
        run = self.begin()
        run.run() if t is None else run.until(t)

    @property
    def units(self) -> dict[str, str]:
        """Of the recorded columns, the time first."""
        return {name: unit for name, unit, *_ in self._run.columns()}

    def extremes(self) -> Array:
        """By recorded column after the time: last value, least value and its time, largest value and its time (n x 5)."""
        return np.array([[values[-1], *range[:4]] for _, _, values, range in self._run.columns()[1:] if range])

    def advance(self, h: Quantity) -> None:
        """Runs on by exactly h, s, as a controller in a loop does."""
        self.begin().advance(seconds(h))

    def step(self, h: Quantity = 0.0) -> float:
        """Makes one step of at most h, s, and returns its length."""
        return self.begin().step(seconds(h))

    @property
    def table(self) -> Table:
        """The columns so far. They stay as they are when the run goes on."""
        return Table.of(self._run.columns(), self._run.title)

    def __getitem__(self, name: str) -> Value:
        """A recorded column, or a channel, at the present time: run["A.rz"], in SI, with its unit.

        Also in on_step. Counted angles and works that are not recorded are a ModelError once the run has begun.
        """
        return Value(*self._run.value(name_of(name, "the column")))

    @property
    def t(self) -> float:
        """The present time, s."""
        return self.begin().t

    @property
    def findings(self) -> list[Finding]:
        """What is remarkable about the run so far, also as warnings."""
        return self.begin().findings()

    @property
    def steps(self) -> int:
        """Accepted steps."""
        return self.begin().steps

    @property
    def stopped_by(self) -> str:
        """Names of the events that ended the run; "" if none did."""
        return self.begin().stopped_by

    def body(self, name: str) -> dict[str, Any]:
        """Pose and twist of a body now: x (3, m), q (4, scalar first), v (3, m/s), w (3, body axes, rad/s)."""
        return self.begin().body(name_of(name, "the body"))

    @property
    def inputs(self) -> Inputs:
        """Numbers that forces and laws read: run.inputs["u"] = 0.3. A value acts from the next step on."""
        return Inputs(self._run)

    def on(self, name: str, *, when: Callable[[State], float] | None = None,
           at: Quantity | None = None, crossing: str = "any",
           stop: bool = False, once: bool = True, activate: Sequence[str] = (), deactivate: Sequence[str] = (),
           change: Callable[[State], object] | None = None, tolerance: float = 1e-9) -> None:
        """Adds an event: at a time, s, or when a function of a State passes zero ("rising", "falling", "any").

        `change` may set velocities of its State. `stop` ends the run.
        """
        self.begin().add_event(name, when, None if at is None else seconds(at), crossing, stop, once,
                               names_of(activate, "activate"), names_of(deactivate, "deactivate"), change, tolerance)

    def on_step(self, function: Callable[[], bool | None] | None) -> None:
        """Calls a function after each step; False ends the run."""
        self._run.set_on_step(function)

    def activate(self, name: str) -> None:
        """Activates a joint, a force or an event."""
        self.begin().activate(name_of(name, "the part"))

    def deactivate(self, name: str) -> None:
        """Deactivates a joint, a force or an event."""
        self.begin().deactivate(name_of(name, "the part"))

    def subject(self) -> tuple[Any, Types, list[tuple[str, str]], _Run]:
        """Its scene, types and values, and the run itself, for analyses at its present state."""
        return *self._subject, self.begin()

    def save(self, file: str | os.PathLike[str]) -> None:
        """Writes a checkpoint, from which load() continues to the last bit."""
        self.begin()
        if self._report:
            raise ModelError("a run that keeps poses for its report has no checkpoints; give Simulation(..., report=False)")
        self._run.save(os.fspath(file))

    def load(self, file: str | os.PathLike[str]) -> None:
        """Continues from a checkpoint of the same scene. Values of parameters stay those of this run."""
        self.begin().load(os.fspath(file))

    @property
    def channels(self) -> dict[str, str]:
        """What may be recorded, with units."""
        return {name: unit for name, unit, _ in self._run.channels()}

    def report(self, file: str | os.PathLike[str]) -> None:
        """Writes the run as one HTML page; needs Simulation(..., report=True)."""
        page = self._run.report_page()
        with open(file, "w", encoding="utf-8") as out:
            out.write(page)

    def _repr_html_(self) -> str:
        with suppress(ModelError):  # nothing ran yet
            if self._report and self._run.begun:
                page = html.escape(self._run.report_page(), quote=True)
                return f'<iframe srcdoc="{page}" style="width: 100%; height: 720px; border: 0"></iframe>'
        return f"<pre>{html.escape(repr(self))}</pre>"

    def __repr__(self) -> str:
        name = self._run.title or "a scene without a title"
        return f"Simulation of {name}" + (f", t = {self.t:g} s" if self._run.begun else ", not begun")


class Inputs:
    """The inputs of a run, by name."""

    def __init__(self, run: _Run) -> None:
        self._run = run

    def __getitem__(self, name: str) -> float:
        return self._run.input(name)

    def __setitem__(self, name: str, value: float) -> None:
        self._run.set_input(name, number_of(value, name, "a number in SI"))

    def __iter__(self) -> Iterator[str]:
        return iter(self._run.inputs())

    def __repr__(self) -> str:
        return repr({name: self[name] for name in self})
