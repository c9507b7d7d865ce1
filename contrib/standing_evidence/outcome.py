"""Runs one case with the program and says how it ended."""
import json
import math
import os
import signal
import subprocess
import tempfile
from dataclasses import dataclass, field

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
STROMA = os.environ.get("STROMA", os.path.join(ROOT, "build", "stroma"))
PATIENCE = 60  # processor time after which a run hangs [s]; a busy machine does not matter
LONGEST = 1800  # time after which one that only waits does [s]


@dataclass
class Outcome:
    """How a run ended: 'ok', 'cut' (steps were cut, and ok), 'refused' (exit code 1), 'failed' (exit code 2, the last good
    state saved), 'wrong' (finished with an error beyond the bound of its case), 'crash', 'hang' or 'nan'."""
    kind: str
    said: str = ""  # the line that refuses, or the reason of the failure
    error: float = math.nan  # relative, where there is a reference
    steps: int = 0
    iterations: int = 0
    worst_J: float = math.nan  # least change of volume; of 99 % of a body
    drift: float = math.nan  # of the energy over the work done, where a method tells what it dissipates
    results: dict = field(default_factory=dict)
    ended: str = ""  # the kind before it was judged by an error


def run(scene, sets):
    """The outcome of a scene of parameters/evidence with other settings."""
    with tempfile.TemporaryDirectory() as folder:
        output = os.path.join(folder, "run")
        command = ["prlimit", f"--cpu={PATIENCE}:{PATIENCE + 5}", STROMA, "run", os.path.join(ROOT, "parameters", "evidence", scene + ".prm"), "--output", output]
        for entry in sets:
            command += ["--set", entry]
        try:
            done = subprocess.run(command, capture_output=True, text=True, env={**os.environ, "OMP_NUM_THREADS": "1"},
                                  timeout=LONGEST)
        except subprocess.TimeoutExpired:
            return Outcome("hang", f"after {LONGEST} s")
        if done.returncode == -signal.SIGXCPU:
            return Outcome("hang", f"after {PATIENCE} s of processor time")
        said = last_line(done.stderr).replace(output, "its folder")
        if done.returncode == 1:
            return Outcome("refused", said)
        if done.returncode not in (0, 2):
            return Outcome("crash", f"exit code {done.returncode}: {said}")
        with open(os.path.join(output, "summary.json"), encoding="utf-8") as file:
            summary = json.load(file)
    was_cut = "step cut" in done.stdout
    kind = "failed" if done.returncode == 2 else "nan" if summary["without_value"] else "cut" if was_cut else "ok"
    return Outcome(kind, said if kind == "failed" else ", ".join(summary["without_value"]),
                   steps=summary["n_steps"], iterations=summary["newton_iterations"] + summary["linear_iterations"],
                   results=summary["results"], worst_J=least_J(summary["results"]), drift=energy_drift(summary["results"]))


def least_J(results):
    return min((value for name, value in results.items() if name.startswith("J_p01_")), default=math.nan)


def energy_drift(results):
    """Work less all that it went to, over the work."""
    if not results.get("work_J"):
        return math.nan
    rest = results["work_J"] - sum(results.get(name, 0.) for name in ("strain_energy_J", "kinetic_energy_J", "dissipated_energy_J"))
    return abs(rest / results["work_J"])


def last_line(text):
    lines = text.strip().splitlines()
    return lines[-1] if lines else ""
