# SPDX-License-Identifier: BSD-3-Clause
"""What the Python host costs: a run against the program, a law and a joint of Python against those of the library.

    PYTHONPATH=build/release/python LOCKSTEP_PROGRAM=build/release/bin/lockstep python3 tests/benchmark/hosts/python.py

Ratios are medians of pairs in this process, so that the speed of the machine cancels. The test python.benchmark calls the
same functions for short runs, and checks what they return.
"""

import math
import os
import resource
import statistics
import subprocess
import time

import lockstep as ls

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__)))))
PROGRAM = os.environ["LOCKSTEP_PROGRAM"]


def scene(name):
    return os.path.join(ROOT, "samples", "scenes", name + ".json")


def timed(act):
    begin = time.process_time()
    act()
    return time.process_time() - begin


def of_program(name, until):
    begin = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    subprocess.run([PROGRAM, "run", scene(name), "--quiet", "--no-picture", "--record", "/dev/null", "--set", f"run.until={until}"], capture_output=True, check=True)
    return resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - begin


def of_python(name, until):
    return timed(lambda: ls.Simulation(scene(name), set={"run.until": until}).run())


RUNS = {"andrews_a03": "0.15 s", "four_bar": "200 s", "nfourbar_40": "20 s", "spatial_chain_10": "20 s"}


def runs(cases=RUNS, repeat=9):
    print(f"CPU time of a run in Python over those of the program, median of {repeat} pairs")
    for name, until in cases.items():
        ratios = [of_python(name, until) / (of_program(name, until) or math.nan) for _ in range(repeat)]
        print(f"  {name:20} {statistics.median(ratios):6.3f}   ({min(ratios):.3f} ... {max(ratios):.3f})")


def slider(law, until=10):
    return {"lockstep": 1,
            "bodies": [{"name": "m", "sphere": {"mass": 2.0, "radius": 0.1}}],
            "joints": [{"name": "A", "type": "revolute", "p": "m", "s": "ground", "at": [0, 0, 0]}],
            "forces": [{"name": "M", "type": "torque_motor", "p": "m", "s": "ground", "at": [0, 0, 0], "torque": law}],
            "run": {"integrator": "rk4", "step": 1e-4, "until": until, "output": until, "record": ["A.rz"]}}


def laws(until=10, repeat=5):
    """Returns the calls of the law in a run."""
    calls = 0

    def counting(t):
        nonlocal calls
        calls += 1
        return 0.1 * ls.sin(3 * t)

    ls.Simulation(slider(counting, until)).run()
    kinds = {
        "jets": lambda t: 0.1 * t.sin(),
        "numbers": lambda t: (0.1, 0.0, 0.0),
    }
    built_in = statistics.median(timed(ls.Simulation(slider({"type": "sine", "amplitude": 0.1, "omega": 3}, until)).run) for _ in range(repeat))
    print(f"a law of Python, {calls} calls in a run; us a call beyond the built-in law, and beyond the same call from Python")
    for name, f in kinds.items():
        run = statistics.median(timed(ls.Simulation(slider(f, until)).run) for _ in range(repeat))
        t = ls.TimeJet(0.3)

        def loop():
            for _ in range(calls):
                f(t)

        alone = statistics.median(timed(loop) for _ in range(repeat))
        per = (run - built_in) / calls * 1e6
        print(f"  {name:20} {per:6.2f}   {per - alone / calls * 1e6:6.2f}")
    return calls


def joints(until=20, repeat=5):
    """Returns the tables by the joint of Python and by the formula."""
    def bead(joint, **keys):
        return {"lockstep": 1, "gravity": [0, -9.81, 0],
                "bodies": [{"name": "bead", "particle": 1.0, "position": [2, 0, 0]}],
                "joints": [{"name": "wire", "type": joint, "p": "bead", "s": "ground", "at_p": [2, 0, 0],
                            "at_s": [0, 0, 0], **keys}],
                "run": {"tolerance": 1e-8, "until": until, "output": 1, "record": ["bead.y"]}}

    by, tables = {}, []
    joint = ls.joint(lambda y: (y.x / 2) ** 2 + y.y**2 - 1, mask="z")
    for name, scene in (("python", bead(joint)), ("formula", bead("function", phi="=(x/2)^2 + y^2 - 1", mask="z"))):
        by[name] = statistics.median(timed(ls.Simulation(scene).run) for _ in range(repeat))
        tables.append(ls.Simulation(scene).run())
    print(f"a joint of Python over the same formula: {by['python'] / by['formula']:.1f} times the run")
    return tables


def sweeps(n=2000, few=400):
    """Returns the runs of each sweep."""
    made_runs = []
    print(f"a sweep of {n} runs of 10 ms: us a run; of that its start and steps, making the mechanism, and the sweep itself")
    for name, values in (("pendulum", {"length": 0.7}), ("four_bar", {"crank": 0.11})):
        whole = timed(lambda: made_runs.append(ls.sweep(scene(name), [values] * n, until=0.01))) / n
        read, made = ls.Scene(scene(name), ls.Types()), []
        making = timed(lambda: made.extend(ls.Simulation(read, set=values, report=False) for _ in range(few))) / few
        run = timed(lambda: [each.advance_to(0.01) for each in made]) / few
        print(f"  {name:20} {1e6 * whole:6.0f} = {1e6 * run:5.0f} + {1e6 * making:5.0f} + {1e6 * (whole - run - making):5.0f}")
    return made_runs


if __name__ == "__main__":
    sweeps()
    runs()
    laws()
    joints()
