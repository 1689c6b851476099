# SPDX-License-Identifier: BSD-3-Clause
"""The page "lockstep from Python": its blocks run one after another, and their outputs are those on the page.

With LOCKSTEP_WRITE_PAGES=1 the outputs on the page are written anew.
"""

import ast
import contextlib
import io
import os
import re
import shutil
import tempfile
import unittest
import warnings

ROOT = os.environ["LOCKSTEP_ROOT"]
PAGE = os.path.join(ROOT, "framework", "docs", "from_python.md")
BLOCK = re.compile(r"^```(python|text)\n(.*?)^```$", re.MULTILINE | re.DOTALL)


def output_of(code, names):
    """What a cell of a notebook shows: its prints, and the value of its last expression."""
    tree = ast.parse(code)
    last = tree.body.pop() if isinstance(tree.body[-1], ast.Expr) else None
    with contextlib.redirect_stdout(io.StringIO()) as out, warnings.catch_warnings():
        warnings.simplefilter("ignore")
        exec(compile(tree, PAGE, "exec"), names)
        value = None if last is None else eval(compile(ast.Expression(last.value), PAGE, "eval"), names)
        if value is not None:
            print(repr(value))
    return out.getvalue()


class Page(unittest.TestCase):
    def test_blocks(self):
        try:
            import scipy  # noqa: F401
            import matplotlib
        except ImportError as missing:
            self.skipTest(f"{missing.name} is missing")
        matplotlib.use("Agg")
        with open(PAGE, encoding="utf-8") as file:
            page = file.read()
        written, names, shown, at = [], {"__name__": "page"}, None, 0
        before = os.getcwd()
        with tempfile.TemporaryDirectory() as folder:
            shutil.copy(os.path.join(ROOT, "samples", "scenes", "four_bar.json"), folder)
            os.chdir(folder)
            try:
                for block in BLOCK.finditer(page):
                    language, text = block.groups()
                    if language == "python":
                        shown = output_of(text, names)
                    elif os.environ.get("LOCKSTEP_WRITE_PAGES"):
                        written += [page[at:block.start(2)], shown]
                        at = block.end(2)
                    else:
                        self.assertEqual(shown, text, "below line " + str(page.count("\n", 0, block.start())))
            finally:
                os.chdir(before)
        if written:
            with open(PAGE, "w", encoding="utf-8") as file:
                file.write("".join(written) + page[at:])


if __name__ == "__main__":
    unittest.main()
