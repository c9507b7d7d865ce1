#!/usr/bin/python3
"""Draws runs beside each other, beside.png: their last fields, each with one scale for all runs, and these along a vertical line.

    plot_beside.py NAME=FOLDER NAME=FOLDER ... [--field pressure_Pa --field von_mises_Pa] [--x 0] [--row 0.025]
                   [--out FOLDER] [--dpi N] [--format png|pdf|svg] [--width CM]
"""
import argparse

import numpy

import picture
import results
from picture import EngFormatter
from plot_study import style


def profile(field, x, row):
    """(y, values): means over the points nearest to x, row by row of this height, from the top down."""
    near = numpy.abs(field.points[:, 0] - x) <= .75 * row
    if not numpy.any(near):
        raise results.MissingResult(f"no point is near x = {x:g} m")
    y, values = field.points[near, 1], field.values[near]
    rows = numpy.floor((y - y.min()) / row + 1e-6).astype(int)
    places = [rows == row for row in sorted(set(rows), reverse=True)]
    return numpy.array([y[row].mean() for row in places]), numpy.array([values[row].mean() for row in places])


def draw_profiles(axes, fields, x, row):
    """fields: name of a run -> its field."""
    label, unit = results.label_and_unit(next(iter(fields.values())).name)
    for number, (run, field) in enumerate(fields.items()):
        y, values = profile(field, x, row)
        axes.plot(values, y, label=run, **style(number))
    picture.show_lengths(axes, ("", "y"))
    picture.show_multiple([(axes.xaxis, f"{label} at x = {EngFormatter('m')(x)}")], unit)
    axes.grid(alpha=.3)
    axes.legend(fontsize="small")


def draw(runs, names, x, row, path):
    """A row of panels a field, in narrow pictures two panels a row."""
    panels = len(runs) + 1
    columns = 2 if picture.is_narrow() else panels
    rows_a_field = -(-panels // columns)
    figure, grid = picture.subplots(len(names) * rows_a_field, columns, 3.6 * columns, 3.6 * len(names) * rows_a_field)
    for axes, name in zip(grid.reshape(len(names), -1), names):
        fields = {run: results.read_field(folder, name) for run, folder in runs}
        scale = picture.colour_scale(fields.values())
        for place, (run, field) in zip(axes, fields.items()):
            (picture.draw_plane if field.dim == 2 else picture.draw_slice)(place, field, scale)
            place.set_title(run)
        draw_profiles(axes[len(runs)], fields, x, row)
        for place in axes[panels:]:
            place.set_axis_off()
        picture.add_colour_bar(figure, list(axes), name, scale, list(fields.values()), aspect=40,
                               location="bottom" if picture.is_narrow() else "right")
    picture.save(figure, path)


def named_run(text):
    """(name, folder) of "NAME=FOLDER"."""
    name, sign, folder = text.partition("=")
    if not sign:
        raise argparse.ArgumentTypeError(f"'{text}' is no NAME=FOLDER")
    return name, picture.folder(folder)


def main():
    parser = picture.Parser(description="Draws runs beside each other.")
    parser.add_argument("runs", nargs="+", type=named_run, metavar="NAME=FOLDER")
    parser.add_argument("--field", action="append", help="to draw, may be repeated (default: pressure_Pa and von_mises_Pa)")
    parser.add_argument("--x", type=float, default=0., help="place of the vertical line [m] (default: %(default)s)")
    parser.add_argument("--row", type=picture.positive, default=.025, help="height of what is taken together along it [m] (default: %(default)s)")
    picture.add_options(parser, "first run")
    arguments = parser.parse_args()
    runs = arguments.runs
    picture.use_options(arguments)
    picture.draw_all(arguments.out or runs[0][1], {
        f"beside.{arguments.format}": lambda path: draw(runs, arguments.field or ["pressure_Pa", "von_mises_Pa"], arguments.x,
                                                        arguments.row, path)})


if __name__ == "__main__":
    main()
