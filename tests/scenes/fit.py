"""`stroma fit`: constants found again from forces that known ones made, in other units and with noise; data that cannot tell
them apart; a fit that is killed and resumed, and on two ranks; bad input with the exact line."""
import csv
import itertools
import json
import os
import shutil
import signal
import subprocess
import time

from program import Folder, HERE, check, command, settings
from server import run

SCENE = os.path.join(HERE, "fit.prm")
TRUE = {"soft": 1000., "stiff": 4000.}
BESIDE = "Bodies/lower/Upper corner = 0.5, 2, Bodies/upper/Lower corner = 0.5, 0"
NUMBERS = itertools.count()  # of output folders
NOISE = (.011, -.014, .006, -.004)  # of the largest force

FIT = """
subsection Fit
  subsection Parameters
{parameters}  end
  subsection Data
    subsection stacked
      set File     = {stacked}
      set Against  = strain_y
      set Quantity = reaction_force_y_N
    end
{more}  end
end
"""
SECOND = f"""    subsection side_by_side
      set File     = {{beside}}
      set Quantity = reaction_force_y_N
      set Set      = {BESIDE}
    end
"""
BOTH = "".join(f"    subsection {name}\n      set Lower = 100\n      set Upper = 50000\n    end\n" for name in TRUE)


def forces(folder, name, entries):
    """Strain, time and force of a run of the scene with the true constants, but for the start at rest."""
    output = os.path.join(folder, name)
    run(["run", SCENE, "--output", output, "--quiet"] + settings([f"Constants/{k}={v}" for k, v in TRUE.items()] + entries))
    with open(os.path.join(output, "series.csv")) as file:
        return [[float(row[c]) for c in ("strain_y", "time_s", "reaction_force_y_N")] for row in csv.DictReader(file)][1:]


def write(path, text):
    with open(path, "w") as file:
        file.write(text)
    return path


def fit_scene(path, parameters, more="", **files):
    with open(SCENE) as file:
        scene = file.read()
    return write(path, scene + FIT.format(parameters=parameters, more=more.format(**files), **files))


def fitted(output):
    with open(os.path.join(output, "fit.json")) as file:
        return json.load(file)


def refused(scene, entries, line, output):
    done = run(["fit", scene, "--output", f"{output}{next(NUMBERS)}", "--quiet"] + settings(entries), expect=1)
    check(done.stderr.strip() == "stroma: " + line, f"said: {done.stderr.strip()}\n  wanted: stroma: {line}")


with Folder() as folder:
    path = lambda name: os.path.join(folder, name)  # noqa: E731
    stacked, beside = forces(folder, "a", []), forces(folder, "b", BESIDE.replace(", Bodies", "|Bodies").split("|"))
    # In nN against strain, and in mN against minutes.
    files = {"stacked": write(path("stacked.csv"), "# a comment\nstrain_y,reaction_force_y_nN\n" +
                              "".join(f"{x:.12g},{1e9 * f:.12g}\n" for x, _, f in stacked)),
             "beside": write(path("beside.csv"), "reaction_force_y_mN,other,time_min\n\n" +
                             "".join(f"{1e3 * f:.12g},7,{t / 60:.12g}\n" for _, t, f in beside))}
    scene = fit_scene(path("both.prm"), BOTH, SECOND, **files)

    whole = path("whole")
    run(["fit", scene, "--output", whole, "--quiet"])
    result = fitted(whole)
    for one in result["parameters"]:
        print(f"{one['name']} = {one['value']}, {result['n_runs']} runs")
        check(abs(one["value"] / TRUE[one["name"]] - 1) < 1e-4, f"{one['name']} is {one['value']}")
    check(result["converged"] and not result["warnings"], f"warnings {result['warnings']}")
    pictures = subprocess.run(["/usr/bin/python3", "-c", "import numpy, matplotlib"], capture_output=True).returncode == 0
    check(not pictures or os.path.getsize(os.path.join(whole, "fit.png")) > 10000, "no picture")
    check(len(list(csv.reader(open(os.path.join(whole, "fit.csv"))))) == 9, "fit.csv")

    # Killed and resumed: the same to the last digit, and what had ended was kept.
    killed = path("killed")
    process = subprocess.Popen(command(["fit", scene, "--output", killed, "--quiet"]), start_new_session=True,
                               stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    while process.poll() is None and not os.path.exists(os.path.join(killed, "002,soft,stacked", "study_run.json")):
        time.sleep(.002)
    check(process.poll() is None, "the fit ended before it could be killed")
    os.killpg(process.pid, signal.SIGKILL)
    process.wait()
    first = os.path.getmtime(os.path.join(killed, "001,stacked", "study_run.json")) \
        if os.path.exists(os.path.join(killed, "001,stacked")) else None
    check(first is not None, f"no run 001 in {os.listdir(killed)}")
    run(["fit", scene, "--output", killed, "--quiet", "--resume"])
    check(fitted(killed) == result, "a resumed fit differs")
    check(os.path.getmtime(os.path.join(killed, "001,stacked", "study_run.json")) == first, "a run was done again")
    run(["fit", scene, "--output", killed], expect=1)  # not written over

    # Written over: nothing is left of runs that this fit has not.
    older = os.path.join(killed, "917,soft,stacked")
    shutil.copytree(os.path.join(killed, "001,stacked"), older)
    kept = os.path.join(killed, "notes")
    os.mkdir(kept)
    run(["fit", scene, "--output", killed, "--quiet", "--overwrite"])
    check(fitted(killed) == result and not os.path.exists(older) and os.path.exists(kept), "folders of an older fit are left")

    # Two ranks, which share the runs.
    run(["fit", scene, "--output", path("ranks"), "--quiet"], ranks=2)
    for one, other in zip(result["parameters"], fitted(path("ranks"))["parameters"]):
        check(abs(one["value"] / other["value"] - 1) < 1e-5, f"{one['name']} depends on the ranks")

    # Noise: the interval holds the truth, and is as wide as the noise makes it: s/(sum of squares of the forces over the largest).
    noisy = [(x, f + n * stacked[-1][2]) for (x, _, f), n in zip(stacked, NOISE)]
    one = fit_scene(path("one.prm"), BOTH[:BOTH.index("    subsection stiff")], stacked=write(
        path("noisy.csv"), "strain_y,reaction_force_y_N\n" + "".join(f"{x:.12g},{f:.12g}\n" for x, f in noisy)))
    run(["fit", one, "--output", path("one"), "--quiet"] + settings([f"Constants/stiff={TRUE['stiff']}"]))
    found, noise = fitted(path("one"))["parameters"][0], fitted(path("one"))["noise"]
    low, high = found["confidence_95"]
    print(f"with noise: {found['value']:.1f}, from {low:.1f} to {high:.1f}; noise {noise:.4f}")
    check(low < TRUE["soft"] < high and .005 < noise < .02, f"interval {low} to {high}, noise {noise}")

    # Layers in series: the force tells one modulus only.
    alike = fit_scene(path("alike.prm"), BOTH, **files)
    done = run(["fit", alike, "--output", path("alike")])
    check("cannot tell 'soft' and 'stiff' apart" in done.stdout + done.stderr, "no warning of alike constants")

    # The strain that runs reach falls with the constant: on one side of the start they end before the data.
    short = fit_scene(path("short.prm"), BOTH[:BOTH.index("    subsection stiff")], **files)
    run(["fit", short, "--output", path("short"), "--quiet"] +
        settings([f"Constants/stiff={TRUE['stiff']}", "Supports/top/Displacement=free; 0.1*y*t*1500/soft"]))
    found = fitted(path("short"))
    print(f"runs that do not reach the data: {found['parameters'][0]['value']:.2f}, {found['warnings']}")
    check(abs(found["parameters"][0]["value"] / TRUE["soft"] - 1) < 1e-2, "the value from runs of other lengths")
    check(any("do not reach all data" in warning for warning in found["warnings"]), "no warning of runs that are too short")

    # A start at which the force is 1e-5 of what was measured is far off, but the force depends on the constant.
    run(["fit", short, "--output", path("far"), "--quiet"] +
        settings([f"Constants/stiff={TRUE['stiff']}", "Fit/Parameters/soft/Lower=1e-3", "Fit/Parameters/soft/Start=1e-2"]))
    far = fitted(path("far"))["parameters"][0]["value"]
    print(f"from a start far below: {far:.2f}")
    check(abs(far / TRUE["soft"] - 1) < 1e-3, "the value from a start far below")

    # Bad input.
    out = path("bad")
    at = lambda file, text: 1 + next(i for i, line in enumerate(open(file)) if text in line)  # noqa: E731
    refused(scene, ["Fit/Parameters/soft/Upper=1200"],
            "--set Fit/Parameters/soft/Upper=1200: the start of 'soft', 1500, is not between 100 ('Lower') and 1200 "
            "('Upper'); widen the bounds, or give 'Start'", out)
    refused(scene, ["Fit/Parameters/soft/Lower=-1"],
            "--set Fit/Parameters/soft/Lower=-1: 'Lower' was given as -1; on a logarithmic scale it must be positive; raise it, "
            "or set 'Scale = linear'", out)
    refused(scene, ["Fit/Parameters/soften/Lower=1"],
            "--set Fit/Parameters/soften/Lower=1: 'soften' is no constant of section Constants, which has: idle, soft, stiff; "
            "name there what is to be fitted, and use the name where it acts", out)
    refused(scene, ["Fit/Parameters/idle/Lower=.1", "Fit/Parameters/idle/Upper=10"],
            "--set Fit/Parameters/idle/Lower=.1: nothing in the file depends on the constant 'idle'; use it in an entry, or do not "
            "fit it", out)
    refused(scene, ["Fit/Data/stacked/Set=Constants/sofft=2"],
            "--set Constants/sofft=2: no entry uses the constant 'sofft'; those in use are: soft, stiff", out)
    refused(one, ["Constants/idle=2", "Fit/Parameters/idle/Lower=.1", "Fit/Parameters/idle/Upper=10", "Title=idle"],
            "--set Fit/Parameters/idle/Lower=.1: none of the measured values depends on 'idle' at the start; do not fit it, or measure something else", out)
    columns = " (or with MN, kN, mN, nN, uN for N); the first line of the file must name it, and has: strain_y, reaction_force_y_nN"
    refused(scene, ["Fit/Data/stacked/Quantity=reaction_top_x_N"],
            f"{files['stacked']}:2: no column is called 'reaction_top_x_N'{columns}", out)

    def with_data(text, line, entries=()):
        refused(scene, [f"Fit/Data/stacked/File={write(path('bad.csv'), text)}", *entries], path("bad.csv") + line, out)

    with_data("strain_y,reaction_force_y_lb\n.1,2\n",
              ":1: no column is called 'reaction_force_y_N' (or with MN, kN, mN, nN, uN for N); the first line of the file must name "
              "it, and has: strain_y, reaction_force_y_lb")
    with_data("strain_y,reaction_force_y_N\n.01,2\n.03,3\n.02,4\n",
              ":4: 'strain_y' goes back or stays; sort the lines by it, and average what was measured several times")
    with_data("strain_y,reaction_force_y_N\n0,05,2,1\n", ":2: the line has 4 numbers, the first line names 2 columns; decimals are "
              "written with a point")
    with_data("strain_y,reaction_force_y_N\n.01,soft\n", ":2: 'soft' in column 2 is no number")
    with_data("strain_y,reaction_force_y_N\n", ": the file holds no row of numbers below the names of its columns")
    with_data("strain_y,reaction_force_y_N\n.01,2\n.2,3\n", ":3: 'strain_y' is 0.2 here, but goes from 0 to 0.1 in the run; let the "
              "scene go farther, or leave the line out")
    with_data("strain_y,reaction_force_y_N\n-.01,2\n.1,3\n", ":2: 'strain_y' is -0.01 here, but goes from 0 to 0.1 in the run; the "
              "data lie before its first row: check their sign and column, or leave the line out")
    refused(scene, ["Fit/Data/stacked/File=none.csv"],
            "none.csv: there is no such file, here or beside the parameter file; correct 'File'", out)
    few = fit_scene(path("few.prm"), BOTH, stacked=write(path("few.csv"), "strain_y,reaction_force_y_N\n.1,2\n"))
    refused(few, [], f"{few}:{at(few, 'subsection Data')}: 1 measured value cannot tell 2 parameters apart; give more data, or fit fewer",
            out)
    run(["check", scene])  # reads the data too
    check("idle" in run(["check", scene] + settings(["Fit/Parameters/idle/Lower=.1", "Fit/Parameters/idle/Upper=10"]), expect=1).stderr,
          "check does not read the fit")
    check("'sofft'" in run(["check", scene] + settings(["Fit/Data/stacked/Set=Constants/sofft=2"]), expect=1).stderr,
          "check does not read the scenes of the data")
