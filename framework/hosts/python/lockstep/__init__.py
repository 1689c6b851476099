# SPDX-License-Identifier: BSD-3-Clause
"""lockstep: mechanisms of rigid bodies.

    import lockstep as ls
    run = ls.Simulation("four_bar.json", crank="120 mm")
    table = run.until("0.7 s")
    table["drive_torque"].max_of_motion

All numbers are SI. Texts may have units, as in scenes: "120 mm", "30 deg".
"""

from lockstep._core import Jet, Scene, TimeJet, Types, version as __version__
from lockstep.analyses import (
    Equilibrium, LinearSystem, Mode, Modes, Pose, Reaction, inverse, kinematics, linearize, modes, statics)
from lockstep.builder import Mechanism
from lockstep.errors import (
    AssemblyError, DoubtfulResult, Error, FileError, Finding, FindingWarning, InterruptedRun, ModelError, ModelWarning,
    NonFiniteError, PluginError, SceneError, SolveError, StepError, UserCodeError, WrongResult)
from lockstep.jets import arccos, arcsin, arctan, arctan2, cos, cosh, exp, log, norm, sin, sinh, sqrt, tan, tanh
from lockstep.simulation import Array, Simulation
from lockstep.sweeps import InterruptedSweep, Runs, sweep
from lockstep.table import Column, Range, Table, Value
from lockstep.types import force, integrator, joint, law

__all__ = [
    "Array", "AssemblyError", "Column", "DoubtfulResult", "Equilibrium", "Error", "FileError", "Finding", "FindingWarning",
    "InterruptedRun", "InterruptedSweep", "Jet", "LinearSystem", "Mechanism", "Mode", "ModelError", "ModelWarning", "Modes",
    "NonFiniteError", "PluginError", "Pose", "Range", "Reaction", "Runs", "Scene", "SceneError", "Simulation",
    "SolveError", "StepError", "Table", "TimeJet", "Types", "UserCodeError", "Value", "WrongResult", "arccos", "arcsin",
    "arctan", "arctan2", "cos", "cosh", "exp", "force", "integrator", "inverse", "joint", "kinematics", "law",
    "linearize", "log", "modes", "norm", "sin", "sinh", "sqrt", "statics", "sweep", "tan", "tanh"]
