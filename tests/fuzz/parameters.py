"""Mutated parameter files: all scenes that come with Stroma and those of the tests, by check, template, run and study."""
import json
import math
import os
import re

from mutations import ENTRY, mutate

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")
SCENES = os.path.join(ROOT, "tests", "scenes")

# Entries that make a scene small; what is not listed is small as it is.
SMALL = {
    "guilkey2006": ["Bodies/construct/Phantom/Size=32, 32, 1", "Constants/cells=16"],
    "construct.prm": ["Bodies/construct/Phantom/Size=16, 16, 8", "MPM/Cells=4, 4, 2"],
    "quickstart.prm": ["Bodies/construct/Phantom/Size=16, 16, 8", "MPM/Cells=4, 4, 2"],
    "pillars.prm": ["Constants/levels=1", "Constants/dp=1e-3"],
    "tractions": ["Constants/cells=8", "Constants/dp=0.1*length"],
    "methods_study.prm": ["Constants/cells=8"],
    "hertz.prm": ["Constants/levels=3"],
    "drop.prm": ["Method=sph", "Materials/liquid/Density=1000"],
    "indentation": ["Constants/cells=8"],
    "oscillating_plate.prm": ["Constants/n=4"],
    "taylor_green_3d.prm": ["Constants/n=6"],
    "kelvin_voigt_layer_3d.prm": ["Constants/n=8"],
    "cylinder": ["Constants/n=12"],
}


def small(path):
    return [entry for key, entries in SMALL.items() if key in path for entry in entries]


def scenes():
    found = []
    for top in (os.path.join(ROOT, "parameters"), SCENES):
        for folder, _, names in sorted(os.walk(top)):
            found += [os.path.join(folder, name) for name in sorted(names) if name.endswith(".prm")]
    return found


def read(path):
    """The scene's text with its includes put in, so that a mutation reaches them too."""
    with open(path) as file:
        text = file.read()
    inside = lambda found: read(os.path.join(os.path.dirname(path), found.group(1).strip()))  # noqa: E731
    return re.sub(r"^include (.*)$", inside, text, flags=re.M)


def plain_numbers(text):
    """Entries whose value is one plain number, with the path of their sections."""
    path, found = [], {}
    for line in text.splitlines():
        words = line.split("#")[0].split()
        if words[:1] == ["subsection"]:
            path.append(" ".join(words[1:]))
        elif words == ["end"] and path:
            path.pop()
        elif match := ENTRY.match(line):
            if re.fullmatch(r"[-+]?\d+(\.\d+)?(e[-+]?\d+)?", match.group(4)):
                found["/".join(path + [match.group(2)])] = float(match.group(4))
    return found


def misread(given, echoed):
    """A number that the run's own parameters.prm gives otherwise than the file; None if there is none."""
    said = plain_numbers(echoed)
    for name, value in plain_numbers(given).items():
        if name in said and not math.isclose(value, said[name], rel_tol=1e-5, abs_tol=1e-300):
            return f"'{name}' was given as {value} and read as {said[name]}"
    return None


class Parameters:
    """A file mutated, by one of the commands that read one."""

    def __init__(self):
        self.texts = {path: read(path) for path in scenes()}
        self.light = [path for path in self.texts if os.path.dirname(path) == SCENES]

    def case(self, random, sandbox):
        command = random.choice(["check"] * 6 + ["template"] + ["run"] * 3 + ["study"])
        path = random.choice(self.light if command == "run" else sorted(self.texts))
        data = mutate(random, self.texts[path])
        sandbox.write("scene.prm", data)
        sandbox.write("case.txt", f"{command} {os.path.relpath(path, ROOT)}\n".encode())
        entries = [word for entry in small(path) for word in ("--set", entry)]
        if command in ("check", "template"):
            return command, sandbox.run([command, "scene.prm"] + entries), self.judge
        seconds = 2.0 if command == "study" else 4.0
        return command, sandbox.run([command, "scene.prm", "--output", "out", "--quiet"] + entries, seconds), self.judge

    @staticmethod
    def judge(command, outcome, sandbox):
        if command == "template" and outcome.code == 0:
            return None if b"set Dimension" in outcome.stdout else "no template"
        if command != "run":
            return None
        if outcome.code == 1 and os.path.exists(sandbox.output("summary.json")):
            return "refused, but left a summary"
        if outcome.code == 0:
            with open(sandbox.output("summary.json")) as file:
                summary = json.load(file)
            nothing = [name for name, value in summary["results"].items() if value is None]
            if nothing:
                return f"results without a value: {nothing}"
        if os.path.exists(sandbox.output("parameters.prm")):
            with open(sandbox.output("parameters.prm")) as file:
                echoed = file.read()
            with open(os.path.join(sandbox.work, "scene.prm"), errors="replace") as file:
                return misread(file.read(), echoed)
        return None
