# SPDX-License-Identifier: BSD-3-Clause
"""Tolerances: the spread of a four-bar's largest drive torque and rocker angle over 10 000 copies.

Lengths have a standard deviation of 0.1 mm, the mass of the rocker 1 %. The spread of the copies is compared with the
linear prediction sigma^2 = sum (df/dx_k sigma_k)^2, whose derivatives are central differences.
"""

import os
import sys
from concurrent.futures import ProcessPoolExecutor

import numpy as np

import lockstep as ls

SCENE = os.path.join(os.path.dirname(__file__), "..", "..", "scenes", "four_bar.json")
NOMINAL = {"crank": 0.100, "coupler": 0.300, "rocker": 0.250, "base": 0.280, "bodies.rocker.rod.mass": 0.9}
SIGMA = {"crank": 1e-4, "coupler": 1e-4, "rocker": 1e-4, "base": 1e-4, "bodies.rocker.rod.mass": 9e-3}
RESULTS = ("rocker.last", "drive_torque.last")
END = "0.1 s"


def copies(n: int) -> list[dict[str, float]]:
    """Values of n copies, with a fixed seed."""
    random = np.random.default_rng(1)
    draws = {name: random.normal(NOMINAL[name], SIGMA[name], n) for name in NOMINAL}
    return [{name: float(draws[name][k]) for name in NOMINAL} for k in range(n)]


def predicted() -> dict[str, float]:
    """Standard deviations from derivatives by central differences."""
    rows = [{**NOMINAL, name: NOMINAL[name] + sign * SIGMA[name]} for name in NOMINAL for sign in (1, -1)]
    runs = ls.sweep(SCENE, rows, until=END)
    return {r: float(np.linalg.norm((runs[r][0::2] - runs[r][1::2]) / 2)) for r in RESULTS}


def main(n: int = 10_000) -> None:
    with ProcessPoolExecutor() as pool:
        runs = ls.sweep(SCENE, copies(n), executor=pool, progress=True, until=END)
    assert not runs.failed, runs.errors[runs.failed[0]]
    for name, sigma in predicted().items():
        found = float(np.std(runs[name], ddof=1))
        print(f"{name:18} mean {np.mean(runs[name]):.6g} {runs[name].unit}, deviation {found:.4g}, "
              f"predicted {sigma:.4g}")
        # A standard deviation of n samples has a relative error of 1/sqrt(2 n); three of them, and 1 % for curvature.
        assert abs(found / sigma - 1) < 3 / np.sqrt(2 * n) + 0.01, name


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
