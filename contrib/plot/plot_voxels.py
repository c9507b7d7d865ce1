#!/usr/bin/python3
"""Draws a field on the voxels of a scan (`Output/Image fields`, NRRD) beside the scan and over it: the middle planes, each
image in the frame of its own header. Exit code 1 if the two frames differ.

    plot_voxels.py SCAN.nrrd FIELD.nrrd [--out FOLDER] [--dpi N] [--format png|pdf|svg] [--width CM]
"""
import os
import re
import sys

import numpy

import nrrd
import picture
import results
import vtu
from picture import EngFormatter, plt

PLANES = (("x", "y"), ("x", "z"), ("y", "z"))


def plane(image, across, up):
    """(2D voxels, extent) of the middle plane with these axes, 0 to 2."""
    normal = 3 - across - up
    cut = numpy.take(image.voxels, image.voxels.shape[2 - normal] // 2, 2 - normal)
    return cut, image.edges(across) + image.edges(up)


def name_of(path):
    """The field's name in its file's: voxels_von_mises_Pa_0001.nrrd."""
    return re.sub(r"^voxels_|_\d+$", "", os.path.splitext(os.path.basename(path))[0])


def when(path):
    """When a run's file of voxels is; "" if no list of files in its folder tells it."""
    folder = os.path.dirname(path) or "."
    listed = os.path.join(folder, "voxels.pvd")
    times = [time for time, file in (vtu.read_pvd(listed) if os.path.isfile(listed) else ())
             if os.path.basename(file) == os.path.basename(path)]
    return f" at {results.when(folder, times[0])}" if times else ""


def draw(scan, field, names, path):
    """A row a plane that is more than a voxel thick: the scan, the field, and outlines of the scan's labels over the field. names: of
    the scan, of the field, and when it is."""
    shown = [("xyz".index(a), "xyz".index(b)) for a, b in PLANES
             if min(field.voxels.shape[2 - "xyz".index(a)], field.voxels.shape[2 - "xyz".index(b)]) > 1]
    extents = [plane(field, *axes)[1] for axes in shown]
    heights = [max(.25, (e[3] - e[2]) / (e[1] - e[0])) for e in extents]
    figure, grid = picture.subplots(len(shown), 3, 15., 2.5 + (7. if picture.is_narrow() else 4.6) * sum(heights),
                                    gridspec_kw={"height_ratios": heights})
    of_length = results.with_micro(field.unit)
    low, high = numpy.nanpercentile(field.voxels, [.5, 99.5])
    for row, axes in zip(grid, shown):
        (labels, of_scan), (values, of_field) = plane(scan, *axes), plane(field, *axes)
        row[0].imshow(labels, origin="lower", extent=of_scan, cmap="gray", interpolation="nearest")
        for panel in row[1:]:
            drawn = panel.imshow(values, origin="lower", extent=of_field, cmap=picture.COLOURS, vmin=min(low, 0.), vmax=high,
                                 interpolation="nearest")
        centres = [numpy.linspace(of_scan[2 * i], of_scan[2 * i + 1], labels.shape[1 - i], endpoint=False) for i in (0, 1)]
        centres = [c + .5 * (c[1] - c[0]) for c in centres]
        if labels.min() < labels.max():
            row[2].contour(*centres, labels, levels=[.5 * (float(labels.min()) + float(labels.max()))], colors="white", linewidths=.6)
        for panel in row:
            panel.set(xlim=of_scan[:2], ylim=of_scan[2:], xlabel=f"{'xyz'[axes[0]]} [{of_length}]",
                      ylabel=f"{'xyz'[axes[1]]} [{of_length}]" if panel is row[0] else "")
            panel.set_aspect("equal")
            panel.xaxis.set_major_locator(plt.MaxNLocator(3))
            panel.tick_params(labelleft=panel is row[0])
            if of_scan[3] - of_scan[2] < .4 * (of_scan[1] - of_scan[0]):  # flat: numbers would touch
                panel.set_yticks([tick for tick in plt.MaxNLocator(3, steps=[1, 2, 5, 10]).tick_values(*of_scan[2:]) if tick <= of_scan[3]][-1:])
    label, unit = results.label_and_unit(names[1])
    for panel, title in zip(grid[0], (names[0], label, "with outlines" if picture.is_narrow() else f"outlines of {names[0]} over it")):
        panel.set_title(title)
    figure.suptitle(label + names[2], fontsize="medium")
    bar = {"ax": list(grid.flat), "location": "bottom", "aspect": 40} if picture.is_narrow() else {"ax": list(grid[:, 2])}
    figure.colorbar(drawn, format=EngFormatter(unit), label=label, shrink=.8, **bar)
    picture.save(figure, path)


def main():
    parser = picture.Parser(description="Draws a field on the voxels of a scan beside the scan.")
    parser.add_argument("scan", help="the scan, NRRD")
    parser.add_argument("field", help="voxels_..._0001.nrrd of a run")
    picture.add_options(parser, "field")
    arguments = parser.parse_args()
    picture.use_options(arguments)
    try:
        scan, field = nrrd.read(arguments.scan), nrrd.read(arguments.field)
    except (results.MissingResult, OSError) as reason:
        parser.error(str(reason))
    if scan.voxels.shape != field.voxels.shape or not numpy.array_equal(scan.spacing, field.spacing) or \
            not numpy.array_equal(scan.origin, field.origin):
        print(f"The frames differ: scan {scan.voxels.shape[::-1]} voxels of {scan.spacing} from {scan.origin}, field "
              f"{field.voxels.shape[::-1]} of {field.spacing} from {field.origin}", file=sys.stderr)
        sys.exit(1)
    stem, folder = os.path.splitext(os.path.basename(arguments.field))[0], os.path.dirname(arguments.field)
    names = os.path.splitext(os.path.basename(arguments.scan))[0], name_of(arguments.field), when(arguments.field)
    picture.draw_all(arguments.out or folder or ".", {
        f"{stem}.{arguments.format}": lambda path: draw(scan, field, names, path)})


if __name__ == "__main__":
    main()
