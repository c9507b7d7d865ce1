"""A small cell that migrates: no particle enters it, half the step and a finer spacing have nearly the same path, in a stiff
matrix its force is that which it is given, the edge of the matrix
ends the run with all results, and film.py makes a film of it."""
import math
import os
import subprocess
import sys

from particle_scenes import SCENES
from program import Folder, HERE, check, run, settings, summary

SCENE, ENTRIES = SCENES["NSPH, migration"]
FILM = os.path.join(HERE, "..", "..", "contrib", "plot", "film.py")


def cell(folder, name, entries):
    """Results and ending of a run."""
    output = os.path.join(folder, name)
    run(["run", SCENE, "--output", output] + settings(ENTRIES[:-1] + ["NSPH/Closing tolerance=1e-6"] + entries))
    result = summary(output)
    check(result["status"] == "finished", f"{name}: {result['status']}")
    results = result["results"]
    check(results["particles_inside_cell"] == 0, f"{name}: particles are in the cell")
    check(abs(results["volume_change"]) < .01, f"{name}: volume changes by {results['volume_change']:.3g}")
    return results, result.get("ending", "")


with Folder() as folder:
    ahead, ending = cell(folder, "ahead", [])
    check(ending == "", f"ended: {ending}")
    check(ahead["cell_displacement_y_m"] > 2e-6, f"the cell has gone {ahead['cell_displacement_y_m']:.3g} m only")
    for name, entries, bound in (("step", ["Constants/step=0.25"], .02), ("spacing", ["Constants/dp=8"], .2)):
        other, _ = cell(folder, name, entries)
        difference = abs(other["cell_displacement_y_m"] / ahead["cell_displacement_y_m"] - 1)
        check(difference < bound, f"{name}: the way differs by {difference:.3g}")
        print(f"{name}: gone {other['cell_displacement_y_m']:.6g} m, with the other one {ahead['cell_displacement_y_m']:.6g} m")
    stiff, _ = cell(folder, "stiff", ["Materials/matrix/Young's modulus=250e3"])
    force = math.hypot(stiff["cell_force_x_N"], stiff["cell_force_y_N"])
    check(abs(force / 5e-6 - 1) < .01, f"in a stiff matrix {force:.3g} N act on the cell, not 5e-6 N")
    gone, ending = cell(folder, "to the edge", ["Constants/start=150", "Time/End=600", "Output/Fields every=20"])
    check(gone["end_time_s"] < 600. and "has reached the edge" in ending, f"ended with '{ending}' at {gone['end_time_s']} s")
    print(f"{ending}, at {gone['end_time_s']:g} s")
    made = subprocess.run([sys.executable, FILM, os.path.join(folder, "to the edge")], capture_output=True, text=True)
    check(made.returncode == 0 and os.path.isfile(os.path.join(folder, "to the edge", "film.png")),
          f"no film: {made.stdout}{made.stderr}")
