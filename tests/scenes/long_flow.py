"""A fluid that flows for long flows as at the start: vortices held up by a force of the place, over two turnovers. Without shifts particles
line up along streamlines and the run ends after .15 turnovers; forces that went with the matter would take the vortices apart."""
import csv
import math
import os

from program import Folder, HERE, check, run, settings

ENTRIES = ["Constants/n=16", "Time/End=2000", "Time/Initial step=10", "Time/Largest step=100"]

with Folder() as folder:
    output = os.path.join(folder, "out")
    run(["run", os.path.join(HERE, "..", "..", "parameters", "verification", "taylor_green.prm"), "--output", output] + settings(ENTRIES))
    with open(os.path.join(output, "series.csv")) as file:
        rows = list(csv.DictReader(file))[1:]
    exact = .1 * (2 * math.pi / .01)**2 * 1e-5**2 * .01**2  # mu k^2 U^2 L^2 [W]
    powers, crowding = [float(row["dissipation_W"]) for row in rows], [float(row["crowding"]) for row in rows]
    print(f"dissipation {min(powers) / exact:.3f} to {max(powers) / exact:.3f} of the exact one, crowding up to {max(crowding):.3f}")
    mean = sum(powers) / len(powers)
    check(abs(mean / exact - 1) < .05, f"mean dissipation {mean} W instead of {exact} W")
    check(.5 < min(powers) / exact and max(powers) / exact < 1.3, f"dissipation from {min(powers)} to {max(powers)} W instead of {exact} W")
    check(max(crowding) < .09, f"crowding {max(crowding)}")
