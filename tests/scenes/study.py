"""`stroma study` with errors: orders of convergence, a study that is killed and resumed, ranks, several runs at once, a
reference run and a stored reference; bad input with the exact line."""
import csv
import json
import os
import signal
import subprocess
import time

from program import Folder, HERE, check, command, manufactured, settings
from server import run

STUDY = """
subsection Study
  set Results      = displacement_error_L2_relative
  set Repeat       = 2
  subsection Cases
    subsection one point
      set Set = MPM/Points per cell = 1, 1
    end
    subsection four points
      set Set = MPM/Points per cell = 2, 2
    end
  end
  subsection resolution
    set Parameter = Constants/cells
    set Values    = 4, 8, 16
  end
  subsection Error
    set Against = exact
    set Fields  = displacement_m
    set Norm    = L2
  end
end
"""
OF_TIME = ("wall_time_s", "spread_s", "cpu_time_s", "peak_memory_MB")


def table(folder):
    """study.csv without the columns that hold times."""
    with open(os.path.join(folder, "study.csv")) as file:
        return [{name: value for name, value in row.items() if name not in OF_TIME} for row in csv.DictReader(file)]


def kill_when(arguments, done):
    """Kills (SIGKILL) the study once done() is true."""
    process = subprocess.Popen(command(arguments), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                               start_new_session=True)
    deadline = time.time() + 300
    while process.poll() is None and time.time() < deadline and not done():
        time.sleep(.002)
    check(process.poll() is None, "the study ended before it could be killed")
    os.killpg(process.pid, signal.SIGKILL)
    process.wait()


with Folder() as folder:
    path = lambda name: os.path.join(folder, name)  # noqa: E731
    scene = manufactured(folder, STUDY)
    base = ["study", scene, "--quiet"]

    # Orders, and the errors that the runs report themselves.
    whole = path("whole")
    run(base + ["--output", whole])
    rows = table(whole)
    check(len(rows) == 6 and all(row["times"] == "2" and row["status"] == "finished" for row in rows), f"table {rows}")
    for row in rows:
        check(abs(float(row["error"]) / float(row["displacement_error_L2_relative"]) - 1) < 1e-3, f"error in {row}")
    for case in ("one point", "four points"):
        orders = [row["order"] for row in rows if row["case"] == case]
        print(case, "orders", orders)
        check(orders[0] == "-" and abs(float(orders[-1]) - 2) < .15, f"orders {orders} of {case}")
    with open(os.path.join(whole, "study.json")) as file:
        runs = json.load(file)["runs"]
    check(runs[0]["curve"] == "one point" and runs[2]["axis_number"] == 16 and len(runs[0]["wall_times_s"]) == 2,
          "study.json")
    check(os.path.exists(os.path.join(whole, "study.txt")), "no study.txt")
    with open(os.path.join(whole, "study.csv")) as file:
        costs = [(float(row["cpu_time_s"]), float(row["peak_memory_MB"])) for row in csv.DictReader(file)]
    check(all(0 < seconds < 100 and 10 < megabytes < 2000 for seconds, megabytes in costs), f"CPU time and memory {costs}")
    check([1e-6 * one["peak_memory_bytes"] for one in runs] == [one["summary"]["peak_memory_bytes"] * 1e-6 for one in runs],
          "memory of the runs' summaries")
    pictures = subprocess.run(["/usr/bin/python3", "-c", "import numpy, matplotlib"], capture_output=True).returncode == 0
    check(not pictures or os.path.getsize(os.path.join(whole, "study.png")) > 10000, "no picture")

    # Killed at any place: within a run, between repetitions; the resumed table is the same.
    records = lambda output: sum("study_run.json" in files for _, _, files in os.walk(output))  # noqa: E731
    for number, stop in enumerate((
            lambda output: records(output) == 2,
            lambda output: os.path.exists(os.path.join(output, "one_point,cells=16", "series.csv")),
            lambda output: os.path.exists(os.path.join(output, "four_points,cells=8", "again")))):
        killed = path(f"killed-{number}")
        kill_when(base + ["--output", killed], lambda: stop(killed))
        check(records(killed) < 6, "all runs had ended")
        print("killed", number)
        kept = os.path.join(killed, "one_point,cells=4", "summary.json")
        before = os.stat(kept).st_mtime_ns
        run(base + ["--output", killed, "--resume"])
        check(table(killed) == rows, f"after resuming: {table(killed)}\ninstead of {rows}")
        check(os.stat(kept).st_mtime_ns == before, "a run that had ended was done again")

    # A resumed study does runs again whose parameters have changed, and only them.
    run(base + ["--output", whole, "--resume"] + settings(["Study/resolution/Values=4, 8"]))
    check(table(whole) == [row for row in rows if row["cells"] != "16"], "fewer values")
    run(base + ["--output", whole, "--resume"] + settings(["Constants/a=0.02"]))
    check(all(a["error"] != b["error"] for a, b in zip(table(whole), rows)), "other parameters, old results")

    # Ranks and runs at once do not matter.
    for name, ranks, more in (("three", 3, []), ("at-once", 2, ["--at-once", "2"])):
        run(base + ["--output", path(name)] + more, ranks)
        for a, b in zip(table(path(name)), rows):
            check(a["case"] == b["case"] and a["cells"] == b["cells"] and
                  abs(float(a["error"]) / float(b["error"]) - 1) < 1e-3, f"{name}: {a} instead of {b}")
    with open(os.path.join(path("at-once"), "study.json")) as file:
        check(json.load(file)["at_once"] == 2, "at_once in study.json")

    # Against a run of its own, and against the same stored.
    entries = settings(["Study/Error/Against=reference", "Study/Reference/Set=Constants/cells = 32", "Study/Repeat=1",
                        "Study/Error/Points=grid", "Study/Error/Grid=24, 24"])
    run(base + ["--output", path("reference")] + entries)
    errors = [float(row["error"]) for row in table(path("reference"))]
    print("against 32 cells:", " ".join(f"{e:.2e}" for e in errors))
    check(all(b < .35 * a for a, b in ((errors[0], errors[1]), (errors[3], errors[4]))), f"errors {errors}")
    again = settings(["Study/Error/Against=" + os.path.join(path("reference"), "reference"), "Study/Repeat=1",
                      "Study/Error/Points=grid", "Study/Error/Grid=24, 24"])
    run(base + ["--output", path("against")] + again)
    check([row["error"] for row in table(path("against"))] == [row["error"] for row in table(path("reference"))],
          "errors against the same run")

    # A second study in the same folder is refused before anything is touched; --overwrite replaces it.
    before = {name: os.stat(os.path.join(path("reference"), name)).st_mtime_ns for name in os.listdir(path("reference"))}
    kept = os.path.join(path("reference"), "reference", "study_run.json")
    done = run(base + ["--output", path("reference")] + entries, expect=1)
    check("holds results" in done.stderr and os.path.exists(kept), done.stderr)
    check(before == {name: os.stat(os.path.join(path("reference"), name)).st_mtime_ns for name in os.listdir(path("reference"))},
          "a refused study changed its folder")
    run(base + ["--output", path("reference"), "--overwrite"] + entries +
        settings(["Loads/source/Where=box 9, 9 : 10, 10"]), expect=1)
    check(os.path.exists(kept), "an unusable study removed a record")

    # Nothing is written or removed outside the folder, whatever a case is called.
    outside = path("outside")
    os.makedirs(os.path.join(outside, "states"))
    with open(os.path.join(outside, "states", "state_00000001.h5"), "w") as file:
        file.write("mine")
    dots = path("dots.prm")
    with open(scene) as file, open(dots, "w") as copy:
        copy.write(file.read().replace("one point", "..").replace("set Values    = 4, 8, 16", "set Values = 4\n    set Only = four points"))
    done = run(["study", dots, "--quiet", "--output", os.path.join(outside, "out")], expect=1)
    check(len(done.stderr.splitlines()) == 1 and "'..'" in done.stderr, done.stderr)
    check(os.listdir(outside) == ["states"] and os.listdir(os.path.join(outside, "states")) == ["state_00000001.h5"],
          f"outside holds {os.listdir(outside)}")

    # What is no number, but grows by a factor, has an order too.
    run(base + ["--output", path("factor")] + settings(["Study/resolution/Parameter=MPM/Cells", "Study/Repeat=1",
                                                        "Study/resolution/Values=(4, 8), (8, 16)"]))
    orders = [row["order"] for row in table(path("factor"))]
    check(orders[0] == orders[2] == "-" and all(1.5 < float(order) < 2.5 for order in orders[1::2]), f"orders {orders}")

    # Several numbers are one value in parentheses; fields need no unit; a run that fails is counted and has no results.
    vectors = settings(["Study/resolution/Parameter=MPM/Cells", "Study/resolution/Values=(4, 4), (8, 8)", "Study/Repeat=1",
                        "Study/Error/Fields=displacement", "Study/Results=strain_energy_J"])
    run(base + ["--output", path("vectors")] + vectors)
    for a, b in zip(table(path("vectors")), [row for row in rows if row["cells"] != "16"]):
        check(a["error"] == b["error"] and a["order"] == b["order"], f"{a} instead of {b}")
    done = run(base + ["--output", path("failing")] + vectors + settings(["Study/resolution/Parameter=Newton/Maximum iterations",
                                                                          "Study/resolution/Values=1, 30",
                                                                          "Time/Smallest step=0.1"]), expect=2)
    check("2 of 4 runs failed; they have no results in the table" in done.stderr, done.stderr)
    check([(row["status"], row["strain_energy_J"] == "-") for row in table(path("failing"))] ==
          [("failed", True), ("finished", False)] * 2, f"{table(path('failing'))}")

    # A result that no run has is told after the first run, with those that there are; with the right name the study goes on.
    done = run(base + ["--output", path("misspelt")] + vectors + settings(["Study/Results=strain_energ_J"]), expect=1)
    said = done.stderr.splitlines()
    check(len(said) == 1 and said[0].startswith("stroma: --set Study/Results=strain_energ_J: 'Results' names 'strain_energ_J', which no run "
                                                "has; its results are: strain_energy_J, "), said)
    check(len(table(path("misspelt"))) == 1, "rows of a study that misses a result")
    first = os.path.join(path("misspelt"), "one_point,Cells=4,_4", "summary.json")
    before = os.stat(first).st_mtime_ns
    run(base + ["--output", path("misspelt"), "--resume"] + vectors)
    check(table(path("misspelt")) == table(path("vectors")) and os.stat(first).st_mtime_ns == before, "the study did not go on")

    # Bad input.
    with open(scene) as file:
        lines = file.readlines()
    place = 1 + next(n for n, line in enumerate(lines) if line.startswith("subsection Study"))
    first_case = 1 + next(n for n, line in enumerate(lines) if "Points per cell = 1, 1" in line)
    bad = [
        (["--at-once", "2"], 1, "--at-once 2: the program runs on 1 rank; give 1 to 1, or start with mpirun -np 2"),
        (settings(["Study/resolution/Values=4, many"]), 1,
         f"--set Study/resolution/Values=4, many: --set Constants/cells=many: 'cells' was given as 'many': 'many' is not known "
         "here; it must be a number in (-inf, inf), or an expression of the names in section Constants"),
        (settings(["Study/resolution/Parameter=Constants/cels"]), 1,
         f"{scene}:{first_case}: --set Constants/cels=4: no entry uses the constant 'cels'; those in use are: a, mu, kappa, sx, sy, cells"),
        (settings(["Study/Error/Norm=L3"]), 2,
         "--set Study/Error/Norm=L3: 'Norm' was given as 'L3'; it must be one of: L2, H1, max"),
        (settings(["Study/Error/Against=reference"]), 2,
         f"{scene}:{place}: 'Against = reference' needs a section Reference; say there by 'Set' how the reference differs from the "
         "scene"),
        (["--resume"], 1, f"--output {path('bad')}: there is no such folder to resume; run without --resume"),
        (settings(["Study/Error/Fields=displacement_m, von_mises_Pa"]), 1,
         "the exact solution has no field 'von_mises_Pa'; both have: displacement_m"),
    ]
    for arguments, ranks, wanted in bad:
        done = run(base + ["--output", path("bad")] + arguments, ranks, expect=1)
        said = [one for one in done.stderr.splitlines() if one.startswith("stroma:")]
        check(said == ["stroma: " + wanted], f"said {said}\nwanted stroma: {wanted}")
        if ranks == 1 and arguments[0] == "--set" and "Error" not in arguments[1]:  # `check` reads all runs, too
            told = run(["check", scene] + arguments, expect=1).stderr
            check(told == "stroma: " + wanted + "\n", f"check said {told}")
