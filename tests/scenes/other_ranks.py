"""A checkpoint of every method, of fluids too, is read on another number of ranks: a run that is stopped half-way on some ranks
and resumed on others ends with the results of the uninterrupted run on one rank, to 1e-10 of the largest of their kind, with
solver tolerances of 1e-12, and of the area vectors of fluids of 1e-13."""
import os

from program import Folder, HERE, check, kinds_and_sizes, settings, summary
from particle_scenes import BLOCK, BODIES, SCENES as PARTICLE_SCENES
from server import run
from solid_scenes import FLUID, SURFACE, SCENES as ELEMENT_SCENES

SMALL = os.path.join(HERE, "small.prm")
NEWTON = ["Newton/Displacement tolerance=1e-12", "Newton/Energy tolerance=1e-12", "Newton/Inexact=false"]
LINEAR = ["Linear solver/Tolerance=1e-12"]
SOLID = ELEMENT_SCENES["contact, stick"]
VORTICES = PARTICLE_SCENES["NSPH, vortices"]
WATER, INERTIAL_WATER = PARTICLE_SCENES["NSPH, water"], PARTICLE_SCENES["SPH, water"]
TOLERANCE = 1e-10
# name: parameter file, entries, time of the stop (in units of the file)
SCENES = {
    "MPM, never reset": (SMALL, NEWTON + LINEAR + ["MPM/Grid reset=never"], "0.5"),
    "MPM, always reset": (SMALL, NEWTON + LINEAR + ["MPM/Grid reset=always"], "0.5"),
    "MPM, halved points": (SMALL, NEWTON + LINEAR + [
        "MPM/Grid reset=always", "MPM/Cells=32, 32", "MPM/Margin above=0, 32", "Supports/top/Displacement=free; 0.4*y*t",
        "Loads/push/Where=layer y-max 8", "Loads/push/Total force=1e-9*t; 0",
        "Loads/pull/Where=nearest 32, 30", "Loads/pull/Total force=0; 2e-10*t"], "0.5"),
    "MPM, B-splines": (SMALL, NEWTON + LINEAR + ["MPM/Shape functions=quadratic B-spline", "MPM/Grid reset=always"], "0.5"),
    "FEM, Prony": (*[ELEMENT_SCENES["Prony"][0], NEWTON + LINEAR + ELEMENT_SCENES["Prony"][1]], "0.5"),
    "FEM, contact": (SOLID[0], NEWTON + LINEAR + SOLID[1], "0.5"),
    "MPM, contact": (SOLID[0], NEWTON + LINEAR + ELEMENT_SCENES["contact of a ball that turns, MPM"][1], "0.5"),
    "FEM, rigid body": (SOLID[0], NEWTON + LINEAR + ELEMENT_SCENES["rigid body, turned by a torque"][1], "0.5"),
    "FEM, contact with a surface": (SURFACE, NEWTON + LINEAR, "0.5"),
    "FEM, fluid": (FLUID, LINEAR, "0.05"),
    "NSPH": (BLOCK, LINEAR, "0.5"),
    "SPH": (BLOCK, ["Method=sph"], "0.5"),
    "NSPH, bodies": (BLOCK, LINEAR + BODIES, "0.5"),
    "SPH, bodies": (BLOCK, ["Method=sph"] + BODIES, "0.5"),
    # In steps below what moves allow: longer ones depend on where a run ends.
    "NSPH, vortices": (VORTICES[0], VORTICES[1] + LINEAR + ["NSPH/Closing tolerance=1e-13", "Time/End=200", "Time/Initial step=5",
                                                            "Time/Largest step=5"], "100"),
    "NSPH, migration": (PARTICLE_SCENES["NSPH, migration"][0], PARTICLE_SCENES["NSPH, migration"][1] + LINEAR, "3"),
    "NSPH, water": (WATER[0], WATER[1] + LINEAR + ["NSPH/Closing tolerance=1e-13"], "2"),
    "SPH, water": (INERTIAL_WATER[0], INERTIAL_WATER[1] + ["SPH/Closing tolerance=1e-13"], "0.4"),
}


def largest_difference(one, other):
    """Over the largest result of its kind."""
    kind, size = kinds_and_sizes(one)
    return max((abs(other[name] - one[name]) / (size[kind[name]] or 1), name) for name in kind)


with Folder() as folder:
    for name, (scene, entries, stop) in SCENES.items():
        base = ["run", scene, "--quiet"] + settings(entries)
        whole = os.path.join(folder, f"{name}-whole")
        run(base + ["--output", whole])
        for before, after in ((1, 4), (4, 1), (2, 3), (3, 2)):
            output = os.path.join(folder, f"{name}-{before}-{after}")
            run(base + ["--output", output] + settings([f"Time/End={stop}", "Output/Checkpoint every=1"]), before)
            run(base + ["--output", output, "--resume"] + settings(["Output/Checkpoint every=1"]), after)
            done = summary(output)
            check(done["status"] == "finished" and done["n_ranks"] == after, f"{name}: {done['status']}")
            largest, where = largest_difference(summary(whole)["results"], done["results"])
            print(f"{name}, {before} ranks, then {after}: largest difference {largest:.1e} ({where})")
            check(largest < TOLERANCE, f"{name}, {before} ranks, then {after}: {where} differs by {largest}")
