"""Mutated options of phantom, compare and study."""
import os

from mutations import WORDS
from parameters import SCENES

NUMBERS = ["0", "-1", "nan", "inf", "1e9", "4294967297", "0.5", "", "1,2", "1,2,3,4", "x", "1e-320", "64,64,1e6", "100000,100000,100000"]


class Commands:
    """One option of a command takes another value."""

    def prepare(self, sandbox):
        for name, top in (("a", "0.1"), ("b", "0.11")):
            outcome = sandbox.run(["run", os.path.join(SCENES, "small.prm"), "--output", name, "--quiet", "--set", "Output/Keep states=true",
                                   "--set", "Time/Initial step=0.5", "--set", "Time/Largest step=0.5", "--set", "Output/Fields every=1",
                                   "--set", f"Supports/top/Displacement=free; {top}*y*t"], 60.0)
            assert outcome.code == 0, outcome.lines()

    def case(self, random, sandbox):
        command = random.choice(["phantom", "compare", "compare"])
        options = {"phantom": {"--size": "8,8,2", "--voxel": "1,1,1", "--fraction": "0.2", "--radius": "2", "--blur": "1", "--noise": "0.1",
                               "--seed": "3"},
                   "compare": {"--fields": "displacement_m", "--times": "1", "--points": "A", "--grid": "4,4", "--samples": "10",
                               "--region": "box 0, 0 : 3e-5, 3e-5", "--line": "0, 0 : 6e-5, 6e-5", "--save": "out/ref.h5"}}[command]
        places = {"phantom": ["out/p.nrrd"], "compare": ["a", "b"]}[command]
        os.makedirs(sandbox.output(""), exist_ok=True)
        used = random.sample(sorted(options), random.randrange(len(options) + 1))
        values = {name: options[name] for name in used}
        for _ in range(random.choice([1, 1, 2])):
            at = random.randrange(len(used) + len(places))
            value = random.choice(NUMBERS + [word for word in WORDS if "\0" not in word])
            if at < len(used):
                values[used[at]] = value
            elif "/" not in value and value != "..":
                places[at - len(used)] = "out/" + value if command == "phantom" else value
        arguments = [command] + places + [f"{name}={value}" for name, value in values.items() if name != "--save"]
        if "--save" in values:
            arguments += ["--save", "out/ref.h5"]
        if command == "compare":
            arguments += ["--output", "out/compare", "--quiet"]
        return command, sandbox.run(arguments), lambda *_: None
