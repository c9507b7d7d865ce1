"""The point layout and the allocated matrices and vectors are exactly those that a scene needs."""
import os

from program import Folder, HERE, block, check, settings, stretched, summary
from server import run

ALWAYS = {"point field: volume", "matrix: stiffness", "vector: displacement", "vector: unbalanced force",
          "vector: displacement with ghosts"}
OPTIONAL = {"point field: material": 8, "point field: deformation gradient": 32, "point field: displacement": 16,
            "point field: support": 8, "point field: sides": 16, "point field: weight": 8, "point field: load": 8, "vector: external force": 0, "vector: last increment": 0, "cells without unknowns": 0, "grid reset": 0,
            "algebraic multigrid": 0, "matrices of cells with geometric multigrid": 0, "vector: velocity with ghosts": 0, "vector: acceleration with ghosts": 0,
            "point field: velocity gradient": 32, "GMRES instead of conjugate gradients": 0,
            "material history": 8 * 12, "voxels instead of points": 0, "ghost points": 0, "contact": 0, "inertia": 0}
HANDLER = 2 * 16 + 4 + 4  # place, place in the cell, id, handle: two dimensions

SCENES = [
    ("two materials, never reset", [], {"voxels instead of points", "algebraic multigrid"}),
    ("all points", ["MPM/Integration=all points"], {"point field: material", "algebraic multigrid"}),
    ("jacobi", ["Linear solver/Preconditioner=jacobi"], {"voxels instead of points"}),
    ("geometric", ["Linear solver/Preconditioner=geometric"],
     {"voxels instead of points", "matrices of cells with geometric multigrid"}),
    ("large grid", ["MPM/Cells=152, 160", "Bodies/construct/Phantom/Size=256, 256, 1", "Supports/top/Displacement=free; 1e-3*y*t", "Time/Initial step=1", "Time/Largest step=1"],
     {"voxels instead of points", "matrices of cells with geometric multigrid"}),
    ("reset", ["MPM/Grid reset=always"],
     {"point field: material", "point field: deformation gradient", "point field: displacement", "point field: support",
      "point field: sides", "point field: weight", "cells without unknowns", "grid reset", "algebraic multigrid"}),
    ("published", ["MPM/Internal force=published"],
     {"point field: material", "point field: deformation gradient", "point field: displacement", "algebraic multigrid"}),
    ("driven layer", ["Supports/top/Where=layer y-max 2"],
     {"point field: material", "point field: support", "algebraic multigrid"}),
    ("viscous and reset", ["Materials/collagen/Viscosity=1", "MPM/Grid reset=always"],
     {"point field: material", "point field: deformation gradient", "point field: displacement", "point field: support",
      "point field: velocity gradient", "vector: velocity with ghosts", "GMRES instead of conjugate gradients",
      "point field: sides", "point field: weight", "cells without unknowns", "grid reset", "algebraic multigrid"}),
    ("history", ["Materials/collagen/Law=Prony", "Materials/collagen/Relaxation times=1",
                 "Materials/collagen/Shear parts g=0.5", "Materials/collagen/Bulk parts k=0.5"],
     {"point field: material", "material history", "algebraic multigrid"}),
    ("load", ["Loads/weight/Where=all", "Loads/weight/Total force=0; -1e-10*t"],
     {"point field: material", "vector: external force", "algebraic multigrid"}),
    ("grid larger than the body", ["MPM/Upper corner=80, 64", "MPM/Cells=20, 16"],
     {"voxels instead of points", "cells without unknowns", "algebraic multigrid"}),
]

with Folder() as folder:
    for number, (name, entries, wanted) in enumerate(SCENES):
        if "grid reset" not in wanted:  # the increment is of use on the same grid only
            wanted = wanted | {"vector: last increment"}
        output = os.path.join(folder, str(number))
        run(["run", os.path.join(HERE, "small.prm"), "--output", output] + settings(entries))
        result = summary(output)
        are_voxels = "voxels instead of points" in wanted
        never = {"point field: volume"} if are_voxels else set()
        never |= {"matrix: stiffness"} if "matrices of cells with geometric multigrid" in wanted else set()
        check(set(result["used"]) == (ALWAYS - never) | wanted, f"{name}: uses {sorted(result['used'])}")
        check(set(result["left_out"]) == (set(OPTIONAL) | never) - wanted, f"{name}: leaves out {sorted(result['left_out'])}")
        size = 1 if are_voxels else HANDLER + 8 + sum(OPTIONAL[part] for part in wanted)
        check(result["bytes_per_point"] == size, f"{name}: {result['bytes_per_point']} bytes a point instead of {size}")
        check(not set(result["used"]) & set(result["left_out"]), f"{name}: used and left out at once")
        print(f"{name}: {size} bytes a point, {len(result['used'])} parts")

    # Fields that do not fit into what the limit leaves are left out, and that is said once.
    output = os.path.join(folder, "large grid")
    said = run(["run", os.path.join(HERE, "small.prm"), "--output", output] +
               settings(["MPM/Cells=300, 300", "Memory limit=0.3", "Output/Grid fields=true", "Output/Fields every=1"]))
    check(said.stderr.count("from here on they are left out") == 1, f"large grid: says '{said.stderr}'")
    check(not os.path.exists(os.path.join(output, "grid.pvd")), "large grid: fields on it are written")

    # One material, no index: a scene with a single material.
    output = os.path.join(folder, "single")
    scene = os.path.join(folder, "single.prm")
    with open(scene, "w") as file:
        file.write(block(3, "set Law = linear elastic\n set Young's modulus = 1000\n set Poisson's ratio = 0.3",
                         stretched("z", "free; free; 0.01*t") + """subsection MPM
  set Cells = 4, 4, 4
end
"""))
    run(["run", scene, "--output", output])
    result = summary(output)
    check(set(result["used"]) == ALWAYS | {"algebraic multigrid", "vector: last increment"}, f"single material: uses {sorted(result['used'])}")
    check(result["bytes_per_point"] == 2 * 24 + 4 + 4 + 8, f"single material: {result['bytes_per_point']} bytes a point")
    print("single material, 3D:", result["bytes_per_point"], "bytes a point")

    # Particles: no material index and no moduli that the scene does not need.
    viscous = "\n set Viscosity = 1\n set Viscous operator = morris\n set Density = 1"
    clamp = """
subsection Supports
  subsection bottom
    set Where = side y-min
    set Type  = clamp
  end
end
subsection Time
  set End = 0.1
end
subsection NSPH
  set Spacing = 0.1
end
subsection SPH
  set Spacing = 0.1
end
"""
    solid = "set Law = hypoelastic\n set Young's modulus = 1\n set Poisson's ratio = 0.3"
    fluid = "set Law = fluid\n set Bulk modulus = 10"
    periodic = "subsection Periodic\n set Directions = x\nend"
    needed = {"point field: " + field for field in
              ("id", "place", "initial place", "velocity", "initial volume", "volume ratio", "mover", "place of search", "place of pairs",
               "volume ratio of pairs")}
    for name, material, more, method, wanted in [
            ("solid particles", solid, "", "nsph",
             {"point field: deviatoric stress", "point field: closure", "closed area vectors", "friction of pairs",
              "hourglass control", "stiffness in the velocity system"}),
            ("fluid particles", fluid, periodic, "sph",
             {"point field: closure", "closed area vectors", "friction of pairs", "ghost particles", "periodic images", "inertia", "point field: excess",
              "shifts of crowded particles"})]:
        scene = os.path.join(folder, "particles.prm")
        with open(scene, "w") as file:
            file.write(block(2, material + viscous, clamp + more))
        output = os.path.join(folder, name)
        run(["run", scene, "--output", output] + settings(["Method=" + method]))
        result = summary(output)
        optional = {"point field: material", "point field: deviatoric stress", "point field: closure",
                    "held particles", "ghost particles", "periodic images", "closed area vectors", "friction of pairs",
                    "friction of velocity gradients", "hourglass control", "interfaces between materials", "inertia", "grid", "shifts of crowded particles", "point field: excess",
                    "point field: contact", "contact", "walls of facets", "point field: degradation factor", "point field: free surface", "degradation"}
        if method == "nsph":
            optional.add("stiffness in the velocity system")
        check(set(result["used"]) == needed | {"fixed particles"} | wanted, f"{name}: uses {sorted(result['used'])}")
        check(set(result["left_out"]) == optional - wanted, f"{name}: leaves out {sorted(result['left_out'])}")
        print(f"{name}: {result['bytes_per_point']:.0f} bytes a point, {len(result['used'])} parts")
