"""Runs the program for the tests in this folder. Standard library only."""
import json
import os
import shutil
import subprocess
import sys
import tempfile

STROMA = os.environ["STROMA"]
MPIRUN = os.environ.get("MPIRUN", "mpirun")
HERE = os.path.dirname(os.path.abspath(__file__))


def command(arguments, ranks=1):
    prefix = [MPIRUN, "--oversubscribe", "-np", str(ranks)] if ranks > 1 else []
    return prefix + [STROMA] + arguments


def run(arguments, ranks=1, expect=0):
    """Runs stroma and returns its standard output and error; fails the test on another exit code."""
    done = subprocess.run(command(arguments, ranks), capture_output=True, text=True)
    check(done.returncode == expect, f"exit code {done.returncode} instead of {expect}: {done.stdout[-2000:]}{done.stderr}")
    return done


def summary(folder):
    with open(os.path.join(folder, "summary.json")) as file:
        return json.load(file)


def settings(entries):
    return [word for entry in entries for word in ("--set", entry)]


def kinds_and_sizes(results):
    """Kind of each result (such as 'reaction'), and the largest of each kind. Errors against an exact solution are themselves
    small differences and are left out."""
    kind = {name: name.split("_")[0] + name.split("_")[-1] for name in results if "_error_" not in name}
    size = {k: max(abs(results[name]) for name in kind if kind[name] == k) for k in kind.values()}
    force = max((abs(value) for name, value in results.items() if name.endswith("_N")), default=0.)
    speed = results.get("max_speed_m_per_s", 0.)
    size.update({k: max(size[k], 1e-3 * speed) for k in size if k.startswith("flow")})  # the net flow of vortices is 0
    size.update({k: max(size[k], 1e-3) for k in size if k == "volumechange"})  # that of all, which passes through 0
    size.update({k: max(size[k], force) for k in size if k.endswith("Nm")})  # torques of symmetric bodies are 0; an arm of 1 m
    return kind, size


def manufactured(folder, study=""):
    """Path of a copy of the manufactured scene in the plane, with another section Study or none."""
    with open(os.path.join(HERE, "..", "..", "parameters", "verification", "manufactured_2d.prm")) as file:
        text = file.read()
    path = os.path.join(folder, "manufactured.prm")
    with open(path, "w") as file:
        file.write(text[:text.index("subsection Study")] + study)
    return path


def block(dimension, material, more="", body="set Shape = box"):
    """The text of a scene: one body of one material, with their entries, and more sections. Lengths of the box are 1."""
    return f"""set Dimension = {dimension}
subsection Materials
  subsection gel
    {material}
  end
end
subsection Bodies
  subsection block
    {body}
  end
end
{more}
"""


def stretched(axis, displacement):
    """The text of the supports of a body whose lower side along an axis is clamped and whose upper one moves."""
    return f"""subsection Supports
  subsection bottom
    set Where = side {axis}-min
    set Type  = clamp
  end
  subsection top
    set Where        = side {axis}-max
    set Displacement = {displacement}
  end
end
"""


def check(condition, message):
    if not condition:
        print("FAILED:", message)
        sys.exit(1)


class Folder:
    """A temporary folder, removed at the end."""

    def __enter__(self):
        self.path = tempfile.mkdtemp(prefix="stroma-test-")
        return self.path

    def __exit__(self, *_):
        shutil.rmtree(self.path, ignore_errors=True)
