"""contrib/evidence work-precision: one study a problem over methods and resolutions, error against what a run costs."""
import argparse
import json
import math
import os
import resource
import shutil
import subprocess
import tempfile
from dataclasses import dataclass, field

import page
from outcome import ROOT, STROMA

PARAMETERS = os.path.join(ROOT, "parameters")
MUCH = 1.5  # a setting is worse than another one that is faster and more accurate by this factor


@dataclass
class Problem:
    name: str
    title: str
    study: str  # file under parameters
    sets: tuple = ()  # entries that make it small
    coarser: tuple = ()  # entries of a run with a fraction of the reference's unknowns; none if the solution is exact
    grid: tuple = ("101", "101")  # of the comparison of the two
    defaults: tuple = ()  # cases that are what a method does unless it is told otherwise
    others: dict = field(default_factory=dict)  # by default, the cases of the same method


PROBLEMS = (
    Problem("finite-strain", "Manufactured solution of finite strain in 3D", "verification/manufactured_3d.prm",
            defaults=("MPM", "FEM Q1"), others={"MPM": (), "FEM Q1": ("FEM Q1 projected",)}),
    Problem("slice", "Slice of two materials, contrast 10", "evidence/work_slice.prm",
            coarser=("Method = fem", "Constants/cells = 256", "FEM/Degree = 1", "FEM/Material at = cell"), defaults=("MPM bonded points", "FEM Q1"),
            others={"MPM bonded points": ("MPM composite cells", "MPM reset", "MPM B-splines"), "FEM Q1": ("FEM Q2",)}),
    Problem("tractions", "Tractions on a Kelvin-Voigt solid (Heck 2017, 3.1)", "heck2017/methods_study.prm",
            ("Study/resolution/Values = 10, 20, 40", "Study/resolution of SPH/Values = 10, 20"),
            ("Constants/cells = 48", "Constants/dt = 5", "FEM/Degree = 2", "FEM/Scheme = SDIRK 3"), defaults=("NSPH SDIRK 2", "FEM Q1"),
            others={"NSPH SDIRK 2": ("NSPH backward Euler", "NSPH explicit", "NSPH published"), "FEM Q1": ("FEM Q2",)}),
    Problem("indentation", "Indentation with a rigid circle (Heck 2017, 3.3)", "heck2017/indentation_study.prm",
            ("Study/resolution/Values = 10, 20", "Study/Reference/Set = Method = fem, Constants/cells = 60"),
            ("Method = fem", "Constants/cells = 30"), defaults=("MPM linear",), others={"MPM linear": ("MPM B-splines",)}),
)


def settings(entries):
    return [part for entry in entries for part in ("--set", entry)]


def stroma(*arguments):
    """Runs the program on one core; what it took of processor time [s]."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run([STROMA, *arguments], capture_output=True, text=True, env={**os.environ, "OMP_NUM_THREADS": "1"})
    if done.returncode not in (0, 2):
        raise SystemExit(f"stroma {' '.join(arguments)}: {done.stderr.strip()}")
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def error_of_reference(problem, file, folder):
    """How far a run with a fraction of its unknowns is from the reference, a bound of the reference's own error; 0 if that is exact."""
    if not problem.coarser:
        return 0.
    coarser, out = os.path.join(folder, "coarser"), os.path.join(folder, "own")
    stroma("run", file, *settings((*problem.sets, *problem.coarser, "Output/Keep states = true")), "--output", coarser)
    stroma("compare", coarser, os.path.join(folder, "study", "reference"), "--points", "grid", "--grid", *problem.grid, "--fields", "displacement_m",
           "--quiet", "--output", out)
    with open(os.path.join(out, "compare.json"), encoding="utf-8") as text:
        last = json.load(text)["fields"][-1]
    return last["regions"][0]["L2"]["relative"]


def measure(problem, folder):
    """The runs of the study of a problem, each with the processor time of the whole run, and the reference's own error."""
    file = os.path.join(PARAMETERS, problem.study)
    stroma("study", file, *settings(problem.sets), "--output", os.path.join(folder, "study"))
    with open(os.path.join(folder, "study", "study.json"), encoding="utf-8") as text:
        runs = json.load(text)["runs"]
    for i, run in enumerate(runs):
        run["processor_s"] = stroma("run", os.path.join(folder, "study", run["folder"], "parameters.prm"), "--output", os.path.join(folder, f"again{i}"))
    return runs, error_of_reference(problem, file, folder)


def has_error(run):
    return run["status"] == "finished" and run["error"] is not None


def beaten(problem, runs):
    """Lines on runs of defaults that another setting of the same method beats in time and error."""
    for default in problem.defaults:
        for run in filter(has_error, runs):
            for other in filter(has_error, runs):
                if (run["case"] == default and other["case"] in problem.others[default] and
                        run["processor_s"] > MUCH * other["processor_s"] and run["error"] > MUCH * other["error"]):
                    yield (f"{run['case']} ({run['axis_value']}) is beaten by {other['case']} ({other['axis_value']}): "
                           f"{run['error']:.1e} in {run['processor_s']:.2g} s, {other['error']:.1e} in {other['processor_s']:.2g} s")


def cheapest(runs):
    """By the error that is asked for, the run that costs least."""
    good = list(filter(has_error, runs))
    for wanted in (.1, .05, .02, .01, 5e-3, 2e-3, 1e-3):
        enough = [run for run in good if run["error"] <= wanted]
        if enough:
            best = min(enough, key=lambda run: run["processor_s"])
            yield [f"{wanted:g}", best["case"], best["axis_value"], f"{best['error']:.1e}", f"{best['processor_s']:.2g}"]


def row(run):
    summary = run["summary"]
    numbers = [str(summary[key]) for key in ("n_dofs", "n_steps", "newton_iterations", "linear_iterations")]
    error = f"{run['error']:.1e}" if has_error(run) else ""
    order = "" if run["order"] is None else f"{run['order']:.1f}"
    return [run["case"], run["axis_value"] or "", error, order, f"{run['wall_time_s']:.2g}", f"{run['processor_s']:.2g}", *numbers, run["status"]]


def chapter(problem, runs, own):
    """What the page says of a problem."""
    least = min((run["error"] for run in filter(has_error, runs)), default=math.nan)
    reference = ("the exact solution" if not problem.coarser else
                 f"a finer run, whose own error is below {own:.1e} (a run with {', '.join(problem.coarser)} is that far from it)" +
                 ("" if own <= .1 * least else f"; not a tenth of the smallest error here, {least:.1e}: read errors of that size as no smaller than their sum"))
    worse = list(beaten(problem, runs))
    return f"""
## {problem.title}
`parameters/{problem.study}`{''.join(f', `{entry}`' for entry in problem.sets)}. Errors in L2 of the displacement, against {reference}.

![error against wall time](work_{problem.name}.png)

""" + page.table(["case", "resolution", "error", "order", "wall s", "processor s", "unknowns", "steps", "Newton", "linear", "status"], map(row, runs)) + """
Least processor time for an error:

""" + page.table(["error", "case", "resolution", "has", "processor s"], cheapest(runs)) + "\n" + (
        "\n".join(f"- {line}" for line in worse) if worse else f"No default ({', '.join(problem.defaults)}) is beaten by {MUCH} in time and error "
        "by another setting of its method.") + "\n"


def main(arguments):
    parser = argparse.ArgumentParser(prog="contrib/evidence work-precision", description=__doc__)
    parser.add_argument("--only", action="append", metavar="PROBLEM", choices=[problem.name for problem in PROBLEMS],
                        help="problems by their names; prints, writes no page")
    chosen = parser.parse_args(arguments)
    text, plots = "", {}
    with tempfile.TemporaryDirectory() as folder:
        for problem in PROBLEMS:
            if chosen.only and problem.name not in chosen.only:
                continue
            where = os.path.join(folder, problem.name)
            os.makedirs(where)
            part = chapter(problem, *measure(problem, where))
            print(part, flush=True)
            text += part
            plots[problem.name] = os.path.join(where, "study", "study.png")
        if chosen.only:
            return 0
        page.write("work_precision.md", page.heading("Error against run time", "work-precision") + """
Wall time: the median of the runs that the study repeats, without the start of the program. Processor time: of a whole run on one core with its
start (.5 s), which a busy machine hardly changes. Work: steps, Newton and linear iterations.
""" + text)
        for name, plot in plots.items():
            if os.path.exists(plot):
                shutil.copy(plot, os.path.join(ROOT, "documentation", "evidence", f"work_{name}.png"))
    return 0
