"""The homogeneous stretch of Guilkey 2006, known to all digits; scaled particles. Orders of convergence are checked by baselines.py."""
import os

from program import Folder, HERE, check, run, settings, summary

PARAMETERS = os.path.join(HERE, "..", "..", "parameters")

with Folder() as folder:
    # One material everywhere: the reaction is known to all digits (design notes; one equation for the lateral stretch).
    for plane, force in (("strain", 69.420e-9), ("stress", 64.719e-9)):
        output = os.path.join(folder, plane)
        run(["run", os.path.join(PARAMETERS, "guilkey2006", "slice.prm"), "--output", output]
            + settings(["Constants/ratio=1", "Constants/cells=32", f"Plane={plane}", "Output/Point fields=none"]))
        reaction = summary(output)["results"]["reaction_force_y_N"]
        print(f"plane {plane}: {reaction:.6e} N, analytic {force:.4e} N")
        check(abs(reaction - force) < .0006e-9, f"plane {plane}: reaction {reaction} instead of {force}")

    # Tractions of Heck 2017 at the scale of metres and of micrometres: the same numbers, over 1e4, in the same order.
    largest = []
    for name in ("tractions", "tractions_micrometre"):
        output = os.path.join(folder, name)
        run(["run", os.path.join(PARAMETERS, "heck2017", name + ".prm"), "--output", output]
            + settings(["Method=nsph", "Time/End=50", "Output/Fields at=50", "Output/Point fields=none"]))
        largest.append(summary(output)["results"]["max_displacement_m"])
    print(f"micrometre: {largest[1]:.15e} m, metre {largest[0]:.15e} m")
    check(abs(1e4 * largest[1] / largest[0] - 1.) < 1e-12, f"micrometre scale: {largest[1]} instead of {largest[0] / 1e4}")
