"""A run killed between checkpoints and resumed ends with the reactions of the uninterrupted run, to the last digit: on one rank."""
import os
import signal
import subprocess
import time

from program import Folder, check, command, settings, summary
from resuming import SCENES, check_resumes, check_stopped, small
from server import run

with Folder() as folder:
    for name in SCENES:
        check_resumes(folder, name, small(name), 1)
    check_stopped(folder, 1)

    # Refused: another scene, another version, no checkpoint; and results are never overwritten unasked.
    base, killed = small("always"), os.path.join(folder, "always-1-killed")
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
