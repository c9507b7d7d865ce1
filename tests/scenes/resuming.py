"""Runs that are killed or stopped, and resumed, against the uninterrupted ones: by resume.py on one rank, by resume_ranks.py on several."""
import os
import signal
import subprocess
import time

from program import HERE, check, command, settings, summary
from particle_scenes import BLOCK, SCENES as PARTICLE_SCENES
from server import run

STEPS = ["Output/Checkpoint every=3", "Time/Largest step=1/32", "Time/Initial step=1/32"]
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


def check_resumes(folder, name, base, ranks):
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


def check_goes_on(folder, name, base, ranks):
    """Runs the scene, and again stopped politely where the whole run saves nothing, and resumed: equal to the last digit."""
    whole = os.path.join(folder, f"{name}-{ranks}-whole")
    stopped = os.path.join(folder, f"{name}-{ranks}-stopped")
    run(base + ["--output", whole], ranks)
    kill_when(stopped, base + ["--output", stopped], ranks, 9, signal.SIGTERM if ranks == 1 else signal.SIGUSR1)
    run(base + ["--output", stopped, "--resume"], ranks)
    a, b = [open(os.path.join(f, "series.csv")).read() for f in (whole, stopped)]
    check(a == b, f"{name} on {ranks} ranks: series.csv differs after a stop")
    print(f"{name} on {ranks} ranks: stopped and resumed, {len(a.splitlines())} equal rows")


def small(name):
    """Arguments of a run of one of SCENES."""
    return ["run", os.path.join(HERE, "small.prm")] + settings(SCENES[name] + STEPS)


def check_stopped(folder, ranks):
    """Scenes of particles that are stopped politely."""
    for name in ("NSPH", "NSPH, multigrid", "NSPH, explicit", "NSPH, bodies", "SPH", "SPH, bodies", "NSPH, pillars", "NSPH, vortices", "SPH, water"):
        scene, entries = PARTICLE_SCENES[name]
        steps = ["Time/Initial step=1/128", "Time/Largest step=1/128"] if scene == BLOCK else []
        check_goes_on(folder, name + ", stopped", ["run", scene] + settings(entries + steps), ranks)
