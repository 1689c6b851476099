# SPDX-License-Identifier: BSD-3-Clause
"""Sweeps: against closed forms, the same by every executor, and failures as rows."""

import concurrent.futures
import io
import contextlib
import math
import multiprocessing
import os
import pickle
import signal
import threading
import time
import unittest
import warnings

import numpy as np

import lockstep as ls


def oscillator(**run):
    """A mass of 2 kg on a spring: x = 0.1 cos(w t), w^2 = k/m."""
    return {
        "lockstep": 1, "parameters": {"k": "50 N/m", "m": "2 kg"},
        "bodies": [{"name": "m", "particle": "=m", "position": [1.1, 0, 0]}],
        "joints": [{"name": "guide", "type": "point_on_line", "p": "m", "s": "ground", "at_p": [1.1, 0, 0],
                    "at_s": [1.1, 0, 0], "axis": "x"}],
        "forces": [{"name": "spring", "type": "spring_damper", "p": "m", "s": "ground", "at_s": [0, 0, 0],
                    "stiffness": "=k", "free_length": 1.0}],
        "run": {"integrator": "dop853", "tolerance": 1e-11, "until": 0.2, "output": 0.1, "record": [{"x": "m.x"}], **run},
    }


def exact(k, m, t=0.2):
    return 1 + 0.1 * np.cos(np.sqrt(k / m) * t)


def last(run):
    return float(run.table["x"][-1])


def both(run):
    return {"x": last(run), "steps": run.steps}


def raises(run):
    raise ZeroDivisionError("in measure")


class Sweeps(unittest.TestCase):
    def check_grid(self, executor=None, **more):
        runs = ls.sweep(oscillator(), {"k": ["40 N/m", "0.05 kN/m"], "m": [1.0, 2.0, 3.0]}, executor=executor, **more)
        self.assertEqual(len(runs), 6)
        np.testing.assert_array_equal(runs["k"], [40, 40, 40, 50, 50, 50])
        np.testing.assert_array_equal(runs["m"], [1, 2, 3] * 2)
        self.assertEqual((runs["k"].unit, runs["m"].unit, runs["x.last"].unit), ("N/m", "kg", "m"))
        np.testing.assert_allclose(runs["x.last"], exact(runs["k"], runs["m"]), atol=1e-9)
        return runs

    def test_all_combinations(self):
        runs = self.check_grid()
        np.testing.assert_allclose(runs["x.max"], 1.1, atol=1e-12)
        np.testing.assert_array_equal(runs["x.t_max"], 0)
        self.assertEqual(runs["x.t_min"].unit, "s")
        self.assertIn("6 runs", repr(runs))
        np.testing.assert_array_equal(pickle.loads(pickle.dumps(runs))["x.last"], runs["x.last"])

    def test_threads(self):
        with concurrent.futures.ThreadPoolExecutor(2) as pool:
            threads = self.check_grid(pool, chunk=1)
        np.testing.assert_array_equal(threads["x.last"], self.check_grid()["x.last"])

    def test_processes(self):
        with concurrent.futures.ProcessPoolExecutor(2, multiprocessing.get_context("spawn")) as pool:
            self.check_grid(pool)
            runs = ls.sweep(oscillator(), [{"k": 30.0}, {"k": 60.0}], executor=pool, measure=both)
        np.testing.assert_allclose(runs["x"], exact(np.array([30, 60]), 2), atol=1e-9)
        self.assertGreater(runs["steps"].min(), 0)

    def test_dask(self):
        try:
            from dask.distributed import Client, LocalCluster
        except ImportError:
            self.skipTest("python3-distributed is missing")
        with LocalCluster(n_workers=2, threads_per_worker=1, processes=False, dashboard_address=None) as cluster:
            with Client(cluster) as client:
                self.check_grid(client.get_executor(), chunk=2)

    def test_lists_and_measures(self):
        runs = ls.sweep(oscillator(), [{"k": 30.0}, {"k": "0.06 kN/m", "m": "4 kg"}], measure=last, until="0.1 s")
        np.testing.assert_allclose(runs["last"], exact(np.array([30, 60]), np.array([2, 4]), 0.1), atol=1e-9)
        self.assertTrue(math.isnan(runs["m"][0]))
        self.assertEqual(runs["m"][1], 4)
        self.assertEqual(runs.varied, ["k", "m"])

    def test_failures_are_rows(self):
        runs = ls.sweep(oscillator(), {"m": [1.0, -1.0, 2.0]})
        self.assertEqual(runs.failed, [1])
        self.assertIsInstance(runs.errors[1], ls.SceneError)
        self.assertTrue(math.isnan(runs["x.last"][1]))
        np.testing.assert_allclose(runs["x.last"][[0, 2]], exact(50, np.array([1, 2])), atol=1e-9)
        self.assertIn("1 failed", repr(runs))
        self.assertEqual([type(e) for e in ls.sweep(oscillator(), {"m": [1.0]}, measure=raises).errors],
                         [ZeroDivisionError])

    def test_single_values(self):
        runs = ls.sweep(oscillator(), {"k": np.array(40.0), "m": [1.0, np.float32(2)]})
        np.testing.assert_allclose(runs["x.last"], exact(40, np.array([1, 2])), atol=1e-9)
        runs = ls.sweep(oscillator(), {"k": b"40"})
        self.assertIsInstance(runs.errors[0], TypeError)
        self.assertIn("k is b'40'", str(runs.errors[0]))

    def test_a_text_that_is_no_value_is_one_nan(self):
        runs = ls.sweep(oscillator(), {"k": ["40 N/m", "=2*35 N/m", "60 N", "1,2", "0.05 kN/m"]})
        np.testing.assert_array_equal(runs["k"], [40, math.nan, math.nan, math.nan, 50])
        self.assertEqual((runs["k"].unit, runs.failed), ("N/m", [2, 3]))

    def test_an_unknown_name_is_an_error_of_each_run(self):
        runs = ls.sweep(oscillator(), {"kk": [1.0, 2.0]})
        self.assertEqual(runs.failed, [0, 1])
        self.assertIn('"kk"', str(runs.errors[0]))

    def test_findings_belong_to_their_rows(self):
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            runs = ls.sweep(oscillator(integrator="rk4", step=0.4, until=8), {"k": [0.01, 50.0]})
        self.assertNotIn("energy-not-conserved", [f.code for f in runs.findings[0]])
        self.assertIn("energy-not-conserved", [f.code for f in runs.findings[1]])

    def test_a_measure_named_as_a_parameter_is_an_error(self):
        def k(run):
            return last(run)

        for measure in (k, lambda run: {"x": 1.0, "k": 2.0}):
            with self.assertRaisesRegex(ValueError, '"k" is a parameter'):
                ls.sweep(oscillator(), {"k": [40.0, 50.0]}, measure=measure)

    def test_an_interrupt_keeps_the_runs_made(self):
        done = []

        def interrupted(run):
            done.append(run)
            if len(done) == 3:
                signal.raise_signal(signal.SIGINT)
            return last(run)

        for pool in (None, concurrent.futures.ThreadPoolExecutor(1)):
            done.clear()
            with self.assertRaisesRegex(ls.InterruptedSweep, "after . of 6 runs") as raised:
                ls.sweep(oscillator(), {"k": np.linspace(40, 50, 6)}, measure=interrupted, chunk=2, executor=pool)
                self.fail(f"{pool} was not interrupted")
            runs = raised.exception.runs
            self.assertEqual(len(runs), 6)
            np.testing.assert_allclose(runs["interrupted"][:2], exact(np.array([40.0, 42.0]), 2), atol=1e-9)
            self.assertEqual(runs.errors[:2], [None, None])
            for error, x in zip(runs.errors, runs["interrupted"]):
                self.assertEqual(isinstance(error, ls.InterruptedRun), math.isnan(x))
            self.assertTrue(pool or runs.failed == [2, 3, 4, 5])
            self.assertIsInstance(raised.exception, KeyboardInterrupt)

    def test_an_interrupt_keeps_the_runs_of_all_threads_and_ends_them(self):
        made, both = [], threading.Barrier(2, timeout=60)

        def interrupted(run):
            made.append(run)
            if len(made) <= 2:
                both.wait()
                if made[0] is run:
                    os.kill(os.getpid(), signal.SIGINT)  # to the main thread
            time.sleep(0.1)
            return last(run)

        with self.assertRaises(ls.InterruptedSweep) as raised:
            with concurrent.futures.ThreadPoolExecutor(2) as pool:
                ls.sweep(oscillator(), {"k": [50.0] * 200}, measure=interrupted, chunk=100, executor=pool)
        runs = raised.exception.runs
        self.assertEqual(len(runs) - len(runs.failed), len(made))
        self.assertLess(len(made), 100)

    def test_an_interrupt_between_submissions_ends_all_runs(self):
        class Interrupting(concurrent.futures.ThreadPoolExecutor):
            def submit(self, *work):
                future = super().submit(*work)
                os.kill(os.getpid(), signal.SIGINT)
                time.sleep(0.1)
                return future

        made = []
        with self.assertRaises(ls.InterruptedSweep) as raised:
            with Interrupting(1) as pool:
                ls.sweep(oscillator(), {"k": [50.0] * 20}, measure=lambda run: made.append(time.sleep(0.1)) or last(run),
                         chunk=20, executor=pool)
        runs = raised.exception.runs
        self.assertEqual(len(runs) - len(runs.failed), len(made))
        self.assertIn(len(made), range(1, 10))

    def test_a_parameter_without_values_is_an_error(self):
        for empty in ([], np.array([])):
            with self.assertRaisesRegex(ValueError, '"k" has no values'):
                ls.sweep(oscillator(), {"m": [1.0], "k": empty})

    def test_plots_are_over_the_parameter(self):
        try:
            import matplotlib
        except ImportError:
            self.skipTest("matplotlib is missing")
        matplotlib.use("Agg")
        runs = ls.sweep(oscillator(), {"k": [40.0, 50.0, 60.0]})
        axes = runs.plot("x.last")[0]
        np.testing.assert_array_equal(axes.lines[0].get_xdata(), [40, 50, 60])
        self.assertEqual(axes.get_xlabel(), "k [N/m]")

    def test_progress(self):
        seen = []
        ls.sweep(oscillator(), {"k": [1.0] * 10}, chunk=4, progress=lambda done, of: seen.append((done, of)))
        self.assertEqual(seen, [(4, 10), (8, 10), (10, 10)])
        with contextlib.redirect_stderr(io.StringIO()) as text:
            ls.sweep(oscillator(), {"k": [1.0]}, progress=True)
        self.assertIn("1 of 1 runs", text.getvalue())

    def test_columns_and_files(self):
        scene = os.path.join(os.environ["LOCKSTEP_ROOT"], "samples", "scenes", "four_bar.json")
        runs = ls.sweep(scene, {"crank": ["80 mm", "100 mm"]}, until=0.7, columns=["rocker.omega_world_z"])
        np.testing.assert_allclose(runs["crank"], [0.08, 0.1], rtol=1e-15)
        self.assertEqual(runs["rocker.omega_world_z.max"].unit, "rad/s")
        np.testing.assert_array_equal(runs["rocker.omega_world_z.max"], runs["rocker_d.max"])


if __name__ == "__main__":
    unittest.main()
