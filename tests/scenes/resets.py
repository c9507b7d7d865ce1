"""Grids that are reset: sides move as they are told, points are found on any number of ranks, stretched
bodies keep their force, and one that is torn ends the run with its last state saved."""
import os

from program import Folder, HERE, check, settings, summary
from server import run

BAR = """
set Dimension = 2
set Thickness = 1e6
subsection Units
  set Length = um
end
subsection Materials
  subsection gel
    set Law             = linear elastic
    set Young's modulus = 1000
    set Poisson's ratio = 0
  end
end
subsection Bodies
  subsection bar
    set Shape        = box
    set Upper corner = 4, 16
    set Material     = gel
  end
end
subsection Supports
  subsection bottom
    set Where = side y-min
    set Type  = clamp
  end
  subsection top
    set Where        = side y-max
    set Displacement = 0; y*t
  end
end
subsection Time
  set Initial step = 0.05
  set Largest step = 0.05
end
subsection MPM
  set Cells           = 4, 16
  set Grid reset      = always
  set Points per cell = 2, 2
  set Margin above    = 2, 18
end
subsection Output
  set Grid fields = false
end
"""
SMALL = os.path.join(HERE, "small.prm")


def run_scene(folder, name, scene, entries, ranks=1, expect=0):
    output = os.path.join(folder, name)
    done = run(["run", scene, "--output", output] + settings(entries), ranks, expect)
    return summary(output), done.stdout + done.stderr, output


with Folder() as folder:
    # A side that leaves its plane is followed by its points, wherever the zero of its motion lies.
    forces = []
    for zero in ("32", "32.0001"):
        motion = f"0; 0.4*(y-{zero})*t"
        result = run_scene(folder, "symmetric" + zero, SMALL,
                           ["MPM/Grid reset=always", "MPM/Margin above=0, 24", "MPM/Margin below=0, 24",
                            "Supports/bottom/Type=displacement", "Supports/bottom/Displacement=" + motion,
                            "Supports/top/Displacement=" + motion])[0]["results"]
        forces.append(result["reaction_top_y_N"])
    print(f"symmetric stretch: {forces[0]:.6e} and {forces[1]:.6e} N")
    check(abs(forces[0] / forces[1] - 1) < 1e-4, "the zero of a motion changes the force")

    # Points that move by several cells in a step, on two ranks.
    forces = [run_scene(folder, f"far{ranks}", SMALL,
                        ["MPM/Grid reset=always", "MPM/Cells=64, 64", "MPM/Points per voxel=2, 2",
                         "Time/Initial step=0.5", "Time/Largest step=0.5"], ranks)[0]["results"]["reaction_force_y_N"]
              for ranks in (1, 2, 3)]
    print(f"points that move far: {forces[0]:.12e} N, others' differences {[f / forces[0] - 1 for f in forces[1:]]}")
    check(max(abs(f / forces[0] - 1) for f in forces) < 1e-7, f"ranks differ: {forces}")

    # Doubled in length, points are halved, and the force stays that of a grid that is never reset.
    scene = os.path.join(folder, "bar.prm")
    with open(scene, "w") as file:
        file.write(BAR)
    forces = [run_scene(folder, reset, scene, ["MPM/Grid reset=" + reset])[0]["results"]["reaction_top_y_N"]
              for reset in ("never", "always")]
    print(f"doubled in length: {forces[0]:.6e} N, reset {forces[1]:.6e} N")
    check(abs(forces[1] / forces[0] - 1) < 5e-3, f"resets change the force: {forces}")

    # Points of published forces are not halved and come further apart than a cell: the body is torn, and the run says so.
    result, text, output = run_scene(folder, "torn", scene, ["MPM/Internal force=published"], expect=2)
    check("torn between its material points" in result["status"], f"status {result['status']}")
    check(any(name.startswith("checkpoint") for name in os.listdir(output)), "no checkpoint of the torn body")
    run(["run", scene, "--output", output, "--resume"] + settings(["MPM/Internal force=published"]), expect=2)
    check("% full" in text, "no warning before the body is torn")
    print("torn: " + result["status"][:60])
