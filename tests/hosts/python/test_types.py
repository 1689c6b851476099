# SPDX-License-Identifier: BSD-3-Clause
"""Type stubs: mypy accepts the package and the samples, and the stub has what the compiled part has."""

import ast
import glob
import os
import subprocess
import sys
import unittest

from lockstep import _core

ROOT = os.environ["LOCKSTEP_ROOT"]
HOST = os.path.join(ROOT, "framework", "hosts", "python")


class Types(unittest.TestCase):
    def test_mypy(self):
        if subprocess.run([sys.executable, "-m", "mypy", "--version"], capture_output=True).returncode != 0:
            self.skipTest("mypy is missing")
        made = subprocess.run(
            [sys.executable, "-m", "mypy", "--config-file", os.path.join(HOST, "mypy.ini"), "--cache-dir", os.devnull,
             os.path.join(HOST, "lockstep"), *glob.glob(os.path.join(ROOT, "samples", "hosts", "python", "*.py"))],
            capture_output=True, text=True, env={**os.environ, "MYPYPATH": HOST})
        self.assertEqual(made.returncode, 0, made.stdout + made.stderr)

    def test_the_stub_names_what_is_there(self):
        with open(os.path.join(HOST, "lockstep", "_core.pyi")) as file:
            stub = ast.parse(file.read())
        for part in stub.body:
            if isinstance(part, ast.FunctionDef):
                self.assertTrue(hasattr(_core, part.name), part.name)
            elif isinstance(part, ast.ClassDef) and not part.name.startswith("_"):
                of = getattr(_core, part.name)
                for member in part.body:
                    name = getattr(member, "name", getattr(getattr(member, "target", None), "id", None))
                    self.assertTrue(name is None or hasattr(of, name), f"{part.name}.{name}")


if __name__ == "__main__":
    unittest.main()
