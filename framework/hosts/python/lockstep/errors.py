# SPDX-License-Identifier: BSD-3-Clause
"""Exceptions and warnings of lockstep."""

from __future__ import annotations

import threading
import sys
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any


class Error(Exception):
    """Base of the errors of lockstep. Its facts are attributes; None if they do not apply.

    `thing`: name of the joint, body, force, law, ...; `thing_kind`: "joint", ...; `key`: the parameter; `value`: as it was
    found, with its unit; `problem`: what is wrong; `advice`: what to do next; place in a file; `t`: simulated time, s.
    """

    thing: str | None = None
    thing_kind: str | None = None
    key: str | None = None
    value: str | None = None
    problem: str | None = None
    advice: str | None = None
    file: str | None = None
    line: int | None = None
    column: int | None = None
    t: float | None = None

    def __reduce__(self) -> tuple[Any, ...]:
        return _restored, (type(self), str(self), dict(self.__dict__))


def _restored(kind: type[Error], sentence: str, facts: dict[str, Any]) -> Error:
    error = kind(sentence)
    error.__dict__.update(facts)
    return error


class ModelError(Error):
    """An impossible mechanism, or an invalid parameter."""


class AssemblyError(Error):
    """A start that could not be brought onto the constraints."""


class SolveError(Error):
    """The equations of motion could not be solved."""


class StepError(Error):
    """A step could not be made."""


class NonFiniteError(Error):
    """An evaluation gave a NaN or an infinity."""


class PluginError(Error):
    """A plugin that cannot be loaded, or a type that cannot be registered."""


class SceneError(Error):
    """A scene that cannot be understood, with its place."""


class FileError(Error):
    """A file that cannot be read or written."""


class UserCodeError(Error):
    """A function of Python, or code of a plugin, threw. The original exception is the cause."""


class InterruptedRun(Error):
    """A run was interrupted on request."""


_KINDS = {
    "model": ModelError, "assembly": AssemblyError, "solve": SolveError, "step": StepError, "not finite": NonFiniteError,
    "plugin": PluginError, "scene": SceneError, "file": FileError, "user code": UserCodeError,
    "interrupted": InterruptedRun,
}


def error_of(kind: str, sentence: str, facts: dict[str, Any]) -> Error:
    """The exception of an error of the library."""
    return _restored(_KINDS.get(kind, Error), sentence, facts)


@dataclass(frozen=True)
class Finding:
    """A remark about a scene, a start or a run. None if a field does not apply.

    `code`: "energy-not-conserved", never changes; `severity`: "note", "warning", "doubt" or "wrong"; `value`: what was
    measured, and `limit`: what it was compared with, in `unit`; `t`: simulated time, s; `place`: "four_bar.json:4:64".
    """

    code: str
    severity: str
    thing: str | None
    message: str
    advice: str | None
    value: float | None
    limit: float | None
    unit: str | None
    t: float | None
    place: str | None
    text: str

    def __str__(self) -> str:
        return self.text


class FindingWarning(UserWarning):
    """Base of the warnings of lockstep; `finding` has the facts."""

    def __init__(self, finding: Finding) -> None:
        super().__init__(finding.text)
        self.finding = finding

    @property
    def code(self) -> str:
        return self.finding.code


class ModelWarning(FindingWarning):
    """Something is probably not what was meant."""


class DoubtfulResult(FindingWarning):
    """The result may be wrong."""


class WrongResult(FindingWarning):
    """The result is wrong."""


_WARNINGS = {"warning": ModelWarning, "doubt": DoubtfulResult, "wrong": WrongResult}


_heard = threading.local()


@contextmanager
def heard() -> Iterator[list[Finding]]:
    """Findings of this thread are collected in a list in place of warnings."""
    before, _heard.findings = getattr(_heard, "findings", None), []
    try:
        yield _heard.findings
    finally:
        _heard.findings = before


def warn(findings: list[Finding]) -> None:
    """Warns of all findings above notes."""
    collected = getattr(_heard, "findings", None)
    if collected is not None:
        collected.extend(findings)
        return
    level, frame = 1, sys._getframe()
    while frame.f_back is not None and frame.f_globals.get("__name__", "").split(".")[0] == __package__:
        level, frame = level + 1, frame.f_back  # to the code of the user
    for finding in findings:
        if finding.severity in _WARNINGS:
            warnings.warn(_WARNINGS[finding.severity](finding), stacklevel=level)
