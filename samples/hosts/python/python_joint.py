# SPDX-License-Identifier: BSD-3-Clause
"""A joint in Python against the same one in C++: a nut runs down a screw, also against the closed form."""

import math
import time
from typing import Any

import numpy as np

import lockstep as ls

MASS, INERTIA, LEAD, G = 2.0, 0.004, 0.1, 9.81


@ls.joint(mask="x y e1 e2")
def thread(y: Any, lead: float) -> Any:
    """A screw: z = lead * turns, turning about z."""
    return y.z - lead / (2 * math.pi) * y.angle_z


def mechanism(of_python: bool) -> ls.Mechanism:
    m = ls.Mechanism("a nut on a screw", gravity=(0, 0, -G))
    nut = m.body("nut", mass=MASS, inertia=[0.003, 0.003, INERTIA], position=[0, 0, 0])
    m.joint(thread if of_python else "screw", "thread", nut, at=(0, 0, 0), lead=LEAD)
    return m


def seconds_of(of_python: bool) -> tuple[float, ls.Table]:
    """The least time of three runs."""
    times = []
    for _ in range(3):
        run = mechanism(of_python).simulation(tolerance=1e-10, integrator="dop853", output=0.02, report=False,
                                              record=["nut.z", "thread.rz", "thread.force_on_p_world_z"])
        begin = time.perf_counter()
        table = run.until(2.0)
        times.append(time.perf_counter() - begin)
    return min(times), table


def main() -> None:
    fast, theirs = seconds_of(False)
    slow, ours = seconds_of(True)
    for name in ("nut.z", "thread.rz", "thread.force_on_p_world_z"):
        difference = np.max(np.abs(ours[name] - theirs[name])) / np.max(np.abs(theirs[name]))
        print(f"{name:28} differs by {difference:.1e} of its largest value")
        assert difference < 1e-9, name
    k = 2 * math.pi / LEAD
    exact = -0.5 * MASS * G / (MASS + INERTIA * k**2) * np.asarray(ours.t) ** 2
    print(f"height to {np.max(np.abs(ours['nut.z'] - exact)):.1e} m of the closed form")
    assert np.max(np.abs(ours["nut.z"] - exact)) < 1e-9
    print(f"C++ {1e3 * fast:.2f} ms, Python {1e3 * slow:.2f} ms: {slow / fast:.1f} times")


if __name__ == "__main__":
    main()
