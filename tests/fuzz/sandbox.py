"""A folder in which cases run, the process that runs them, and what every case must leave behind."""
import json
import os
import shutil
import subprocess

MEMORY = 6 << 30
SECONDS = 8.0
LONGEST_LINE = 1000


class Sandbox:
    """`root/work` is the folder that a case runs in; it may write to `root/work/out` only."""

    def __init__(self, root, server):
        self.root, self.work = root, os.path.join(root, "work")
        os.makedirs(os.path.join(self.work, "keep", "states"))
        for name in ("summary.json", "parameters.prm", "study_run.json", "states/state_00000001.h5"):
            self.write(os.path.join("keep", name), b"not to be touched\n")
            self.write(os.path.join("..", os.path.basename(name)), b"not to be touched\n")
        self.server = server

    def write(self, name, data):
        with open(os.path.join(self.work, name), "wb") as file:
            file.write(data)

    def start(self):
        environment = dict(os.environ, OMPI_MCA_mpi_warn_on_fork="0")
        self.process = subprocess.Popen([self.server], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True,
                                        env=environment)

    def stop(self):
        self.process.stdin.close()
        self.process.wait()

    def listing(self):
        """Every file outside `out` with its size and time; the case's output is not part of it."""
        found = {}
        for folder, folders, names in os.walk(self.root):
            if folder == self.work:
                folders[:] = [name for name in folders if name != "out"]
            for name in names + folders:
                path = os.path.join(folder, name)
                about = os.lstat(path)
                found[path] = (about.st_size, about.st_mtime_ns) if name in names else None
        for name in ("stdout", "stderr"):
            found.pop(os.path.join(self.root, name), None)
        return found

    def output(self, name):
        return os.path.join(self.work, "out", name)

    def clean(self):
        shutil.rmtree(os.path.join(self.work, "out"), ignore_errors=True)

    def run(self, arguments, seconds=SECONDS, signals=()):
        """Runs `stroma arguments`; returns an Outcome."""
        before = self.listing()
        case = {"arguments": arguments, "folder": self.work, "seconds": seconds, "memory": MEMORY, "signals": list(signals)}
        self.process.stdin.write(json.dumps(case) + "\n")
        self.process.stdin.flush()
        answer = json.loads(self.process.stdout.readline())
        outcome = Outcome(answer, self.read("stdout"), self.read("stderr"), list(signals))
        after = self.listing()
        outcome.strayed = sorted(path for path in before.keys() | after.keys()
                                 if path not in before or path not in after or before[path] != after[path])
        return outcome

    def read(self, name):
        with open(os.path.join(self.root, name), "rb") as file:
            return file.read()


class Outcome:
    def __init__(self, answer, stdout, stderr, signals):
        self.code, self.signal, self.killed = answer["code"], answer["signal"], answer["killed"]
        self.asked, self.elapsed = answer["asked"], answer["elapsed"]
        self.stdout, self.stderr, self.signals, self.strayed = stdout, stderr, signals, []

    def lines(self):
        return self.stderr.decode("utf-8", "replace").rstrip("\n").split("\n") if self.stderr else []

    def errors(self):
        return [line for line in self.lines() if line.startswith("stroma: ") and not line.startswith("stroma: warning")]

    def kind(self):
        return {0: "usable", 1: "refused", 2: "failed physics", 3: "stopped"}.get(self.code, "fault")

    def fault(self):
        """What no case may do, whatever its input; None if all is well."""
        if self.killed:
            return "hangs: did not stop when asked to"
        if self.signal:
            return f"killed by signal {self.signal}"
        if self.code not in (0, 1, 2, 3):
            return f"exit code {self.code}: {self.lines()[:1]}"
        if self.code == 3 and not (self.asked or self.signals):
            return "exit code 3 though nobody asked it to stop"
        if self.strayed:
            return f"wrote outside its folder: {self.strayed[:3]}"
        if any(byte < 32 and byte not in b"\n\t" for byte in self.stderr):
            return "control characters on the terminal"
        if self.code == 1:
            if len(self.errors()) != 1 or not all(line.startswith("stroma: ") for line in self.lines()):
                return f"{len(self.lines())} lines, {len(self.errors())} errors: {self.lines()[:3]}"
            if len(self.errors()[0]) > LONGEST_LINE:
                return f"a line of {len(self.errors()[0])} characters"
        return None
