#!/usr/bin/python3
"""Draws a field on the voxels of a scan (`Output/Image fields`, NRRD) beside the scan and over it: the middle planes, each
image in the frame of its own header. Exit code 1 if the two frames differ.

    plot_voxels.py SCAN.nrrd FIELD.nrrd [--out FOLDER] [--dpi N] [--format png|pdf|svg] [--width CM]
"""
import argparse
import os
import re
import sys

import numpy

import nrrd
import picture
import results
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


def draw(scan, field, name, path):
    """A row a plane that is more than a voxel thick: the scan, the field, and outlines of the scan's labels over the field."""
    shown = [("xyz".index(a), "xyz".index(b)) for a, b in PLANES
             if min(field.voxels.shape[2 - "xyz".index(a)], field.voxels.shape[2 - "xyz".index(b)]) > 1]
    extents = [plane(field, *axes)[1] for axes in shown]
    heights = [max(.25, (e[3] - e[2]) / (e[1] - e[0])) for e in extents]
    figure, grid = picture.subplots(len(shown), 3, 15., 1. + (7.5 if picture.is_narrow() else 4.6) * sum(heights),
                                    gridspec_kw={"height_ratios": heights})
    low, high = numpy.nanpercentile(field.voxels, [.5, 99.5])
    for row, axes in zip(grid, shown):
        (labels, of_scan), (values, of_field) = plane(scan, *axes), plane(field, *axes)
        row[0].imshow(labels, origin="lower", extent=of_scan, cmap="gray", interpolation="nearest")
        for panel in row[1:]:
            drawn = panel.imshow(values, origin="lower", extent=of_field, cmap=picture.COLOURS, vmin=min(low, 0.), vmax=high,
                                 interpolation="nearest")
        centres = [numpy.linspace(of_scan[2 * i], of_scan[2 * i + 1], labels.shape[1 - i], endpoint=False) for i in (0, 1)]
        centres = [c + .5 * (c[1] - c[0]) for c in centres]
        row[2].contour(*centres, labels, levels=[.5 * (float(labels.min()) + float(labels.max()))], colors="white",
                       linewidths=.6)
        for panel in row:
            panel.set(xlim=of_scan[:2], ylim=of_scan[2:], xlabel=f"{'xyz'[axes[0]]} [{field.unit}]",
                      ylabel=f"{'xyz'[axes[1]]} [{field.unit}]" if panel is row[0] else "")
            panel.set_aspect("equal")
            panel.xaxis.set_major_locator(plt.MaxNLocator(3))
    label, unit = results.label_and_unit(name)
    for panel, title in zip(grid[0], ("scan", label, "with outlines" if picture.is_narrow() else "scan's outlines over it")):
        panel.set_title(title)
    bar = {"ax": list(grid.flat), "location": "bottom", "aspect": 40} if picture.is_narrow() else {"ax": list(grid[:, 2])}
    figure.colorbar(drawn, format=EngFormatter(unit), label=label, shrink=.8, **bar)
    picture.save(figure, path)


def main():
    parser = argparse.ArgumentParser(description="Draws a field on the voxels of a scan beside the scan.")
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
    picture.draw_all(arguments.out or folder or ".", {
        f"{stem}.{arguments.format}": lambda path: draw(scan, field, name_of(arguments.field), path)})


if __name__ == "__main__":
    main()
