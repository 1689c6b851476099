# SPDX-License-Identifier: BSD-3-Clause
"""The benchmark of the Python host in a short form: what it measures is the same work."""

import contextlib
import csv
import importlib.util
import io
import os
import subprocess
import tempfile
import unittest

import numpy as np

ROOT = os.environ["LOCKSTEP_ROOT"]
FILE = os.path.join(ROOT, "tests", "benchmark", "hosts", "python.py")
SPEC = importlib.util.spec_from_file_location("benchmark", FILE)
benchmark = importlib.util.module_from_spec(SPEC)
SPEC.loader.exec_module(benchmark)


def last_row_of_program(name, *sets):
    with tempfile.TemporaryDirectory() as folder:
        file = os.path.join(folder, "a.csv")
        subprocess.run([benchmark.PROGRAM, "run", benchmark.scene(name), "--record", file, "--no-picture", *sets], check=True,
                       capture_output=True)
        with open(file) as rows:
            header, *_, last = csv.reader(rows)
    return {h.split(" [")[0]: float(x) for h, x in zip(header, last)}


class Benchmark(unittest.TestCase):
    def setUp(self):
        self.text = self.enterContext(contextlib.redirect_stdout(io.StringIO()))

    def test_runs(self):
        benchmark.runs({name: "1 ms" for name in benchmark.RUNS}, repeat=1)
        for name in benchmark.RUNS:
            self.assertIn(name, self.text.getvalue())

    def test_laws_are_called_at_each_stage(self):
        """rk4 has four stages a step; all steps are alike, 100 in 10 ms."""
        calls = [benchmark.laws(until, 1) for until in (0.01, 0.02, 0.03)]
        self.assertEqual(calls[1] - calls[0], calls[2] - calls[1])
        self.assertGreaterEqual(calls[1] - calls[0], 4 * 100)

    def test_joints_are_the_same(self):
        python, formula = benchmark.joints(2, 1)
        np.testing.assert_allclose(python["bead.y"], formula["bead.y"], atol=1e-7)

    def test_sweeps_are_runs_of_the_program(self):
        for runs, (name, value) in zip(benchmark.sweeps(4, 2), (("pendulum", "length=0.7"), ("four_bar", "crank=0.11"))):
            theirs = last_row_of_program(name, "--set", value, "--set", "run.until=0.01")
            self.assertEqual((len(runs), runs.failed), (4, []))
            for column, last in theirs.items():
                if column != "t":
                    np.testing.assert_array_equal(runs[f"{column}.last"], last)


if __name__ == "__main__":
    unittest.main()
