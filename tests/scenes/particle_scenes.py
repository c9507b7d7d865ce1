"""Particle scenes of the tests of ranks and of resuming: name -> (parameter file, entries)."""
import os

from program import HERE

BLOCK = os.path.join(HERE, "particles.prm")
PILLARS = os.path.join(HERE, "..", "..", "parameters", "heck2017", "pillars.prm")
VORTICES = os.path.join(HERE, "..", "..", "parameters", "verification", "taylor_green.prm")
WATER = os.path.join(HERE, "still_water.prm")
MIGRATION = os.path.join(HERE, "..", "..", "parameters", "heck2017", "migration.prm")
SHORT_PILLARS = ["Constants/dp=4e-4", "Time/Initial step=0.05", "Time/Largest step=0.05", "Time/End=1"]
# A disc that comes from the right, pushes the block, rubs along it and goes away again.
CONTACT = ["Bodies/disc/Shape=ball", "Bodies/disc/Centre=1.21, 0.5", "Bodies/disc/Radius=0.2", "Bodies/disc/Rigid=true",
           "Supports/drive/Where=body disc", "Supports/drive/Displacement=-0.05*sin(4*t); 0.01*t", "Contact/touch/Body=disc"]

# The disc presses a flake that nothing holds against a bar. (Loose again it bears no force, and round-off decides what touches.)
FLAKE = CONTACT + ["Time/End=0.45", "Bodies/disc/Centre=1.61, 0.5", "Bodies/flake/Shape=box", "Bodies/flake/Lower corner=1.2, 0.3",
                   "Bodies/flake/Upper corner=1.4, 0.6", "Bodies/flake/Material=gel", "Bodies/bar/Shape=box",
                   "Bodies/bar/Lower corner=1.15, 0.2", "Bodies/bar/Upper corner=1.195, 0.7", "Bodies/bar/Rigid=true",
                   "Contact/rest/Body=bar"]

# No jump of stiffness: stress, friction and hourglass control are summed at once.
ONE_SOLID = ["Materials/stiff/Young's modulus=2.5", "Materials/stiff/Poisson's ratio=0.45"]

# Two rigid bodies, which forces and a torque move.
BODIES = ["Bodies/bead/Shape=ball", "Bodies/bead/Rigid=true", "Bodies/bead/Centre=0.25, 0.75", "Bodies/bead/Radius=0.15",
          "Bodies/bead/Pivot=0.2, 0.75", "Bodies/bead/Density=3", "Loads/pull/Where=body bead",
          "Loads/pull/Total force=0.05*t; 0.1*t", "Loads/pull/Torque=-0.02*t",
          "Bodies/stone/Shape=box", "Bodies/stone/Rigid=true", "Bodies/stone/Lower corner=0.7, 0.2",
          "Bodies/stone/Upper corner=0.9, 0.4", "Bodies/stone/Mass=0.2", "Bodies/stone/Drag=0.1",
          "Supports/guide/Where=body stone", "Supports/guide/Displacement=0.02*t; free",
          "Supports/guide/Rotation=free"]

SCENES = {
    "NSPH": (BLOCK, []),
    "NSPH, backward Euler": (BLOCK, ["NSPH/Scheme=backward Euler"]),
    "NSPH, explicit": (BLOCK, ["NSPH/Stress update=explicit", "Materials/gel/Viscous operator=morris",
                               "Materials/stiff/Viscous operator=morris", "Time/Initial step=1/64", "Time/Largest step=1/64"]),
    "NSPH, published": (BLOCK, ["NSPH/Formulation=published", "NSPH/Stabilisation=1.25", "Materials/gel/Viscous operator=morris",
                                "Materials/stiff/Viscous operator=morris", "Time/Initial step=1/32", "Time/Largest step=1/32"]),
    "NSPH, multigrid": (BLOCK, ["Linear solver/Preconditioner=amg"]),
    "NSPH, contact": (BLOCK, CONTACT),
    "NSPH, islands": (BLOCK, FLAKE),
    "NSPH, contact by distance": (BLOCK, CONTACT + ["NSPH/Contact/Criterion=heck"]),
    "SPH": (BLOCK, ["Method=sph"]),
    "SPH, one solid": (BLOCK, ["Method=sph"] + ONE_SOLID),
    "NSPH, bodies": (BLOCK, BODIES),
    "SPH, bodies": (BLOCK, ["Method=sph"] + BODIES),
    "SPH, frictionless contact": (BLOCK, CONTACT + ["Method=sph", "Contact/touch/Type=frictionless"]),
    "NSPH, migration": (MIGRATION, ["Constants/width=160", "Constants/length=200", "Constants/start=90", "Bodies/cell/Radius=20",
                                    "Migration/cell/Force=5e-6", "Degradation/cell/Width=20", "Degradation/cell/Initial width=20",
                                    "Time/End=6", "Constants/step=0.5", "NSPH/Closing tolerance=1e-13", "Output/Point fields=none"]),
    "NSPH, pillars": (PILLARS, ["Method=nsph"] + SHORT_PILLARS),
    "SPH, pillars": (PILLARS, ["Method=sph"] + SHORT_PILLARS),
    "NSPH, vortices": (VORTICES, ["Constants/n=10", "Time/End=300", "Time/Initial step=20", "Time/Largest step=20"]),
    "NSPH, water": (WATER, ["Method=nsph", "NSPH/Jitter=0.2", "Time/End=4", "Time/Initial step=0.25", "Time/Largest step=0.25"]),
    "SPH, water": (WATER, ["Method=sph", "SPH/Jitter=0.2", "Time/End=0.8", "Time/Initial step=0.05", "Time/Largest step=0.05"]),
}
