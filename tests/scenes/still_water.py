"""A liquid at rest stays at rest: level, speed and pressure after 20 s in an open tank and in a closed vessel, SPH and NSPH. Without
Packing an open tank had lost a fifth of its height by then, and ended with exit code 0."""
import os
import sys

from program import Folder, HERE, check, run, settings, summary

sys.path.insert(0, os.path.join(HERE, "..", "..", "contrib", "plot"))
import vtu  # noqa: E402

LID = ["Supports/lid/Where=side y-max", "Supports/lid/Type=clamp", "Exact solution/Pressure=1e4*(0.25-y)"]
OPEN = .25 - 1e4 * .5**2 / (3 * 1e6)

# name -> (entries, mean height [m], share of it that may be lost, largest speed [m/s], relative error of the pressure)
CASES = {
    "tank, SPH": (["Method=sph"], OPEN, .01, 5e-3, .25),
    "vessel, SPH": (["Method=sph"] + LID, .25, .003, 5e-4, .02),
    "tank, NSPH": (["Method=nsph"], OPEN, .02, 5e-3, .35),
    "vessel, NSPH": (["Method=nsph"] + LID, .25, .03, 5e-3, 1.),
}

with Folder() as folder:
    for name, (entries, height, loss, speed, error) in CASES.items():
        output = os.path.join(folder, name)
        run(["run", os.path.join(HERE, "still_water.prm"), "--output", output] + settings(entries))
        found = summary(output)["results"]
        mesh = vtu.read(os.path.join(output, "points_0000.pvtu"))
        level = mesh.points[mesh.point_data["fixed"] == 0, 1].mean()
        print(f"{name}: mean height {level:.5f} of {height:.5f} m, crowding {found['crowding']:.1e}, "
              f"speed {found['max_speed_m_per_s']:.1e} m/s, error of pressure {found['pressure_error_L2_relative']:.2e}")
        check(abs(level / height - 1) < loss, f"{name}: mean height {level} instead of {height} m")
        check(found["max_speed_m_per_s"] < speed, f"{name}: moves with {found['max_speed_m_per_s']} m/s")
        check(found["pressure_error_L2_relative"] < error, f"{name}: pressure is {found['pressure_error_L2_relative']} off")
