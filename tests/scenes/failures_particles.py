"""Loads and motions that particles cannot follow: the step is cut, and then the run ends with exit code 2, one line on standard
error, and its last good state: finite, the last row of series.csv, written as fields, and in a checkpoint from which
--resume goes on, to fail again soon. On 1 and on 2 ranks. A load that all particles have left is said, and the run goes on.
"""
import csv
import glob
import math
import os
import re

from program import Folder, HERE, check, settings, summary
from server import run

BLOCK = os.path.join(HERE, "particles.prm")
DROP = os.path.join(HERE, "drop.prm")
COARSE = ["NSPH/Spacing=0.1", "SPH/Spacing=0.1", "Time/Smallest step=1/256"]
PUSH = ["Loads/push/Force density=1e4*t; 0"]  # a hundred thousand times that of the scene
SQUEEZE = ["Supports/top/Displacement=0; -1.5*t"]  # to less than nothing
SLAM = ["Supports/top/Displacement=0; -20*t"]
MORRIS = ["Materials/gel/Viscous operator=morris", "Materials/stiff/Viscous operator=morris", "Time/Initial step=1/64",
          "Time/Largest step=1/64"]
LIQUID = ["Method=sph", "Materials/liquid/Density=1", "Materials/liquid/Viscous operator=morris", "Time/Smallest step=1e-3",
          "Loads/squeeze/Where=all"]
TOO_FAR = "a particle would move by more than a fifth of the spacing, or be strained by more than a fifth, in one step"
CRUSHED = "a particle would be pressed to less than a tenth of its volume"
APART = ("a solid is stretched by more than its particles can follow (1.6 to 2 times): rows of them have gathered in pairs, with gaps "
         "between; use 'Method = mpm' or 'fem', or end the run earlier")
LOST = (TOO_FAR, CRUSHED, APART, "a value was not finite")

# Name -> (scene, entries, what may be said of the last cut).
SCENES = {
    "NSPH, pushed": (BLOCK, COARSE + PUSH, (TOO_FAR,)),
    "NSPH explicit, pushed": (BLOCK, COARSE + MORRIS + PUSH + ["NSPH/Stress update=explicit"], (TOO_FAR,)),
    "NSPH, squeezed flat": (BLOCK, COARSE + SQUEEZE, (TOO_FAR, CRUSHED, APART)),
    "SPH, pushed": (BLOCK, COARSE + ["Method=sph", "Loads/push/Force density=1e6*t; 0"], LOST),
    "SPH, slammed": (BLOCK, COARSE + SLAM + ["Method=sph"], LOST),
    "SPH, drop squeezed": (DROP, LIQUID + ["Loads/squeeze/Force density=-1e5*x*t; 0"], LOST),
}
LARGEST = 1e3  # of displacement and speed: sizes are of 1 m, times of .01 s and more; more is no good state


def last_row(folder):
    with open(os.path.join(folder, "series.csv")) as file:
        return {name: float(value) for name, value in list(csv.DictReader(file))[-1].items()}


def check_state(name, folder, result):
    """The last good state of a failed run. Returns its time."""
    row, results = last_row(folder), result["results"]
    for table, of in ((row, "series.csv"), (results, "summary.json")):
        for key, value in table.items():
            check(value is not None and math.isfinite(value), f"{name}: {key} of {of} is {value} in the last good state")
            if key.startswith("max_displacement") or key.startswith("max_speed"):
                check(value < LARGEST, f"{name}: {key} of {of} is {value} in the last good state")
    check(results["end_time_s"] == row["time_s"], f"{name}: summary ends at {results['end_time_s']}, series at {row['time_s']}")
    for key in ("reaction_bottom_x_N", "strain_energy_J", "max_displacement_m", "max_speed_m_per_s"):
        if key in row and key in results:
            check(row[key] == results[key], f"{name}: {key} is {results[key]} in summary.json and {row[key]} in series.csv")
    record = open(os.path.join(folder, "points.pvd")).read()
    times = [float(t) for t in re.findall(r'timestep="([^"]*)"', record)]
    check(times and abs(times[-1] - row["time_s"]) <= 1e-9 * row["time_s"], f"{name}: fields of {times}, failed at {row['time_s']}")
    saved = glob.glob(os.path.join(folder, f"checkpoint_{result['n_steps']}.h5"))
    check(len(saved) == 1, f"{name}: no checkpoint of step {result['n_steps']}")
    return row["time_s"]


def check_failure(name, arguments, ranks, said):
    done = run(arguments, ranks, expect=2)
    lines = [line for line in done.stderr.splitlines() if line.startswith("stroma:")]
    folder = arguments[arguments.index("--output") + 1]
    wanted = (r"stroma: warning: failed: (.*) in the step from t = \S+ to \S+ s; the last good state is saved in "
              + re.escape(folder))
    match = re.fullmatch(wanted, lines[0]) if len(lines) == 1 else None
    check(match and match[1] in said, f"{name} on {ranks} ranks said {lines}")
    result = summary(folder)
    check(result["status"].startswith("failed: "), f"{name}: status {result['status']}")
    return result, done.stdout


with Folder() as folder:
    for name, (scene, entries, said) in SCENES.items():
        ends = []
        for ranks in (1, 2):
            output = os.path.join(folder, f"{len(os.listdir(folder))}")
            arguments = ["run", scene, "--output", output] + settings(entries)
            result, _ = check_failure(name, arguments, ranks, said)
            ends.append(check_state(f"{name} on {ranks} ranks", output, result))
            # The half step that was not tried any more is what a resumed run starts with.
            again, told = check_failure(name + ", resumed", arguments + ["--resume"], ranks, said)
            steps = "1 step" if result["n_steps"] == 1 else f"{result['n_steps']} steps"
            check(f"after {steps}\n" in told, f"{name}, resumed, continues elsewhere: {told[:1000]}")
            end = check_state(f"{name} on {ranks} ranks, resumed", output, again)
            check(ends[-1] <= end < 1.5 * ends[-1], f"{name} on {ranks} ranks fails at {ends[-1]} s, resumed at {end} s")
        check(abs(ends[0] - ends[1]) <= .05 * ends[0], f"{name}: fails at {ends[0]} s on one rank, at {ends[1]} s on two")
        print(f"{name}: last good state at {ends[0]:.4g} s")
    # A drop that flies out of where it is pulled.
    flies = ["Loads/pull/Where=box -1, -1 : 1, 1", "Loads/pull/Total force=1e-3; 0", "Bodies/drop/Initial velocity=20; 0", "Time/End=0.11"]
    said = run(["run", DROP, "--output", os.path.join(folder, "flies")] + settings(LIQUID[:-1] + flies), 2).stderr
    check(said.count("no particle is left where load 'pull' acts, and its total force acts on nothing") == 1,
          f"a drop that left its load: {said}")
