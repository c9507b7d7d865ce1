"""Rigid bodies are the same to every method: a surface from a file is the shape that could have been drawn, and what a support
holds goes nowhere by a load."""
import os

from program import Folder, block, check, settings, summary
from server import run

LOWER, UPPER = (.25, .25, .5), (.75, .75, .75)
SCENE = """
subsection Supports
  subsection bottom
    set Where = side {axis}-min
    set Type  = clamp
  end
  subsection drive
    set Where = body core
  end
end
subsection Time
  set Initial step = 0.5
  set Largest step = 0.5
end
subsection FEM
  set Cells  = {cells}
  set Degree = 1
end
subsection MPM
  set Cells = {cells}
end
subsection NSPH
  set Spacing = 0.125
end
subsection SPH
  set Spacing = 0.125
end
subsection Output
  set Point fields = none
  set Grid fields  = false
end
"""
PLANE, SPACE = SCENE.format(axis="y", cells="8, 8"), SCENE.format(axis="z", cells="8, 8, 8")
ELASTIC = "set Law = {}\n set Young's modulus = 1\n set Poisson's ratio = 0.3"
VISCOUS = "\n set Viscosity = 0.1\n set Density = 1"
OF_PARTICLES = ELASTIC.format("hypoelastic") + VISCOUS
FLUID = "set Law = fluid\n set Bulk modulus = 10" + VISCOUS
MOVED = ["Supports/drive/Displacement=0; 0.01*t; -0.02*t", "Supports/drive/Rotation=0; 0; 0.1*t"]
FLOWING = ["FEM/Degree=2", "Supports/drive/Type=velocity", "Supports/drive/Velocity=0; 0.01; -0.02", "Supports/drive/Angular velocity=0; 0; 0.1",
           "Supports/bottom/Type=velocity", "Supports/bottom/Velocity=0; 0; 0"]
# The body comes down on the material.
PRESSED = ["MPM/Upper corner=1, 1, 1.25", "Bodies/core/Pivot=0.5, 0.5, 1.125", "Supports/drive/Displacement=0; 0; -0.03*t", "Contact/touch/Body=core"]


def box(lower, upper):
    """The surface of a box as STL."""
    def corner(bits):
        return tuple((lower, upper)[bits >> d & 1][d] for d in range(3))

    sides = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]  # anticlockwise from outside
    triangles = [t for a, b, c, d in sides for t in ((a, b, c), (a, c, d))]
    facets = ["facet normal 0 0 0\nouter loop\n" + "".join("vertex {} {} {}\n".format(*corner(v)) for v in t) +
              "endloop\nendfacet\n" for t in triangles]
    return "solid box\n" + "".join(facets) + "endsolid box\n"


def results(folder, name, dimension, material, entries):
    scene, output = os.path.join(folder, "scene.prm"), os.path.join(folder, name)
    with open(scene, "w") as file:
        file.write(block(dimension, material, PLANE if dimension == 2 else SPACE))
    run(["run", scene, "--quiet", "--output", output] + settings(["Bodies/core/Rigid=true"] + entries))
    return {key: value for key, value in summary(output)["results"].items() if key.startswith(("core_", "contact_", "reaction_"))}


def differences(one, other):
    """Of forces and of torques, over the largest of both."""
    largest = max(abs(value) for name, value in one.items() if name.endswith("_N"))
    return max(abs(one[name] - other[name]) for name in one if name.endswith(("_N", "_Nm"))) / largest


# name: material, entries, whether the body is in contact, how near the results are
CASES = {
    "FEM": (ELASTIC.format("neo-Hookean"), ["Method=fem"] + MOVED, False, 1e-9),
    "FEM, contact": (ELASTIC.format("neo-Hookean"), ["Method=fem"] + PRESSED, True, 1e-9),
    "FEM, fluid": (FLUID, ["Method=fem", "FEM/Cells=4, 4, 4"] + FLOWING, False, 1e-9),
    "MPM": (ELASTIC.format("neo-Hookean"), ["Method=mpm"] + MOVED, False, 1e-3),
    "MPM, contact": (ELASTIC.format("neo-Hookean"), ["Method=mpm"] + PRESSED, True, 1e-9),
    "NSPH": (OF_PARTICLES, ["Method=nsph"] + MOVED, False, 1e-9),
    "NSPH, facets": (OF_PARTICLES, ["Method=nsph", "NSPH/Walls=facets", "NSPH/Closing tolerance=1e-12",
                                    "Linear solver/Tolerance=1e-11"] + MOVED, False, 1e-9),
    "NSPH, contact": (OF_PARTICLES, ["Method=nsph"] + PRESSED, True, 1e-9),
    "SPH": (OF_PARTICLES, ["Method=sph"] + MOVED, False, 1e-9),
    "SPH, fluid": (FLUID, ["Method=sph"] + FLOWING, False, 1e-9),
}

with Folder() as folder:
    for name, (material, entries, touches, near) in CASES.items():
        lower, upper = [c[:2] + (c[2] + .5 * touches,) for c in (LOWER, UPPER)]
        surface = os.path.join(folder, "box.stl")
        with open(surface, "w") as file:
            file.write(box(lower, upper))
        drawn = results(folder, name + "-drawn", 3, material, entries + [
            "Bodies/core/Shape=box", "Bodies/core/Lower corner=" + ", ".join(map(str, lower)),
            "Bodies/core/Upper corner=" + ", ".join(map(str, upper))])
        read = results(folder, name + "-read", 3, material, entries + ["Bodies/core/Shape=surface", "Bodies/core/File=" + surface])
        difference = differences(drawn, read)
        print(f"{name}: {drawn['core_force_z_N']:.4g} N, surface off by {difference:.1e}")
        check(drawn.keys() == read.keys() and abs(drawn["core_force_z_N"]) > 1e-4, f"{name}: {drawn}, {read}")
        check(difference < near, f"{name}: {drawn}, {read}")

    # The load along x is borne by the support that moves the body along x, and nothing else differs.
    guided = ["Bodies/core/Shape=box", "Bodies/core/Lower corner=0.25, 0.5", "Bodies/core/Upper corner=0.75, 0.75",
              "Bodies/core/Density=1", "Loads/push/Where=body core"]
    solid = guided + ["Supports/drive/Displacement=0.01*t; free", "Supports/drive/Rotation=0"]
    fluid = guided + ["FEM/Degree=2", "Supports/drive/Type=velocity", "Supports/drive/Velocity=0.01; free", "Supports/drive/Angular velocity=0",
                      "Supports/bottom/Type=velocity", "Supports/bottom/Velocity=0; 0"]
    for name, material, entries in (("fem", ELASTIC.format("neo-Hookean"), solid), ("mpm", ELASTIC.format("neo-Hookean"), solid),
                                    ("nsph", OF_PARTICLES, solid), ("sph", OF_PARTICLES, solid),
                                    ("fem", FLUID, fluid), ("nsph", FLUID, fluid), ("sph", FLUID, fluid)):
        without, loaded = [results(folder, f"{name}-{len(entries)}-{force}", 2, material, entries + [
            "Method=" + name, f"Loads/push/Total force={force}*t; -0.002*t"]) for force in ("0", "0.005")]
        borne = {key: without[key] - loaded[key] for key in without}
        print(f"{name}, {'fluid' if entries is fluid else 'solid'}: of 0.005 N the support bears {borne.pop('reaction_drive_x_N'):.4g} N")
        check("reaction_drive_y_N" not in loaded, f"{name}: {loaded}")
        check(abs(without["reaction_drive_x_N"] - loaded["reaction_drive_x_N"] - .005) < 1e-9, f"{name}: {without}, {loaded}")
        check(abs(without["reaction_drive_x_N"] - without["core_force_x_N"]) < 1e-9, f"{name}: {without}")
        check(max(map(abs, borne.values())) < 1e-9, f"{name}: {borne}")
