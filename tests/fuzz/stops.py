"""Stops and kills at random times, damaged checkpoints: a run that goes on ends as the uninterrupted one."""
import functools
import os
import re
import shutil
import signal
import subprocess

from parameters import SCENES
from sandbox import Outcome

STEPS = ["Output/Checkpoint every=3", "Output/Fields every=4", "Output/Grid fields=false", "Output/Point fields=none"]
MANY = {"small.prm": ["Time/Initial step=1/48", "Time/Largest step=1/48"],
        "particles.prm": ["Time/End=0.25", "Time/Initial step=1/96", "Time/Largest step=1/96"],
        "solid.prm": ["Time/Initial step=1/32", "Time/Largest step=1/32"]}
SIGNALS = [signal.SIGTERM, signal.SIGTERM, signal.SIGHUP, signal.SIGINT, signal.SIGKILL]
METHODS = {"particles.prm": ["nsph", "sph"]}


def cases():
    return [(name, method) for name in MANY for method in METHODS.get(name, [None])]


def arguments(name, method, output, more=()):
    entries = STEPS + MANY[name] + ([f"Method={method}"] if method else []) + list(more)
    return ["run", os.path.join(SCENES, name), "--output", output, "--quiet"] + [w for e in entries for w in ("--set", e)]


def rows(path):
    with open(path) as file:
        return file.read()


def record_fault(folder):
    """A .pvd that names one file twice, or times that do not increase."""
    for name in os.listdir(folder):
        if name.endswith(".pvd"):
            text = rows(os.path.join(folder, name))
            files, times = re.findall(r'file="([^"]*)"', text), [float(t) for t in re.findall(r'timestep="([^"]*)"', text)]
            if len(set(files)) != len(files) or sorted(set(times)) != times:
                return f"{name} names {len(files)} files, {len(set(files))} different, {len(set(times))} times"
            if missing := [file for file in files if not os.path.exists(os.path.join(folder, file))]:
                return f"{name} names {missing[0]}, which is not there"
    return None


class Stops:
    """A run is stopped or killed, once or twice, and resumed."""

    def prepare(self, sandbox):
        self.whole, self.seconds = {}, {}
        for name, method in cases():
            outcome = sandbox.run(arguments(name, method, "out"), 300.0)
            assert outcome.code == 0, outcome.lines()
            self.whole[name, method] = rows(sandbox.output("series.csv"))
            self.seconds[name, method] = outcome.elapsed
            sandbox.clean()

    def case(self, random, sandbox):
        name, method = random.choice(cases())
        resume, stops = [], 0
        for _ in range(random.choice([1, 1, 2])):
            number = random.choice(SIGNALS)
            outcome = sandbox.run(arguments(name, method, "out") + resume, 60.0,
                                  [[int(number), random.random() * self.seconds[name, method]]])
            if fault := self.stop_fault(outcome, number):
                return name, outcome, lambda *_: fault
            stops += outcome.code != 0
            kept = os.path.isdir(sandbox.output("")) and any(re.fullmatch(r"checkpoint_\d+\.h5", f) for f in os.listdir(sandbox.output("")))
            resume = ["--resume"] if kept else ["--overwrite"]
            if outcome.code == 0:
                break
        if outcome.code != 0:
            outcome = sandbox.run(arguments(name, method, "out") + resume, 60.0)
        return name, outcome, lambda *_: self.judge(name, method, outcome, sandbox)

    @staticmethod
    def stop_fault(outcome, number):
        if number == signal.SIGKILL:
            outcome.signal = 0 if outcome.signal == signal.SIGKILL else outcome.signal
            outcome.code = 3 if outcome.code < 0 else outcome.code
        return f"exit code {outcome.code} after signal {number}" if outcome.code not in (0, 3) or outcome.signal else None

    def judge(self, name, method, outcome, sandbox):
        if outcome.code != 0:
            return f"{name} {method or ''} does not go on: {outcome.lines()[:1]}"
        if rows(sandbox.output("series.csv")) != self.whole[name, method]:
            return f"{name} {method or ''}: series.csv is not that of the uninterrupted run"
        return record_fault(sandbox.output(""))


class Checkpoints:
    """A checkpoint with changed bytes, or cut, is refused or leads to the same end."""

    def prepare(self, sandbox):
        outcome = sandbox.run(arguments("small.prm", None, "out", ["Time/End=25/48"]), 60.0)
        assert outcome.code == 0, outcome.lines()
        os.remove(sandbox.output("summary.json"))  # as if it had been killed after step 25
        shutil.copytree(sandbox.output(""), os.path.join(sandbox.root, "stopped"))
        outcome = sandbox.run(arguments("small.prm", None, "out") + ["--resume"], 60.0)
        assert outcome.code == 0, outcome.lines()
        self.whole = rows(sandbox.output("series.csv"))

    def case(self, random, sandbox):
        shutil.copytree(os.path.join(sandbox.root, "stopped"), sandbox.output(""))
        names = sorted(n for n in os.listdir(sandbox.output("")) if n.startswith("checkpoint_") and n.endswith(".h5"))
        for name in names if random.random() < 0.5 else names[-1:]:
            self.damage(random, sandbox.output(name))
        outcome = sandbox.run(arguments("small.prm", None, "out") + ["--resume"], 60.0)
        return "checkpoint", outcome, lambda *_: self.judge(outcome, sandbox)

    @staticmethod
    def damage(random, path):
        with open(path, "r+b") as file:
            size = os.path.getsize(path)
            if random.random() < 0.2:
                file.truncate(random.randrange(size))
                return
            for _ in range(random.choice([1, 4, 64])):
                file.seek(random.randrange(size))
                file.write(bytes([random.randrange(256)]))

    def judge(self, outcome, sandbox):
        if outcome.code == 0 and rows(sandbox.output("series.csv")) != self.whole:
            return "a damaged checkpoint leads to another end without a word"
        return None


@functools.lru_cache
def own_mounts():
    """The option of unshare by which a run has mounts of its own: not of another user where that is not needed, since a changed root forbids it."""
    return "-m" if subprocess.run(["unshare", "-m", "true"], capture_output=True).returncode == 0 else "-rm"


class Disks:
    """A disk of a random size, so small that it fills: the state is kept where there is room, and the end is said in one line."""

    def case(self, random, sandbox):
        name, method = random.choice(cases())
        kept, disk = os.path.join(sandbox.root, "kept"), os.path.join(sandbox.work, "out")
        shutil.rmtree(kept, ignore_errors=True)
        os.makedirs(kept)
        os.makedirs(disk)
        more = ["Output/Fields every=1", "Output/Keep states=true", "Output/Point fields=von_mises", "Time/End=0.2"]
        script = f'mount -t tmpfs -o size=$0k tmpfs "{disk}" || exit 98; "$@"; code=$?; cp -a "{disk}/." "{kept}"; exit $code'
        done = subprocess.run(["unshare", own_mounts(), "sh", "-c", script, str(random.choice([8, 16, 32, 64, 128, 256, 512, 768])),
                               os.environ["STROMA"]] + arguments(name, method, disk, more), capture_output=True, timeout=120)
        answer = {"code": done.returncode, "signal": 0, "killed": False, "asked": False, "elapsed": 0.0}
        outcome = Outcome(answer, done.stdout, done.stderr, [])
        return name, outcome, lambda *_: self.judge(outcome, kept)

    @staticmethod
    def judge(outcome, kept):
        """Warnings may come first; the last line says why the run ended."""
        if outcome.code not in (0, 1, 2) or any(not line.startswith("stroma: ") for line in outcome.lines()):
            return f"exit code {outcome.code}: {outcome.lines()[:3]}"
        names = os.listdir(kept)
        if outcome.code == 0 and "summary.json" not in names:
            return "done without a summary"
        if outcome.code == 1 and "series.csv" in names and len(rows(os.path.join(kept, "series.csv")).splitlines()) > 2:
            return "a full disk is taken for unusable input"
        return None
