# SPDX-License-Identifier: BSD-3-Clause
"""Tables of results: columns of numbers with units."""

from __future__ import annotations

import csv
from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike


class Value(float):
    """A number with its `unit`: "N"; "" without dimension."""

    unit: str

    def __new__(cls, value: float, unit: str) -> Value:
        made = super().__new__(cls, value)
        made.unit = unit
        return made

    def __getnewargs__(self) -> tuple[float, str]:  # type: ignore[override]
        return float(self), self.unit

    def __repr__(self) -> str:
        return f"{float(self):.9g} {self.unit}".rstrip()


class Range(NamedTuple):
    """An extreme of a column over the motion: value, in the unit of the column, and time t, s."""

    value: float
    t: float

    def __repr__(self) -> str:
        return f"{self.value:.6g} at t = {self.t:.6g} s"


class Column(np.ndarray[Any, np.dtype[np.float64]]):
    """A column: an array with name, unit ("" without dimension), and the extremes of the motion, also between rows."""

    name: str
    unit: str

    def __new__(cls, values: ArrayLike, name: str = "", unit: str = "", extremes: Any = None) -> Column:
        column = np.asarray(values, dtype=float).view(cls)
        column.name, column.unit, column._extremes = name, unit, extremes
        return column

    def __array_finalize__(self, of: Any) -> None:
        self.name, self.unit = getattr(of, "name", ""), getattr(of, "unit", "")
        self._extremes = None

    def __array_wrap__(self, array: Any, context: Any = None) -> Any:
        return array.view(np.ndarray)[()] if array.ndim == 0 else array.view(np.ndarray)

    def __reduce__(self) -> tuple[Any, ...]:
        return Column, (np.array(self), self.name, self.unit, self._extremes)

    def __copy__(self) -> Column:
        return Column(np.array(self), self.name, self.unit, self._extremes)

    def __deepcopy__(self, memo: Any) -> Column:
        return self.__copy__()

    @property
    def min_of_motion(self) -> Range:
        """The least value over the motion and its time."""
        return self._range(0, 1)

    @property
    def max_of_motion(self) -> Range:
        """The largest value over the motion and its time."""
        return self._range(2, 3)

    @property
    def is_resolved(self) -> bool:
        """False: between the instants at which the column was computed it may be smaller or larger."""
        return self._extremes is not None and bool(self._extremes[4])

    def _range(self, value: int, t: int) -> Range:
        if self._extremes is None:
            raise ValueError(f'"{self.name}" is a part of a column, or computed; ask the column of the table')
        return Range(self._extremes[value], self._extremes[t])

    @property
    def label(self) -> str:
        """Name with unit: "Bx [N]"."""
        return f"{self.name} [{self.unit}]" if self.unit else self.name


class Table:
    """Columns of numbers with name and unit. table["Bx"] is a column; the first is the time, s."""

    def __init__(self, columns: list[Column], title: str = "") -> None:
        self._columns = {c.name: c for c in columns}
        self.title = title

    @classmethod
    def of(cls, columns: list[tuple[str, str, Any, Any]], title: str = "") -> Table:
        """A table of columns as the module _core returns them."""
        return cls([Column(values, name, unit, extremes) for name, unit, values, extremes in columns], title)

    @property
    def names(self) -> list[str]:
        """Of the columns, from left to right."""
        return list(self._columns)

    @property
    def units(self) -> dict[str, str]:
        """Of each column."""
        return {name: c.unit for name, c in self._columns.items()}

    @property
    def t(self) -> Column:
        """The time, s."""
        return self["t"]

    def __getitem__(self, name: str) -> Column:
        try:
            return self._columns[name]
        except KeyError:
            import difflib
            near = difflib.get_close_matches(name, self._columns, 1)
            hint = f'; did you mean "{near[0]}"?' if near else "; there are: " + ", ".join(self._columns)
            raise KeyError(f'no column "{name}"{hint}') from None

    def __contains__(self, name: object) -> bool:
        return name in self._columns

    def __iter__(self) -> Iterator[str]:
        return iter(self._columns)

    def __len__(self) -> int:
        return len(self.t)

    def to_csv(self, file: str) -> None:
        """Writes all columns, with units in the header; numbers read back as the same doubles."""
        with open(file, "w", encoding="utf-8", newline="") as out:
            csv.writer(out, lineterminator="\n").writerow(c.label for c in self._columns.values())
            for row in zip(*(c.tolist() for c in self._columns.values())):
                out.write(",".join(map(repr, row)) + "\n")

    def to_pandas(self) -> Any:
        """A DataFrame of pandas, indexed by the time."""
        import pandas
        return pandas.DataFrame({n: np.asarray(c) for n, c in self._columns.items()}).set_index("t")

    def plot(self, *names: str, x: str | None = None, axes: Any = None) -> Any:
        """Plots columns over the column x by matplotlib, one panel per unit, and returns the panels (Axes).

        Default of `names`: all columns; of x: the first, which is the time, or the first parameter of a sweep.
        """
        import matplotlib.pyplot as plt
        x = x or self.names[0]
        chosen = [self[n] for n in names or self.names if n != x]
        units = list(dict.fromkeys(c.unit for c in chosen))
        if axes is None:
            _, axes = plt.subplots(len(units), sharex=True, squeeze=False, layout="constrained")
            axes = axes[:, 0]
        axes = np.atleast_1d(axes)
        for panel, unit in zip(axes, units):
            curves = [c for c in chosen if c.unit == unit]
            for c in curves:
                panel.plot(self[x], c, label=c.name)
            panel.set_ylabel(curves[0].label if len(curves) == 1 else unit)
            if len(curves) > 1:
                panel.legend()
        axes[-1].set_xlabel(self[x].label)
        axes[0].set_title(self.title)
        return list(axes)

    def __repr__(self) -> str:
        if len(self) == 0:
            return f"Table of {len(self.names)} columns, no rows"
        lines = [f"{'':24} {'last':>14} {'least':>14} {'at [s]':>10} {'largest':>14} {'at [s]':>10}"]
        for c in list(self._columns.values())[1:]:
            least, most = c.min_of_motion, c.max_of_motion
            lines.append(f"{c.label:24} {c[-1]:14.6g} {least.value:14.6g} {least.t:10.4g} {most.value:14.6g} {most.t:10.4g}")
        return f"{len(self)} rows, t = {self.t[0]:g} ... {self.t[-1]:g} s\n" + "\n".join(lines)
