# SPDX-License-Identifier: BSD-3-Clause
"""Runs of scenes: against closed forms, and against the program to the last bit."""

import copy
import math
import os
import pickle
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest
import warnings

import numpy as np

import lockstep as ls

ROOT = os.environ["LOCKSTEP_ROOT"]
PROGRAM = os.environ["LOCKSTEP_PROGRAM"]
SCENES = os.path.join(ROOT, "samples", "scenes")


def oscillator(**run):
    """A mass of 2 kg on a spring of 50 N/m: x = 0.1 cos(5 t)."""
    settings = {"integrator": "dop853", "tolerance": 1e-11, "output": 0.1, "record": [{"x": "m.x"}], **run}
    return {
        "lockstep": 1,
        "parameters": {"k": "50 N/m"},
        "bodies": [{"name": "m", "particle": 2.0, "position": [1.1, 0, 0]}],
        "joints": [{"name": "guide", "type": "point_on_line", "p": "m", "s": "ground", "at_p": [1.1, 0, 0],
                    "at_s": [1.1, 0, 0], "axis": "x"}],
        "forces": [{"name": "spring", "type": "spring_damper", "p": "m", "s": "ground", "at_s": [0, 0, 0],
                    "stiffness": "=k", "free_length": 1.0}],
        "run": {key: value for key, value in settings.items() if value is not None},
    }


class Runs(unittest.TestCase):
    def test_a_dictionary_runs_as_the_closed_form(self):
        table = ls.Simulation(oscillator()).until("2 s")
        self.assertEqual(table.names, ["t", "x"])
        self.assertEqual(table["x"].unit, "m")
        np.testing.assert_allclose(table["x"], 1 + 0.1 * np.cos(5 * table.t), atol=1e-9)

    def test_extremes_are_of_the_motion(self):
        table = ls.Simulation(oscillator(output=0.37)).until(1)
        self.assertAlmostEqual(table["x"].min_of_motion.value, 0.9, 6)
        self.assertAlmostEqual(table["x"].min_of_motion.t, math.pi / 5, 3)
        self.assertTrue(table["x"].is_resolved)

    def test_rows_equal_those_of_the_program(self):
        with tempfile.TemporaryDirectory() as folder:
            file = os.path.join(folder, "a.csv")
            scene = os.path.join(SCENES, "four_bar.json")
            subprocess.run([PROGRAM, "run", scene, "--set", "crank=120 mm", "--record", file], check=True,
                           capture_output=True)
            table = ls.Simulation(scene, crank="120 mm").run()
            own = os.path.join(folder, "b.csv")
            table.to_csv(own)
            theirs = np.genfromtxt(file, delimiter=",", skip_header=1)
            np.testing.assert_array_equal(np.column_stack([table[n] for n in table.names]), theirs)
            with open(file) as a, open(own) as b:
                self.assertEqual(a.readline(), b.readline())

    def test_parameters_are_numbers_and_texts(self):
        for k in ("200 N/m", "0.2 kN/m"):
            table = ls.Simulation(oscillator(), k=k).until(1)
            self.assertAlmostEqual(table["x"][-1], 1 + 0.1 * math.cos(10), 8)
        table = ls.Simulation(oscillator(), set={"bodies.m.particle": 0.5}).until(1)
        self.assertAlmostEqual(table["x"][-1], 1 + 0.1 * math.cos(10), 8)

    def test_columns_stay_when_the_run_goes_on(self):
        run = ls.Simulation(oscillator())
        first = run.until(1)
        x, copied = first["x"], np.array(first["x"])
        whole = run.until(3)
        np.testing.assert_array_equal(x, copied)
        self.assertEqual(len(whole), 31)
        np.testing.assert_array_equal(whole["x"][:11], copied)

    def test_columns_are_not_copies(self):
        run = ls.Simulation(oscillator())
        run.until(1)
        a, b = run.table["x"], run.table["x"]
        self.assertTrue(np.shares_memory(a, b))
        with self.assertRaises(ValueError):
            a[0] = 1

    def test_steps_of_a_controller(self):
        run = ls.Simulation(oscillator())
        for k in range(1, 11):
            run.advance("10 ms")
            self.assertAlmostEqual(run.t, 0.01 * k, 15)

    def test_a_checkpoint_continues_to_the_last_bit(self):
        with tempfile.TemporaryDirectory() as folder:
            file = os.path.join(folder, "c.checkpoint")
            one = ls.Simulation(oscillator())
            one.until(1)
            one.save(file)
            whole = one.until(2)
            two = ls.Simulation(oscillator())
            two.load(file)
            np.testing.assert_array_equal(two.until(2)["x"], whole["x"])

    def test_an_unknown_column_names_the_closest(self):
        table = ls.Simulation(oscillator()).until(0.1)
        with self.assertRaisesRegex(KeyError, 'no column "X"'):
            table["X"]

    def test_tables_pickle(self):
        table = ls.Simulation(oscillator()).until(1)
        again = pickle.loads(pickle.dumps(table))
        np.testing.assert_array_equal(again["x"], table["x"])
        self.assertEqual(again["x"].unit, "m")
        self.assertEqual(again["x"].min_of_motion, table["x"].min_of_motion)

    def test_threads_run_side_by_side(self):
        results = {}

        def one(k):
            results[k] = ls.Simulation(oscillator(), k=f"{k} N/m").until(2)["x"][-1]

        threads = [threading.Thread(target=one, args=(k,)) for k in (50.0, 200.0, 450.0)]
        for t in threads:
            t.start()
        for t in threads:
            t.join()
        for k, x in results.items():
            self.assertAlmostEqual(x, 1 + 0.1 * math.cos(2 * math.sqrt(k / 2)), 8)

    def test_a_run_is_used_in_one_thread_at_a_time(self):
        run = ls.Simulation(oscillator(output=None))
        began, caught = threading.Event(), []
        run.on_step(lambda: began.set())

        def use():
            began.wait(10)
            for act in (lambda: run.table, lambda: run.t, lambda: run.advance(0.1)):
                try:
                    act()
                except ls.ModelError as error:
                    caught.append(str(error))

        other = threading.Thread(target=use)
        other.start()
        while other.is_alive():
            run.advance(1)
        self.assertTrue(all("another thread" in text for text in caught))
        self.assertGreater(len(caught), 0)

    def test_functions_may_read_the_table_of_their_run(self):
        run = ls.Simulation(oscillator())
        seen = []
        run.on_step(lambda: seen.append(len(run.table)))
        whole = run.until(2)
        self.assertEqual(len(whole), 21)
        self.assertEqual(sorted(seen), seen)
        np.testing.assert_allclose(whole["x"], 1 + 0.1 * np.cos(5 * whole.t), atol=1e-9)

    def test_two_threads_begin_one_run(self):
        for _ in range(20):
            run = ls.Simulation(oscillator())
            caught = []

            def use(run=run, caught=caught):
                try:
                    run.t
                except ls.ModelError as error:
                    caught.append(str(error))

            threads = [threading.Thread(target=use) for _ in range(4)]
            for thread in threads:
                thread.start()
            for thread in threads:
                thread.join()
            self.assertTrue(all("another thread" in text for text in caught))
            self.assertEqual(len(run.until(1)), 11)

    def test_a_numpy_false_of_an_observer_ends_the_run(self):
        run = ls.Simulation(oscillator())
        run.on_step(lambda: run.body("m")["x"][0] > 1)
        run.until(5)
        self.assertLess(run.t, 1)
        self.assertEqual(run.stopped_by, "the caller")

    def test_columns_are_added_after_a_look_at_the_table(self):
        run = ls.Simulation(oscillator())
        self.assertEqual(len(run.table), 0)
        run.record(["m.vx"])
        self.assertEqual(run.until(1).names, ["t", "x", "m.vx"])

    def test_a_function_cannot_run_its_own_run(self):
        run = ls.Simulation(oscillator())
        run.on_step(lambda: run.advance(0.1))
        with self.assertRaises(ls.Error):
            run.until(1)
        run.on_step(None)
        self.assertEqual(len(run.until(1)), 11)

    def test_an_interrupt_ends_a_run(self):
        run = ls.Simulation(oscillator(output=None))
        threading.Timer(0.5, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
        with self.assertRaises(KeyboardInterrupt):
            run.until(1e6)
        t = run.t
        self.assertGreater(t, 0)
        self.assertGreater(len(run.table), 10)
        self.assertAlmostEqual(run.until(t + 1)["x"][-1], 1 + 0.1 * math.cos(5 * (t + 1)), 4)


class Channels(unittest.TestCase):
    """Channels at the present time, as a controller reads them."""

    def test_columns_are_those_of_the_table(self):
        run = ls.Simulation(os.path.join(SCENES, "four_bar.json"), record=["rocker.angle_z"])
        for k in range(1, 6):
            run.advance(0.02)
            table = run.until(0.02 * k)
            for name in table.names[1:]:
                self.assertEqual(run[name], table[name][-1], name)
                self.assertEqual(run[name].unit, table[name].unit)

    def test_a_channel_in_closed_form(self):
        run = ls.Simulation(oscillator())
        self.assertAlmostEqual(run["m.ax"], -25 * 0.1, 12)
        self.assertEqual(repr(run["m.ax"]), "-2.5 m/s^2")
        for k in range(1, 4):
            run.advance(0.1)
            self.assertAlmostEqual(run["m.ax"], -2.5 * math.cos(0.5 * k), 8)
        again = pickle.loads(pickle.dumps(run["m.ax"]))
        self.assertEqual((again, again.unit), (run["m.ax"], "m/s^2"))

    def test_in_an_observer_and_without_an_effect(self):
        run, other = ls.Simulation(oscillator()), ls.Simulation(oscillator())
        seen = [run["m.ax"]]
        run.on_step(lambda: seen.append(run["m.ax"] + 25 * (run["x"] - 1)))
        np.testing.assert_array_equal(run.until(1)["x"], other.until(1)["x"])
        np.testing.assert_allclose(seen[1:], 0, atol=1e-12)
        self.assertGreater(len(seen), 5)

    def test_what_cannot_be_read_is_named(self):
        run = ls.Simulation(oscillator(record=[{"x": "m.x"}, {"top": "=max(m.x)"}]))
        for name, words in (("top", "depends on the motion before"), ("m.xx", "m.x")):
            with self.assertRaisesRegex(ls.ModelError, words):
                run[name]
        run.until(0.1)
        self.assertAlmostEqual(run["m.vx"], -0.5 * math.sin(0.5), 8)
        four_bar = ls.Simulation(os.path.join(SCENES, "four_bar.json"), set={"run.output": 0.01})
        four_bar.until(0.01)
        with self.assertRaisesRegex(ls.ModelError, "run of its system has begun; record what needs it before the run"):
            four_bar["coupler.angle_x"]
        self.assertEqual(len(four_bar.until(0.02)), 3)
        run = ls.Simulation(oscillator())
        run["x"]
        run.on("e", when=lambda s: run["x"] - 1)
        with self.assertRaisesRegex(ls.Error, "inside a step"):
            try:
                run.until(1)
            except ls.UserCodeError as error:
                raise error.__cause__


class Ends(unittest.TestCase):
    """The interpreter ends while a daemon thread is inside a run."""

    SCRIPT = """
import sys, threading, time
sys.path.insert(0, {folder!r})
from test_simulation import ls, oscillator
run = ls.Simulation(oscillator(output=None, **{settings}))
{more}
threading.Thread(target=lambda: run.until(1e5), daemon=True).start()
time.sleep({seconds})
"""

    def check_ends(self, more="", settings="{}"):
        for k in range(3):
            script = self.SCRIPT.format(folder=os.path.dirname(os.path.abspath(__file__)), more=more, settings=settings,
                                        seconds=0.1 + 0.01 * k)
            ended = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=120)
            self.assertEqual((ended.returncode, ended.stderr), (0, ""), ended.stderr)

    def test_in_a_run(self):
        self.check_ends()

    def test_in_an_observer(self):
        self.check_ends("run.on_step(lambda: sum(range(1000)) > 0)")

    def test_in_a_law(self):
        self.check_ends("""
scene = {"lockstep": 1, "bodies": [{"name": "m", "particle": 1.0}],
         "forces": [{"name": "F", "type": "applied_force", "p": "m", "at": [0, 0, 0], "direction": "x",
                     "law": lambda t: sum(range(1000)) - 499500.0 + ls.cos(t)}]}
run = ls.Simulation(scene)
""")


class Messages(unittest.TestCase):
    def test_errors_are_those_of_scenes(self):
        scene = oscillator()
        scene["forces"][0]["stifness"] = 3
        with self.assertRaises(ls.SceneError) as raised:
            ls.Simulation(scene)
        self.assertIn('unknown key "stifness"', str(raised.exception))
        self.assertIn('did you mean "stiffness"', str(raised.exception))
        self.assertIsInstance(raised.exception, ls.Error)

    def test_units_are_checked(self):
        with self.assertRaises(ls.SceneError) as raised:
            ls.Simulation(oscillator(), set={"bodies.m.particle": "3 mm"})
        self.assertIn("mm", str(raised.exception))

    def test_places_in_files(self):
        with tempfile.TemporaryDirectory() as folder:
            file = os.path.join(folder, "wrong.json")
            with open(file, "w") as out:
                out.write('{"lockstep": 1,\n "bodies": [{"name": "m", "mass": "heavy"}]}\n')
            with self.assertRaises(ls.SceneError) as raised:
                ls.Simulation(file)
            self.assertEqual(raised.exception.line, 2)
            self.assertTrue(raised.exception.file.endswith("wrong.json"))
            again = pickle.loads(pickle.dumps(raised.exception))
            self.assertEqual(again.line, 2)
            self.assertEqual(str(again), str(raised.exception))

    def test_a_scene_that_contains_itself(self):
        scene = oscillator()
        scene["bodies"][0]["visual"] = scene
        with self.assertRaises(RecursionError):
            ls.Simulation(scene)

    def test_warnings_name_the_code_of_the_user_once(self):
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            run = ls.Simulation(oscillator(integrator="rk4", step=0.5))
            for k in range(1, 6):
                run.until(k)
        self.assertEqual({w.filename for w in caught}, {__file__})
        self.assertEqual(sum(w.category is ls.WrongResult for w in caught), 1)

    def test_advance_warns_as_until_does(self):
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            run = ls.Simulation(oscillator(integrator="rk4", step=0.5))
            for _ in range(20):
                run.advance(0.5)
        self.assertEqual(sum(w.category is ls.WrongResult for w in caught), 1)
        self.assertEqual({w.filename for w in caught}, {__file__})

    def test_numpy_values_of_scenes(self):
        scene = oscillator()
        scene["bodies"][0]["particle"] = np.array(0.5)
        scene["bodies"][0]["position"] = np.array([1.1, 0, 0])
        scene["run"].update(output=np.float32(0.5), assemble=np.True_)
        table = ls.Simulation(scene, k=np.array(50)).until(np.float64(1))
        self.assertAlmostEqual(table["x"][-1], 1 + 0.1 * math.cos(10), 8)
        scene["bodies"][0]["particle"] = np.True_
        with self.assertRaisesRegex(ls.SceneError, "true"):
            ls.Simulation(scene)
        ls.Simulation(oscillator(), set={"run.assemble": np.False_})

    def test_values_that_are_no_numbers_are_named(self):
        for wrong in (b"2", bytearray(b"2"), 2j):
            scene = oscillator()
            scene["bodies"][0]["particle"] = wrong
            with self.assertRaisesRegex(TypeError, r"scene\.bodies\[0\]\.particle"):
                ls.Simulation(scene)
            with self.assertRaisesRegex(TypeError, "^k is "):
                ls.Simulation(oscillator(), k=wrong)
        with self.assertRaisesRegex(TypeError, "the time is b'1'"):
            ls.Simulation(oscillator()).until(b"1")

    def test_what_is_no_name_is_named(self):
        run = ls.Simulation(oscillator())
        for wrong, act in ((r"record\[0\] is None", lambda: ls.Simulation(oscillator(), record=[None])),
                           (r"record\[1\] is 3", lambda: run.record(["m.x", 3])),
                           ("record is 'm.x'", lambda: run.record("m.x")),
                           ("the column is 1", lambda: run[1]),
                           ("the body is None", lambda: run.body(None)),
                           ("the part is 2.5", lambda: run.activate(2.5)),
                           ("activate is 'spring'", lambda: run.on("e", at=1, activate="spring")),
                           ("the scene is Simulation of", lambda: ls.Simulation(run)),
                           ("the scene is 3;", lambda: ls.Simulation(3))):
            with self.assertRaisesRegex(TypeError, wrong):
                act()

    def test_what_no_scene_can_hold(self):
        scene = oscillator()
        scene["bodies"][0]["position"] = {1, 2, 3}
        with self.assertRaisesRegex(TypeError, r"scene\.bodies\[0\]\.position"):
            ls.Simulation(scene)

    def test_findings_are_warnings_by_kind(self):
        scene = oscillator(integrator="rk4", step=0.5)
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            run = ls.Simulation(scene)
            run.until(5)
        kinds = [w.category for w in caught]
        self.assertTrue(all(issubclass(k, ls.FindingWarning) for k in kinds))
        self.assertEqual(len({str(w.message) for w in caught}), len(caught))
        self.assertIn(ls.WrongResult, kinds)
        with warnings.catch_warnings():
            warnings.simplefilter("error", ls.WrongResult)
            with self.assertRaises(ls.WrongResult) as raised:
                ls.Simulation(scene).until(5)
        self.assertEqual(raised.exception.code, "energy-not-conserved")
        codes = [f.code for f in run.findings]
        self.assertIn("energy-not-conserved", codes)
        wrong = next(f for f in run.findings if f.code == "energy-not-conserved")
        self.assertEqual(wrong.severity, "wrong")
        self.assertGreater(wrong.value, wrong.limit)


class Building(unittest.TestCase):
    def pendulum(self):
        m = ls.Mechanism("a pendulum", gravity=(0, -9.81, 0))
        rod = m.rod("rod", mass=1, from_=(0, 0, 0), to=(1, 0, 0))
        self.pin = m.revolute("pin", rod, at=(0, 0, 0))
        return m

    def test_a_pendulum(self):
        m = self.pendulum()
        run = m.simulation(until="1 s", tolerance=1e-10, record=["rod.omega_world_z", self.pin["rz"], "energy.total"])
        table = run.run()
        self.assertAlmostEqual(np.ptp(table["energy.total"]), 0, 7)
        rate, angle = table["rod.omega_world_z"][-1], table["pin.rz"][-1]
        inertia = 1 / 3 + 1e-4  # of the rod, whose radius is length/50
        self.assertAlmostEqual(rate**2, -9.81 * math.sin(angle) / (1 / 3), delta=1e-2)
        self.assertGreater(inertia, 0)

    def test_unknown_types_name_the_closest(self):
        with self.assertRaisesRegex(AttributeError, 'did you mean "revolute"'):
            self.pendulum().revolut("x", "rod")
        self.assertIn("spring_damper", dir(self.pendulum()))

    def test_parameters_of_a_builder(self):
        m = ls.Mechanism(gravity=(0, -9.81, 0))
        m.particle("ball", "2 kg", (0, 0, 0))
        m.force("applied_force", "up", "ball", at=(0, 0, 0), force=[0, m.parameter("F", 30.0), 0])
        scene = m.scene()
        for F in (30.0, 40.0):
            table = ls.Simulation(scene, F=F, record=["ball.y"]).until(1)
            self.assertAlmostEqual(table["ball.y"][-1], 0.5 * (F / 2 - 9.81), 7)

    def test_names_with_an_underscore_at_their_end_are_kept(self):
        m = ls.Mechanism(parameters={"k": 3.0, "k_": 5.0})
        m.parameter("from_", 1.0)
        m.rod("rod", mass=1, from_=(0, 0, 0), to=("=k_", "=from_", 0))
        self.assertEqual(m.scene()["parameters"], {"k": 3.0, "k_": 5.0, "from_": 1.0})
        self.assertEqual(m.scene()["bodies"][0]["rod"]["from"], [0, 0, 0])
        self.assertEqual(float(m.simulation(until=1)["rod.x"]), 2.5)

    def test_parts_are_names_for_a_run(self):
        m = self.pendulum()
        extra = m.particle("extra", mass=1, position=(3, 0, 0))
        np.testing.assert_array_equal(m.simulation(until=1).body(extra)["x"], [3, 0, 0])

    def test_functions_become_types_by_their_kind(self):
        m = self.pendulum()
        law = ls.law(lambda t: t)
        for add, wrong, advice in ((m.joint, lambda y: y.x, r"joint 'j'.*ls\.joint"), (m.joint, law, "joint 'j'"),
                                   (m.force, lambda at: at.P.x, r"force 'j'.*ls\.force")):
            with self.assertRaisesRegex(TypeError, advice):
                add(wrong, "j", "rod")

    def test_names_are_no_lists_of_channels(self):
        m = self.pendulum()
        for record in ("pin.rz", self.pin):
            with self.assertRaises(TypeError):
                m.simulation(until=1, record=record)

    def test_copies_are_independent(self):
        m = self.pendulum()
        other = copy.deepcopy(m)
        other.particle("p", 1, (0, 0, 0))
        self.assertEqual(len(m.scene()["bodies"]), 1)


if __name__ == "__main__":
    unittest.main()
