# SPDX-License-Identifier: BSD-3-Clause
"""A fit: dry and viscous friction of a pendulum's bearing from the decay of its swing.

The "measurement" is a run with known friction, with noise of 2 mrad and a fixed seed. scipy's least squares finds the
friction again.
"""

from typing import Any

import numpy as np
from scipy.optimize import least_squares

import lockstep as ls

DRY, VISCOUS = 0.020, 0.015  # N m, N m s/rad
NOISE = 2e-3  # rad


def pendulum() -> ls.Mechanism:
    m = ls.Mechanism("a pendulum with friction", gravity=(0, -9.81, 0))
    arm = m.rod("arm", mass=0.6, from_=(0, 0, 0), to=(0.5, 0, 0))
    m.revolute("hinge", arm, at=(0, 0, 0))
    m.parameter("dry", f"{DRY} N m")
    m.parameter("viscous", f"{VISCOUS} N m s/rad")
    m.function_force("friction", link="hinge", torque="=-dry*tanh(qd/(0.05 rad/s)) - viscous*qd")
    return m


def swing(scene: dict[str, Any], dry: float, viscous: float) -> ls.Array:
    """The angle every 50 ms, rad."""
    return np.asarray(ls.Simulation(scene, dry=dry, viscous=viscous).run()["angle"])


def main() -> None:
    scene = {**pendulum().scene(), "run": {"until": 6, "output": 0.05, "tolerance": 1e-9, "record": [
        {"angle": "hinge.rz"}]}}
    measured = swing(scene, DRY, VISCOUS) + np.random.default_rng(7).normal(0, NOISE, 121)
    fit = least_squares(lambda p: (swing(scene, *p) - measured) / NOISE, x0=[0.05, 0.05], x_scale=[0.01, 0.01],
                        diff_step=1e-4, bounds=([0, 0], [1, 1]))
    # The standard deviations of the estimates follow from the Jacobian of the residuals.
    deviation = np.sqrt(np.diag(np.linalg.inv(fit.jac.T @ fit.jac)))
    for name, found, true, sigma in zip(("dry", "viscous"), fit.x, (DRY, VISCOUS), deviation):
        print(f"{name:8} {found:.5f} +- {sigma:.5f}, true {true:.5f}")
        assert abs(found - true) < 4 * sigma, name
        assert sigma < 0.05 * true, name
    print(f"{fit.nfev} evaluations, residual {np.sqrt(2 * fit.cost / len(measured)):.2f} of the noise")


if __name__ == "__main__":
    main()
