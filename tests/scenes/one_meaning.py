"""One scene means the same to every method: resultants of loads and momenta against exact values."""
import math
import os

from program import Folder, check, settings, summary
from server import run

THICKNESS = .5

BASE = """set Dimension = 2
set Thickness = 0.5
subsection Materials
  subsection gel
    set Law = LAW
    set Young's modulus = 1000
    set Poisson's ratio = 0.3
    set Density = 2
    VISCOUS
  end
  subsection core
    set Law = LAW
    set Young's modulus = 2000
    set Poisson's ratio = 0.3
    set Density = 2
    VISCOUS
  end
end
subsection Bodies
  subsection block
    set Shape = box
    set Material = gel
  end
  subsection inner
    set Shape = box
    set Lower corner = 0.25, 0.5
    set Upper corner = 0.75, 0.75
    set Material = core
  end
end
subsection Supports
  subsection bottom
    set Where = side y-min
    set Type = clamp
  end
end
subsection Time
  set End = 0.01
  set Initial step = 0.01
end
subsection FEM
  set Cells = 8, 8
  set Degree = 1
end
subsection MPM
  set Cells = 8, 8
  set Points per cell = 2, 2
  set Lower corner = 0, 0
  set Upper corner = 1, 1
end
subsection NSPH
  set Spacing = 1/32
end
subsection SPH
  set Spacing = 1/32
end
subsection Output
  set Point fields = none
  set Grid fields = false
end
"""

# Name of a load -> (where, entry, exact force on the thickness [N]). Regions cut cells and particles and overlap bodies.
DENSITY = (3., -2.)
LOADS = {
    "all": ("all", "Force density", 1.),
    "a cut box": ("box 0.1, 0.3 : 0.43, 0.81", "Force density", .33 * .51),
    "a cut layer": ("layer y-max 0.3", "Force density", .3),
    "a ball": ("ball 0.5, 0.5 : 0.3", "Force density", math.pi * .09),
    "the later body": ("material core", "Force density", .125),
    "the total of a cut box": ("box 0.1, 0.3 : 0.43, 0.81", "Total force", 1. / THICKNESS),
    "the total of the nearest": ("nearest 0.52, 0.98", "Total force", 1. / THICKNESS),
}

# Material points count as a whole: their error at a region's edge is up to half a point over the region's width.
TOLERANCE = {"fem": {"a ball": 3e-3}, "mpm": {"a cut box": .12, "a cut layer": .05, "a ball": .06},
             "nsph": {"a cut box": 5e-3, "a cut layer": 5e-3, "a ball": 5e-3}}


def scene(folder, method):
    """Path of the scene for a method; finite elements and material points solve it without viscosity."""
    viscous = "set Viscosity = 100\n set Viscous operator = morris" if method in ("nsph", "sph") else ""
    law = "hypoelastic" if method in ("nsph", "sph") else "linear elastic"
    path = os.path.join(folder, method + ".prm")
    with open(path, "w") as file:
        file.write(f"set Method = {method}\n" + BASE.replace("VISCOUS", viscous).replace("LAW", law))
    return path


def load(where, entry):
    return [f"Loads/push/Where={where}", f"Loads/push/{entry}={DENSITY[0]}; {DENSITY[1]}"]


def results(folder, method, entries, name="out"):
    output = os.path.join(folder, method + name)
    run(["run", scene(folder, method), "--quiet", "--overwrite", "--output", output] + settings(entries))
    return summary(output)["results"]


with Folder() as folder:
    # The reaction balances the load.
    for name, (where, entry, volume) in LOADS.items():
        for method in ("fem", "mpm", "nsph"):
            got = results(folder, method, load(where, entry))
            tolerance = TOLERANCE[method].get(name, 1e-4)
            for axis, density in zip("xy", DENSITY):
                exact = -density * volume * THICKNESS
                force = got[f"reaction_bottom_{axis}_N"]
                check(abs(force - exact) <= tolerance * abs(exact),
                      f"{method}, load on {name}: reaction {force} N along {axis} instead of {exact} N")

    # Two loads on regions that overlap add up.
    for method in ("fem", "mpm", "nsph"):
        got = results(folder, method, load("all", "Force density") + ["Loads/more/Where=material core",
                                                                    "Loads/more/Total force=1; 0"])
        check(abs(got["reaction_bottom_x_N"] + 3 * THICKNESS + 1) < 1e-5, f"{method}: two loads give {got['reaction_bottom_x_N']}")

    # Where bodies overlap the later one says with what velocity the material starts, also if it says none.
    for inner, share in (("", .875), ("Bodies/inner/Initial velocity=0; 0.02", .875 + 4 * .125)):
        energy = .5 * 2. * .01 ** 2 * share * THICKNESS
        for method, tolerance in (("fem", .06), ("sph", 1e-3)):
            results(folder, method, ["Bodies/block/Initial velocity=0.01; 0", "FEM/Cells=32, 32", "Supports/bottom/Where=box 0, 0 : 1, 0.04",
                                     "Supports/bottom/Displacement=free; 0", "Supports/bottom/Type=displacement",
                                     "FEM/Inertia=true", "Time/End=1e-6", "Time/Initial step=1e-6"] + ([inner] if inner else []))
            with open(os.path.join(folder, method + "out", "series.csv")) as file:
                names, start = (line.strip().split(",") for line in list(file)[:2])
            got = float(start[names.index("kinetic_energy_J")])
            check(abs(got - energy) < tolerance * energy, f"{method}: {got} J at the start instead of {energy} J")

    # A support that reaches one of two sides that repeat holds them both.
    got = results(folder, "fem", load("all", "Force density") + [
        "Periodic/Directions=x", "Supports/patch/Where=box 0.99, 0.5 : 1, 0.7", "Supports/patch/Displacement=free; 0"])
    check(got["reaction_patch_y_N"] > .05 and abs(got["reaction_patch_y_N"] + got["reaction_bottom_y_N"] - 1.) < 1e-6,
          f"the patch holds {got['reaction_patch_y_N']} N, the bottom {got['reaction_bottom_y_N']} N, of 1 N")

    # A rigid body moves as a whole, and a side where the scene repeats is no side.
    rigid = ["Bodies/pillar/Shape=box", "Bodies/pillar/Rigid=true", "Bodies/pillar/Lower corner=0.375, 0.125",
             "Bodies/pillar/Upper corner=0.625, 0.375", "Supports/drive/Where=body pillar", "Supports/drive/Displacement=0.01*t*y; 0"]
    for method in ("fem", "nsph", "sph"):
        done = run(["check", scene(folder, method)] + settings(rigid), expect=1)
        check("'drive' on rigid body 'pillar' depends on place" in done.stderr, done.stderr)
        done = run(["check", scene(folder, method)] + settings(["Periodic/Directions=y"]), expect=1)
        check("support 'bottom' acts on side y-min, where the scene repeats" in done.stderr, done.stderr)

    # A load that nothing can balance is refused.
    for method, words in (("fem", "the supports leave the bodies free to move"), ("nsph", "the loads sum up to 1.5 N along x, and nothing holds the scene")):
        path = scene(folder, method)
        with open(path) as file:
            text = file.read()
        with open(path, "w") as file:
            file.write(text[:text.index("subsection Supports")] + text[text.index("subsection Time"):])
        done = run(["check", path] + settings(load("all", "Force density") + ["Periodic/Directions=x, y"]), expect=1)
        check(words in done.stderr, done.stderr)
    # The log says which law a name stands for, and which material no body is made of.
    done = run(["run", scene(folder, "fem"), "--output", os.path.join(folder, "laws")] + settings(
        ["Bodies/inner/Material=gel"]))
    for words in ("St. Venant-Kirchhoff, S = lambda tr E I + 2 mu E", "no body is made of material 'core'"):
        check(words in done.stdout + done.stderr, f"not said: {words}")
    print("one meaning: all methods agree")
