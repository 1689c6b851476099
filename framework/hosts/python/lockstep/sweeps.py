# SPDX-License-Identifier: BSD-3-Clause
"""Many runs of one scene, one row each, by any executor of concurrent.futures."""

from __future__ import annotations

import itertools
import math
import numbers
import os
import pickle
import sys
import uuid
from collections.abc import Callable, Iterable, Mapping, Sequence
from concurrent.futures import Executor, Future, ThreadPoolExecutor, as_completed
from contextlib import suppress
from typing import Any

import numpy as np

from lockstep import _core
from lockstep.errors import Error, Finding, InterruptedRun, heard
from lockstep.simulation import Quantity, Simulation, Source, built_in, scene_of, seconds, text_of
from lockstep.table import Column, Table

Row = dict[str, Quantity]
Vary = Mapping[str, Sequence[Quantity]] | Sequence[Row] | Any
Measure = Callable[[Simulation], Any]
Units = dict[str, str]
Result = tuple[Any, Units | None, Exception | None, list[Finding]]
"""Extremes with the units of the columns, or what `measure` returned; an error; findings."""
_OF_COLUMN = ("last", "min", "t_min", "max", "t_max")
_ended: set[str] = set()
"""Sweeps that were interrupted: threads of this process make no further run of them."""


class Runs(Table):
    """One row per run. runs["crank"] are the values of a parameter, in SI units.

    For each recorded column "x" of the runs there are "x.last", "x.min" and "x.max", and "x.t_min" and "x.t_max", the
    times of the extremes, s. Numbers that a `measure` returned have its names. Rows of runs that failed are NaN.
    `varied`: names of the parameters. By run: `errors`, what it raised or None, `findings`, and what `measure` returned.
    """

    def __init__(self, columns: list[Column], varied: list[str], errors: list[Exception | None],
                 findings: list[list[Finding]], measured: list[Any]) -> None:
        super().__init__(columns)
        self.varied, self.errors, self.findings, self.measured = varied, errors, findings, measured

    @property
    def failed(self) -> list[int]:
        """Indices of the runs that raised."""
        return [k for k, error in enumerate(self.errors) if error is not None]

    def __len__(self) -> int:
        return len(self.errors)

    def to_pandas(self) -> Any:
        """A DataFrame of pandas."""
        import pandas
        return pandas.DataFrame({n: np.asarray(self[n]) for n in self.names})

    def __repr__(self) -> str:
        lines = [f"{len(self)} runs" + (f", {len(self.failed)} failed" if self.failed else ""),
                 f"{'':32} {'least':>14} {'mean':>14} {'largest':>14} {'deviation':>14}"]
        for c in (self[n] for n in self.names):
            values = np.asarray(c)[~np.isnan(c)]
            if len(values):
                numbers = (values.min(), values.mean(), values.max(), values.std())
                lines.append(f"{c.label:32} " + " ".join(f"{x:14.6g}" for x in numbers))
        return "\n".join(lines)


def rows_of(vary: Vary) -> list[Row]:
    """The values of each run: all combinations of a dictionary of lists, rows of a list or of a DataFrame."""
    if hasattr(vary, "to_dict"):
        return list(vary.to_dict("records"))
    if isinstance(vary, Mapping):
        if empty := [name for name, values in vary.items() if np.ndim(values) > 0 and not len(values)]:
            raise ValueError(f'"{empty[0]}" has no values; give one or more')
        lists = [[v] if isinstance(v, (str, bytes)) or (hasattr(v, "__float__") and np.ndim(v) == 0) else list(v)
                 for v in vary.values()]
        return [dict(zip(vary, row)) for row in itertools.product(*lists)]
    return [dict(row) for row in vary]


class InterruptedSweep(KeyboardInterrupt):
    """Ctrl-C during a sweep. `runs` are its runs; those that were not made have an InterruptedRun as error."""

    def __init__(self, runs: Runs, done: int) -> None:
        super().__init__(f"the sweep was interrupted after {done} of {len(runs)} runs; the attribute runs has them")
        self.runs = runs


def _read(source: Any) -> _core.Scene:
    return source if isinstance(source, _core.Scene) else _core.Scene(source, built_in())


def _chunk(results: list[Result], scene: _core.Scene, rows: list[Row], until: float | None, columns: Any,
           measure: Measure | None, sweep: str = "") -> None:
    """The runs of some rows, appended to `results`. Units are those of the first that has ended."""
    units: Units = {}
    for row in itertools.takewhile(lambda _: sweep not in _ended, rows):
        with heard() as findings:
            try:
                run = Simulation(scene, set=row, record=columns, report=False)
                run.advance_to(until)
                units = units or ({} if measure else run.units)
                results.append((measure(run) if measure else run.extremes(), units or None, None, findings))
            except Exception as error:
                results.append((None, None, error, findings))


def _remote(source: Any, *work: Any) -> list[Result]:
    """The same in a worker, which may send back only what pickles, and after an interrupt what there is."""
    results: list[Result] = []
    with suppress(KeyboardInterrupt):
        _chunk(results, _read(source), *work)
    for k, (given, units, error, findings) in enumerate(results):
        try:
            pickle.loads(pickle.dumps((given, error)))
        except Exception as problem:
            results[k] = None, None, Error(f"{error!r}" if error else f"the result of the run: {problem}"), findings
    return results


def _fill(parts: dict[int, list[Result]], work: tuple[Any, ...], rows: list[Row], size: int,
          executor: Executor | None, done: Callable[[int], None]) -> None:
    """Makes the runs, in parts by the number of their first row. Finished runs are there after an interrupt too."""
    source, options = work[0], work[1:]
    starts = range(0, len(rows), size)
    if executor is None:
        scene = _read(source)
        for k in starts:
            _chunk(parts.setdefault(k, []), scene, rows[k:k + size], *options)
            done(k)
        return
    sweep = uuid.uuid4().hex
    futures: dict[Future[list[Result]], int] = {}
    submitted = ((executor.submit(_remote, source, rows[k:k + size], *options, sweep), k) for k in starts)
    try:
        with ThreadPoolExecutor(1) as uninterrupted:  # an interrupt reaches the main thread only, so no future is lost
            uninterrupted.submit(lambda: futures.update(submitted)).result()
        for future in as_completed(futures):
            parts[futures[future]] = future.result()
            done(futures[future])
    finally:
        _ended.add(sweep)
        for future, k in futures.items():
            if not future.cancel() and (future.done() or isinstance(executor, ThreadPoolExecutor)):
                with suppress(Exception):
                    parts[k] = future.result()
        _ended.remove(sweep)


def _of_extremes(results: list[Result]) -> list[Column]:
    """The columns of runs without a measure."""
    known: Units = next((units for _, units, *_ in results if units), {})
    recorded = list(known.items())[1:]
    missing = np.full((len(recorded), len(_OF_COLUMN)), math.nan)
    numbers = np.array([missing if units is None else values for values, units, *_ in results])
    return [Column(numbers[:, k, j].copy(), f"{name}.{what}", "s" if what.startswith("t_") else unit)
            for k, (name, unit) in enumerate(recorded) for j, what in enumerate(_OF_COLUMN)]


def _measured(results: list[Result], measure: Measure) -> list[Mapping[str, Any]]:
    """What a measure returned, by name."""
    single = getattr(measure, "__name__", "measure")
    return [{} if error else given if isinstance(given, Mapping) else {single: given} for given, _, error, _ in results]


def _of_measures(rows: list[Mapping[str, Any]]) -> list[Column]:
    """The numbers that a measure returned."""
    columns = []
    for name in dict.fromkeys(itertools.chain.from_iterable(rows)):
        with suppress(TypeError, ValueError):  # no number; `measured` has it
            columns.append(Column([float(row.get(name, math.nan)) for row in rows], name))
    return columns


def _parameters(scene: Any, rows: list[Row]) -> list[Column]:
    """The values that were varied, in SI units; NaN for words, formulas, and values that their runs reject."""
    read = _read(scene)
    columns = []
    for name in dict.fromkeys(itertools.chain.from_iterable(rows)):
        given = [row.get(name, math.nan) for row in rows]
        known: dict[Any, float] = {}
        unit = ""
        for text in dict.fromkeys(["0", *(v for v in given if isinstance(v, str))]):
            with suppress(Error, ValueError):  # not one value
                [known[text]], its = read.quantities(name, text)
                unit = its or unit
        columns.append(Column([known.get(v, math.nan) if isinstance(v, str) else float(v)
                               if isinstance(v, numbers.Real) else math.nan for v in given], name, unit))
    return columns


def sweep(scene: Source, vary: Vary, *, executor: Executor | None = None, until: Quantity | None = None,
          columns: Sequence[str] | Mapping[str, str] = (), measure: Measure | None = None,
          progress: bool | Callable[[int, int], object] = False, chunk: int | None = None) -> Runs:
    """Runs the scene once for each choice of values, and returns one row per run.

    `vary`: {"crank": ["80 mm", "100 mm"], ...} for all combinations, or a list of dictionaries, or a DataFrame.
    `executor`: threads, processes, Dask's; None: one run after another. For processes `measure` is a function of a module.
    `until`: end of the runs; default: that of the scene. `columns`: to record in addition to those of the scene.
    `measure`: a function of the finished Simulation, whose result, a number or a dictionary, is the row.
    `progress`: True for a line on the error stream, or a function of the runs done and all runs. `chunk`: runs at a time.
    A run that raises is a row of NaN, and its exception is in `errors`. Ctrl-C raises InterruptedSweep, with the runs made.
    """
    if chunk is not None and chunk < 1:
        raise ValueError(f"chunk is {chunk}; give 1 or more runs")
    rows, source = rows_of(vary), scene_of(scene)
    size = chunk or max(1, len(rows) // (8 * (os.cpu_count() or 1)))
    work = source, None if until is None else seconds(until), columns, measure
    parts: dict[int, list[Result]] = {}

    def told(first: int) -> None:
        for row, given in zip(rows[first:], _measured(parts[first], measure) if measure else []):
            if both := sorted(row.keys() & given.keys()):
                raise ValueError(f'"{both[0]}" is a parameter and a number of measure; give one of them another name')
        done = sum(map(len, parts.values()))
        if callable(progress):
            progress(done, len(rows))
        elif progress:
            print(f"\r{done} of {len(rows)} runs", end="\n" if done == len(rows) else "", file=sys.stderr, flush=True)

    interrupt = None
    try:
        _fill(parts, work, rows, size, executor, told)
    except KeyboardInterrupt as error:
        interrupt = error
    results: list[Result] = [(None, None, InterruptedRun("the sweep was interrupted before this run"), [])] * len(rows)
    for first, part in parts.items():
        results[first:first + len(part)] = part
    parameters = _parameters(source, rows)
    found = _of_measures(_measured(results, measure)) if measure else _of_extremes(results)
    runs = Runs(parameters + found, [c.name for c in parameters], [error for _, _, error, _ in results],
                [findings for *_, findings in results], [given for given, *_ in results] if measure else [])
    if interrupt is not None:
        raise InterruptedSweep(runs, sum(map(len, parts.values()))) from interrupt
    return runs
