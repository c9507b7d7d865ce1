"""A liquid at rest does not lose volume without a word: its level, in an open tank and in a closed vessel, SPH and NSPH, when the
limit of crowding ends the run. Without the limit a fifth of the height is lost after 20 s, with exit code 0."""
import glob
import os
import sys

from program import Folder, HERE, check, run, settings

sys.path.insert(0, os.path.join(HERE, "..", "..", "contrib", "plot"))
import vtu  # noqa: E402

LID = ["Supports/lid/Where=side y-max", "Supports/lid/Type=clamp"]
OPEN = .25 - 1e4 * .5**2 / (3 * 1e6)

# name -> (entries, mean height [m])
CASES = {
    "vessel, SPH": (["Method=sph"] + LID, .25),
    "tank, SPH": (["Method=sph"], OPEN),
    "vessel, NSPH": (["Method=nsph"] + LID, .25),
    "tank, NSPH": (["Method=nsph"], OPEN),
}

with Folder() as folder:
    for name, (entries, height) in CASES.items():
        output = os.path.join(folder, name)
        done = run(["run", os.path.join(HERE, "still_water.prm"), "--output", output] + settings(entries), expect=2)
        check("places and volumes have drifted apart" in done.stderr, f"{name}: {done.stderr}")
        mesh = vtu.read(max(glob.glob(os.path.join(output, "points_*.pvtu"))))
        level = mesh.points[mesh.point_data["fixed"] == 0, 1].mean()
        print(f"{name}: mean height {level:.5f} of {height:.5f} m")
        check(abs(level / height - 1) < .025, f"{name}: mean height {level} instead of {height} m")
