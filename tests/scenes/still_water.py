"""A liquid at rest stays at rest: its level and its pressure after 100 s in an open tank and in a closed vessel, by SPH and NSPH. Once
particles took up less and less room there, and a fifth of the height was gone after 20 s."""
import os
import sys

import numpy as np

from program import Folder, HERE, check, run, settings

sys.path.insert(0, os.path.join(HERE, "..", "..", "contrib", "plot"))
import vtu  # noqa: E402

LID = ["Supports/lid/Where=side y-max", "Supports/lid/Type=clamp"]
HEIGHT, WEIGHT, MODULUS = .5, 1e4, 1e6
OPEN = HEIGHT / 2 - WEIGHT * HEIGHT**2 / (3 * MODULUS)
FULL = HEIGHT / 2 - WEIGHT * HEIGHT**2 / (12 * MODULUS)
FINER = ["SPH/Spacing=.05", "NSPH/Spacing=.05"]

# name -> (entries, mean height [m], part of it that may be off)
CASES = {
    "vessel, SPH": (["Method=sph"] + LID, FULL, .001),
    "tank, SPH": (["Method=sph"], OPEN, .001),
    "vessel, NSPH": (["Method=nsph"] + LID, FULL, .001),
    "tank, NSPH": (["Method=nsph"], OPEN, .001),
    "tank, NSPH, finer": (["Method=nsph"] + FINER, OPEN, .001),
    "tank, SPH, hexagonal": (["Method=sph", "SPH/Arrangement=hexagonal", "Time/End=40"], OPEN, .005),
}

with Folder() as folder:
    for name, (entries, height, tolerance) in CASES.items():
        output = os.path.join(folder, name)
        run(["run", os.path.join(HERE, "still_water.prm"), "--output", output] + settings(entries))
        mesh = vtu.read(os.path.join(output, "points_0000.pvtu"))
        y, p, v = mesh.points[:, 1], mesh.point_data["pressure_Pa"], mesh.point_data["velocity_m_per_s"]
        level, error = y.mean(), p - WEIGHT * (HEIGHT - y)
        if LID[0] in entries:
            error -= error.mean()  # as a full vessel's pressure is known but for a constant
        error = np.sqrt((error**2).mean()) / (WEIGHT * HEIGHT)
        print(f"{name}: mean height {level:.5f} of {height:.5f} m, pressure off by {error:.1e}, fastest {np.abs(v).max():.1e} m/s")
        check(abs(level / height - 1) < tolerance, f"{name}: mean height {level} instead of {height} m")
        check(error < 10 * tolerance, f"{name}: pressure off by {error} of that on the floor")
        check(np.abs(v).max() < 5e-3, f"{name}: still moves at {np.abs(v).max()} m/s")
