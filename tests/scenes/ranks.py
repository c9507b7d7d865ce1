"""Reactions on 1, 2, 3 and 4 ranks agree to 1e-10 when the solvers' tolerances are 1e-12."""
import os

from program import Folder, HERE, check, run, settings, summary

TIGHT = ["Newton/Displacement tolerance=1e-12", "Newton/Energy tolerance=1e-12", "Linear solver/Tolerance=1e-12",
         "Newton/Inexact=false"]
SCENES = {
    "never reset": ["MPM/Grid reset=never"],
    "reset when distorted": ["MPM/Grid reset=when distorted", "MPM/Distortion limit=0.05"],
    "driven layer": ["MPM/Grid reset=never", "Supports/top/Where=layer y-max 1.5"],
    "published": ["MPM/Internal force=published", "Plane=stress"],
    "jacobi": ["Linear solver/Preconditioner=jacobi"],
}

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
