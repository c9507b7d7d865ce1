"""What contrib/plot draws of a run: force over strain, or over time where the strain is held; the force that is driven, as in shear;
components of a tensor with their names; a number without a unit without a prefix; and its options, in all formats. Edges where they
are; panels of narrow pictures that do not lie on each other."""
import argparse
import itertools
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
import plot_run  # noqa: E402
import plot_study  # noqa: E402
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
_, axes = picture.plt.subplots()
picture.show_image(axes, numpy.ones((4, 2)), (0., 2e-6, 0., 4e-6), picture.Normalize(0, 1))
check(axes.get_xlim()[0] < 0. and axes.get_xlim()[1] > 2e-6 and axes.get_ylim()[0] < 0., "no white round a body")
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
check(results.Field("cauchy_stress_Pa", 0., None, None, "size").label == "|Cauchy stress|", "name of a size")
check(picture.bar_format("", None) is None and picture.bar_format("Pa", "kPa")(2500., 0) == "2.5 kPa", "units of the bar")

# The right edge of a waisted sheet is drawn where it is, to half a point.
x, y = (a.ravel().astype(float) for a in numpy.meshgrid(numpy.arange(60), numpy.arange(60)))
waist = .8 * numpy.sin(numpy.pi * y / 59.)
image, extent = picture.shown_points(x - waist * (x / 59.), y, 1.)
check(image.shape == (120, 120) and extent == (-.5, 59.5, -.5, 59.5), f"pixels {image.shape}, {extent}")
for row in range(120):
    edge = extent[0] + .5 * (1 + numpy.flatnonzero(image[row] >= 0).max())
    true = 59.5 - .8 * numpy.sin(numpy.pi * min(max(.5 * row - .25, 0.), 59.) / 59.)
    check(numpy.all(image[row, :110] >= 0) and abs(edge - true) <= .55, f"row {row} ends at {edge} instead of {true}")
layers = picture.shown_points(numpy.zeros(3), numpy.zeros(3), 1., numpy.array([3., 1., 2.]), 0.)[0]
check(numpy.all(layers == 1), "the point with the smallest key is seen")
check(list(picture.values_of(numpy.array([[0, 2]]), numpy.array([5., 6., 7.]))[0]) == [5., 7.], "values of the points that are seen")


def check_panels(figure, path):
    """Nothing of a panel, with its labels, lies on another one or beyond the picture."""
    figure.canvas.draw()
    for axes in figure.axes:
        check(axes.get_legend() is None or axes.get_legend().get_window_extent().y0 >= axes.bbox.y1 - 1., f"{path}: keys on curves")
    boxes = [axes.get_tightbbox(figure.canvas.get_renderer()) for axes in figure.axes if axes.get_visible() and axes.axison]
    check(len(boxes) >= 3, f"{path}: {len(boxes)} panels")
    for one, other in itertools.combinations(boxes, 2):
        check(min(one.x1, other.x1) - max(one.x0, other.x0) < 1. or min(one.y1, other.y1) - max(one.y0, other.y0) < 1.,
              f"{path}: panels on each other, {one} and {other}")
    for box in boxes:
        check(box.x0 > -1. and box.y0 > -1. and box.x1 < figure.bbox.x1 + 1. and box.y1 < figure.bbox.y1 + 1., f"{path}: cut off")
        check(min(box.width, box.height) > .04 * figure.bbox.width, f"{path}: a panel of {box.width:.0f} x {box.height:.0f}")
    picture.plt.close(figure)


def narrow_panels():
    """Fields of a study, of a tall and of a flat body, and the three views of a body, 8 cm wide."""
    plain, save, read = dict(picture.plt.rcParams), picture.save, results.read_field
    picture.use_options(argparse.Namespace(dpi=100, width=8.))
    picture.save = check_panels
    for width, height in ((10, 20), (40, 10)):
        places = numpy.array(list(itertools.product(range(width), range(height), [0]))) * 1e-6
        results.read_field = lambda folder, name: results.Field(name, 1., places, places[:, 0] * 1e6)
        runs = [plot_study.Run("", {"values": {"MPM/Cells": f"{n}, {n}"}, "folder": "", "status": "finished"}) for n in (5, 10, 20)]
        plot_study.draw_fields(runs, "von_mises_Pa", f"study of {width} x {height}")
    places = numpy.array(list(itertools.product(range(12), range(12), range(4)))) * 1e-6
    body = results.Field("von_mises_Pa", 1., places, places[:, 0] * 1e6)
    figure, axes = plot_run.draw_field_3d(body, picture.colour_scale([body]))
    picture.add_colour_bar(figure, axes, body.name, picture.colour_scale([body]), [body], location="bottom")
    check_panels(figure, "three views")
    bins = [{"from": n, "to": n + 1, "fraction": .1} for n in range(10)]
    histograms, results.read_histograms = results.read_histograms, lambda folder: {
        (f"principal_stretch_{k}", ""): {"collagen": bins, "vessel": bins} for k in range(4)}
    plot_run.draw_histograms("", "histograms")
    results.read_histograms = histograms
    picture.save, results.read_field = save, read
    picture.settings.update(width=None)
    picture.plt.rcParams.update(plain)


def means_of_studies():
    """Means of two studies side by side, with standard errors over seeds."""
    def study(entry):
        return {"means": [{"case": "", "values": {entry: str(x)}, "results": {"speed_m_per_s": {"mean": x, "standard_error": .1 * x}}}
                          for x in (3., 1., 2.)]}

    def check_bars(figure, path):
        check([axes.get_xlabel() for axes in figure.axes] == ["Width", "Force"], f"{path}: a panel a study")
        for axes in figure.axes:
            bars = [bar[:, 1] for bar in axes.containers[0][2][0].get_segments()]
            check(numpy.allclose(bars, [[.9 * x, 1.1 * x] for x in (1., 2., 3.)]), f"{path}: bars {bars}")
        picture.plt.close(figure)

    save, picture.save = picture.save, check_bars
    plot_study.draw_means([study("Width"), study("Force")], "means")
    picture.save = save


narrow_panels()
means_of_studies()

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
