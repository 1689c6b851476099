# SPDX-License-Identifier: BSD-3-Clause
"""Runs a sample: a program, or a notebook, whose cells are executed and whose pictures must be there.

Usage: run_sample.py FILE [ARGUMENTS]. If a package is missing it prints "skipped: " and its name.
"""

import os
import runpy
import sys

OURS = "lockstep"


def run_notebook(file):
    import nbformat
    from nbconvert import HTMLExporter
    from nbconvert.preprocessors import ExecutePreprocessor
    import ipykernel  # noqa: F401
    import matplotlib  # noqa: F401, what the cells import
    import scipy  # noqa: F401

    notebook = nbformat.read(file, as_version=4)
    folder = os.path.dirname(file)
    ExecutePreprocessor(timeout=300, kernel_name="python3").preprocess(notebook, {"metadata": {"path": folder}})
    outputs = [o for cell in notebook.cells if cell.cell_type == "code" for o in cell.outputs]
    pictures = [o for o in outputs if "image/png" in o.get("data", {})]
    text = "".join(o.get("text", "") for o in outputs)
    print(text, end="")
    page, _ = HTMLExporter().from_notebook_node(notebook)
    written = os.path.join(os.environ.get("LOCKSTEP_OUTPUT", "."), os.path.basename(file).replace(".ipynb", ".html"))
    with open(written, "w", encoding="utf-8") as out:
        out.write(page)
    print(f"{len(pictures)} pictures, {written}")
    if len(pictures) < 2:
        sys.exit("the notebook drew fewer than two pictures")


def main():
    file, sys.argv = os.path.abspath(sys.argv[1]), sys.argv[1:]
    try:
        if file.endswith(".ipynb"):
            run_notebook(file)
        else:
            runpy.run_path(file, run_name="__main__")
    except ModuleNotFoundError as missing:
        if (missing.name or OURS).split(".")[0] == OURS:
            raise
        print(f"skipped: the Python package {missing.name} is missing")


if __name__ == "__main__":
    main()
