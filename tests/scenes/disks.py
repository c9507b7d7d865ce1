"""Files that cannot be written: the run keeps its state, ends with code 2 and one line, and goes on once there is room."""
import os
import resource
import subprocess
import time

from program import Folder, HERE, check, command, run, settings, summary

SMALL = os.path.join(HERE, "small.prm")
# A checkpoint every step, since the preconditioner is built anew after each.
STEPS = ["Time/Initial step=1/16", "Time/Largest step=1/16", "Output/Checkpoint every=1"]


def text(path):
    with open(path) as file:
        return file.read()


def lines(done):
    return [line for line in done.stderr.splitlines() if line]


def check_obstacle(folder, name, place, entries, whole, ranks=1):
    """A folder lies where a file is to be written; without it the run continues and ends as the whole one."""
    output = os.path.join(folder, name)
    base = ["run", SMALL, "--quiet", "--output", output] + settings(STEPS + entries)
    os.makedirs(os.path.join(output, place, "in the way"))
    done = run(base, ranks, expect=2)
    check(len([line for line in lines(done) if line.startswith("stroma:")]) == 1 and place.split("/")[-1] in done.stderr,
          done.stderr)
    check("the last good state is saved" in done.stderr, done.stderr)
    os.removedirs(os.path.join(output, place, "in the way"))
    run(base + ["--resume"], ranks)
    check(ranks > 1 or text(os.path.join(output, "series.csv")) == whole, f"{name}: series.csv differs")
    check(summary(output)["status"] == "finished", name)


with Folder() as folder:
    path = lambda name: os.path.join(folder, name)  # noqa: E731
    run(["run", SMALL, "--quiet", "--output", path("whole")] + settings(STEPS))
    whole = text(path("whole/series.csv"))
    every = ["Output/Fields every=4"]
    check_obstacle(folder, "field file", "points_0001.0.0.vtu", every, whole)
    check_obstacle(folder, "field file of the other rank", "points_0001.1.0.vtu", every, whole, ranks=2)
    check_obstacle(folder, "list", "points.pvd", every, whole)
    check_obstacle(folder, "state", "states/state_00000008.h5", every + ["Output/Keep states=true"], whole)

    # A limit on the size of files, set while it runs: the row of series.csv that does not fit leaves no half, and neither
    # does a checkpoint; the earlier one is good.
    limited = path("limited")
    base = ["run", SMALL, "--output", limited, "--quiet"] + settings(["Time/Initial step=1/64", "Time/Largest step=1/64",
                                                                       "Output/Checkpoint every=5"])
    process = subprocess.Popen(command(base), stderr=subprocess.PIPE, text=True)
    while process.poll() is None and not os.path.exists(os.path.join(limited, "checkpoint_5.h5")):
        time.sleep(.002)
    size = os.path.getsize(os.path.join(limited, "series.csv"))
    resource.prlimit(process.pid, resource.RLIMIT_FSIZE, (size + 300, resource.RLIM_INFINITY))
    said = process.communicate()[1]
    check(process.returncode == 2, f"exit code {process.returncode}: {said}")
    check("series.csv: the row cannot be written" in said and "no checkpoint could be saved" in said and "HDF5" not in said, said)
    rows = text(os.path.join(limited, "series.csv"))
    check(rows.endswith("\n") and len({len(row.split(",")) for row in rows.splitlines()}) == 1, "half a row")
    run(base + ["--resume"])
    run([word if word != limited else path("unlimited") for word in base])
    check(text(os.path.join(limited, "series.csv")) == text(path("unlimited/series.csv")), "resumed after a full disk")

    # Nothing is removed or written before the scene is known to be usable.
    before = sorted(os.listdir(path("whole")))
    stamp = os.stat(path("whole/series.csv")).st_mtime_ns
    run(["run", SMALL, "--quiet", "--overwrite", "--output", path("whole")] +
        settings(["Supports/top/Where=box 900, 900 : 901, 901"]), expect=1)
    check(sorted(os.listdir(path("whole"))) == before and os.stat(path("whole/series.csv")).st_mtime_ns == stamp,
          "--overwrite removed results for a scene that cannot be used")
    run(["run", SMALL, "--quiet", "--output", path("never")] + settings(["Supports/top/Where=box 900, 900 : 901, 901"]), expect=1)
    check(not os.path.exists(path("never")), "a folder for a scene that cannot be used")

    # Folders that cannot be used: one line each.
    with open(path("file"), "w") as file:
        file.write("mine")
    for output, wanted in (("", "the name of a folder is empty"), (path("a" * 300), "File name too long"),
                           (path("file"), "a file of this name exists"), (path("whole/states"), "where a run keeps its states"),
                           (path("file/below"), "a file of this name exists")):
        done = run(["run", SMALL, "--quiet", "--output", output], expect=1)
        check(len(lines(done)) == 1 and wanted in done.stderr, f"{output[-20:]}: {done.stderr}")
