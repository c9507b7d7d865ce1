#!/usr/bin/python3
"""Draws a run: force.png (reaction forces) and <field>.png (the field at the end) from the folder of its results.

    plot_run.py FOLDER [--field cauchy_stress_Pa --component xy] [--plane z=2e-5] [--range 0 2 --unit kPa] [--colours MAP]
                [--outlines] [--dpi 300] [--format pdf] [--out FOLDER]
"""
import argparse
import os

import numpy

import picture
import results
from picture import EngFormatter, plt


def draw_forces(axes, series):
    x = results.abscissa(series)
    columns = results.reaction_columns(series)
    if not columns:
        raise results.MissingResult("series.csv has no reaction force")
    for column in columns:
        label, unit = results.label_and_unit(column)
        axes.plot(series[x], series[column], marker=".", label=label)
    label, x_unit = results.label_and_unit(x)
    axes.set_xlabel(f"{label} [{x_unit}]" if x_unit else label)
    axes.set_ylabel("reaction force")
    axes.yaxis.set_major_formatter(EngFormatter(unit))
    axes.grid(alpha=.3)
    axes.legend()


def draw_force_picture(folder, path, dpi):
    figure, axes = plt.subplots(figsize=(6.4, 4.4), constrained_layout=True)
    draw_forces(axes, results.read_series(folder))
    figure.savefig(path, dpi=dpi)


def draw_field_2d(field, scale):
    size = numpy.ptp(field.points[:, :2], axis=0)
    height = numpy.clip(6. * size[1] / max(size[0], 1e-300), 3., 9.)
    figure, axes = plt.subplots(figsize=(7.4, height), constrained_layout=True)
    picture.draw_plane(axes, field, scale)
    return figure, axes


def draw_field_3d(field, scale):
    figure, axes = plt.subplots(1, 3, figsize=(16., 5.4), constrained_layout=True,
                                gridspec_kw={"width_ratios": [1., 1., 1.3]})
    draws = {"middle plane": picture.draw_slice, "largest value along z": picture.draw_projection,
             "surface": picture.draw_body}
    for one, (title, draw) in zip(axes, draws.items()):
        draw(one, field, scale)
        one.set_title(title)
    return figure, axes


def draw_field_in_plane(field, scale, plane):
    axis, _, place = plane.partition("=")
    figure, axes = plt.subplots(figsize=(7.4, 6.), constrained_layout=True)
    picture.draw_slice(axes, field, scale, axis, float(place) if place else None)
    axes.set_title(f"{axis} = {EngFormatter('m')(float(place))}" if place else f"middle plane of {axis}", fontsize="medium")
    return figure, axes


def caption(folder, field):
    """When it is: the strain where the body is driven, and the time."""
    try:
        series = results.read_series(folder)
    except results.MissingResult:
        return f"{field.label} at {field.time:g} s"
    strain = next((name for name, values in series.items() if name.startswith("strain_") and len(name) == 8
                   and numpy.ptp(values) > 0.), None)
    row = numpy.argmin(numpy.abs(series["time_s"] - field.time))
    of_strain = f"{100. * series[strain][row]:.4g} % strain along {strain[-1]}, " if strain else ""
    return f"{field.label} at {of_strain}{field.time:g} s"


def draw_field_picture(arguments, path):
    field = results.read_field(arguments.folder, arguments.field, arguments.component, arguments.outlines)
    scale = picture.colour_scale([field])
    unit = results.label_and_unit(arguments.field)[1]
    if arguments.range:
        factor = picture.factor_of(arguments.unit, unit) if arguments.unit else 1.
        scale = picture.Normalize(*(factor * end for end in arguments.range))
    if field.dim == 2:
        figure, axes = draw_field_2d(field, scale)
    elif arguments.plane:
        figure, axes = draw_field_in_plane(field, scale, arguments.plane)
    else:
        figure, axes = draw_field_3d(field, scale)
    picture.add_colour_bar(figure, axes, arguments.field, scale, [field], in_unit=arguments.unit, shrink=.8)
    figure.suptitle(caption(arguments.folder, field))
    figure.savefig(path, dpi=arguments.dpi, bbox_inches="tight")


def plane(text):
    axis, sign, place = text.partition("=")
    if axis not in ("x", "y", "z") or (sign and not numpy.isfinite(results.number(place))):
        raise argparse.ArgumentTypeError(f"'{text}' is no plane; give x, y or z, or with a place in m: z=2e-5")
    return text


def parse():
    parser = argparse.ArgumentParser(description="Draws force.png and <field>.png of a run.")
    parser.add_argument("folder", help="the run's results")
    parser.add_argument("--field", default="von_mises_Pa", help="field to draw (default: %(default)s)")
    parser.add_argument("--component", default="", help="of a vector or tensor: x, xy, ..., or size (default: size)")
    parser.add_argument("--plane", type=plane, help="in space: only the plane across this axis, at its middle or a place [m]: z=2e-5")
    parser.add_argument("--range", type=float, nargs=2, metavar=("LOW", "HIGH"), help="ends of the colour bar, in --unit")
    parser.add_argument("--unit", help="of the colour bar, such as kPa (default: a prefix that fits)")
    parser.add_argument("--colours", default="viridis", choices=plt.colormaps(), metavar="MAP", help="colour map of matplotlib")
    parser.add_argument("--outlines", action="store_true", help="lines between materials, in planes")
    parser.add_argument("--dpi", type=int, default=130, help="of PNG (default: %(default)s)")
    parser.add_argument("--format", default="png", choices=["png", "svg", "pdf"], help="of the pictures (default: %(default)s)")
    parser.add_argument("--out", help="where to put the pictures (default: the run's folder)")
    arguments = parser.parse_args()
    if not os.path.isdir(arguments.folder):
        parser.error(f"{arguments.folder} is not a folder")
    return arguments


def main():
    arguments = parse()
    picture.use_colours(arguments.colours)
    name = "_".join(word for word in (arguments.field, arguments.component, (arguments.plane or "")[:1]) if word)
    picture.draw_all(arguments.out or arguments.folder, {
        f"force.{arguments.format}": lambda path: draw_force_picture(arguments.folder, path, arguments.dpi),
        f"{name}.{arguments.format}": lambda path: draw_field_picture(arguments, path)})


if __name__ == "__main__":
    main()
