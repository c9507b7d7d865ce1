"""Supports in one place: their reactions add up to one headline; the strain knows both ends; no two results of one name."""
import os
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from program import HERE, Folder, check, settings, summary  # noqa: E402
from server import run  # noqa: E402

SMALL = os.path.join(HERE, "small.prm")
METHODS = {"mpm": [], "fem": ["Method=fem", "FEM/Cells=16, 16", "FEM/Material at=quadrature point"]}
PULL = ["Supports/top/Displacement=0; free", "Loads/pull/Where=layer y-max 4", "Loads/pull/Total force=0; 1e-9*t",
        "Time/Initial step=1", "Time/Largest step=1"]
TWICE = {"a side twice": "side y-min", "a side and a layer": "layer y-min 4", "a side and a box": "box 0, 0 : 64, 4"}

with Folder() as folder:
    for method, entries in METHODS.items():
        for name, where in TWICE.items():
            output = os.path.join(folder, f"{method} {name}")
            run(["run", SMALL, "--output", output] +
                settings(entries + PULL + [f"Supports/again/Where={where}", "Supports/again/Type=clamp"]))
            results = summary(output)["results"]
            force = results["reaction_force_y_N"]
            check(abs(force - 1e-9) < 1e-13, f"{method}, {name}: reaction_force_y_N = {force} instead of 1e-9")
            total = results["reaction_bottom_y_N"] + results["reaction_again_y_N"]
            check(abs(total + 1e-9) < 1e-13, f"{method}, {name}: the reactions add up to {total}")
        output = os.path.join(folder, method)
        run(["run", SMALL, "--output", output] +
            settings(entries + ["Supports/top/Displacement=free; 0.1*(y-32)*t", "Supports/bottom/Type=displacement",
                                "Supports/bottom/Displacement=0; 0.1*(y-32)*t"]))
        strain = summary(output)["results"]["strain_y"]
        check(abs(strain - .1) < 1e-12, f"{method}: strain_y = {strain} of a symmetric stretch by .1")
    for arguments in (["check", SMALL], ["run", SMALL, "--output", os.path.join(folder, "twice")]):
        done = run(arguments + settings(["Supports/force/Where=layer y-min 4", "Supports/force/Type=clamp"]), expect=1)
        check("two results are called 'reaction_force_y_N'" in done.stderr, f"not refused: {done.stderr}")
    print("reactions add up")
