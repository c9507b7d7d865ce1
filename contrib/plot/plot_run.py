#!/usr/bin/python3
"""Draws a run: force.png (reaction forces), <field>.png (the field at the end) and, where the scene asks for results by material,
histograms.png, from the folder of its results.

    plot_run.py FOLDER [--field cauchy_stress_Pa --component xy] [--plane z=2e-5] [--range 0 2 --unit kPa] [--colours MAP]
                [--outlines] [--scan FOLDER_OF_STROMA_IMAGE] [--width 8] [--dpi 300] [--format pdf]
                [--out FOLDER]
"""
import argparse
import os

import numpy

import picture
import plot_image
import results
from picture import EngFormatter, plt

DEFAULT_FIELD = "von_mises_Pa"


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
    figure, axes = picture.subplots(1, 1, 6.4, 4.4)
    draw_forces(axes[0, 0], results.read_series(folder))
    picture.save(figure, path)


def histogram_edges(rows):
    """Edges (n + 1,) and densities (n,), part of the volume over width, of the bins of equal width of one histogram, and the part
    of the volume beyond them."""
    edges = numpy.array([float(row["from"]) for row in rows] + [float(rows[-1]["to"])])
    widths = numpy.diff(edges)
    parts = numpy.array([float(row["fraction"]) for row in rows])
    return edges[1:-1], (parts / numpy.where(widths > 0., widths, numpy.inf))[1:-1], parts[0] + parts[-1]


def draw_histograms(folder, path):
    """A panel a field, a line a material or body; the rest beyond the bins of equal width is said, not drawn."""
    fields = results.read_histograms(folder)
    is_narrow = picture.is_narrow() and len(fields) > 1
    columns = 2 if is_narrow else min(len(fields), 3)
    rows = -(-len(fields) // columns)
    figure, all_axes = picture.subplots(rows, columns, 4.2 * columns, (4.4 if is_narrow else 3.2) * rows)
    for axes in all_axes.flat[len(fields):]:
        axes.set_axis_off()
    for axes, ((field, unit), groups) in zip(all_axes.flat, fields.items()):
        for group, bins in groups.items():
            edges, density, rest = histogram_edges(bins)
            axes.stairs(density, edges, label=f"{group} ({100. * rest:.2g} % beyond)", linewidth=1.5)
        axes.set(ylabel=("" if is_narrow else "part of the volume ") + f"per {unit or 'unit'}", ylim=(0., None))
        picture.show_multiple([(axes.xaxis, results.label_and_unit(field)[0])], unit, 3 if is_narrow else 6)
        axes.legend(fontsize="x-small" if is_narrow else "small", loc="lower right" if is_narrow else "lower left",
                    bbox_to_anchor=(1. if is_narrow else 0., 1.), borderaxespad=.2, frameon=False)  # on no curve
    if is_narrow:
        figure.supylabel("part of the volume", fontsize="medium")
    picture.save(figure, path)


def draw_field_2d(field, scale, scan):
    size = numpy.ptp(field.points[:, :2], axis=0)
    height = numpy.clip(6. * size[1] / max(size[0], 1e-300), 3., 9.)
    figure, axes = picture.subplots(1, 1, 7.4, height)
    picture.draw_plane(axes[0, 0], field, scale, scan)
    return figure, axes


def draw_field_3d(field, scale):
    figure, axes = picture.subplots(2, 2, 8., 9.) if picture.is_narrow() else picture.subplots(1, 3, 16., 5.4)
    if picture.is_narrow():  # the surface below both planes
        for one in axes[1]:
            one.remove()
        axes = numpy.array([[*axes[0], figure.add_subplot(axes[0, 0].get_gridspec()[1, :])]])
    draws = {"middle plane": picture.draw_slice, "largest value along z": picture.draw_projection,
             "surface": picture.draw_body}
    for one, (title, draw) in zip(axes.flat, draws.items()):
        draw(one, field, scale)
        one.set_title(title)
    return figure, axes


def draw_field_in_plane(field, scale, plane, scan):
    axis, _, place = plane.partition("=")
    figure, axes = picture.subplots(1, 1, 7.4, 6.)
    picture.draw_slice(axes[0, 0], field, scale, axis, float(place) if place else None, scan)
    title = f"{axis} = {EngFormatter('m')(float(place))}" if place else f"middle plane of {axis}"
    blend = f"; colours at {picture.OVER_SCAN:.0%} over the scan" if scan else ""
    axes[0, 0].set_title(title + blend, fontsize="medium")
    return figure, axes


def caption(folder, field):
    """Which field it is, and when."""
    return f"{field.label} at {results.when(folder, field.time)}" + (", on undeformed places" if field.is_undeformed else "")


def with_scan(arguments, field):
    """Plane and scan of a picture with the scan underneath; they go through one plane."""
    if not arguments.scan:
        return arguments.plane, None
    axis, _, place = (arguments.plane or "z").partition("=")
    grey, extent, of_scan = plot_image.scan_in_plane(arguments.scan, axis)
    if place and abs(float(place) - of_scan) > 1e-9 * abs(of_scan):
        raise results.MissingResult(f"the report holds the scan at {axis} = {of_scan:g} m only; give --plane {axis}")
    return (arguments.plane if field.dim == 2 else f"{axis}={of_scan!r}"), (grey, extent)


def draw_field_picture(arguments, path):
    field = results.read_field(arguments.folder, arguments.field, arguments.component, arguments.outlines,
                               bool(arguments.scan))
    plane_drawn, scan = with_scan(arguments, field)
    scale = picture.colour_scale([field])
    unit = results.label_and_unit(arguments.field)[1]
    if arguments.range:
        factor = picture.factor_of(arguments.unit, unit) if arguments.unit else 1.
        scale = picture.Normalize(*(factor * end for end in arguments.range))
    if field.dim == 2:
        figure, axes = draw_field_2d(field, scale, scan)
    elif plane_drawn:
        figure, axes = draw_field_in_plane(field, scale, plane_drawn, scan)
    else:
        figure, axes = draw_field_3d(field, scale)
    picture.add_colour_bar(figure, axes, arguments.field, scale, [field], in_unit=arguments.unit, shrink=.8,
                           location="bottom" if picture.is_narrow() and axes.size > 1 else "right")
    figure.suptitle(caption(arguments.folder, field))
    picture.save(figure, path)


def plane(text):
    axis, sign, place = text.partition("=")
    if axis not in ("x", "y", "z") or (sign and not numpy.isfinite(results.number(place))):
        raise argparse.ArgumentTypeError(f"'{text}' is no plane; give x, y or z, or with a place in m: z=2e-5")
    return text


def parse():
    parser = picture.Parser(description="Draws force.png and <field>.png of a run.")
    parser.add_argument("folder", type=picture.folder, help="the run's results")
    parser.add_argument("--field", help=f"field to draw (default: {DEFAULT_FIELD})")
    parser.add_argument("--component", default="", help="of a vector or tensor: x, xy, ..., or size (default: size)")
    parser.add_argument("--plane", type=plane, help="in space: only the plane across this axis, at its middle or a place [m]: z=2e-5")
    parser.add_argument("--range", type=float, nargs=2, metavar=("LOW", "HIGH"), help="ends of the colour bar, in --unit")
    parser.add_argument("--unit", help="of the colour bar, such as kPa (default: a prefix that fits)")
    parser.add_argument("--colours", default="viridis", choices=plt.colormaps(), metavar="MAP", help="colour map of matplotlib")
    parser.add_argument("--outlines", action="store_true", help="lines between materials, in planes")
    parser.add_argument("--scan", metavar="FOLDER", help="the scan underneath, from a folder of stroma image --segment; drawn on "
                        "undeformed places")
    picture.add_options(parser, "run")
    arguments = parser.parse_args()
    if arguments.range and not (numpy.all(numpy.isfinite(arguments.range)) and arguments.range[0] < arguments.range[1]):
        parser.error(f"--range {arguments.range[0]:g} {arguments.range[1]:g}: the first number must be below the second")
    arguments.is_asked = any(getattr(arguments, name) != parser.get_default(name) for name in
                             ("field", "component", "plane", "range", "unit", "outlines", "scan"))
    arguments.field = arguments.field or DEFAULT_FIELD
    return arguments


def main():
    arguments = parse()
    picture.use_options(arguments)
    picture.use_colours(arguments.colours)
    name = "_".join(word for word in (arguments.field, arguments.component, (arguments.plane or "")[:1]) if word)
    name = f"{name}.{arguments.format}"
    pictures = {f"force.{arguments.format}": lambda path: draw_force_picture(arguments.folder, path),
                name: lambda path: draw_field_picture(arguments, path)}
    if os.path.isfile(os.path.join(arguments.folder, results.HISTOGRAMS)):
        pictures[f"histograms.{arguments.format}"] = lambda path: draw_histograms(arguments.folder, path)
    picture.draw_all(arguments.out or arguments.folder, pictures, [name] if arguments.is_asked else [])


if __name__ == "__main__":
    main()
