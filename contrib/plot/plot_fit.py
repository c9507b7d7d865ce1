#!/usr/bin/python3
"""Draws a fit from the folder of its fit.json: fit.png, what was measured and the runs at the start and at the end of the
search, one panel a curve, and below it the differences that remain.

    plot_fit.py FOLDER [--out FOLDER] [--dpi N] [--format png|pdf|svg] [--width CM]
"""

import numpy

import picture
import results
from picture import EngFormatter


def title(fit):
    """The constants with their intervals, one a line."""
    def text(one):
        low, high = one["confidence_95"]
        interval = "no interval" if low is None else f"95 %: {low:.4g} to {high:.4g}"
        return f"{one['name']} = {one['value']:.4g} ({interval})"
    return "\n".join(text(one) for one in fit["parameters"])


def draw_curve(axes, data):
    """Measured values and runs; returns the curve at the end at the measured places."""
    x_label, x_unit = results.label_and_unit(data["against"])
    y_label, y_unit = results.label_and_unit(data["quantity"])
    x, y = numpy.array(data["x"]), numpy.array(data["y"])
    start, end = data["start"], data["end"]
    axes.plot(start["x"], start["y"], ":", color="0.5", label="start")
    axes.plot(end["x"], end["y"], "-", color="C0", label="fit")
    if data["deviation"]:
        axes.errorbar(x, y, yerr=data["deviation"], fmt="o", color="C3", markersize=4, capsize=2, label="measured")
    else:
        axes.plot(x, y, "o", color="C3", markersize=4, label="measured")
    axes.set_title(data["name"], fontsize="medium")
    axes.set_ylabel(y_label)
    axes.yaxis.set_major_formatter(EngFormatter(y_unit))
    if x_unit:
        axes.xaxis.set_major_formatter(EngFormatter(x_unit))
    axes.legend(fontsize="small")
    return x_label, y - numpy.interp(x, end["x"], end["y"])


def draw_fit(fit, path):
    data = fit["data"]
    figure, grid = picture.subplots(2, len(data), .6 + 4.6 * len(data), 5.2, sharex="col", gridspec_kw={"height_ratios": [3, 1]})
    for column, one in enumerate(data):
        label, rest = draw_curve(grid[0, column], one)
        below = grid[1, column]
        below.axhline(0., color="C0", linewidth=1)
        below.plot(one["x"], rest, "o", color="C3", markersize=4)
        below.margins(y=.25)  # so that outer points are whole
        below.set(xlabel=label, ylabel="measured - fit")
        below.yaxis.set_major_formatter(EngFormatter(results.label_and_unit(one["quantity"])[1]))
        for axes in grid[:, column]:
            axes.grid(alpha=.3)
    figure.suptitle(title(fit), fontsize="medium")
    picture.save(figure, path)


def main():
    parser = picture.Parser(description="Draws fit.png of a fit.")
    parser.add_argument("folder", type=picture.folder, help="the fit's results")
    picture.add_options(parser, "fit")
    arguments = parser.parse_args()
    picture.use_options(arguments)
    try:
        fit = results.read_json(arguments.folder, "fit.json")
    except results.MissingResult as reason:
        parser.error(str(reason))
    picture.draw_all(arguments.out or arguments.folder,
                     {f"fit.{arguments.format}": lambda path: draw_fit(fit, path)})


if __name__ == "__main__":
    main()
