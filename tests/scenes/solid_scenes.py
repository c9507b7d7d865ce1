"""Scenes of solids, by finite elements unless they say so, of the tests of ranks and of resuming: name -> (parameter file, entries)."""
import os

from program import HERE

SURFACE = os.path.join(HERE, "surface.prm")
SOLID = os.path.join(HERE, "solid.prm")
NOTHING_VISCOUS = ["Materials/gel/Viscosity=0", "Bodies/inclusion/Material=gel"]
INDENTER = ["Bodies/ball/Shape=ball", "Bodies/ball/Rigid=true", "Bodies/ball/Centre=0, 0.302", "Bodies/ball/Radius=0.3",
            "Loads/push/Where=body ball", "Loads/push/Total force=0; -30*t",
            "Supports/guide/Where=body ball", "Supports/guide/Displacement=0; free",
            "FEM/Refinement/top/Where=ball 0, 0 : 0.2"]
TURNED = ["Bodies/core/Shape=box", "Bodies/core/Lower corner=0.25, -0.75", "Bodies/core/Upper corner=0.75, -0.5",
          "Bodies/core/Rigid=true", "Bodies/core/Pivot=0.3, -0.6", "Supports/drive/Where=body core",
          "Supports/drive/Displacement=0.02*t; free", "Supports/drive/Rotation=free",
          "Loads/turn/Where=body core", "Loads/turn/Torque=30*t"]
DRAGGED = ["FEM/Cells=8, 16", "Bodies/grain/Shape=box", "Bodies/grain/Lower corner=H/8, H/4",
           "Bodies/grain/Upper corner=H/4, H/2", "Bodies/grain/Rigid=true", "Loads/pull/Where=body grain",
           "Loads/pull/Total force=1e-4*t; 0", "Loads/pull/Torque=1e-7*t"]
FLUID = os.path.join(HERE, "..", "..", "parameters", "verification", "stokes_nearly_incompressible.prm")

SCENES = {
    "viscous, two error cycles": (SOLID, ["FEM/Scheme=SDIRK 2", "FEM/Error cycles=2"]),
    "viscous, Q1, projected": (SOLID, ["FEM/Scheme=SDIRK 3", "FEM/Degree=1", "FEM/Dilatation=projected"]),
    "Prony": (SOLID, NOTHING_VISCOUS + ["Materials/gel/Law=Prony", "Materials/gel/Kelvin-Voigt viscosity=300"]),
    "dynamic": (SOLID, ["FEM/Inertia=true", "Bodies/block/Initial velocity=0.1*y; 0"]),
    "periodic, small strains": (SOLID, ["Periodic/Directions=x", "FEM/Kinematics=small",
                                        "FEM/Refinement/top/Where=nearest 0.3, -0.3"]),
    "rigid body, turned by a torque": (SOLID, TURNED),
    "contact, stick": (SOLID, NOTHING_VISCOUS + INDENTER + ["Contact/touch/Type=stick"]),
    "contact, frictionless, viscous": (SOLID, INDENTER + ["Contact/touch/Type=frictionless"]),
    "contact with friction, and a mass": (SOLID, NOTHING_VISCOUS + INDENTER + [
        "Contact/touch/Type=Coulomb", "Contact/touch/Friction coefficient=0.1", "Supports/guide/Displacement=0.02*t; free",
        "FEM/Inertia=true", "Bodies/ball/Mass=20"]),
    "contact with a surface from a file": (SURFACE, []),
    "contact of a ball that turns, MPM": (SOLID, INDENTER[:-1] + [
        "Method=mpm", "MPM/Cells=12, 6", "MPM/Upper corner=1, 0.03", "Contact/touch/Type=stick",
        "Supports/guide/Displacement=0.01*t; free", "Supports/guide/Rotation=free", "Loads/push/Torque=0.5*t"]),
    "fluid with a bulk modulus": (FLUID, []),
    "fluid with a body that a force and a torque move": (FLUID, DRAGGED),
}
