"""Runs one case with the program and says how it ended."""
import json
import math
import os
import resource
import signal
import subprocess
import tempfile
from dataclasses import dataclass, field

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
STROMA = os.environ.get("STROMA", os.path.join(ROOT, "build", "stroma"))
PATIENCE = 60  # processor time after which a run hangs [s]; a busy machine does not matter


@dataclass
class Outcome:
    """How a run ended: 'ok', 'cut' (steps were cut, and ok), 'refused' (exit code 1), 'failed' (exit code 2, the last good
    state saved), 'wrong' (finished with an error beyond the bound of its case), 'crash', 'hang' or 'nan'."""
    kind: str
    said: str = ""  # the line that refuses, or the reason of the failure
    error: float = math.nan  # relative, where there is a reference
    steps: int = 0
    iterations: int = 0
    results: dict = field(default_factory=dict)


def run(scene, sets):
    """The outcome of a scene of parameters/evidence with other settings."""
    with tempfile.TemporaryDirectory() as folder:
        output = os.path.join(folder, "run")
        command = [STROMA, "run", os.path.join(ROOT, "parameters", "evidence", scene + ".prm"), "--output", output]
        for entry in sets:
            command += ["--set", entry]
        done = subprocess.run(command, capture_output=True, text=True, env={**os.environ, "OMP_NUM_THREADS": "1"},
                              preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU, (PATIENCE, PATIENCE + 5)))
        if done.returncode in (-signal.SIGXCPU, -signal.SIGKILL):
            return Outcome("hang", f"after {PATIENCE} s of processor time")
        if done.returncode == 1:
            return Outcome("refused", last_line(done.stderr))
        if done.returncode not in (0, 2):
            return Outcome("crash", f"exit code {done.returncode}: {last_line(done.stderr)}")
        with open(os.path.join(output, "summary.json"), encoding="utf-8") as file:
            summary = json.load(file)
    was_cut = "step cut" in done.stdout
    kind = "failed" if done.returncode == 2 else "nan" if summary["without_value"] else "cut" if was_cut else "ok"
    return Outcome(kind, last_line(done.stderr) if kind == "failed" else ", ".join(summary["without_value"]),
                   steps=summary["n_steps"], iterations=summary["newton_iterations"] + summary["linear_iterations"],
                   results=summary["results"])


def last_line(text):
    lines = text.strip().splitlines()
    return lines[-1] if lines else ""
