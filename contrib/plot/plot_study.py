#!/usr/bin/python3
"""Draws a study from the folder of its study.json. A study with errors: study.png, error against CPU time and against
resolution, one curve a case. A study with means: means.png, the first result with its standard error; several such studies side by
side. Others: forces.png (reaction force of all runs) and <field>_all.png (the field at the end of all runs, one colour scale); each
grid reset has its own panel or row, if the study varies it.

    plot_study.py FOLDER [FOLDER_WITH_MEANS]... [--field von_mises_Pa] [--out FOLDER]
"""
import os
import sys
import textwrap

import numpy

import picture
import results
from picture import EngFormatter, plt

PANEL_PARAMETER = "MPM/Grid reset"
LETTERS_OF_PANEL = 28  # in a picture of two columns in print
LETTERS_OF_AXIS = 40  # in one of one column


class Run:
    """One run of a study. folder: its results; label: the values that vary within its panel; panel: its grid reset."""

    def __init__(self, study_folder, entry):
        values = dict(entry["values"])
        self.folder = os.path.join(study_folder, entry["folder"])
        self.finished = entry["status"] == "finished"
        self.panel = f"grid reset: {values.pop(PANEL_PARAMETER)}" if PANEL_PARAMETER in values else ""
        self.label = ", ".join(([entry["case"]] if entry.get("case") else []) +
                               [f"{path.split('/')[-1]} = {value}" for path, value in values.items()])


def panels(runs):
    """{panel: its runs}, in order of appearance."""
    found = {}
    for run in runs:
        found.setdefault(run.panel, []).append(run)
    return found


def collect(runs, read):
    """{run: what read(run.folder) found}, without the runs that have none."""
    found = {}
    for run in runs:
        try:
            found[run] = read(run.folder)
        except results.MissingResult as reason:
            print(f"Left out: {reason}", file=sys.stderr)
    if not found:
        raise results.MissingResult("no run of the study has what this picture needs")
    return found


def force_column(series):
    for one in series.values():
        columns = results.reaction_columns(one)
        if columns:
            return columns[0]
    raise results.MissingResult("no run has a reaction force in series.csv")


def draw_forces(runs, path):
    series = collect(runs, results.read_series)
    column = force_column(series)
    label, unit = results.label_and_unit(column)
    shown = panels(series)
    figure, grid = picture.subplots(1, len(shown), 1.2 + 5.2 * len(shown), 4.6, stack=True, sharey=True)
    for axes, (title, members) in zip(grid.flat, shown.items()):
        for number, run in enumerate(run for run in members if column in series[run]):
            x = results.abscissa(series[run])
            line, = axes.plot(series[run][x], series[run][column], label=run.label + ("" if run.finished else " (did not finish)"),
                              **style(number))
            if not run.finished:
                axes.plot(series[run][x][-1], series[run][column][-1], "x", color=line.get_color(), markersize=10)
            axes.set_xlabel(results.label_and_unit(x)[0])
        axes.set_title(title)
        axes.grid(alpha=.3)
        axes.legend(fontsize="small")
    grid[0, 0].set_ylabel(label)
    grid[0, 0].yaxis.set_major_formatter(EngFormatter(unit))
    picture.save(figure, path)


def layout(shown):
    """(rows, columns, {run: place}): a row a panel; one panel alone is broken into rows of four, narrow pictures into rows of two."""
    members = list(shown.values())
    if len(members) == 1 or picture.is_narrow():
        runs = [run for row in members for run in row]
        columns = min(2 if picture.is_narrow() else 4, len(runs))
        return -(-len(runs) // columns), columns, {run: divmod(i, columns) for i, run in enumerate(runs)}
    return (len(members), max(len(row) for row in members),
            {run: (r, c) for r, row in enumerate(members) for c, run in enumerate(row)})


def draw_fields(runs, name, path):
    fields = collect(runs, lambda folder: results.read_field(folder, name))
    scale = picture.colour_scale(list(fields.values()))
    rows, columns, places = layout(panels(fields))
    size = numpy.ptp(next(iter(fields.values())).points[:, :2], axis=0)
    height = numpy.clip(4. * size[1] / max(size[0], 1e-300), 2., 8.)
    around = (2., 1.4 * rows) if picture.is_narrow() else (.6, 0.)  # bar and labels, which are large beside narrow panels
    figure, grid = picture.subplots(rows, columns, 1.5 + 4. * columns, sum(around) + height * rows)
    for axes in grid.flat:
        axes.set_visible(False)
    for run, place in places.items():
        axes, field = grid[place], fields[run]
        axes.set_visible(True)
        draw = picture.draw_slice if field.dim == 3 else picture.draw_plane
        draw(axes, field, scale)
        lines = [run.panel, run.label, "" if run.finished else f"did not finish: at {results.when(run.folder, field.time)}"]
        if picture.is_narrow():
            lines = [textwrap.fill(line, LETTERS_OF_PANEL) for line in lines]
        axes.set_title("\n".join(line for line in lines if line), fontsize="small")
    picture.add_colour_bar(figure, list(grid.flat), name, scale, list(fields.values()), shrink=.8,
                           location="bottom" if picture.is_narrow() else "right")
    said = {results.when(run.folder, field.time) for run, field in fields.items()}
    figure.suptitle(next(iter(fields.values())).label + (f" at {said.pop()}" if len(said) == 1 else ""), fontsize="medium")
    picture.save(figure, path)


def curves(study):
    """{name: its runs with an error, from coarse to fine}."""
    found = {}
    for entry in study["runs"]:
        if entry.get("error"):
            found.setdefault(entry["curve"], []).append(entry)
    if not found:
        raise results.MissingResult("no run of the study has an error")
    return found


def style(number):
    """Curves may lie on one another: each has its own dashes and marker, later ones are thinner and hollow."""
    kind = number % 4
    return {"color": f"C{number % 10}", "marker": "osD^vPX*<>"[number % 10], "fillstyle": "none" if kind else "full",
            "linestyle": ("-", "--", "-.", ":")[kind], "linewidth": (1.8, 1.4, 1.1, 1.)[kind] * plt.rcParams["lines.linewidth"],
            "markersize": (.8, 1.3, 1.8, 1.)[kind] * plt.rcParams["lines.markersize"]}


def name_points(axes, points, all_of_them=False):
    """points: [(x, y, name)] of a curve that falls. The first and the last are named, or all; the last one below its curve."""
    for number, (x, y, name) in enumerate(points):
        is_last = number == len(points) - 1 > 0
        if all_of_them or is_last or number == 0:
            axes.annotate(name, (x, y), xytext=(-4, -4) if is_last else (4, 4), textcoords="offset points", fontsize="x-small",
                          ha="right" if is_last else "left", va="top" if is_last else "bottom")


def draw_work(axes, shown):
    """Error against CPU time of all ranks; bars from the least to the most of repeated runs; the first and last value of each curve."""
    for number, (name, runs) in enumerate(shown.items()):
        times = [r["cpu_time_s"] for r in runs]
        spread = [[t - min(r["cpu_times_s"]) for r, t in zip(runs, times)], [max(r["cpu_times_s"]) - t for r, t in zip(runs, times)]]
        axes.errorbar(times, [r["error"] for r in runs], xerr=spread, capsize=2, label=name or None, **style(number))
        name_points(axes, [(time, run["error"], run.get("axis_value", "")) for run, time in zip(runs, times)], len(shown) == 1)
    axes.set_xlabel("CPU time [s]")
    axes.margins(.12, .12)  # so that the names of points are inside


def order_label(name, runs):
    """Name of the curve with the order of its last step."""
    order = runs[-1]["order"] if len(runs) > 1 else None
    if order is None:
        return name
    return f"{name} (order {order:.2f})" if name else f"order {order:.2f}"


def mark_values(axes, values):
    """Ticks at the varied numbers themselves, if they are few. values: {number: as the file gives it}."""
    if values and len(values) <= 8:
        step = -(-sum(len(name) + 2 for name in values.values()) // LETTERS_OF_AXIS) if picture.is_narrow() else 1
        shown = sorted(values)[::step]
        axes.set_xticks(shown, [values[number] for number in shown])
        axes.set_xticks([], minor=True)
    else:
        picture.show_logarithm(axes.xaxis)


def draw_orders(axes, study, shown):
    """Error against the varied number, with the order of the last step; what is varied and is no number, in its order."""
    all_runs = [run for runs in shown.values() for run in runs]
    is_number = any(run.get("axis_number") for run in all_runs)
    names = list(dict.fromkeys(run.get("axis_value", "") for run in all_runs))
    values = {}
    for number, (name, runs) in enumerate(shown.items()):
        runs = [r for r in runs if r.get("axis_number")] if is_number else runs
        places = [r["axis_number"] if is_number else names.index(r.get("axis_value", "")) for r in runs]
        values.update(zip(places, (r.get("axis_value", "") for r in runs)))
        if runs:
            axes.plot(places, [r["error"] for r in runs], label=order_label(name, runs) or None, **style(number))
    if is_number:
        axes.set_xscale("log")
        mark_values(axes, values)
    else:
        axes.set_xticks(range(len(names)), names)
    axes.set_xlabel(", ".join(dict.fromkeys(with_unit(study, r["axis"]) for runs in shown.values() for r in runs if "axis" in r)))


def draw_precision(study, path):
    shown = curves(study)
    figure, both = picture.subplots(1, 2, 14.5, 5.2, stack=True, sharey=True)
    is_stacked, both = both.shape[0] == 2, both.ravel()
    draw_work(both[0], shown)
    both[0].set_xscale("log")
    draw_orders(both[1], study, shown)
    error = study["error"]
    both[0].set_ylabel(f"relative {error['norm']} error of {results.label_and_unit(error['field'])[0]}")
    for axes in both:
        axes.set_yscale("log")
        axes.grid(alpha=.3, which="both")
    picture.show_logarithm(both[0].xaxis)
    picture.show_logarithm(both[0].yaxis)
    if both[1].get_legend_handles_labels()[1]:
        both[1].legend(fontsize="small", loc="upper left", bbox_to_anchor=(0., -.25) if is_stacked else (1.01, 1.))
    title = f"against {error['against']}"
    if study["at_once"] > 1:
        title += f"; {study['at_once']} runs at once: times are not comparable"
    figure.suptitle(title, fontsize="medium")
    picture.save(figure, path)


def with_unit(study, entry):
    """"Section/name [unit]" of an entry that a study varies, as the file of its first run gives it."""
    unit = results.unit_of_entry(os.path.join(study["folder"], study["runs"][0]["folder"]), entry)
    return f"{entry} [{unit}]" if unit else entry


def mean_curves(means):
    """{name of a case and of all values but the last: [(number, mean, standard error)]}, with the name of the last entry."""
    entry = list(means[0]["values"])[-1] if means[0]["values"] else ""
    found = {}
    for one in means:
        values = dict(one["values"])
        number = results.number(values.pop(entry, "nan"))
        label = ", ".join(([one["case"]] if one["case"] else []) + [f"{k.split('/')[-1]} = {v}" for k, v in values.items()])
        first = next(iter(one["results"].values()))
        if first["mean"] is not None and numpy.isfinite(number):
            found.setdefault(label, []).append((number, first["mean"], first["standard_error"] or 0.))
    return {label: sorted(points) for label, points in found.items()}, entry


def draw_mean_curves(axes, study):
    """The first result of a study's means along its last entry, with standard errors."""
    curves_of, entry = mean_curves(study["means"])
    if not curves_of:
        raise results.MissingResult("the study has no means along a number")
    for number, (name, points) in enumerate(curves_of.items()):
        x, y, error = numpy.array(points).T
        axes.errorbar(x, y, yerr=error, capsize=3, label=name or None, **style(number))
    everywhere = numpy.concatenate([numpy.array(points)[:, 0] for points in curves_of.values()])
    if everywhere.min() > 0. and everywhere.max() > 30. * everywhere.min():
        axes.set_xscale("log")
        picture.show_logarithm(axes.xaxis)
    label, unit = results.label_and_unit(next(iter(study["means"][0]["results"])))
    axes.set_xlabel(with_unit(study, entry))
    picture.show_multiple([(axes.yaxis, label)], unit, 6)
    axes.grid(alpha=.3)
    if any(curves_of):
        axes.legend(fontsize="small")


def draw_means(studies, path):
    """A panel a study."""
    figure, grid = picture.subplots(1, len(studies), 1.2 + 5.2 * len(studies), 4.4, stack=True)
    for axes, study in zip(grid.flat, studies):
        draw_mean_curves(axes, study)
    picture.save(figure, path)


def main():
    parser = picture.Parser(description="Draws study.png, or forces.png and <field>_all.png, of a study.")
    parser.add_argument("folders", nargs="+", type=picture.folder, metavar="FOLDER", help="the study's results; of several, each has means")
    parser.add_argument("--field", default="von_mises_Pa", help="field to draw (default: %(default)s)")
    picture.add_options(parser, "study")
    arguments = parser.parse_args()
    picture.use_options(arguments)
    folder = arguments.folders[0]
    out = arguments.out or folder
    try:
        studies = [{"folder": one, **results.read_json(one, "study.json")} for one in arguments.folders]
    except results.MissingResult as reason:
        parser.error(str(reason))
    without = [one for one, study in zip(arguments.folders, studies) if "means" not in study]
    if len(studies) > 1 and without:
        parser.error(f"{without[0]}: a study without means is drawn alone")
    study = studies[0]
    if len(studies) == 1 and "error" in study:
        picture.draw_all(out, {f"study.{arguments.format}": lambda path: draw_precision(study, path)})
        return
    if not without:
        picture.draw_all(out, {f"means.{arguments.format}": lambda path: draw_means(studies, path)})
        return
    runs = [Run(folder, entry) for entry in study["runs"]]
    picture.draw_all(out, {
        f"forces.{arguments.format}": lambda path: draw_forces(runs, path),
        f"{arguments.field}_all.{arguments.format}": lambda path: draw_fields(runs, arguments.field, path)})


if __name__ == "__main__":
    main()
