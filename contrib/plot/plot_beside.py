#!/usr/bin/python3
"""Draws runs beside each other: their last fields, each with one scale for all runs, and these along a vertical line.

    plot_beside.py PICTURE NAME=FOLDER NAME=FOLDER ... [--field pressure_Pa --field von_mises_Pa] [--x 0] [--width 0.025]
"""
import argparse

import numpy

import picture
import results
from picture import EngFormatter, plt


def profile(field, x, width):
    """(y, values): means over the points nearest to x, row by row of height width, from the top down."""
    near = numpy.abs(field.points[:, 0] - x) <= .75 * width
    y, values = field.points[near, 1], field.values[near]
    rows = numpy.floor((y - y.min()) / width + 1e-6).astype(int)
    places = [rows == row for row in sorted(set(rows), reverse=True)]
    return numpy.array([y[row].mean() for row in places]), numpy.array([values[row].mean() for row in places])


def draw_points(axes, field, scale):
    """Each point as large as its part of the undeformed body, at its deformed place."""
    size = 72. * 2.8 * picture.spacing(field.points, 2) / numpy.ptp(field.points[:, 0])
    axes.set(aspect="equal", xlabel="x [m]", ylabel="y [m]")
    return axes.scatter(field.points[:, 0], field.points[:, 1], c=field.values, s=size ** 2, marker="s", linewidths=0,
                        cmap=picture.COLOURS, norm=scale)


def draw(runs, fields, x, width, path):
    columns = len(runs) + 1
    figure, axes = plt.subplots(len(fields), columns, figsize=(3.6 * columns, 3.3 * len(fields)), squeeze=False,
                                constrained_layout=True)
    for row, name in zip(axes, fields):
        of_runs = {run: results.read_field(folder, name) for run, folder in runs}
        scale = picture.colour_scale(of_runs.values())
        label, unit = results.label_and_unit(name)
        for place, (run, field) in zip(row, of_runs.items()):
            points = draw_points(place, field, scale)
            place.set_title(f"{label}, {run}")
        figure.colorbar(points, ax=row[len(runs) - 1], format=EngFormatter(unit), shrink=.8)
        for run, field in of_runs.items():
            y, values = profile(field, x, width)
            row[-1].plot(values, y, marker=".", label=run)
        row[-1].set_xlabel(f"{label} at x = {x:g} m")
        row[-1].set_ylabel("y [m]")
        row[-1].xaxis.set_major_formatter(EngFormatter(unit))
        row[-1].xaxis.set_major_locator(plt.MaxNLocator(4))
        row[-1].grid(alpha=.3)
        row[-1].legend()
    figure.savefig(path, dpi=100)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("picture")
    parser.add_argument("runs", nargs="+", metavar="NAME=FOLDER")
    parser.add_argument("--field", action="append")
    parser.add_argument("--x", type=float, default=0.)
    parser.add_argument("--width", type=float, default=.025)
    arguments = parser.parse_args()
    runs = [run.split("=", 1) for run in arguments.runs]
    draw(runs, arguments.field or ["pressure_Pa", "von_mises_Pa"], arguments.x, arguments.width, arguments.picture)


if __name__ == "__main__":
    main()
