# SPDX-License-Identifier: BSD-3-Clause
"""Laws, joints, forces and events of Python: against closed forms and the types of the library."""

import gc
import math
import traceback
import unittest
import weakref

import numpy as np

import lockstep as ls


def slider(law=None, **more):
    drive = {} if law is None else {"drive": {"axis": "z", "law": law}}
    return {
        "lockstep": 1,
        "bodies": [{"name": "m", "sphere": {"mass": 2.0, "radius": 0.1}}],
        "joints": [{"name": "A", "type": "prismatic", "p": "m", "s": "ground", "at": [0, 0, 0], "axis": "z", **drive}],
        "run": {"integrator": "dop853", "tolerance": 1e-11, "until": 2, "output": 0.1,
                "record": ["m.z", "m.vz", "m.az"]},
        **more,
    }


class Jets(unittest.TestCase):
    def test_derivatives_of_functions(self):
        t = ls.TimeJet(0.7)
        seen = {}

        @ls.law
        def probe(t):
            y = ls.exp(-t) * np.sin(3 * t) / (1 + t**2) + ls.sqrt(2 + t) ** 3 - 2 ** t + abs(t - 2) + ls.arctan2(t, 2.0)
            seen["y"] = y
            return y

        ls.Simulation(slider(probe)).until(0.7)
        y, h = seen["y"], 1e-4

        def f(t):
            return (math.exp(-t) * math.sin(3 * t) / (1 + t * t) + math.sqrt(2 + t) ** 3 - 2**t + abs(t - 2)
                    + math.atan2(t, 2))

        self.assertAlmostEqual(y.value, f(0.7), 12)
        self.assertAlmostEqual(y.rate, (f(0.7 + h) - f(0.7 - h)) / (2 * h), 6)
        self.assertAlmostEqual(y.second, (f(0.7 + h) - 2 * f(0.7) + f(0.7 - h)) / h**2, 5)
        self.assertEqual(t.value, 0.7)

    def test_whole_powers_at_zero(self):
        table = ls.Simulation(slider(lambda t: sum(c * t**k for k, c in enumerate((0.0, 1.0, 2.0, 3.0))))).until(1)
        np.testing.assert_allclose(table["m.az"], 4 + 18 * np.asarray(table.t), atol=1e-9)

    def test_a_function_of_numpy_is_a_law(self):
        table = ls.Simulation(slider(np.sin)).until(1)
        np.testing.assert_allclose(table["m.az"], -np.sin(np.asarray(table.t)), atol=1e-9)

    def test_functions_of_math_are_refused(self):
        with self.assertRaises(ls.UserCodeError) as raised:
            ls.Simulation(slider(lambda t: math.sin(t))).until(0.1)
        self.assertIsInstance(raised.exception.__cause__, TypeError)
        self.assertIn("numpy", str(raised.exception.__cause__))


class Laws(unittest.TestCase):
    def check(self, law):
        table = ls.Simulation(slider(law)).run()
        t = np.asarray(table.t)
        np.testing.assert_allclose(table["m.z"], 0.1 * np.sin(3 * t), atol=1e-12)
        np.testing.assert_allclose(table["m.vz"], 0.3 * np.cos(3 * t), atol=1e-12)
        np.testing.assert_allclose(table["m.az"], -0.9 * np.sin(3 * t), atol=1e-12)

    def test_a_lambda(self):
        self.check(lambda t: 0.1 * ls.sin(3 * t))

    def test_numbers_with_derivatives(self):
        def law(t):
            t = t.value
            return 0.1 * math.sin(3 * t), 0.3 * math.cos(3 * t), -0.9 * math.sin(3 * t)

        self.check(law)

    def test_further_parameters_are_keys(self):
        @ls.law
        def wave(t, amplitude, omega=3.0):
            """A wave."""
            return amplitude * ls.sin(omega * t)

        self.check({"type": wave, "amplitude": "100 mm"})
        with self.assertRaisesRegex(ls.SceneError, 'did you mean "amplitude"'):
            ls.Simulation(slider({"type": wave, "amplitud": 1}))

    def test_a_law_that_raises_ends_the_run(self):
        def broken(t):
            if t > 0.55:
                raise RuntimeError("no value here")
            return 0.0 * t

        run = ls.Simulation(slider(broken))
        with self.assertRaises(ls.UserCodeError) as raised:
            run.run()
        error = raised.exception
        self.assertIn("broken", str(error))
        self.assertIsInstance(error.__cause__, RuntimeError)
        self.assertIn("in broken", "".join(traceback.format_tb(error.__cause__.__traceback__)))
        self.assertGreaterEqual(error.t, 0.5)
        self.assertGreaterEqual(len(run.table), 1)
        self.assertLessEqual(run.t, error.t)

    def test_jumps(self):
        @ls.law(breaks=[1.0])
        def step(t):
            return 0.5 * (t - 1) ** 2 if t >= 1 else 0 * t

        table = ls.Simulation(slider(step)).run()
        self.assertAlmostEqual(table["m.z"][-1], 0.5, 12)


class Derivatives(unittest.TestCase):
    """Functions that hide a part of their derivatives are errors when their scene is read."""

    def check_refused(self, scene, *words):
        with self.assertRaises(ls.ModelError) as raised:
            ls.Simulation(scene)
        for word in words:
            self.assertIn(word, str(raised.exception))
        return raised.exception

    def test_a_law_of_plain_numbers(self):
        def hidden(t):
            return 0.1 * math.sin(t.value)

        error = self.check_refused(slider(hidden), "law 'hidden'", "yd at t = ", "is 0, finite differences of y give 0.0",
                                   "compute with t itself")
        self.assertEqual((error.thing, error.thing_kind), ("hidden", "law"))
        inside = {"type": "sum", "laws": [hidden, 1.0]}
        self.check_refused(slider(inside), "finite differences")

    def test_a_law_with_a_wrong_rate(self):
        wrong = slider(lambda t: (math.sin(t.value), math.cos(t.value), math.sin(t.value)))
        self.check_refused(wrong, "ydd", "wrong sign")

    def test_a_joint_of_plain_numbers(self):
        scene = Joints().bead(ls.joint(lambda y: y.x**2 + y.y.value**2 - 4, mask="z"))
        self.check_refused(scene, "joint 'wire'", "in y is 0", "not their .value")

    def test_laws_that_are_right(self):
        for law in (lambda t: 0.3, lambda t: 0.0 if t < 1 else 1.0, lambda t: abs(t - 1), lambda t: ls.sqrt(t),
                    lambda t: 0.1 * t if t < 1 else 1 / 0):
            ls.Simulation(slider(law))

    def test_a_law_that_drives_no_joint_needs_no_rates(self):
        scene = slider(forces=[{"name": "F", "type": "force_motor", "p": "m", "s": "ground", "at": [0, 0, 0],
                                "force": lambda t: float(np.interp(t.value, [0, 2], [0, 4]))}])
        self.assertAlmostEqual(ls.Simulation(scene).run()["m.z"][-1], 2 * 2**3 / (2 * 6), 8)


class Plugins(unittest.TestCase):
    def test_a_plugin_brings_its_types(self):
        types = ls.Types()
        self.assertNotIn("drag", types.names()["forces"])
        types.load_plugin("drag")
        scene = {"lockstep": 1, "gravity": [0, 0, -10],
                 "bodies": [{"name": "m", "particle": 1.0}],
                 "forces": [{"name": "air", "type": "drag", "p": "m", "at": [0, 0, 0], "coefficient": 0.1}],
                 "run": {"until": 5, "tolerance": 1e-10, "record": ["m.vz"]}}
        table = ls.Simulation(scene, types=types).run()
        self.assertAlmostEqual(table["m.vz"][-1], -10 * math.tanh(5), 7)
        with self.assertRaises(ls.SceneError):
            ls.Simulation(scene)
        with self.assertRaises(ls.PluginError):
            types.load_plugin("no_such_plugin")


class Joints(unittest.TestCase):
    def bead(self, joint, **keys):
        return {
            "lockstep": 1, "gravity": [0, -9.81, 0],
            "bodies": [{"name": "bead", "particle": 1.0, "position": [2, 0, 0]}],
            "joints": [{"name": "wire", "type": joint, "p": "bead", "s": "ground", "at_p": [2, 0, 0], "at_s": [0, 0, 0],
                        **keys}],
            "run": {"integrator": "dop853", "tolerance": 1e-11, "until": 1, "output": 0.05,
                    "record": ["bead.x", "bead.y", "bead.z", "energy.total"]},
        }

    def test_an_ellipse_against_a_formula(self):
        a, b = 2.0, 1.0
        by_python = ls.Simulation(self.bead(ls.joint(lambda y: (y.x / a) ** 2 + (y.y / b) ** 2 - 1, mask="z"))).run()
        by_formula = ls.Simulation(self.bead("function", phi="=(x/2)^2 + y^2 - 1", mask="z")).run()
        for name in ("bead.x", "bead.y"):
            np.testing.assert_allclose(by_python[name], by_formula[name], atol=1e-12)
        self.assertLess(np.ptp(by_python["energy.total"]), 1e-8)
        np.testing.assert_allclose((by_python["bead.x"] / a) ** 2 + (by_python["bead.y"] / b) ** 2, 1, atol=1e-10)

    def test_a_coordinate_that_is_read_later_is_an_error(self):
        joint = ls.joint(lambda y: y.x * y.x + y.y * y.y - 4 + (0 * y.e3 if y.y < -0.5 else 0.0), mask="z")
        scene = self.bead(joint)
        scene["bodies"][0] = {"name": "bead", "sphere": {"mass": 1, "radius": 0.1}, "position": [2, 0, 0]}
        with self.assertRaises(ls.Error) as raised:
            ls.Simulation(scene).run()
        self.assertIn("reads", str(raised.exception) + str(raised.exception.__cause__))

    def test_an_exception_names_the_joint_of_a_particle(self):
        with self.assertRaises(ls.UserCodeError) as raised:
            ls.Simulation(self.bead(ls.joint(lambda y: 1 / 0, mask="z"))).run()
        self.assertEqual((raised.exception.thing, type(raised.exception.__cause__)), ("wire", ZeroDivisionError))
        circle = ls.joint(lambda y: y.x**2 + y.y**2 - 4 + 0 / (y.x.value**2 + y.y.value**2), mask="z")
        table = ls.Simulation(self.bead(circle)).run()
        np.testing.assert_allclose(table["bead.x"] ** 2 + table["bead.y"] ** 2, 4, atol=1e-9)

    def test_two_rows(self):
        joint = ls.joint(lambda y: (y.x * y.x + y.y * y.y - 4, y.z), rows=2)
        table = ls.Simulation(self.bead(joint)).run()
        circle = ls.Simulation(self.bead("function", phi=["=x^2 + y^2 - 4", "=z"])).run()
        np.testing.assert_allclose(table["bead.y"], circle["bead.y"], atol=1e-12)

    def test_implicit_methods_have_exact_tangents(self):
        joint = ls.joint(lambda y: (y.x / 2) ** 2 + y.y**2 - 1, mask="z")
        scene = self.bead(joint)
        scene["run"]["integrator"] = "radau5"
        scene["run"]["tolerance"] = 1e-9
        by_python = ls.Simulation(scene).run()
        scene["joints"][0].update(type="function", phi="=(x/2)^2 + y^2 - 1", mask="z")
        by_formula = ls.Simulation(scene).run()
        np.testing.assert_allclose(by_python["bead.y"], by_formula["bead.y"], atol=1e-10)

    def test_a_coupling_of_two_joints(self):
        def gears(joint, **keys):
            return {
                "lockstep": 1,
                "bodies": [{"name": n, "cylinder": {"mass": 1, "radius": r, "length": 0.02}, "position": [x, 0, 0]}
                           for n, r, x in (("one", 0.1, 0), ("two", 0.2, 0.3))],
                "joints": [{"name": "A", "type": "revolute", "p": "one", "s": "ground", "at": [0, 0, 0]},
                           {"name": "B", "type": "revolute", "p": "two", "s": "ground", "at": [0.3, 0, 0]},
                           {"name": "mesh", "type": joint, "pairs": ["A", "B"], **keys}],
                "forces": [{"name": "M", "type": "torque_motor", "p": "one", "s": "ground", "at": [0, 0, 0],
                            "torque": 0.1}],
                "run": {"tolerance": 1e-10, "until": 10, "output": 1, "record": ["A.rz", "B.rz"]},
            }

        coupled = ls.Simulation(gears(ls.joint(lambda a, b: a.angle_z + 2 * b.angle_z, pairs=2))).run()
        meshed = ls.Simulation(gears("gear", ratio=2)).run()
        np.testing.assert_allclose(coupled["A.rz"], meshed["A.rz"], rtol=1e-10)
        self.assertGreater(coupled["A.rz"][-1], 4 * math.pi)


class Forces(unittest.TestCase):
    def scene(self, force, integrator="dop853", **keys):
        return {
            "lockstep": 1, "gravity": [0, 0, -9.81],
            "bodies": [{"name": "m", "particle": 2.0, "position": [1, 0, 0], "velocity": [0, 1, 0]}],
            "forces": [{"name": "F", "type": force, "p": "m", "s": "ground", "at_p": [1, 0, 0], "at_s": [0, 0, 0], **keys}],
            "run": {"integrator": integrator, "tolerance": 1e-10, "until": 1, "output": 0.1,
                    "record": ["m.x", "m.y", "m.z", "energy.total"]},
        }

    def spring(self, at):
        d = at.P.x - at.S.x
        length = ls.norm(d)
        return {"force": -200 * (length - 0.8) / length * d, "potential": 100 * (length - 0.8) ** 2}

    def test_a_spring_against_that_of_the_library(self):
        for integrator in ("dop853", "radau5"):
            own = ls.Simulation(self.scene(ls.force(self.spring), integrator)).run()
            theirs = ls.Simulation(self.scene("spring_damper", integrator, stiffness=200, free_length=0.8)).run()
            for name in ("m.x", "m.y", "m.z", "energy.total"):
                np.testing.assert_allclose(own[name], theirs[name], atol=1e-8)
            self.assertLess(np.ptp(own["energy.total"]), 1e-6)

    def test_wrong_results_are_named(self):
        for wrong, words in ((lambda at: 3.0, "three numbers"), (lambda at: {"forse": [0, 0, 0]}, "forse")):
            with self.assertRaises(ls.UserCodeError) as raised:
                ls.Simulation(self.scene(ls.force(wrong))).run()
            self.assertIn(words, str(raised.exception.__cause__))


class Events(unittest.TestCase):
    def ball(self):
        return {
            "lockstep": 1, "gravity": [0, -10, 0],
            "bodies": [{"name": "ball", "particle": 1.0, "position": [0, 5, 0]}],
            "run": {"tolerance": 1e-10, "output": 0.1, "record": ["ball.y", "ball.vy"]},
        }

    def test_a_condition_and_a_change(self):
        run = ls.Simulation(self.ball())
        times = []

        def bounce(state):
            times.append(state.t)
            v = state.body("ball")["v"]
            state.set_twist("ball", v=[v[0], -v[1], v[2]])

        run.on("floor", when=lambda s: s.body("ball")["x"][1], crossing="falling", once=False, change=bounce)
        table = run.until(3.5)
        self.assertAlmostEqual(times[0], 1, 8)
        self.assertAlmostEqual(times[1], 3, 7)
        self.assertAlmostEqual(table["ball.y"][-1], 5 * (1 - 0.25) , 5)

    def test_a_stop(self):
        run = ls.Simulation(self.ball())
        run.on("low", when=lambda s: s.body("ball")["x"][1] - 3.2, stop=True)
        run.until(10)
        self.assertAlmostEqual(run.t, 0.6, 8)
        self.assertEqual(run.stopped_by, "low")

    def test_a_sample_ends_with_its_call(self):
        run = ls.Simulation(self.ball())
        kept = []
        run.on("keep", when=lambda s: kept.append(s) or 1.0)
        run.until(0.5)
        with self.assertRaises(ls.ModelError):
            kept[0].t

    def test_a_state_ends_with_its_call(self):
        run = ls.Simulation(self.ball())
        kept = []
        run.on("keep", at="0.1 s", change=kept.append)
        run.until(0.5)
        for act in (lambda: kept[0].t, lambda: kept[0].body("ball"), lambda: kept[0].set_twist("ball", v=[0, 0, 0])):
            with self.assertRaises(ls.ModelError):
                act()

    def test_a_condition_changes_no_state(self):
        with self.assertRaisesRegex(ls.UserCodeError, "read only"):
            run = ls.Simulation(self.ball())
            run.on("look", when=lambda s: s.set_twist("ball", v=[0, 0, 0]) or 1.0)
            run.until(1)

    def test_an_unknown_crossing_is_an_error(self):
        with self.assertRaisesRegex(ValueError, "upwards"):
            ls.Simulation(self.ball()).on("e", when=lambda s: 1.0, crossing="upwards")

    def test_a_condition_is_a_number(self):
        for wrong in (True, np.bool_(False), None, "y"):
            run = ls.Simulation(self.ball())
            with self.assertRaises(ls.UserCodeError) as raised:
                run.on("low", when=lambda s: wrong)
                run.until(1)
            self.assertIn(f"is {wrong!r}; return a number that passes zero", str(raised.exception.__cause__))

    def test_names_of_events_are_taken_once(self):
        run = ls.Simulation({**self.ball(), "events": [{"name": "end", "at": 1, "stop": True}]})
        run.on("low", at=0.1)
        for name in ("end", "low"):
            with self.assertRaisesRegex(ls.ModelError, f'there is an event "{name}"; give another name'):
                run.on(name, at=0.2)

    def test_an_observer_ends_the_run(self):
        run = ls.Simulation(self.ball())
        calls = []
        run.on_step(lambda: calls.append(1) or len(calls) < 3)
        run.until(10)
        self.assertEqual(len(calls), 3)
        self.assertEqual(run.stopped_by, "the caller")


class Integrators(unittest.TestCase):
    def test_heuns_method_is_of_second_order(self):
        @ls.integrator(order=2)
        class Heun:
            def step(self, system, y, h):
                k = system.rates(y)
                return y.moved(h, (k + system.rates(y.moved(h, k))) / 2)

        def error(h):
            scene = {"lockstep": 1,
                     "bodies": [{"name": "m", "particle": 2.0, "position": [1.1, 0, 0]}],
                     "forces": [{"name": "spring", "type": "spring_damper", "p": "m", "s": "ground", "at_p": [1.1, 0, 0],
                                 "at_s": [0, 0, 0], "stiffness": 50, "free_length": 1}],
                     "run": {"integrator": Heun, "step": h, "until": 1, "record": ["m.x"]}}
            return abs(ls.Simulation(scene).run()["m.x"][-1] - 1 - 0.1 * math.cos(5))

        errors = [error(h) for h in (1 / 100, 1 / 200, 1 / 400)]
        self.assertAlmostEqual(errors[0] / errors[1], 4, delta=0.1)
        self.assertAlmostEqual(errors[1] / errors[2], 4, delta=0.05)

    def run_of(self, method, bodies=1):
        return ls.Simulation({"lockstep": 1, "run": {"integrator": method, "step": 0.1, "until": 1},
                              "bodies": [{"name": f"b{k}", "particle": 1, "position": [k, 0, 0]} for k in range(bodies)]})

    def test_errors_name_the_integrator_and_the_time(self):
        def fails(self, *_):
            raise KeyError("mine")

        def stays(self, system, y, h):
            return y

        for parts, cause in (({"begin": fails, "step": stays}, KeyError), ({"step": fails}, KeyError),
                             ({"step": lambda *_: 3}, TypeError), ({}, AttributeError)):
            with self.assertRaises(ls.UserCodeError) as raised:
                self.run_of(ls.integrator(type("Own", (), parts))).run()
            self.assertEqual((raised.exception.thing, raised.exception.t), ("Own", 0))
            self.assertIsInstance(raised.exception.__cause__, cause)

    def test_an_order_is_from_1_to_53(self):
        for order in (0, 54):
            with self.assertRaisesRegex(ValueError, f"order is {order}; give 1 to 53"):
                ls.integrator(order=order)

    def test_rates_of_another_mechanism_are_an_error(self):
        kept, problems = [], []

        @ls.integrator
        class Mixed:
            def step(self, system, y, h):
                kept.append(system.rates(y))
                for use in (lambda: kept[0] + kept[-1], lambda: kept[0] - kept[-1], lambda: y.moved(h, kept[0])):
                    try:
                        use()
                    except ValueError as error:
                        problems.append(str(error))
                return y.moved(h, kept[-1])

        self.run_of(Mixed).step(0.1)
        self.assertEqual(problems, [])
        self.run_of(Mixed, bodies=2).step(0.1)
        self.assertEqual(len(problems), 3)
        self.assertIn("rates of another mechanism: 7, 6 and 0 numbers of q, v and s; here are 14, 12 and 0", problems)


class Garbage(unittest.TestCase):
    """Functions that refer to their own run do not keep it alive."""

    def check_freed(self, make):
        run = weakref.ref(make())
        gc.collect()
        self.assertIsNone(run())

    def test_observers_and_events(self):
        def make():
            run = ls.Simulation(slider())
            run.on_step(lambda: run.t >= 0)
            run.on("e", when=lambda s: s.t - run.t - 1, change=lambda s: run)
            run.until(0.5)
            return run

        self.check_freed(make)

    def test_laws_joints_and_types(self):
        def make():
            runs = []

            @ls.law
            def law(t, k=1.0):
                return k * t + 0 * len(runs)

            joint = ls.joint(lambda y: y.x + 0 * len(runs))
            types = ls.Types()
            types.add(joint)
            scene = ls.Scene(slider({"type": law, "k": 2.0}), types)
            runs += [types, scene, ls.Simulation(scene)]
            runs[-1].until(0.5)
            return runs[-1]

        self.check_freed(make)

    def test_a_run_keeps_its_functions(self):
        run = ls.Simulation(slider(lambda t: 0.1 * ls.sin(3 * t)))
        run.on("end", when=lambda s: s.t - 0.5, stop=True)
        gc.collect()
        self.assertAlmostEqual(run.until(1)["m.z"][-1], 0.1 * math.sin(1.5), 10)


class Inputs(unittest.TestCase):
    def test_analyses_of_a_run_take_its_inputs(self):
        scene = slider(forces=[{"name": "motor", "type": "force_motor", "p": "m", "s": "ground", "at": [0, 0, 0],
                                "force": {"type": "input", "name": "u"}},
                               {"name": "spring", "type": "spring_damper", "p": "m", "s": "ground", "at_p": [0, 0, 0],
                                "at_s": [0, 0, -1], "stiffness": 100, "free_length": 1, "damping": 30}])
        run = ls.Simulation(scene)
        run.inputs["u"] = 10
        run.until(1)
        self.assertAlmostEqual(ls.statics(run).bodies["m"].x[2], 0.1, 9)

    def test_a_controller_in_the_loop(self):
        scene = slider(forces=[{"name": "motor", "type": "force_motor", "p": "m", "s": "ground", "at": [0, 0, 0],
                                "force": {"type": "input", "name": "u"}}])
        run = ls.Simulation(scene)
        self.assertEqual(list(run.inputs), ["u"])
        for u in (3.0, -1.0):
            run.inputs["u"] = u
            self.assertAlmostEqual(run["m.az"], u / 2, 12)
        v = z = 0.0
        for k in range(100):
            run.inputs["u"] = u = math.cos(0.1 * k)
            run.advance(0.01)
            z += 0.01 * v + 0.5 * u / 2 * 0.01**2
            v += u / 2 * 0.01
        self.assertAlmostEqual(run.body("m")["x"][2], z, 12)
        with self.assertRaises(ls.ModelError):
            run.inputs["w"] = 1
        with self.assertRaises(ls.ModelError):
            run.inputs["u"] = math.nan


if __name__ == "__main__":
    unittest.main()
