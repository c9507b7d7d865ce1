"""Signals at any moment, also in the first second and to mpirun: the program ends with code 3 and nothing half-done, and what
is resumed ends as if it had not been stopped, with one file a time. What --resume does not continue is said."""
import os
import re
import signal
import subprocess
import time

from program import Folder, HERE, check, command, run, settings, summary

SMALL = os.path.join(HERE, "small.prm")
# A checkpoint every step, since the preconditioner is built anew after each: a stop then changes nothing.
STEPS = ["Time/Initial step=1/32", "Time/Largest step=1/32", "Output/Fields every=4", "Output/Checkpoint every=1"]


def start(arguments, ranks=1):
    """A running program that takes signals: it may still be before MPI's initialisation."""
    process = subprocess.Popen(command(arguments, ranks), stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    while ranks == 1 and process.poll() is None and not catches(process.pid, signal.SIGTERM):
        time.sleep(.001)
    return process


def catches(pid, number):
    try:
        with open(f"/proc/{pid}/status") as file:
            caught = re.search(r"SigCgt:\s*([0-9a-f]+)", file.read())
        return bool(int(caught.group(1), 16) >> (number - 1) & 1)
    except (FileNotFoundError, ProcessLookupError):
        return True


def wait_for_rows(process, output, rows):
    path = os.path.join(output, "series.csv")
    while process.poll() is None and not (os.path.exists(path) and len(text(path).splitlines()) > rows):
        time.sleep(.002)


def text(path):
    with open(path) as file:
        return file.read()


def checkpoints(output):
    return sorted(name for name in os.listdir(output) if re.fullmatch(r"checkpoint_\d+\.h5", name))


def check_records(output):
    """Each time of a .pvd has a file of its own, and it is there."""
    for name in os.listdir(output):
        if name.endswith(".pvd"):
            files = re.findall(r'file="([^"]*)"', text(os.path.join(output, name)))
            times = re.findall(r'timestep="([^"]*)"', text(os.path.join(output, name)))
            check(len(set(files)) == len(files) and len(set(times)) == len(times), f"{name}: {files} at {times}")
            check(all(os.path.exists(os.path.join(output, file)) for file in files), f"{name}: a file is missing")


def check_stop(output, numbers, whole, ranks=1):
    """Stops a run by signals, resumes it, and compares it with the whole one."""
    base = ["run", SMALL, "--quiet", "--output", output] + settings(STEPS)
    process = start(base, ranks)
    wait_for_rows(process, output, 6)
    for number in numbers:
        process.send_signal(number)
    said = process.communicate()[1]
    check(process.returncode == 3, f"exit code {process.returncode} after {numbers}: {said}")
    check("stroma: stopping after this step" in said, f"said {said}")
    check(summary(output)["status"].startswith("stopped") and checkpoints(output), "a stopped run saves")
    check_records(output)
    run(base + ["--resume"], ranks)
    check_records(output)
    if ranks == 1:
        check(text(os.path.join(output, "series.csv")) == whole, f"series.csv differs after {numbers}")


with Folder() as folder:
    path = lambda name: os.path.join(folder, name)  # noqa: E731
    base = ["run", SMALL, "--quiet"] + settings(STEPS)
    run(base + ["--output", path("whole")])
    whole = text(path("whole/series.csv"))

    # While nothing is to be saved the program ends at once: before MPI, in the set-up, in check.
    for i, seconds in enumerate((0., .1, .25, .4)):
        for words in (["run", SMALL, "--output", path(f"first-{i}")] + settings(["Time/Initial step=1/512", "Time/Largest step=1/512"]), ["check", SMALL]):
            process = start(words)
            time.sleep(seconds)
            process.send_signal(signal.SIGTERM)
            process.communicate(timeout=60)
            check(process.returncode == 3 or (process.returncode == 0 and words[0] == "check"),
                  f"exit code {process.returncode}: {words[0]} after {seconds} s")

    # One signal, and two in a row as 'timeout' sends them.
    for number, signals in enumerate(([signal.SIGTERM], [signal.SIGHUP], [signal.SIGINT], [signal.SIGTERM, signal.SIGTERM])):
        check_stop(path(f"stop-{number}"), signals, whole)
    check_stop(path("mpirun"), [signal.SIGUSR1], whole, ranks=2)

    # A finished run stays as it is; a later end continues it, and the picture of the earlier end keeps its file.
    longer = ["run", SMALL, "--quiet", "--output", path("longer")] + settings(["Output/Checkpoint every=1"])
    run(longer + settings(["Time/End=0.5"]))
    run(longer + ["--resume"])
    check_records(path("longer"))
    check(len(re.findall("timestep", text(path("longer/points.pvd")))) == 2, "pictures of both ends")
    check(summary(path("longer"))["results"]["end_time_s"] == 1., "the later end")
    stamp = os.stat(path("longer/summary.json")).st_mtime_ns
    done = subprocess.run(command(["run", SMALL, "--resume", "--output", path("longer")] +
                                  settings(["Output/Checkpoint every=1"])), capture_output=True, text=True)
    check(done.returncode == 0 and "has finished and stays as it is" in done.stdout, done.stdout + done.stderr)
    check(os.stat(path("longer/summary.json")).st_mtime_ns == stamp, "a finished run was written again")

    # A checkpoint with one changed number is not taken; the one before is, with a word.
    damaged = path("stop-0")
    newest = max(checkpoints(damaged), key=lambda name: int(re.search(r"\d+", name).group()))
    with open(os.path.join(damaged, newest), "r+b") as file:
        content = file.read()
        place = content.index(b"0x1")  # step control, as hexadecimal numbers
        file.seek(place + 4)
        file.write(b"7" if content[place + 4:place + 5] != b"7" else b"3")
    os.remove(os.path.join(damaged, "summary.json"))
    done = run(["run", SMALL, "--quiet", "--output", damaged, "--resume"] + settings(STEPS))
    check(f"{newest}: " in done.stderr and "is damaged; an older checkpoint is looked for" in done.stderr, done.stderr)
    check(text(os.path.join(damaged, "series.csv")) == whole, "series.csv after a damaged checkpoint")
