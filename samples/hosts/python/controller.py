# SPDX-License-Identifier: BSD-3-Clause
"""A controller in the loop: state feedback holds an inverted pendulum upright on a cart.

The gains come from the linear equations of the mechanism, ls.linearize, and from the Riccati equation of a quadratic
cost, scipy.linalg.solve_continuous_are. The controller reads the state every 5 ms and sets a force until it reads again.
"""

import math

import numpy as np
from scipy.linalg import solve_continuous_are

import lockstep as ls

CART, ROD, LENGTH, G = 2.0, 0.5, 0.8, 9.81


def mechanism(tilt: float) -> ls.Mechanism:
    """A cart on a rail along x, a rod on it that leans by `tilt`, rad, and a motor force u on the cart."""
    m = ls.Mechanism("an inverted pendulum on a cart", gravity=(0, -G, 0))
    cart = m.body("cart", mass=CART, inertia=[0.01, 0.01, 0.01], position=[0, 0, 0])
    rod = m.body("rod", mass=ROD, inertia=[1e-4, ROD * LENGTH**2 / 12, ROD * LENGTH**2 / 12], center=[LENGTH / 2, 0, 0],
                 position=[0, 0, 0], orientation={"axis": "z", "angle": math.pi / 2 + tilt})
    m.prismatic("rail", cart, at=(0, 0, 0), axis="x")
    m.revolute("pin", rod, cart, at=(0, 0, 0))
    m.applied_force("motor", cart, at=(0, 0, 0), direction="x", law={"type": "input", "name": "u"})
    return m


def state_of(run: ls.Simulation) -> ls.Array:
    """x, tilt, and their rates."""
    cart, rod = run.body("cart"), run.body("rod")
    tilt = 2 * math.atan2(rod["q"][3], rod["q"][0]) - math.pi / 2
    return np.array([cart["x"][0], tilt, cart["v"][0], rod["w"][2]])


def main() -> None:
    # The coordinates of the linear equations are motions of bodies; y = C z turns them into those of the controller.
    upright = ls.linearize(mechanism(0.0), inputs=["motor"],
                           outputs=["cart.x", "rod.angle_z", "cart.vx", "rod.omega_world_z"])
    T = upright.C
    A, B = T @ upright.A @ np.linalg.inv(T), T @ upright.B
    print(upright)

    # The textbook's equations of the same, of a rod of length l: (M + m) x'' - m l/2 tilt'' = u,
    # -m l/2 x'' + m l^2/3 tilt'' = m g l/2 tilt.
    mass = np.array([[CART + ROD, -ROD * LENGTH / 2], [-ROD * LENGTH / 2, ROD * LENGTH**2 / 3]])
    A_theirs = np.zeros((4, 4))
    A_theirs[:2, 2:] = np.eye(2)
    A_theirs[2:, 1] = np.linalg.solve(mass, [0, ROD * G * LENGTH / 2])
    assert np.allclose(A, A_theirs, atol=1e-8), A - A_theirs

    Q, R = np.diag([10.0, 10.0, 1.0, 1.0]), np.array([[0.1]])
    P = solve_continuous_are(A, B, Q, R)
    gains = np.linalg.solve(R, B.T @ P)
    poles = np.linalg.eigvals(A - B @ gains)
    print("gains", np.round(gains[0], 3), " slowest pole", round(max(poles.real), 3), "1/s")
    assert max(poles.real) < 0

    run = mechanism(0.2).simulation(record={"x": "cart.x", "angle": "rod.angle_z"}, output="20 ms", tolerance=1e-9)
    largest = 0.0
    for _ in range(1200):
        u = -float((gains @ state_of(run)).item())
        run.inputs["u"] = u
        largest = max(largest, abs(u))
        run.advance("5 ms")
    x, tilt, *_ = state_of(run)
    print(f"after {run.t:g} s: cart at {1e3 * x:.3f} mm, tilt {1e3 * tilt:.3f} mrad; largest force {largest:.1f} N")
    assert abs(x) < 0.02 and abs(tilt) < 0.005
    assert np.ptp(run.table["x"]) < 1.0

    free = mechanism(0.2).simulation(record=["rod.angle_z"])
    free.until("1 s")
    assert abs(state_of(free)[1]) > 1.0  # without the controller it falls


if __name__ == "__main__":
    main()
