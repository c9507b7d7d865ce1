"""A run killed between checkpoints and resumed ends with the reactions of the uninterrupted run, to the last digit."""
import os
import signal
import subprocess
import time

from program import Folder, HERE, check, command, settings, summary
from particle_scenes import BLOCK, MIGRATION, SCENES as PARTICLE_SCENES
from server import run
from solid_scenes import FLUID, SCENES as ELEMENT_SCENES

SCENES = {
    "never": ["MPM/Grid reset=never"],
    "always": ["MPM/Grid reset=always"],
    "loads": ["MPM/Grid reset=always", "Loads/push/Where=layer y-max 2", "Loads/push/Total force=1e-9*t; 0",
              "Loads/pull/Where=nearest 32, 60", "Loads/pull/Total force=0; 2e-10*t", "MPM/Margin above=16, 8"],
    "halved": ["MPM/Grid reset=always", "MPM/Cells=32, 32", "MPM/Margin above=0, 32", "Supports/top/Displacement=free; 0.4*y*t",
               "Loads/push/Where=layer y-max 8", "Loads/push/Total force=1e-9*t; 0",
               "Loads/pull/Where=nearest 32, 30", "Loads/pull/Total force=0; 2e-10*t"],
    "projected": ["MPM/Grid reset=always", "MPM/Dilatation=projected"],
    "viscous": ["Materials/collagen/Viscosity=200", "MPM/Grid reset=when distorted", "MPM/Distortion limit=0.03"],
    "history": ["Materials/collagen/Law=Prony", "Materials/collagen/Relaxation times=0.3",
                "Materials/collagen/Shear parts g=0.4", "Materials/collagen/Bulk parts k=0.2", "MPM/Grid reset=always"],
    "published": ["MPM/Internal force=published", "Plane=stress"],
    "B-splines": ["MPM/Shape functions=quadratic B-spline", "MPM/Grid reset=always"],
    "voxels": ["MPM/Interface=composite cells", "MPM/Integration=two moments", "Output/Image fields=displacement",
               "MPM/Cells=32, 32", "Linear solver/Preconditioner=geometric"],
}


def kill_when(folder, arguments, ranks, rows, how=signal.SIGKILL):
    """Kills the run once series.csv has so many rows."""
    process = subprocess.Popen(command(arguments, ranks), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                               start_new_session=True)
    series = os.path.join(folder, "series.csv")
    deadline = time.time() + 300
    while process.poll() is None and time.time() < deadline:
        if os.path.exists(series) and sum(1 for _ in open(series)) > rows:
            break
        time.sleep(.002)
    check(process.poll() is None, "the run ended before it could be killed")
    if how == signal.SIGKILL:
        os.killpg(process.pid, how)
    else:
        process.send_signal(how)  # mpirun hands SIGUSR1 on
    process.wait()


def check_resumes(name, base, ranks):
    """Runs the scene, and again killed after 9 rows and resumed: equal to the last digit."""
    whole = os.path.join(folder, f"{name}-{ranks}-whole")
    killed = os.path.join(folder, f"{name}-{ranks}-killed")
    run(base + ["--output", whole], ranks)
    kill_when(killed, base + ["--output", killed], ranks, rows=9)
    check(not os.path.exists(os.path.join(killed, "summary.json")), "the killed run finished")
    run(base + ["--output", killed, "--resume"], ranks)
    a, b = summary(whole)["results"], summary(killed)["results"]
    for key in a:
        check(a[key] == b[key], f"{name} on {ranks} ranks: {key} is {a[key]} and after resuming {b[key]}")
    rows = [open(os.path.join(f, "series.csv")).read() for f in (whole, killed)]
    check(rows[0] == rows[1], f"{name}: series.csv differs")
    print(f"{name} on {ranks} ranks: equal in {len(a)} results")


def check_goes_on(name, base, ranks):
    """Runs the scene, and again stopped politely where the whole run saves nothing, and resumed: equal to the last digit."""
    whole = os.path.join(folder, f"{name}-{ranks}-whole")
    stopped = os.path.join(folder, f"{name}-{ranks}-stopped")
    run(base + ["--output", whole], ranks)
    kill_when(stopped, base + ["--output", stopped], ranks, 9, signal.SIGTERM if ranks == 1 else signal.SIGUSR1)
    run(base + ["--output", stopped, "--resume"], ranks)
    a, b = [open(os.path.join(f, "series.csv")).read() for f in (whole, stopped)]
    check(a == b, f"{name} on {ranks} ranks: series.csv differs after a stop")
    print(f"{name} on {ranks} ranks: stopped and resumed, {len(a.splitlines())} equal rows")


with Folder() as folder:
    for name, entries in SCENES.items():
        for ranks in (1, 2):
            check_resumes(name, ["run", os.path.join(HERE, "small.prm")] + settings(
                entries + ["Output/Checkpoint every=3", "Time/Largest step=1/32", "Time/Initial step=1/32"]), ranks)
    for name, (scene, entries) in ELEMENT_SCENES.items():
        steps = ["Constants/steps=32"] if scene == FLUID else ["Time/Largest step=1/32", "Time/Initial step=1/32"]
        check_resumes(name, ["run", scene] + settings(entries + steps + ["Output/Checkpoint every=3"]), 2)
    for name, (scene, entries) in PARTICLE_SCENES.items():
        steps = {BLOCK: ["Time/Initial step=1/64", "Time/Largest step=1/64"], MIGRATION: ["Constants/step=0.4"]}.get(scene, [])
        check_resumes(name, ["run", scene] + settings(entries + steps + ["Output/Checkpoint every=3"]), 2)

    for name in ("NSPH", "NSPH, multigrid", "NSPH, explicit", "NSPH, bodies", "SPH", "SPH, bodies", "NSPH, pillars", "NSPH, vortices", "SPH, water"):
        scene, entries = PARTICLE_SCENES[name]
        steps = ["Time/Initial step=1/128", "Time/Largest step=1/128"] if scene == BLOCK else []
        for ranks in (1, 2):
            check_goes_on(name + ", stopped", ["run", scene] + settings(entries + steps), ranks)

    # Another number of ranks continues too, to the solver's accuracy.
    entries = settings(SCENES["always"] + ["Output/Checkpoint every=3", "Time/Largest step=1/32", "Time/Initial step=1/32"])
    base = ["run", os.path.join(HERE, "small.prm")] + entries
    killed = os.path.join(folder, "other-ranks")
    kill_when(killed, base + ["--output", killed], 2, rows=9)
    run(base + ["--output", killed, "--resume"], 3)
    difference = abs(summary(killed)["results"]["reaction_top_y_N"] /
                     summary(os.path.join(folder, "always-1-whole"))["results"]["reaction_top_y_N"] - 1)
    check(difference < 1e-5, f"resumed on 3 ranks: {difference}")

    # Refused: another scene, another version, no checkpoint; and results are never overwritten unasked.
    done = run(base + ["--output", killed, "--resume"] + settings(["Materials/vessel/Shear modulus=1501"]), expect=1)
    check("this is of another scene: 'Materials/vessel/Shear modulus' was 1500 and is now 1501" in done.stderr,
          done.stderr)
    done = run(base + ["--output", killed], expect=1)
    check("--overwrite" in done.stderr and len(done.stderr.strip().splitlines()) == 1, done.stderr)
    done = run(base + ["--output", os.path.join(folder, "nothing"), "--resume"], expect=1)
    check(len(done.stderr.strip().splitlines()) == 1, done.stderr)

    # A polite stop saves and says how to go on.
    stopped = os.path.join(folder, "stopped")
    process = subprocess.Popen(command(base + ["--output", stopped]), stdout=subprocess.PIPE, text=True)
    while not os.path.exists(os.path.join(stopped, "series.csv")):
        time.sleep(.01)
    process.send_signal(signal.SIGTERM)
    process.communicate()
    if process.returncode == 3:
        check(summary(stopped)["status"].startswith("stopped"), "status of a stopped run")
        run(base + ["--output", stopped, "--resume"])
        check(summary(stopped)["status"] == "finished", "resumed after a stop")
