"""Reactions, and of finite elements and particles all results, agree on 1, 2, 3 and 4 ranks to 1e-10 (particles: 1e-9, flows of
disordered ones: 1e-6) with solver tolerances of 1e-12."""
import os

from program import Folder, HERE, check, kinds_and_sizes, settings, summary
from particle_scenes import SCENES as PARTICLE_SCENES
from server import run
from solid_scenes import SCENES as ELEMENT_SCENES

TIGHT = ["Newton/Displacement tolerance=1e-12", "Newton/Energy tolerance=1e-12", "Linear solver/Tolerance=1e-12",
         "Newton/Inexact=false"]
SCENES = {
    "never reset": ["MPM/Grid reset=never"],
    "reset when distorted": ["MPM/Grid reset=when distorted", "MPM/Distortion limit=0.05"],
    "halved": ["MPM/Grid reset=always", "MPM/Cells=32, 32", "MPM/Margin above=0, 32", "Supports/top/Displacement=free; 0.4*y*t",
               "Loads/push/Where=layer y-max 8", "Loads/push/Total force=1e-9*t; 0",
               "Loads/pull/Where=nearest 32, 30", "Loads/pull/Total force=0; 2e-10*t"],
    "driven layer": ["MPM/Grid reset=never", "Supports/top/Where=layer y-max 1.5"],
    "viscous": ["Materials/collagen/Viscosity=200", "MPM/Grid reset=always"],
    "history": ["Materials/collagen/Law=Prony", "Materials/collagen/Relaxation times=0.3",
                "Materials/collagen/Shear parts g=0.4", "Materials/collagen/Bulk parts k=0.2", "MPM/Grid reset=always"],
    "published": ["MPM/Internal force=published", "Plane=stress"],
    "B-splines": ["MPM/Shape functions=quadratic B-spline", "MPM/Grid reset=always"],
    "voxels": ["MPM/Interface=composite cells", "MPM/Integration=two moments", "MPM/Cells=10, 12"],
    "jacobi": ["Linear solver/Preconditioner=jacobi"],
    "geometric": ["Linear solver/Preconditioner=geometric", "MPM/Interface=composite cells", "MPM/Cells=45, 41"],
}
# So regular that its area vectors are sensitive to round-off.
ARRAY = {"NSPH, cylinder array": (os.path.join(HERE, "..", "..", "parameters", "verification", "cylinder_array.prm"),
                                  ["Constants/n=16"])}


def largest_difference(results):
    """Largest difference of any result from that on one rank, over the largest of its kind."""
    kind, size = kinds_and_sizes(results[0])
    size.update({k: 1. for k in size if k.startswith("crowding")})  # a mean of differences from 1
    return max((abs(other[name] - value) / (size[kind[name]] or 1), name)
               for other in results for name, value in results[0].items() if name in kind)


with Folder() as folder:
    for name, entries in SCENES.items():
        forces = []
        for ranks in (1, 2, 3, 4):
            output = os.path.join(folder, f"{name}-{ranks}")
            run(["run", os.path.join(HERE, "small.prm"), "--output", output] + settings(TIGHT + entries), ranks)
            result = summary(output)
            check(result["n_ranks"] == ranks, "number of ranks in the summary")
            forces.append(result["results"]["reaction_top_y_N"])
        difference = max(abs(f / forces[0] - 1) for f in forces)
        print(f"{name}: reaction {forces[0]:.12e} N, largest difference {difference:.1e}")
        check(difference < 1e-10, f"{name}: ranks differ by {difference}")
    for name, (scene, entries) in {**ELEMENT_SCENES, **PARTICLE_SCENES, **ARRAY}.items():
        tight = TIGHT if scene.endswith(("solid.prm", "surface.prm")) else [] if "Method=sph" in entries else TIGHT[2:3]
        results = []
        for ranks in (1, 2, 3, 4):
            output = os.path.join(folder, f"{name}-{ranks}")
            run(["run", scene, "--output", output] + settings(tight + entries), ranks)
            results.append(summary(output)["results"])
            check(results[-1].keys() == results[0].keys(), f"{name}: the results' names depend on the ranks")
        largest, where = largest_difference(results)
        print(f"{name}: largest difference {largest:.1e} ({where})")
        # Disordered particles that flow: round-off grows from step to step, up to 1e5 times in 15 of them.
        bound = 1e-10 if name in ELEMENT_SCENES else 1e-6 if name.endswith(("vortices", "water")) else 1e-9
        check(largest < bound, f"{name}: ranks differ by {largest} in {where}")
