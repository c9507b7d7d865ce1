#!/usr/bin/python3
"""Draws a run: force.png (reaction forces) and <field>.png (the field at the end) from the folder of its results.

    plot_run.py FOLDER [--field von_mises_Pa] [--out FOLDER]
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


def draw_force_picture(folder, path):
    figure, axes = plt.subplots(figsize=(6.4, 4.4), constrained_layout=True)
    draw_forces(axes, results.read_series(folder))
    figure.savefig(path, dpi=130)


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


def draw_field_picture(folder, name, path):
    field = results.read_field(folder, name)
    scale = picture.colour_scale([field])
    figure, axes = draw_field_3d(field, scale) if field.dim == 3 else draw_field_2d(field, scale)
    picture.add_colour_bar(figure, axes, name, scale, [field], shrink=.8)
    figure.suptitle(f"{results.label_and_unit(name)[0]} at {field.time:g} s")
    figure.savefig(path, dpi=130)


def main():
    parser = argparse.ArgumentParser(description="Draws force.png and <field>.png of a run.")
    parser.add_argument("folder", help="the run's results")
    parser.add_argument("--field", default="von_mises_Pa", help="field to draw (default: %(default)s)")
    parser.add_argument("--out", help="where to put the pictures (default: the run's folder)")
    arguments = parser.parse_args()
    if not os.path.isdir(arguments.folder):
        parser.error(f"{arguments.folder} is not a folder")
    picture.draw_all(arguments.out or arguments.folder, {
        "force.png": lambda path: draw_force_picture(arguments.folder, path),
        f"{arguments.field}.png": lambda path: draw_field_picture(arguments.folder, arguments.field, path)})


if __name__ == "__main__":
    main()
