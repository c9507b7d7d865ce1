"""What contrib/plot draws of a run: force over strain, or over time where the strain is held; the force that is driven, as in shear;
components of a tensor with their names; a number without a unit without a prefix; and its options, in all formats. Edges where they
are; panels of narrow pictures that do not lie on each other."""
import argparse
import itertools
import os
import subprocess
import sys
import warnings

from program import Folder, HERE, check, run

PLOT = os.path.join(HERE, "..", "..", "contrib", "plot")
sys.path.insert(0, PLOT)
sys.dont_write_bytecode = True
import numpy  # noqa: E402

import nrrd  # noqa: E402
import picture  # noqa: E402
import plot_compare  # noqa: E402
import plot_fit  # noqa: E402
import plot_image  # noqa: E402
import plot_run  # noqa: E402
import plot_study  # noqa: E402
import plot_voxels  # noqa: E402
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


def check_words(figure, path):
    """Numbers at an axis do not touch each other, names of points are inside their panel, keys inside the picture."""
    for axes in figure.axes:
        for axis, along in ((axes.xaxis, "x"), (axes.yaxis, "y")):
            low, high = sorted(axis.get_view_interval())
            numbers = [tick.label1 for tick in (*axis.get_major_ticks(), *axis.get_minor_ticks()) if low <= tick.get_loc() <= high]
            boxes = [number.get_window_extent() for number in numbers if axes.axison and number.get_visible() and number.get_text()]
            for one, other in itertools.combinations(sorted(boxes, key=lambda box: getattr(box, along + "0")), 2):
                check(getattr(other, along + "0") - getattr(one, along + "1") > 2., f"{path}: numbers along {along} touch")
        for text in (text for text in axes.texts if axes.axison and text.get_text()):
            box = text.get_window_extent()
            check(axes.bbox.x0 < box.x0 and box.x1 < axes.bbox.x1 and axes.bbox.y0 < box.y0 and box.y1 < axes.bbox.y1,
                  f"{path}: '{text.get_text()}' is cut by the frame")
        if axes.get_legend():
            box = axes.get_legend().get_window_extent()
            check(box.x0 > 0. and box.x1 < figure.bbox.x1, f"{path}: keys are cut off")


def check_panels(figure, path):
    """Nothing of a panel, with its labels, lies on another one or beyond the picture."""
    figure.canvas.draw()
    check_words(figure, path)
    check(figure.bbox.height < 3. * figure.bbox.width, f"{path}: higher than a page")
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


def check_one(figure, path):
    """Its words, and that no point is cut by the frame."""
    figure.canvas.draw()
    check_words(figure, path)
    for axes in figure.axes:
        for line in (line for line in axes.lines if line.get_marker() not in ("", "None", None)):
            places, half = axes.transData.transform(line.get_xydata()), .5 * line.get_markersize() * figure.dpi / 72.
            check(numpy.all(places > axes.bbox.min + half) and numpy.all(places < axes.bbox.max - half), f"{path}: a point is cut by the frame")
    picture.plt.close(figure)


def curves_and_points():
    """A study with errors along pairs of numbers, a fit with its residuals, profiles of two runs, equal thresholds."""
    picture.save = check_one
    runs = [{"curve": "", "error": error, "order": 1.7, "cpu_time_s": time, "cpu_times_s": [.95 * time, 1.05 * time], "axis": "MPM/Cells",
             "axis_value": f"{n}, {2 * n}", "axis_number": n, "folder": ""}
            for n, time, error in ((5, .03, 7e-3), (10, .049, 2.2e-3), (20, .097, 7e-4))]
    error = {"norm": "L2", "field": "displacement_m", "against": "reference"}
    plot_study.draw_precision({"folder": "", "runs": runs, "error": error, "at_once": 1}, "errors of pairs")
    x = [.02, .04, .06, .08, .1]
    data = {"name": "sheet", "against": "strain_y", "quantity": "reaction_force_y_N", "x": x,
            "y": [.13 * a + 5e-5 * (-1) ** n for n, a in enumerate(x)], "start": {"x": x, "y": [0.] * 5}, "end": {"x": x, "y": [.13 * a for a in x]}, "deviation": []}
    plot_fit.draw_fit({"parameters": [{"name": "E", "value": 5., "confidence_95": [4., 6.]}], "data": [data]}, "fit")
    table = {"line": ["0, 5e-5 : 1e-4, 5e-5"] * 5, "time_s": ["1"] * 5, "distance_m": [f"{k * 2.5e-5}" for k in range(5)],
             "displacement_m_x_a": ["2e-7", "1e-7", "0", "-1e-7", "-2e-7"]}
    table["displacement_m_x_b"] = table["displacement_m_x_a"]
    figure, axes = picture.subplots(1, 1, 5.6, 3.3)
    plot_compare.draw_profile(axes[0, 0], table, table["line"][0], ("displacement_m_x_a", "displacement_m_x_b"), 2e-7)
    a, b = axes[0, 0].lines
    check(axes[0, 0].get_title().endswith("[m]") and b.get_linestyle() == "--" and a.get_linewidth() > 2. * b.get_linewidth(), "profiles")
    check_one(figure, "profile")
    check(len({(style.get("color"), style.get("linestyle"), style.get("linewidth")) for style in plot_image.LINES.values()}) == 4, "thresholds")


def voxels():
    """A field on the voxels of a flat scan, beside its labels."""
    def check_named(figure, path):
        first = figure.axes[0]
        check((first.get_title(), first.get_xlabel(), first.get_ylabel()) == ("segmentation", "x [µm]", "y [µm]"), f"{path}: {first.get_title()}")
        check(figure._suptitle.get_text() == "von Mises at 1 s", f"{path}: {figure._suptitle.get_text()}")
        check_one(figure, path)

    picture.save = check_named
    labels = numpy.zeros((16, 64, 64))
    labels[:, 20:40, 20:40] = 1.
    frame = numpy.ones(3), numpy.full(3, .5), "um"
    with warnings.catch_warnings(action="error"):  # nor where a plane holds one material only
        for one in (labels, 0. * labels + 1.):
            plot_voxels.draw(nrrd.Image(one, *frame), nrrd.Image(100. * labels, *frame), ("segmentation", "von_mises_Pa", " at 1 s"), "voxels")


def narrow_panels():
    """Fields of a study, of a tall and of a flat body, and the three views of a body, 8 cm wide."""
    titles = []

    def check_titled(figure, path):
        titles.append(figure.get_suptitle() if hasattr(figure, "get_suptitle") else figure._suptitle and figure._suptitle.get_text())
        check_panels(figure, path)

    plain, save, read = dict(picture.plt.rcParams), picture.save, results.read_field
    picture.use_options(argparse.Namespace(dpi=100, width=8.))
    picture.save = check_titled
    for width, height in ((10, 20), (40, 10)):
        places = numpy.array(list(itertools.product(range(width), range(height), [0]))) * 1e-6
        results.read_field = lambda folder, name: results.Field(name, 1., places, places[:, 0] * 1e6)
        runs = [plot_study.Run("", {"values": {"MPM/Cells": f"{n}, {n}"}, "folder": "", "status": "finished"}) for n in (5, 10, 20)]
        plot_study.draw_fields(runs, "von_mises_Pa", f"study of {width} x {height}")
        check(titles[-1] == "von Mises at 1 s", f"title {titles[-1]}")
    places = numpy.array(list(itertools.product(range(12), range(12), range(4)))) * 1e-6
    body = results.Field("von_mises_Pa", 1., places, places[:, 0] * 1e6)
    figure, axes = plot_run.draw_field_3d(body, picture.colour_scale([body]))
    picture.add_colour_bar(figure, axes, body.name, picture.colour_scale([body]), [body], location="bottom")
    check_panels(figure, "three views")
    check(axes[0, 2].get_subplotspec().colspan == range(2), "the surface has the width of both planes")
    bins = [{"from": n, "to": n + 1, "fraction": .1} for n in range(10)]
    histograms, results.read_histograms = results.read_histograms, lambda folder: {
        (f"principal_stretch_{k}", ""): {"collagen": bins, "vessel": bins} for k in range(4)}
    plot_run.draw_histograms("", "histograms")
    results.read_histograms = histograms
    curves_and_points()
    voxels()
    picture.save, results.read_field = save, read
    picture.settings.update(width=None)
    picture.plt.rcParams.update(plain)


def means_of_studies():
    """Means of two studies side by side, with standard errors over seeds."""
    def study(entry):
        means = [{"case": "", "values": {entry: str(x)}, "results": {"speed_m_per_s": {"mean": x, "standard_error": .1 * x}}}
                 for x in (3., 1., 2.)]
        return {"folder": folder, "runs": [{"folder": ""}], "means": means}

    def check_bars(figure, path):
        check([axes.get_xlabel() for axes in figure.axes] == ["Bodies/cell/Width [µm]", "Force"], f"{path}: a panel a study")
        check(figure.axes[0].get_ylabel() == "speed [m/s]", figure.axes[0].get_ylabel())
        for axes in figure.axes:
            bars = [bar[:, 1] for bar in axes.containers[0][2][0].get_segments()]
            check(numpy.allclose(bars, [[.9 * x, 1.1 * x] for x in (1., 2., 3.)]), f"{path}: bars {bars}")
        picture.plt.close(figure)

    save, picture.save = picture.save, check_bars
    with Folder() as folder:
        with open(os.path.join(folder, "parameters.prm"), "w") as file:
            file.write("subsection Bodies\n  subsection cell\n    # whole numbers in [2, 3] of it [um]; (0, inf)\n    set Width = 2\n  end\nend\n")
        plot_study.draw_means([study("Bodies/cell/Width"), study("Force")], "means")
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
    for words, options in (("no component zx", ("--field", "cauchy_stress_Pa", "--component", "zx")), ("is no unit of this field", ("--unit", "kN")),
                           ("has no field strain; it has von_mises_Pa", ("--field", "strain")), ("is no plane", ("--plane", "w")),
                           ("--range 3 1: the first number must be below the second", ("--range", "3", "1")),
                           ("--range 1 inf: the first", ("--range", "1", "inf")), ("'0' is no number above 0", ("--width", "0"))):
        said = [line for line in draw(output, *options, "--out", out, expect=1).stderr.splitlines() if line]
        check(len(said) == 1 and words in said[0], f"{options}: {said}")
    nothing = os.path.join(folder, "nothing")
    for script, words in (("run", [nothing]), ("study", [nothing]), ("image", [nothing]), ("fit", [nothing]), ("compare", [nothing]),
                          ("beside", [f"A={output}", f"B={nothing}"])):
        done = subprocess.run([sys.executable, "-B", os.path.join(PLOT, f"plot_{script}.py"), *words], capture_output=True, text=True)
        said = done.stderr.splitlines()
        check(done.returncode == 1 and len(said) == 1 and f"the folder '{nothing}' does not exist" in said[0], f"{script}: {said}")
