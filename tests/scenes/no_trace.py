"""A run by finite elements that is stopped by SIGTERM and resumed repeats the one that was let run, to the last digit: what
goes from step to step is saved, and saving leaves no trace."""
import os
import signal
import subprocess
import time

from program import Folder, check, command, run, settings, summary
from solid_scenes import FLUID, SCENES

STOPPED = 3  # exit code


def stop_when(folder, arguments, rows):
    """Stops the run politely once series.csv has so many rows."""
    process = subprocess.Popen(command(arguments), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    series = os.path.join(folder, "series.csv")
    while process.poll() is None and not (os.path.exists(series) and sum(1 for _ in open(series)) > rows):
        time.sleep(.001)
    process.send_signal(signal.SIGTERM)
    process.wait()
    check(process.returncode == STOPPED, f"exit code {process.returncode} of a stopped run")


with Folder() as folder:
    for name, (scene, entries) in SCENES.items():
        steps = ["Constants/steps=32"] if scene == FLUID else ["Time/Largest step=1/32", "Time/Initial step=1/32"]
        base = ["run", scene, "--quiet"] + settings(entries + steps)
        whole, stopped = os.path.join(folder, name + ", whole"), os.path.join(folder, name + ", stopped")
        run(base + ["--output", whole])
        stop_when(stopped, base + ["--output", stopped], rows=7)
        run(base + ["--output", stopped, "--resume"])
        rows = [open(os.path.join(f, "series.csv")).read().splitlines() for f in (whole, stopped)]
        for a, b in zip(*rows):
            check(a == b, f"{name}: the uninterrupted run has '{a}', the resumed one '{b}'")
        check(summary(whole)["results"] == summary(stopped)["results"], f"{name}: results differ")
        print(f"{name}: equal in {len(rows[0])} rows")
