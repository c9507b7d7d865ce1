"""What contrib/plot draws of a run: force over strain, or over time where the strain is held; the force that is driven, as in shear;
components of a tensor with their names; a number without a unit without a prefix; and its options, in all formats."""
import os
import subprocess
import sys

from program import Folder, HERE, check, run

PLOT = os.path.join(HERE, "..", "..", "contrib", "plot")
sys.path.insert(0, PLOT)
sys.dont_write_bytecode = True
import numpy  # noqa: E402

import picture  # noqa: E402
import plot_compare  # noqa: E402
import results  # noqa: E402


def series(**columns):
    return {name: numpy.array(values, float) for name, values in columns.items()}


def draw(folder, *options, expect=0):
    done = subprocess.run([sys.executable, "-B", os.path.join(PLOT, "plot_run.py"), folder, *options], capture_output=True, text=True)
    check(done.returncode == expect, f"plot_run {options}: {done.stdout}{done.stderr}")
    return done


stretch = series(time_s=[0, 1, 2], strain_y=[0, .05, .1])
relaxation = series(time_s=[0, 1, 2, 3], strain_y=[0, .1, .1, .1])
cycles = series(time_s=[0, 1, 2, 3], strain_y=[0, .1, 0, .1])
shear = series(time_s=[0, 1], strain_y=[0, 0], reaction_bottom_x_N=[0, -285], reaction_bottom_y_N=[0, 11],
               reaction_top_x_N=[0, 285], reaction_force_y_N=[0, 11])
check([results.abscissa(s) for s in (stretch, relaxation, cycles, shear)] == ["strain_y", "time_s", "strain_y", "time_s"],
      "what forces are drawn against")
check(results.abscissa({**shear, "shear_strain_xy": numpy.array([0., .1])}) == "shear_strain_xy", "forces of a shear over its strain")
check(set(results.reaction_columns(shear)[:2]) == {"reaction_bottom_x_N", "reaction_top_x_N"}, "the force of a shear")
tension = series(reaction_top_y_N=[0, 3], reaction_force_y_N=[0, 3])
check(results.reaction_columns(tension) == ["reaction_force_y_N"], "the force of a tension")

stress = numpy.array([[1., 2., 3., 4., 5., 6.]])
check(results.component_of(stress, "s", "xy")[0][0] == 4. and results.component_of(stress, "s", "yz")[0][0] == 5., "VTK's order")
check(abs(results.component_of(stress, "s", "")[0][0] ** 2 - (1 + 4 + 9 + 2 * (16 + 25 + 36))) < 1e-12, "size of a tensor")
check(results.component_of(numpy.array([[3., 2., 1.]]), "principal_stress_Pa", "2")[0][0] == 2., "principal values")
_, axes = picture.plt.subplots()
axes.plot([0., 1.], [-1.5e-15, 1e-15])
plot_compare.show_as_zero(axes, 1e-6)
check(axes.get_ylim()[1] == 1e-8, "round-off is drawn as a profile")
check(results.Field("cauchy_stress_Pa", 0., None, None, "size").label == "|cauchy stress|", "name of a size")
check(picture.bar_format("", None) is None and picture.bar_format("Pa", "kPa")(2500., 0) == "2.5 kPa", "units of the bar")

with Folder() as folder:
    output = os.path.join(folder, "run")
    run(["run", os.path.join(HERE, "small.prm"), "--output", output, "--set", "Output/Point fields=von_mises, cauchy_stress, material"])
    draw(output)
    for name in ("force.png", "von_mises_Pa.png"):
        check(os.path.getsize(os.path.join(output, name)) > 5000, name)
    out = os.path.join(folder, "pictures")
    for form in ("svg", "pdf"):
        draw(output, "--field", "cauchy_stress_Pa", "--component", "yy", "--range", "0", "1", "--unit", "kPa", "--colours", "magma",
             "--outlines", "--format", form, "--out", out)
        check(os.path.getsize(os.path.join(out, f"cauchy_stress_Pa_yy.{form}")) > 5000, form)
    check("no component zx" in draw(output, "--field", "cauchy_stress_Pa", "--component", "zx", "--out", out).stderr, "component")
    check("is no unit of this field" in draw(output, "--unit", "kN", "--out", out).stderr, "unit")
    check("is no plane" in draw(output, "--plane", "w", "--out", out, expect=2).stderr, "plane")
