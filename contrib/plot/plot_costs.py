#!/usr/bin/python3
"""Draws the errors of several studies against CPU time, a column a study: those of results against the study's reference run, and that of
its first field.

    plot_costs.py STUDY[+MORE]... --references RUN... [--titles NAME...] [--results reaction_force_y_N ...] [--out costs.png]

STUDY+MORE: runs of two studies in one column. Cases that were run once, as 'averaged cells 16' and 'averaged cells 32', are one curve.
"""
import os
import re

import picture
import results
from picture import plt
from plot_study import name_points, style


def curve_and_value(name, run):
    """Of a run: its curve, and what is written beside it."""
    if run.get("axis_value"):
        return name, run["axis_value"]
    alone = re.match(r"(.*\D) (\d+)$", name)
    return alone.groups() if alone else (name, "")


def all_curves(folders):
    """{name: [(run, what is written beside it)]} of several studies, and the name of the error of the first."""
    found, of_field = {}, ""
    for study in (results.read_json(folder, "study.json") for folder in folders):
        for run in study["runs"]:
            if run["status"] == "finished":
                name, value = curve_and_value(run["curve"], run)
                found.setdefault(name, []).append((run, value))
        if not of_field and "error" in study:
            of_field = f"{study['error']['norm']} of {results.label_and_unit(study['error']['field'])[0]}"
    return found, of_field


def result_error(run, reference, name):
    """|value / that of the reference run - 1|; nothing where a run has none."""
    if not reference.get(name):
        raise results.MissingResult(f"a reference has no result {name}")
    value = ((run.get("summary") or {}).get("results") or {}).get(name)
    return None if value is None else abs(value / reference[name] - 1.)


def draw_curve(axes, shown, number, name):
    """shown: [(CPU time, error, what is written beside it)]; first and last are written."""
    shown = [point for point in shown if point[1]]
    axes.plot([time for time, _, _ in shown], [error for _, error, _ in shown], label=name, **style(number))
    name_points(axes, shown)


def draw_column(column, studies, reference, names):
    """A panel a result, and one of the field's error, whose name is returned."""
    shown, of_field = all_curves(studies)
    for number, (curve, runs) in enumerate(shown.items()):
        for axes, name in zip(column, names):
            draw_curve(axes, [(run["cpu_time_s"], result_error(run, reference, name), value) for run, value in runs], number, curve)
        draw_curve(column[-1], [(run["cpu_time_s"], run.get("error"), value) for run, value in runs], number, curve)
    return of_field


def draw(arguments):
    columns, rows = len(arguments.studies), len(arguments.results) + 1
    figure, grid = plt.subplots(rows, columns, figsize=(1.5 + 3.2 * columns, .6 + 2.4 * rows), sharex="col", sharey="row", squeeze=False,
                                constrained_layout=True)
    for column, studies, reference, title in zip(grid.T, arguments.studies, arguments.references, arguments.titles):
        of_field = draw_column(column, studies.split("+"), results.read_json(reference, "summary.json")["results"], arguments.results)
        column[0].set_title(title)
        column[-1].set_xlabel("CPU time [s]")
        for axes in column:
            axes.set(xscale="log", yscale="log")
            axes.grid(alpha=.3, which="both")
    for axes, name in zip(grid[:, 0], [results.label_and_unit(name)[0] for name in arguments.results] + [of_field]):
        axes.set_ylabel(f"relative error, {name}")
    grid[0, -1].legend(fontsize="small")
    figure.savefig(arguments.out, dpi=110)


def main():
    parser = picture.Parser(description="Draws errors of several studies against CPU time.")
    parser.add_argument("studies", nargs="+", help="folders of studies; those joined by + share a column")
    parser.add_argument("--references", nargs="+", required=True, help="runs that they were compared with, one a column")
    parser.add_argument("--titles", nargs="+", help="of the columns (default: their folders)")
    parser.add_argument("--results", nargs="+", default=["reaction_force_y_N"], help="default: %(default)s")
    parser.add_argument("--out", default="costs.png", help="default: %(default)s")
    arguments = parser.parse_args()
    arguments.titles = arguments.titles or [os.path.basename(folder.rstrip("/")) for folder in arguments.studies]
    if not len(arguments.titles) == len(arguments.references) == len(arguments.studies):
        parser.error("--references and --titles take one a study")
    try:
        draw(arguments)
    except results.MissingResult as reason:
        parser.error(str(reason))


if __name__ == "__main__":
    main()
