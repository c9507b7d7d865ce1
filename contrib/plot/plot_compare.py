#!/usr/bin/python3
"""Draws a comparison, compare.png, from the folder that `stroma compare` has left: its errors (bars, or lines over time),
the difference of the first field at the last time at its places, and A against B along lines at all times.

    plot_compare.py FOLDER
"""
import csv
import os

import numpy

import picture
import results
from picture import plt

NORMS = {"L2": "-", "H1": "--", "max": ":"}


def read_table(path):
    """Columns of a file with a header: name -> list of texts; None if there is no file."""
    if not os.path.isfile(path):
        return None
    with open(path, newline="", encoding="utf-8") as file:
        rows = list(csv.reader(file))
    return {name: [row[i] for row in rows[1:]] for i, name in enumerate(rows[0])}


def numbers(texts):
    return numpy.array([results.number(text) for text in texts])


def relative(field, norm):
    """Error of the whole scene; not a number if unknown or zero."""
    value = field["regions"][0][norm]["relative"]
    return value if value else numpy.nan


def draw_bars(axes, fields):
    """One time: a bar a norm for each field."""
    for n, norm in enumerate(NORMS):
        axes.bar(numpy.arange(len(fields)) + .27 * (n - 1), [relative(f, norm) for f in fields], .25, label=norm)
    axes.set_xticks(range(len(fields)), [results.label_and_unit(f["field"])[0].replace(" ", "\n") for f in fields],
                    fontsize="x-small" if picture.is_narrow() else "small")


def draw_errors(axes, comparison):
    times = comparison["times_s"]
    if len(times) == 1:
        draw_bars(axes, comparison["fields"])
    else:
        names = list(dict.fromkeys(f["field"] for f in comparison["fields"]))
        for colour, name in enumerate(names):
            of_name = [f for f in comparison["fields"] if f["field"] == name]
            for norm, style in NORMS.items():
                values = [relative(f, norm) for f in of_name]
                if numpy.any(numpy.isfinite(values)):
                    axes.plot([f["time_s"] for f in of_name], values, style, color=f"C{colour}", marker=".",
                              label=f"{results.label_and_unit(name)[0]}, {norm}")
        axes.set_xlabel("time [s]")
    if any(numpy.isfinite(relative(f, norm)) for f in comparison["fields"] for norm in NORMS):
        axes.set_yscale("log")
    axes.set_ylabel("relative difference")
    axes.grid(alpha=.3)
    axes.legend(fontsize="x-small")


def draw_map(figure, axes, table):
    """|A - B| of the first field; of a body in space, in its middle plane."""
    name = next(column for column in table if column.endswith("_difference")).removesuffix("_difference")
    points = numpy.stack([numbers(table[c]) for c in ("x_m", "y_m", "z_m")], axis=1)
    field = results.Field(name, 0., points, numbers(table[name + "_difference"]))
    scale = picture.colour_scale([field])
    (picture.draw_slice if field.dim == 3 else picture.draw_plane)(axes, field, scale)
    picture.add_colour_bar(figure, axes, name, scale, [field], shrink=.8)
    axes.set_title(f"|A - B| of {results.label_and_unit(name)[0]}", fontsize="small")


def first_field(table):
    """Columns (A, B) of the components of the first field of profiles.csv."""
    columns = [c for c in table if c.endswith("_a")]
    stem = columns[0].removesuffix("_a")
    stem = stem[:-2] if stem[-2:] in ("_x", "_y", "_z") else stem
    return [(c, c[:-2] + "_b") for c in columns if c.removesuffix("_a") == stem or c[:-4] == stem]


def show_as_zero(axes, largest):
    """What is zero but for round-off, beside the field's largest number, looks like that."""
    if max(map(abs, axes.get_ylim())) < 1e-8 * largest:
        axes.set_ylim(-1e-2 * largest, 1e-2 * largest)


def draw_profile(axes, table, line, columns, largest):
    lines, times = numpy.array(table["line"]), numbers(table["time_s"])
    distance = numbers(table["distance_m"])
    a, b = (numbers(table[c]) for c in columns)
    shown, width = numpy.unique(times[lines == line]), plt.rcParams["lines.linewidth"]
    for i, time in enumerate(shown):
        here = (lines == line) & (times == time)
        colour = plt.get_cmap("viridis")(.85 * i / max(1, len(shown) - 1))
        axes.plot(distance[here], a[here], "-", color=colour, alpha=.4, linewidth=2.5 * width, label=f"A, {time:g} s")
        axes.plot(distance[here], b[here], "--", color=colour, linewidth=width, label=f"B, {time:g} s")
    show_as_zero(axes, largest)
    name, unit = results.label_and_unit(columns[0][:-2])
    component = columns[0][-3] if columns[0][-4:-3] == "_" else ""
    name, unit = results.label_and_unit(columns[0][:-4]) if component else (name, unit)
    axes.set_title(f"line {line} [m]")
    picture.show_multiple([(axes.xaxis, "along the line")], "m")
    picture.show_multiple([(axes.yaxis, f"{name} {component}".strip())], unit, 5)
    axes.grid(alpha=.3)
    if len(shown) <= 6:
        axes.legend(fontsize="x-small")


def panels(n_lines, n_columns):
    """The figure, the two panels of all places, and one a column of each line: a row a line, in a narrow picture all below each other."""
    if picture.is_narrow():
        figure, grid = picture.subplots(2 + n_lines * n_columns, 1, 5.6, 3.3 * (2 + n_lines * n_columns))
        return figure, grid.flat[:2], grid.flat[2:].reshape(n_lines, n_columns)
    width = max(2, n_columns)
    figure, grid = picture.subplots(1 + n_lines, width, 5.6 * width, 4.4 * (1 + n_lines))
    for axes in (*grid[0, 2:], *grid[1:, n_columns:].flat):
        axes.set_visible(False)
    return figure, grid[0], grid[1:]


def draw(folder, path):
    comparison = results.read_json(folder, "compare.json")
    profiles = read_table(os.path.join(folder, "profiles.csv"))
    lines = list(dict.fromkeys(profiles["line"])) if profiles else []
    columns = first_field(profiles) if profiles else []
    largest = max((numpy.nanmax(numpy.abs(numbers(profiles[c]))) for pair in columns for c in pair), default=0.)
    figure, first, of_lines = panels(len(lines), len(columns))
    draw_errors(first[0], comparison)
    draw_map(figure, first[1], read_table(os.path.join(folder, "difference.csv")))
    for row, line in zip(of_lines, lines):
        for axes, pair in zip(row, columns):
            draw_profile(axes, profiles, line, pair, largest)
    figure.suptitle(f"A: {comparison['a']}    B: {comparison['b']}", fontsize="medium")
    picture.save(figure, path)


def main():
    parser = picture.Parser(description="Draws compare.png of a comparison.")
    parser.add_argument("folder", type=picture.folder, help="the folder that stroma compare has left")
    picture.add_options(parser, "comparison")
    arguments = parser.parse_args()
    picture.use_options(arguments)
    picture.draw_all(arguments.out or arguments.folder, {
        f"compare.{arguments.format}": lambda path: draw(arguments.folder, path)})


if __name__ == "__main__":
    main()
