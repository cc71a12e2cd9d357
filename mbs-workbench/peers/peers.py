"""Runs other programs on the motion of a mechanism: times, and states at the instants asked for.

    python peers.py PROGRAM BACK_END.py DEFINITION.py TREE.py < question.json > answers

PROGRAM is `equations` (SciPy, CVODES and IDAS on the equations that CasADi derives from the definition, as compiled C), or
`mujoco`, `exudyn`, `drake`, `pinocchio` (the mechanism as a tree of bodies with closed loops; see trees.py). BACK_END is
with_casadi.py, DEFINITION what `mbs_codegen::casadi_definition` prints, TREE a file with the tree, or `-`.

In:  {"times": [s], "q": [], "qd": [], "z": [], "v": [], "parameters": {name: value}, "longest": s, "scratch": directory}
Out: a line of JSON a run:
     {"program", "setting", "seconds", "evaluations", "q": [instant][coordinate], "qd": the same or null}
     {"program", "setting", "refused": reason}
     {"program", "progress": words}
"""

import importlib.util
import json
import os
import sys
import time

# A time is the shortest of so many runs; of long runs fewer.
RUNS = 5


def load(name, path):
    spec = importlib.util.spec_from_file_location(name, path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def tell(**answer):
    # Programs print on the same channel; lines of this protocol begin with a mark.
    os.write(ANSWERS, ("@" + json.dumps(answer) + "\n").encode())


def shortest(run, longest):
    """Shortest time of some runs, the first one not counted where others follow."""
    times = []
    began = time.perf_counter()
    while len(times) < RUNS + 1 and (not times or time.perf_counter() - began < longest):
        start = time.perf_counter()
        run()
        times.append(time.perf_counter() - start)
    return min(times[1:] or times)


class Late(Exception):
    """A run took longer than it may."""


class Watch:
    """Counts calls and ends a run that takes too long."""

    def __init__(self, longest):
        self.calls, self.end = 0, time.perf_counter() + longest

    def count(self):
        self.calls += 1
        if self.calls % 64 == 0 and time.perf_counter() > self.end:
            raise Late


def ladder(program, settings, run, longest):
    """A curve: `run(value)` gives (states, again, evaluations); coarse settings first, until one takes too long or three fail in turn."""
    lost = 0
    for setting, value in settings:
        began = time.perf_counter()
        try:
            (q, qd), again, evaluations = run(value)
            seconds = shortest(again, longest)
        except Late:
            tell(program=program, setting=setting, refused=f"takes more than {longest:g} s")
            return
        except Exception as error:  # noqa: BLE001: each program has its own
            tell(program=program, setting=setting, refused=last_words(error))
            lost += 1
            if lost == 3:
                return
            continue
        lost = 0
        tell(program=program, setting=setting, seconds=seconds, evaluations=evaluations, q=q, qd=qd)
        if time.perf_counter() - began > 4 * longest or seconds > longest:
            return


def last_words(error):
    lines = [line.strip() for line in str(error).splitlines() if line.strip()]
    return ("; ".join(lines[-2:]) if lines else type(error).__name__)[:200]


def main():
    if len(sys.argv) != 5:
        sys.exit("usage: peers.py PROGRAM BACK_END.py DEFINITION.py TREE.py < question.json")
    program, back_end, definition, tree = sys.argv[1:]
    question = json.load(sys.stdin)
    here = os.path.dirname(os.path.abspath(__file__))
    sys.path.insert(0, here)
    if program == "equations":
        from equations import run_all

        run_all(load("back_end", back_end), load("definition", definition), question)
    else:
        from trees import run_program

        run_program(program, None if tree == "-" else load("tree", tree), question)


# The answers have a channel of their own, for programs write to the standard output as they please.
ANSWERS = os.dup(1)
if __name__ == "__main__":
    os.dup2(2, 1)
    sys.modules["peers"] = sys.modules["__main__"]
    main()
