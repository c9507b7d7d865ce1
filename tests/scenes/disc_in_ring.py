"""A rigid disc turns in a ring, of particles: the torque is that of u_theta = A r + B/r, 4 pi B (G + mu) of a Kelvin-Voigt solid and
4 pi B mu of a fluid (Couette flow between cylinders), and comes nearer with the spacing; that torque turns it as far; a run
is the same on ranks and when it is resumed in the middle of a large turn."""
import math
import os

from program import Folder, HERE, check, settings, summary
from server import run

SOLID = os.path.join(HERE, "disc_in_ring.prm")
G, MU, A, B_OUTER, W = 10., 1., 1., 2., 1e-3
B = W * A**2 * B_OUTER**2 / (B_OUTER**2 - A**2)


def fluid(folder):
    """The same scene of a fluid, whose disc turns at an angular velocity."""
    with open(SOLID) as file:
        text = file.read()
    text = text.replace("set Law             = hypoelastic", "set Law = fluid")
    text = text.replace("set Shear modulus   = 10", "set Bulk modulus = 1000").replace("set Poisson's ratio = 0.3", "")
    text = text.replace("set Displacement = 0; 0", "set Type = velocity\n    set Velocity = 0; 0")
    text = text.replace("set Rotation     = w*t", "set Angular velocity = w")
    text = text.replace("set Displacement = -y*max(A+B/(x^2+y^2),0)*t; x*max(A+B/(x^2+y^2),0)*t",
                        "set Velocity = -y*max(A+B/(x^2+y^2),0); x*max(A+B/(x^2+y^2),0)")
    path = os.path.join(folder, "fluid.prm")
    with open(path, "w") as file:
        file.write(text)
    return path


def results(folder, name, scene, entries, ranks=1):
    output = os.path.join(folder, name)
    run(["run", scene, "--quiet", "--output", output] + settings(entries), ranks)
    return summary(output)["results"]


with Folder() as folder:
    for name, scene, torque in (("solid", SOLID, 4 * math.pi * B * (G + MU)),
                                ("fluid", fluid(folder), 4 * math.pi * B * MU)):
        errors = []
        for dp in (.1, .05):
            found = results(folder, f"{name}-{dp}", scene, [f"Constants/dp={dp}", "Linear solver/Tolerance=1e-10"])
            of_torque = abs(found["disc_torque_Nm"] / torque - 1)
            errors.append(found["velocity_error_L2_relative" if name == "fluid" else "displacement_error_L2_relative"])
            force = math.hypot(found["disc_force_x_N"], found["disc_force_y_N"])
            print(f"{name}, dp = {dp}: torque off by {of_torque:.1e}, field by {errors[-1]:.1e}, force {force:.1e} N")
            check(of_torque < .01, f"{name}: torque off by {of_torque}")
            check(abs(found["disc_rotation_rad"] / W - 1) < 1e-12, f"{name}: rotation {found['disc_rotation_rad']} rad")
            check(force < .02 * torque, f"{name}: force {force} N")
        check(errors[0] < .05 and errors[1] < .7 * errors[0], f"{name}: field off by {errors}")
        # The same torque turns it as far: 4 pi B (G t + mu).
        turned = results(folder, f"{name}-by-torque", scene,
                         ["Supports/disc/Velocity=free; free" if name == "fluid" else "Supports/disc/Displacement=free; free",
                          "Supports/disc/Angular velocity=free" if name == "fluid" else "Supports/disc/Rotation=free",
                          "Loads/turn/Where=body disc",
                          "Loads/turn/Torque=" + (f"{torque}" if name == "fluid" else f"{4 * math.pi * B}*({G}*t+{MU})")])
        print(f"{name}, by a torque: rotation off by {turned['disc_rotation_rad'] / W - 1:.1e}")
        check(abs(turned["disc_rotation_rad"] / W - 1) < .01, f"{name}: a torque turns by {turned['disc_rotation_rad']} rad")
        check(math.hypot(turned["disc_displacement_x_m"], turned["disc_displacement_y_m"]) < .02 * W, f"{name}: moves")
    # A turn by .3, on ranks, and stopped half-way.
    for name, scene, entries in (("solid", SOLID, []), ("SPH", SOLID, ["Method=sph"]), ("spun", fluid(folder), [])):
        entries = entries + ["Constants/w=0.3", "Time/Initial step=1/64", "Time/Largest step=1/64"]
        if name != "SPH":
            entries.append("Linear solver/Tolerance=1e-12")
        whole = results(folder, f"{name}-whole", scene, entries)
        on_ranks = results(folder, f"{name}-ranks", scene, entries, 3)
        stopped = os.path.join(folder, f"{name}-stopped")
        run(["run", scene, "--quiet", "--output", stopped] + settings(entries + ["Time/End=0.5", "Output/Checkpoint every=1"]))
        run(["run", scene, "--quiet", "--output", stopped, "--resume"] + settings(entries + ["Output/Checkpoint every=1"]))
        resumed = summary(stopped)["results"]
        for key in ("disc_torque_Nm", "disc_rotation_rad"):
            check(resumed[key] == whole[key], f"{name}: {key} {whole[key]}, resumed {resumed[key]}")
            check(abs(on_ranks[key] / whole[key] - 1) < 1e-6, f"{name}: {key} {whole[key]}, on ranks {on_ranks[key]}")
        print(f"{name}: turned by {whole['disc_rotation_rad']:.2f} rad, torque {whole['disc_torque_Nm']:.4g} Nm")
