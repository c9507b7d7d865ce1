"""Scenes with known answers: orders of the manufactured solutions, and the homogeneous stretch of Guilkey 2006."""
import json
import math
import os

from program import Folder, HERE, check, run, settings, summary

PARAMETERS = os.path.join(HERE, "..", "..", "parameters")

with Folder() as folder:
    for scene, cells in (("manufactured_2d", "8, 16, 32"), ("manufactured_3d", "4, 8, 16")):
        output = os.path.join(folder, scene)
        run(["study", os.path.join(PARAMETERS, "verification", scene + ".prm"), "--output", output]
            + settings([f"Study/resolution/Values={cells}"]))
        with open(os.path.join(output, "study.json")) as file:
            runs = json.load(file)["runs"]
        for name, order in (("displacement_error_L2_relative", 2), ("displacement_error_H1_relative", 1)):
            errors = [r["summary"]["results"][name] for r in runs]
            orders = [math.log2(a / b) for a, b in zip(errors, errors[1:])]
            print(scene, name, " ".join(f"{e:.3e}" for e in errors), "orders", " ".join(f"{o:.3f}" for o in orders))
            check(abs(orders[-1] - order) < .05, f"{scene}: order {orders[-1]} of {name} instead of {order}")

    # One material everywhere: the reaction is known to all digits (design notes; one equation for the lateral stretch).
    for plane, force in (("strain", 69.420e-9), ("stress", 64.719e-9)):
        output = os.path.join(folder, plane)
        run(["run", os.path.join(PARAMETERS, "guilkey2006", "slice.prm"), "--output", output]
            + settings(["Constants/ratio=1", "Constants/cells=32", f"Plane={plane}", "Output/Point fields=none"]))
        reaction = summary(output)["results"]["reaction_force_y_N"]
        print(f"plane {plane}: {reaction:.6e} N, analytic {force:.4e} N")
        check(abs(reaction - force) < .0006e-9, f"plane {plane}: reaction {reaction} instead of {force}")
