"""contrib/evidence work-precision: one study a problem over methods and resolutions, error against what a run costs."""
import argparse
import json
import math
import os
import resource
import statistics
import subprocess
import tempfile
import time

import page
from outcome import ROOT, STROMA
from work_problems import PROBLEMS

PARAMETERS = os.path.join(ROOT, "parameters")
MUCH = 1.5  # a setting is worse than another one that is faster and more accurate by this factor
SHORT, TIMES = 2., 3  # runs of less processor time [s] are done so often, for medians
LEAST = .2  # differences of times below that are not told apart [s]
WANTED = (.1, .03, .01, 3e-3, 1e-3, 3e-4)  # errors that a reader may ask for


def settings(entries):
    return [part for entry in entries for part in ("--set", entry)]


def stroma(*arguments):
    """Runs the program on one core; its (wall, processor) time [s], start included."""
    before, start = resource.getrusage(resource.RUSAGE_CHILDREN), time.monotonic()
    done = subprocess.run([STROMA, *arguments], capture_output=True, text=True, env={**os.environ, "OMP_NUM_THREADS": "1"})
    wall = time.monotonic() - start
    if done.returncode not in (0, 2):
        raise SystemExit(f"stroma {' '.join(arguments)}: {done.stderr.strip()}")
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return wall, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def read(*path):
    with open(os.path.join(*path), encoding="utf-8") as text:
        return json.load(text)


def timed(arguments, folder):
    """Medians of the (wall, processor) times of a run, which is repeated if it is short."""
    times = [stroma("run", *arguments, "--output", folder)]
    while times[0][1] < SHORT and len(times) < TIMES:
        times.append(stroma("run", *arguments, "--output", folder, "--overwrite"))
    return [statistics.median(each) for each in zip(*times)]


def distance(problem, run, reference):
    """Relative difference of two runs: L2 of the problem's field, or of its result."""
    if problem.result:
        mine, right = (read(each, "summary.json")["results"][problem.result] for each in (run, reference))
        return abs(mine / right - 1)
    out = run + " compared"
    stroma("compare", run, reference, "--points", "grid", "--grid", *problem.grid, "--fields", problem.field, "--quiet", "--output", out)
    return read(out, "compare.json")["fields"][-1]["regions"][0]["L2"]["relative"]


def own_error(away):
    """Error of a reference that the next coarser run is away[0] from, and one twice as coarse away[1]: by extrapolation with their order,
    of no more than two. From one run alone, or without an order to be seen, what the furthest is off."""
    if len(away) < 2 or away[1] < 2.2 * away[0]:
        return max(away, default=0.)
    return away[0] / min(away[1] / away[0] - 2, 3.)


def measure(problem, folder):
    """The runs of the study of a problem, each with its error and times, how far coarser runs are from the reference, and its own error."""
    file, study = os.path.join(PARAMETERS, problem.study), os.path.join(folder, "study")
    stroma("study", file, *settings((*problem.sets, "Study/Repeat = 1")), "--output", study)
    reference = os.path.join(study, "reference")
    if problem.reference:
        stroma("run", file, *settings((*problem.sets, *problem.reference)), "--output", reference)
    away = []
    for i, entries in enumerate(problem.coarser):
        coarser = os.path.join(folder, f"coarser{i}")
        stroma("run", file, *settings((*problem.sets, *entries, "Output/Keep states = true")), "--output", coarser)
        away.append(distance(problem, coarser, reference))
    runs = read(study, "study.json")["runs"]
    for i, run in enumerate(runs):
        if problem.reference:
            run["error"] = distance(problem, os.path.join(study, run["folder"]), reference)
        run["wall_time_s"], run["processor_s"] = timed([os.path.join(study, run["folder"], "parameters.prm")], os.path.join(folder, f"again{i}"))
    return runs, away, own_error(away)


def has_error(run):
    return run["status"] == "finished" and run.get("error") is not None


def method(run):
    return run["case"].split()[0]


def beaten(problem, runs, start):
    """Lines on runs of defaults that another setting of the same method beats in error and in processor time, both without the program's @p start."""
    good = list(filter(has_error, runs))
    net = {id(run): max(run["processor_s"] - start, LEAST) for run in good}
    for run in good:
        for other in good:
            if (run["case"] in problem.defaults and other["case"] != run["case"] and method(other) == method(run) and
                    net[id(run)] > MUCH * net[id(other)] and run["error"] > MUCH * other["error"]):
                yield (f"{run['case']} ({run['axis_value']}) is beaten by {other['case']} ({other['axis_value']}): "
                       f"{run['error']:.1e} in {run['processor_s']:.2g} s, {other['error']:.1e} in {other['processor_s']:.2g} s")


def cheapest(runs, wanted):
    """The run of an error of no more than @p wanted that takes least processor time, or None."""
    enough = [run for run in filter(has_error, runs) if run["error"] <= wanted]
    return min(enough, key=lambda run: run["processor_s"], default=None)


def row(run):
    summary = run["summary"]
    numbers = [str(summary[key]) for key in ("n_dofs", "n_steps", "newton_iterations", "linear_iterations")]
    error = f"{run['error']:.1e}" if has_error(run) else ""
    order = "" if run.get("order") is None else f"{run['order']:.1f}"
    return [run["case"], run["axis_value"] or "", error, order, f"{run['wall_time_s']:.2f}", f"{run['processor_s']:.2f}", *numbers, run["status"]]


def about_reference(problem, runs, away, own):
    """What errors are taken against, and how good that is."""
    if not problem.coarser:
        return "the exact solution"
    far = ", ".join(f"{value:.1e} ({'; '.join(entries)})" for value, entries in zip(away, problem.coarser))
    return f"a finer run. Runs coarser than that are off it by {far}: its own error is about {own:.1e}" + (
        "" if is_fine(runs, own) else f", **more than a tenth of the smallest error here ({least(runs):.1e})**")


def least(runs):
    return min((run["error"] for run in filter(has_error, runs)), default=math.nan)


def is_fine(runs, own):
    return own <= .1 * least(runs)


def chapter(problem, runs, away, own, start):
    """What the page says of a problem."""
    worse = list(beaten(problem, runs, start))
    quantity = problem.result or f"L2 of {problem.field}"
    best = [[f"{wanted:g}", run["case"], run["axis_value"], f"{run['error']:.1e}", f"{run['processor_s']:.2f}"]
            for wanted in WANTED for run in [cheapest(runs, wanted)] if run]
    return f"""
## {problem.title}
`parameters/{problem.study}`{''.join(f', `{entry}`' for entry in problem.sets)}. Relative errors in {quantity}, against {about_reference(problem, runs, away, own)}.

![error against processor time](work_{problem.name}.png)

{problem.why}

""" + page.table(["case", "resolution", "error", "order", "wall s", "processor s", "unknowns", "steps", "Newton", "linear", "status"], map(row, runs)) + """
Least processor time for an error:

""" + page.table(["error", "case", "resolution", "has", "processor s"], best) + "\n" + (
        "\n".join(f"- {line}" for line in worse) if worse else f"No default ({', '.join(problem.defaults)}) is beaten by {MUCH} in time (without the start) and error "
        "by another setting of its method.") + "\n"


def winners(problems, measured):
    """The table of the cheapest case of each problem by the error asked for."""
    rows = []
    for problem in filter(lambda each: each.name in measured, problems):
        best = [cheapest(measured[problem.name][0], wanted) for wanted in WANTED]
        rows.append([problem.title, *(f"{run['case']} ({run['processor_s']:.1f} s)" if run else "" for run in best)])
    return page.table(["least processor time for an error of", *(f"{wanted:g}" for wanted in WANTED)], rows)


def write_page(measured, chapters, start):
    import work_plot  # pylint: disable=import-outside-toplevel  # needs numpy, which the other commands do not
    page.write("work_precision.md", page.heading("Error against run time", "work-precision") + f"""
{len(measured)} of {len(PROBLEMS)} problems. Times are of whole runs on one core with the program's start ({start:.2f} s of processor time): medians of {TIMES} runs where one takes less than {SHORT:g} s. A
busy machine changes processor time little, and work (steps, Newton and linear iterations) not at all.

""" + winners(PROBLEMS, measured) + chapters)
    for problem in filter(lambda each: each.name in measured, PROBLEMS):
        runs, _, own = measured[problem.name]
        work_plot.draw(problem, list(filter(has_error, runs)), own, os.path.join(ROOT, "documentation", "evidence", f"work_{problem.name}.png"))


def judged(problem, runs, own, start):
    """Lines on what a problem must show and does not."""
    yield from (f"{problem.name}: {line}" for line in beaten(problem, runs, start))
    yield from (f"{problem.name}: {run['case']} ({run['axis_value']}) ended as {run['status']}" for run in runs if not has_error(run))
    if not is_fine(runs, own):
        yield f"{problem.name}: the reference's own error is {own:.1e}, more than a tenth of the smallest error {least(runs):.1e}"


def main(arguments):
    parser = argparse.ArgumentParser(prog="contrib/evidence work-precision", description=__doc__)
    parser.add_argument("--only", action="append", metavar="PROBLEM", choices=[problem.name for problem in PROBLEMS],
                        help="problems by their names; prints, writes no page")
    parser.add_argument("--log", metavar="FILE", help="keeps what was measured and takes what it holds; a run that was stopped goes on")
    chosen = parser.parse_args(arguments)
    measured = read(chosen.log) if chosen.log and os.path.exists(chosen.log) else {}
    start = statistics.median(stroma("--version")[1] for _ in range(TIMES))
    chapters, faults = "", []
    for problem in PROBLEMS:
        if chosen.only and problem.name not in chosen.only:
            continue
        if problem.name not in measured:
            with tempfile.TemporaryDirectory() as folder:
                measured[problem.name] = measure(problem, folder)
        if chosen.log:
            with open(chosen.log, "w", encoding="utf-8") as file:
                json.dump(measured, file)
        runs, away, own = measured[problem.name]
        part = chapter(problem, runs, away, own, start)
        print(part, flush=True)
        chapters += part
        faults += judged(problem, runs, own, start)
    if not chosen.only:
        write_page(measured, chapters, start)
    print("\n".join(faults))
    return 1 if faults else 0
