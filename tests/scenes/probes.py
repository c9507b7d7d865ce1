"""Probes have one name and one value in all methods and on any number of ranks; one without material is refused."""
import os
import re

from program import Folder, HERE, block, check, settings, stretched, summary
from server import run

with open(os.path.join(HERE, "particles.prm")) as particles:
    LAW_OF_PARTICLES = re.search(r"set Law\s*=\s*(.*)", particles.read()).group(1)

GEL = "set Law = LAW\n set Young's modulus = 10\n set Poisson's ratio = 0.3\n MORE"
SCENE = block(2, GEL, "set Method = METHOD\n" + stretched("y", "0; 1e-3*t") + """subsection Probes
  subsection centre
    set Where = nearest 0.5, 0.5
  end
  subsection corner
    set Where = nearest 1, 1
  end
end
subsection Time
  set Initial step = 0.25
  set Largest step = 0.25
end
subsection Output
  set Point fields = none
  set Grid fields  = false
end
""")
VISCOUS = "set Viscosity = 1\n    set Viscous operator = central\n    set Density = 1"
METHODS = {
    "mpm": ("neo-Hookean", "", ["MPM/Cells=10, 10"]),
    "fem": ("neo-Hookean", "", ["FEM/Cells=10, 10"]),
    "nsph": (LAW_OF_PARTICLES, VISCOUS, ["NSPH/Spacing=0.1"]),
    "sph": (LAW_OF_PARTICLES, VISCOUS, ["SPH/Spacing=0.1"]),
}
NAMES = [f"displacement_{probe}_{axis}_m" for probe in ("centre", "corner") for axis in "xy"]

with Folder() as folder:
    for method, (law, more, entries) in METHODS.items():
        scene = os.path.join(folder, method + ".prm")
        with open(scene, "w") as file:
            file.write(SCENE.replace("METHOD", method).replace("LAW", law).replace("MORE", more))
        values = {}
        for ranks in (1, 2):
            output = os.path.join(folder, f"{method}-{ranks}")
            run(["run", scene, "--quiet", "--output", output] + settings(entries), ranks)
            results = summary(output)["results"]
            values[ranks] = [results[name] for name in NAMES]
            with open(os.path.join(output, "series.csv")) as file:
                rows = [row.split(",") for row in file.read().splitlines()]
            check(all(rows[0].count(name) == 1 for name in NAMES), f"{method}: columns {rows[0]}")
            check([float(rows[-1][rows[0].index(name)]) for name in NAMES] == values[ranks], f"{method}: series and summary")
        print(method, values[1])
        # By symmetry the centre goes half the way, in statics; the corner goes with the top, as well as particles beside a
        # wall know it.
        wanted = [0, 5e-4, 0, 1e-3]
        for i, (a, b) in enumerate(zip(*values.values())):
            check(abs(a - b) < 1e-9, f"{method}: {NAMES[i]} is {a} on 1 rank and {b} on 2")
            if method in ("mpm", "fem") or i < 2 and method == "nsph":
                check(abs(a - wanted[i]) < 1e-9, f"{method}: {NAMES[i]} is {a} instead of {wanted[i]}")
        done = run(["check", scene] + settings(entries + ["Probes/corner/Where=nearest 1.5, 0.5"]), expect=1)
        check(done.stderr == "stroma: --set Probes/corner/Where=nearest 1.5, 0.5: there is no material at the probe 'corner'; "
              "move it into a body, or away from an edge that the grid does not follow\n", f"{method}: {done.stderr}")
