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
LEFT_OUT = ("steps", "newton", "cg", "wall_time_s", "spread_s", "times", "cpu_time_s", "peak_memory_MB")

# What the test leaves out of a study to stay short: entries to set.
REDUCED = {
    "manufactured_2d": ["Study/resolution/Values=8, 16, 32"],
    "manufactured_3d": ["Study/resolution/Values=4, 8"],
    "kelvin_voigt_manufactured": ["Study/resolution/Values=8, 16", "Study/steps/Values=8, 16"],
    "kelvin_voigt_manufactured_small": ["Study/resolution/Values=8, 16", "Study/steps/Values=8, 16",
                                        "Study/steps of SDIRK 2/Values=32, 64"],
    "kelvin_voigt_creep": ["Study/steps/Values=50, 100, 200"],
    "kelvin_voigt_creep_3d": ["Study/steps/Values=50, 100, 200"],
    "thick_cylinder": ["Study/resolution/Values=4, 8"],
    "cooks_membrane": ["Study/resolution/Values=4, 8"],
    "flat_punch": ["Study/resolution/Values=6, 7"],
    "hertz": ["Study/resolution/Values=6, 7, 8"],
    "hertz_points": ["Study/resolution/Values=20, 40"],
    "stokes_manufactured": ["Study/resolution/Values=8, 16, 32"],
    "cylinder_array": ["Study/resolution/Values=20, 40", "Study/Reference=" + ", ".join(8 * ["1e-6"])],
    "cylinder_in_shell": ["Study/resolution/Values=10, 20", "Study/Reference=" + ", ".join(4 * ["1.34909e-3"])],
    "free_beam": ["Study/resolution/Values=5"],
    "oscillating_plate": ["Study/resolution/Values=5, 10"],
    "kelvin_voigt_layer": ["Study/resolution/Values=20, 40"],
    "kelvin_voigt_layer_3d": ["Study/resolution/Values=8, 16", "Study/resolution of other arrangements/Values=8"],
    "taylor_green_3d": ["Study/resolution/Values=8, 16"],
    "pulled_cylinder": ["Study/resolution/Values=10, 20", "Study/resolution of inertial particles/Values=10"],
    "two_indenters": ["Study/resolution/Values=16"],
    "rolling_disc": ["Study/resolution/Values=16"],
    "turning_body": ["Study/resolution/Values=16, 32", "Study/resolution of inertial particles/Values=16"],
}

# Theory: (scene, cases that start so, column of the error) -> order between the last two values of a curve.
U, GRADIENT = "displacement_error_L2_relative", "displacement_error_H1_relative"
SPACE = [(("MPM", "FEM Q1", "Q1"), U, 2), (("MPM", "FEM Q1", "Q1"), GRADIENT, 1), (("FEM Q2", "Q2", "B-splines at"), U, 3),
         (("FEM Q2", "Q2", "B-splines at"), GRADIENT, 2)]
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
    "particle_poiseuille": [(("NSPH morris", "SPH morris"), "velocity_error_L2_relative", 2)],
    "taylor_green": [(("NSPH morris", "SPH morris"), "velocity_error_L2_relative", 2)],
    "couette": [(("",), "velocity_error_L2_relative", 2)],
    "kelvin_voigt_layer": [(("shear", "compression"), U, 2)],
    "kelvin_voigt_layer_3d": [(("shear morris", "compression"), U, 2)],
    "kelvin_voigt_layer_steps": [(("backward Euler", "explicit"), "error", 1), (("SDIRK 2",), "error", 2)],
    "taylor_green_3d": [(("NSPH morris",), "velocity_error_L2_relative", 2)],
    "stokes_manufactured": [(("",), "velocity_error_L2_relative", 3), (("",), "velocity_error_H1_relative", 2),
                            (("",), "pressure_error_L2_relative", 2)],
    "stokes_nearly_incompressible": [((scheme,), f"{field}_error_L2_relative", n)
                                     for field in ("velocity", "pressure")
                                     for n, scheme in enumerate(("backward Euler", "SDIRK 2", "SDIRK 3"), 1)],
}
KEYS = ("case", "cells", "n", "levels", "Constants/steps", "nu", "Scheme", "End", "hold", "contrast", "gap", "Rate", "Preconditioner")


def locks(row):
    """Whether theory says that this run locks: nearly incompressible, full dilatation."""
    return row.get("nu") == "0.4999" and "projected" not in row["case"]


def key(row):
    return tuple(row[name] for name in KEYS if name in row)


def study(name, folder, reduced):
    """Rows of study.csv, without work and times."""
    output = os.path.join(folder, name)
    run(["study", os.path.join(SCENES, name + ".prm"), "--output", output, "--quiet", "--at-once", "2"]
        + settings(["Study/Repeat=1"] + (REDUCED.get(name, []) if reduced else [])), 2)
    with open(os.path.join(output, "study.csv")) as file:
        return [{column: value for column, value in row.items() if column not in LEFT_OUT} for row in csv.DictReader(file)]


def write(name, rows):
    table = [list(rows[0])] + [list(row.values()) for row in rows]
    widths = [max(map(len, column)) for column in zip(*table)]
    with open(os.path.join(SCENES, name + ".baseline"), "w") as file:
        for row in table:
            file.write("  ".join(cell.rjust(width) for cell, width in zip(row, widths)).rstrip() + "\n")


def read(name):
    """Columns are two spaces or more apart; cells hold single ones."""
    with open(os.path.join(SCENES, name + ".baseline")) as file:
        lines = [[cell.strip() for cell in line.split("  ") if cell.strip()] for line in file]
    return [dict(zip(lines[0], line)) for line in lines[1:]]


def same(column, a, b):
    """Whether two cells agree; '-' is an order that one of the studies cannot know."""
    if column in KEYS or column == "status":
        return a == b
    if column.startswith("order") and "-" in (a, b):
        return True
    a, b = float(a), float(b)
    if column.startswith("order"):
        return abs(a - b) <= ORDER_TOLERANCE + 1e-9
    if column.startswith("deviation"):
        return abs(a - b) <= .01 + 1e-9
    return max(abs(a), abs(b)) < ROUND_OFF or abs(a - b) <= TOLERANCE * abs(b)


def compare(name, rows):
    stored = {key(row): row for row in read(name)}
    for row in rows:
        check(key(row) in stored, f"{name}: the baseline has no {key(row)}; run baselines.py --update {name}")
        wanted = stored[key(row)]
        check(set(row) == set(wanted), f"{name}: columns {list(row)} instead of {list(wanted)}")
        for column in row:
            check(same(column, row[column], wanted[column]),
                  f"{name}: {key(row)} has {column} {row[column]} instead of {wanted[column]}")
    print(f"{name}: {len(rows)} of {len(stored)} runs as stored")


def order(a, b, column):
    """Observed order between two runs and the entry that they differ by."""
    axis = [name for name in KEYS if name in a and a[name] != b[name]]
    check(len(axis) == 1, f"no curve: {a} and {b}")
    return math.log(float(a[column]) / float(b[column])) / math.log(float(b[axis[0]]) / float(a[axis[0]]))


def check_factors(rows):
    """One step multiplies the distance to the equilibrium by R(z), z = G dt/mu; errors are over the displacement at t = mu/G
    of the reference, 2048 steps of SDIRK 2."""
    g = 1 - math.sqrt(.5)
    factors = {"backward Euler": lambda z: 1 / (1 + z), "explicit": lambda z: 1 - z,
               "SDIRK 2": lambda z: (1 - (1 - 2 * g) * z) / (1 + g * z)**2}
    reference = factors["SDIRK 2"](1 / 2048)**2048
    for row in rows:
        steps = int(row["Constants/steps"])
        exact = abs(factors[row["case"]](1 / steps)**steps - reference) / (1 - reference)
        check(abs(float(row["error"]) / exact - 1) < 5e-4, f"{key(row)} has the error {row['error']} instead of {exact:.4e}")
    print(f"kelvin_voigt_layer_steps: {len(rows)} errors as the factor of one step tells")


def check_drift(rows):
    """From 10 to 100 mu/G the displacement stays, unless hourglass modes are free to creep."""
    peaks = {(row["case"], row["hold"]): float(row["max_displacement_m"]) for row in rows}
    for case in sorted({row["case"] for row in rows}):
        drift = peaks[case, "100"] / peaks[case, "10"] - 1
        print(f"long_hold: {case}: drift {drift:.1e}")
        check(drift > .5 if case == "published" else abs(drift) < 1e-3, f"long_hold: {case} drifts by {drift}")


def check_theory(name, rows):
    for cases, column, theory in THEORY.get(name, []):
        curves = {}
        for row in rows:
            curve = row.get("case", row.get("Scheme", ""))
            if any(curve == case or curve.startswith(case + " ") or not case for case in cases) and not locks(row):
                curves.setdefault((curve, row.get("nu")), []).append(row)
        check(curves, f"{name}: no run of {cases}")
        for curve, members in curves.items():
            found = order(members[-2], members[-1], column)
            check(abs(found - theory) < .1, f"{name}, {curve}: order {found:.3f} of {column} instead of {theory}")
        print(f"{name}: {column} of order {theory} in {len(curves)} curves")
    if name == "thick_cylinder":
        errors = {key(row): float(row[U]) for row in rows}
        for degree, factor in (("Q1", 100), ("Q2", 50)):
            full, projected = (errors[case, "8", "0.4999"] for case in (degree, degree + " projected"))
            print(f"{degree} at nu = .4999: {full:.2e}, projected {projected:.2e}")
            check(full > factor * projected, f"{degree} does not lock: {full} against {projected}")
    if name == "kelvin_voigt_layer_steps":
        check_factors(rows)
    if name == "long_hold":
        check_drift(rows)


if __name__ == "__main__":
    update = "--update" in sys.argv
    chosen = [word for word in sys.argv[1:] if word != "--update"]
    names = chosen or sorted(os.path.splitext(one)[0] for one in os.listdir(SCENES)
                             if one.endswith(".prm" if update else ".baseline"))
    check(names, "no baseline")
    for scene in names:
        with Folder() as folder:
            rows = study(scene, folder, reduced=not update)
            if update:
                write(scene, rows)
            else:
                compare(scene, rows)
            check_theory(scene, rows)
