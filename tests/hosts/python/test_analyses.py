# SPDX-License-Identifier: BSD-3-Clause
"""Analyses: against closed forms, and against the program."""

import json
import math
import os
import pickle
import signal
import subprocess
import threading
import unittest

import numpy as np

import lockstep as ls

ROOT = os.environ["LOCKSTEP_ROOT"]
PROGRAM = os.environ["LOCKSTEP_PROGRAM"]
SCENES = os.path.join(ROOT, "samples", "scenes")


def program(*arguments):
    """What the program prints with --json."""
    return json.loads(subprocess.run([PROGRAM, *arguments, "--json"], check=True, capture_output=True).stdout)


def lever():
    """A beam of 3 m on a hinge 1 m from its left end; 6 kg hang left, a spring with a free length holds it right."""
    m = ls.Mechanism("a lever", gravity=(0, -9.81, 0))
    m.body("beam", mass=1, inertia=[0.1, 0.1, 0.1], position=[0, 0, 0])
    m.revolute("hinge", "beam", at=(0, 0, 0))
    m.applied_force("load", "beam", at=(-1, 0, 0), force=[0, -60, 0])
    m.applied_force("counter", "beam", at=(2, 0, 0), force=[0, -30, 0])
    m.function_force("spring", link="hinge", torque="=-500*q")
    return m


def oscillator(c=3.0):
    """A mass of 2 kg on a spring of 50 N/m and a damper; a force along x."""
    return {
        "lockstep": 1, "parameters": {"c": f"{c} N s/m"},
        "bodies": [{"name": "m", "particle": 2.0, "position": [1, 0, 0]}],
        "joints": [{"name": "guide", "type": "point_on_line", "p": "m", "s": "ground", "at_p": [1, 0, 0],
                    "at_s": [1, 0, 0], "axis": "x"}],
        "forces": [{"name": "spring", "type": "spring_damper", "p": "m", "s": "ground", "at_s": [0, 0, 0],
                    "stiffness": 50, "damping": "=c", "free_length": 1.0},
                   {"name": "push", "type": "applied_force", "p": "m", "direction": "x", "law": 0}],
        "run": {"until": 1, "record": [{"x": "m.x"}]},
    }


class Statics(unittest.TestCase):
    def test_a_lever_balances(self):
        rest = ls.statics(lever())
        np.testing.assert_allclose(rest.reactions["hinge"].force, [0, 60 + 30 + 9.81, 0], atol=1e-9)
        self.assertEqual(rest.stability, "stable")
        self.assertAlmostEqual(rest.bodies["beam"].q[0], 1, 12)
        self.assertIn("hinge on beam", repr(rest))

    def test_as_the_program(self):
        scene = os.path.join(SCENES, "double_pendulum.json")
        theirs, rest = program("statics", scene), ls.statics(scene)
        self.assertEqual(rest.stability, theirs["stability"])
        self.assertEqual(rest.energy, theirs["energy"])
        for name, pose in theirs["bodies"].items() if "bodies" in theirs else theirs["poses"].items():
            np.testing.assert_array_equal(rest.bodies[name].x, pose["position"])
        again = pickle.loads(pickle.dumps(rest))
        np.testing.assert_array_equal(again.bodies[name].x, rest.bodies[name].x)


class Driven(unittest.TestCase):
    def test_a_slider_crank_in_closed_form(self):
        r, l, w = 0.15, 0.35, 2 * math.pi
        times = np.linspace(0, 1, 41)
        table = ls.kinematics(os.path.join(SCENES, "slider_crank.json"), times=times)
        x = r * np.cos(w * times) + np.sqrt(l**2 - (r * np.sin(w * times))**2)
        np.testing.assert_allclose(table["xs"], x, atol=1e-12)
        np.testing.assert_array_equal(table.t, times)
        self.assertAlmostEqual(table["xs"].max_of_motion.value, r + l, 12)

    def test_inverse_dynamics_as_the_program(self):
        scene = os.path.join(SCENES, "four_bar.json")
        theirs = {c["name"]: c["values"] for c in program("inverse", scene, "--until", "0.2")["columns"]}
        table = ls.inverse(scene, set={"run.until": 0.2})
        self.assertEqual(set(theirs), set(table.names))
        for name, values in theirs.items():
            np.testing.assert_array_equal(table[name], values)

    def test_from_a_run(self):
        run = ls.Simulation(os.path.join(SCENES, "four_bar.json"))
        run.until(0.1)
        table = ls.kinematics(run, times=[0.1, 0.2], record={"angle": "rocker.angle_z"})
        whole = run.until(0.2)
        self.assertAlmostEqual(table["angle"][-1], whole["rocker"][-1], 9)

    def test_missing_drives_are_named(self):
        with self.assertRaisesRegex(ls.ModelError, "hinge.rz"):
            ls.kinematics(os.path.join(SCENES, "pendulum.json"), times=[0, 1])

    def test_times_are_finite(self):
        for analysis in (ls.kinematics, ls.inverse):
            with self.assertRaisesRegex(ValueError, r"times\[1\] is nan; must be finite"):
                analysis(os.path.join(SCENES, "slider_crank.json"), times=[0, math.nan])


class Interrupts(unittest.TestCase):
    def test_an_interrupt_ends_kinematics_and_inverse(self):
        times = np.linspace(0, 1000, 10_000_000)
        for analysis in (ls.kinematics, ls.inverse):
            threading.Timer(0.5, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
            with self.assertRaises(KeyboardInterrupt):
                analysis(os.path.join(SCENES, "four_bar.json"), times=times)


class Linear(unittest.TestCase):
    def test_frequency_of_a_pendulum(self):
        m = ls.Mechanism(gravity=(0, -9.81, 0))
        m.body("rod", mass=2, center=[0, -0.5, 0], inertia=[1 / 6, 1 / 6, 1 / 6])
        m.revolute("pin", "rod", at=(0, 0, 0))
        found = ls.modes(m)
        self.assertAlmostEqual(found.frequencies[0], math.sqrt(2 * 9.81 * 0.5 / (1 / 6 + 2 * 0.25)) / (2 * math.pi), 10)
        self.assertEqual([mode.kind for mode in found], ["oscillation"])
        self.assertAlmostEqual(abs(found[0].shape["rod"][0][0]) / abs(found[0].shape["rod"][1][2]), 0.5, 10)
        np.testing.assert_allclose(found.eigenvalues.real, 0, atol=1e-9)
        pickle.loads(pickle.dumps(found))

    def test_modes_as_the_program(self):
        scene = os.path.join(SCENES, "double_pendulum.json")
        theirs, found = program("modes", scene, "--equilibrium"), ls.modes(scene, equilibrium=True)
        self.assertEqual([m["frequency"] for m in theirs["modes"]], list(found.frequencies))

    def test_state_space_of_a_mass_on_a_spring(self):
        system = ls.linearize(oscillator(), inputs=["push"], outputs=["x", "m.ax"])
        A, B, C, D = system
        np.testing.assert_allclose(A, [[0, 1], [-25, -1.5]], atol=1e-9)
        np.testing.assert_allclose(B, [[0], [0.5]], atol=1e-9)
        np.testing.assert_allclose(C, [[1, 0], [-25, -1.5]], atol=1e-7)
        np.testing.assert_allclose(D, [[0], [0.5]], atol=1e-9)
        self.assertEqual(system.inputs, ["push"])
        self.assertEqual((system.units["push"], system.units["x"], system.units["m.ax"]), ("N", "m", "m/s^2"))
        self.assertIn("states m.move_x [m]", repr(system))
        pickle.loads(pickle.dumps(system))

    def test_parameters(self):
        self.assertAlmostEqual(ls.linearize(oscillator(), c=8.0).A[1, 1], -4, 9)
        self.assertAlmostEqual(ls.modes(oscillator(), c="4 N s/m").damping[0], 4 / (2 * math.sqrt(50 * 2)), 9)

    def test_a_run_keeps_the_scene_that_it_read(self):
        scene = oscillator()
        run = ls.Simulation(scene)
        scene["forces"][0]["stiffness"] = 200
        np.testing.assert_array_equal(ls.modes(run).frequencies, ls.modes(oscillator()).frequencies)

    def test_linearize_as_the_program(self):
        scene = os.path.join(SCENES, "mass_spring_damper_fast.json")
        still = {"bodies.mass_c.velocity.0": 0, "bodies.mass_c.position.0": 0}
        sets = [part for k, v in still.items() for part in ("--set", f"{k}={v}")]
        theirs = program("linearize", scene, *sets, "--inputs", "push_c", "--outputs", "mass_c.x,mass_c.ax")
        system = ls.linearize(scene, inputs=["push_c"], outputs=["mass_c.x", "mass_c.ax"], set=still)
        for name, own in zip("ABCD", system):
            np.testing.assert_array_equal(own, theirs[name])

    def test_unknown_inputs_name_the_closest(self):
        with self.assertRaisesRegex(ls.ModelError, '"pusch" is not a drive, a law or a force; did you mean "push"'):
            ls.linearize(oscillator(), inputs=["pusch"])

    def test_names_are_lists_and_counts_whole(self):
        for key in ("inputs", "outputs"):
            with self.assertRaisesRegex(TypeError, f"{key} is 'push'"):
                ls.linearize(oscillator(), **{key: "push"})
        with self.assertRaisesRegex(TypeError, "integer"):
            ls.modes(oscillator(), count=1.5)

    def test_a_state_that_moves_is_refused(self):
        run = ls.Simulation(os.path.join(SCENES, "pendulum.json"))
        run.until(0.3)
        with self.assertRaisesRegex(ls.ModelError, "neither an equilibrium.*equilibrium=True takes"):
            ls.modes(run)
        self.assertLess(ls.statics(run).bodies["arm"].q[0], math.cos(math.pi / 4) + 1e-9)


if __name__ == "__main__":
    unittest.main()
