"""Studies of parameters/verification against their stored tables (NAME.baseline), and orders of convergence against theory.

    baselines.py            runs every study that has a baseline (reduced as below) and compares
    baselines.py --update   writes the tables anew
    baselines.py NAME ...   only these scenes
"""
import csv
import math
import os
import sys

from program import Folder, HERE, check, run, settings

SCENES = os.path.join(HERE, "..", "..", "parameters", "verification")
TOLERANCE, ORDER_TOLERANCE = 1e-3, .02
ROUND_OFF = 1e-9  # relative errors below are those of the solvers
LEFT_OUT = ("steps", "newton", "cg", "wall_time_s", "spread_s", "times")

# What the test leaves out of a study to stay short: entries to set.
REDUCED = {
    "manufactured_2d": ["Study/resolution/Values=8, 16, 32"],
    "manufactured_3d": ["Study/resolution/Values=4, 8"],
    "kelvin_voigt_manufactured": ["Study/resolution/Values=8, 16", "Study/steps/Values=4, 8"],
    "kelvin_voigt_manufactured_small": ["Study/resolution/Values=8, 16", "Study/steps/Values=8, 16"],
    "kelvin_voigt_creep": ["Study/steps/Values=50, 100, 200"],
    "kelvin_voigt_creep_3d": ["Study/steps/Values=50, 100, 200"],
    "thick_cylinder": ["Study/resolution/Values=4, 8"],
    "cooks_membrane": ["Study/resolution/Values=4, 8"],
    "stokes_manufactured": ["Study/resolution/Values=8, 16, 32"],
}

# Theory: (scene, cases that start so, column of the error) -> order between the last two values of a curve.
U, GRADIENT = "displacement_error_L2_relative", "displacement_error_H1_relative"
SPACE = [(("MPM", "FEM Q1", "Q1"), U, 2), (("MPM", "FEM Q1", "Q1"), GRADIENT, 1), (("FEM Q2", "Q2"), U, 3),
         (("FEM Q2", "Q2"), GRADIENT, 2)]
IN_TIME = [(("backward Euler", "central backward Euler", "morris backward Euler", "deviatoric backward Euler"), U, 1),
           (("SDIRK 2", "central SDIRK 2", "morris SDIRK 2", "deviatoric SDIRK 2"), U, 2),
           (("SDIRK 3", "central SDIRK 3", "morris SDIRK 3", "deviatoric SDIRK 3"), U, 3)]
THEORY = {
    "manufactured_2d": SPACE,
    "manufactured_3d": SPACE,
    "kelvin_voigt_manufactured": SPACE + IN_TIME,
    "kelvin_voigt_manufactured_small": SPACE + IN_TIME,
    "kelvin_voigt_creep": IN_TIME,
    "kelvin_voigt_creep_3d": IN_TIME,
    "thick_cylinder": SPACE,
    "stokes_manufactured": [(("",), "velocity_error_L2_relative", 3), (("",), "velocity_error_H1_relative", 2),
                            (("",), "pressure_error_L2_relative", 2)],
}
