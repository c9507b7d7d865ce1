"""Steps that start at the solution: tiny strains, held phases, bodies that are only moved, tolerances out of reach."""
import csv
import os
import sys

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from program import HERE, Folder, block, check, settings, stretched, summary  # noqa: E402
from server import run  # noqa: E402

GEL = "set Law = linear elastic\n set Young's modulus = 1000\n set Poisson's ratio = 0.3"
BOX = block(3, GEL, body="set Shape = box\n set Upper corner = 16, 16, 16", more=stretched("z", "free; free; STRAIN*z*t") + """subsection Units
  set Length = um
end
subsection Output
  set Point fields = none
  set Grid fields  = false
end
""")
# Force over strain [N] of linear elasticity on 2 x 2 x 2 trilinear cells: with points at quarters, and with Gauss points.
LINEAR = {"mpm": 2.69665335e-7, "fem": 2.65415578e-7}
SMALL = os.path.join(HERE, "small.prm")
FEM = ["Method=fem", "FEM/Cells=2, 2, 2"]


def stretched(folder, name, strain, steps, more, ranks=1):
    path = os.path.join(folder, "box.prm")
    with open(path, "w") as file:
        file.write(BOX.replace("STRAIN", f"{strain:g}"))
    output = os.path.join(folder, name)
    run(["run", path, "--output", output] +
        settings([f"Time/Initial step={1 / steps}", f"Time/Largest step={1 / steps}"] + more), ranks)
    return summary(output)


with Folder() as folder:
    for strain, steps, more, ranks in [(1e-3, 2, ["MPM/Cells=2, 2, 2"], 1), (1e-5, 2, ["MPM/Cells=2, 2, 2"], 1),
                                       (1e-8, 4, ["MPM/Cells=2, 2, 2"], 2), (1e-12, 8, ["MPM/Cells=2, 2, 2"], 1),
                                       (1e-5, 2, FEM, 2), (1e-8, 4, FEM + ["FEM/Kinematics=small"], 1),
                                       (1e-12, 8, FEM, 1)]:
        done = stretched(folder, f"{strain}_{steps}_{len(more)}_{ranks}", strain, steps, more, ranks)
        force = done["results"]["reaction_force_z_N"]
        right = LINEAR[done["method"]] * strain
        near = max(4 * strain, 3e-15 / strain, 1e-6)
        check(done["n_steps"] == steps, f"{strain}, {more}: {done['n_steps']} steps instead of {steps}")
        check(abs(force / right - 1) < near, f"{strain}, {more}: force {force} instead of {right}")

    # Held after t = 0.5, with driven layers; and moved without any stress.
    steps = ["Time/Initial step=0.1", "Time/Largest step=0.1"]
    layers = ["Supports/top/Where=layer y-max 1.5", "Supports/bottom/Where=layer y-min 4",
              "Supports/top/Displacement=0; 0.1*y*min(t, 0.5)"]
    moved = ["Supports/top/Displacement=0; 5*t", "Supports/bottom/Type=displacement", "Supports/bottom/Displacement=0; 5*t"]
    solid = ["Method=fem", "FEM/Cells=16, 16", "FEM/Material at=quadrature point"]
    for name, entries in [("layers", layers), ("stiff penalty", layers + ["MPM/Penalty=1e8"]),
                          ("held, fem", solid + ["Supports/top/Displacement=0; 0.1*y*min(t, 0.5)"]), ("moved", moved),
                          ("moved, fem", solid + moved)]:
        output = os.path.join(folder, name)
        run(["run", SMALL, "--output", output] + settings(steps + entries))
        done = summary(output)
        check(done["n_steps"] == 10, f"{name}: {done['n_steps']} steps instead of 10")
        with open(os.path.join(output, "series.csv")) as file:
            rows = list(csv.DictReader(file))
        forces = [float(row["reaction_top_y_N"]) for row in rows]
        if name.startswith("moved"):
            check(max(map(abs, forces)) < 1e-17, f"{name}: a body that is only moved has reactions {forces}")
        else:
            check(abs(forces[-1] / forces[5] - 1) < 1e-6, f"{name}: the reaction changes from {forces[5]} while held to {forces[-1]}")

    # A ball pressed in by far less than the tolerance of contact, a length: one node touches, so the force is linear.
    ball = ["Bodies/ball/Shape=ball", "Bodies/ball/Rigid=true", "Bodies/ball/Centre=0, 0.3", "Bodies/ball/Radius=0.3",
            "Supports/guide/Where=body ball", "Contact/touch/Type=frictionless", "FEM/Refinement/top/Where=ball 0, 0 : 0.2",
            "Materials/gel/Viscosity=0", "Bodies/inclusion/Material=gel", "Loads/push/Total force=0; 0"]
    for depth in (1e-6, 1e-10):
        output = os.path.join(folder, f"ball {depth}")
        run(["run", os.path.join(HERE, "solid.prm"), "--output", output] +
            settings(ball + [f"Supports/guide/Displacement=0; -{depth}*t"]))
        results = summary(output)["results"]
        for name in ("contact_force_ball_y_N", "reaction_force_y_N"):
            check(abs(results[name] / (184.57 * depth) - 1) < 1e-3, f"depth {depth}: {name} = {results[name]}")

    # Tolerances that no numbers reach are said, and no step is cut for them.
    output = os.path.join(folder, "tight")
    done = run(["run", SMALL, "--output", output] +
               settings(["Newton/Displacement tolerance=1e-16", "Newton/Energy tolerance=1e-30"]))
    check(done.stderr.count("ask for more than the numbers resolve") == 1, f"nothing said: {done.stderr}")
    check(summary(output)["n_steps"] == 8, "steps were cut for a tolerance out of reach")
    check(summary(output)["results"]["solves_below_round_off"] == 8, "not counted")
    print("starts at the solution converge")
