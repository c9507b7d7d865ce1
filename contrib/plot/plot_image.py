#!/usr/bin/python3
"""Draws what `stroma image` has left in a folder: histogram.png (how often grey values occur, with thresholds) and planes.png
(the scan's middle planes, and over them the materials of its segmentation).

    plot_image.py FOLDER [--out FOLDER] [--dpi N] [--format png|pdf|svg] [--width CM]
"""
import csv
import os

import numpy

import picture
from picture import plt
from results import MissingResult, read_json

LINES = {"Otsu": {"color": "C0", "linewidth": 4., "alpha": .4}, "triangle": {"color": "C0", "linestyle": ":"},
         "lower": {"color": "C3"}, "upper": {"color": "black", "linestyle": (0, (3, 3))}}  # equal ones are seen over each other


def read_histogram(folder):
    """Edges (n + 1,) and counts (n,) of the bins."""
    with open(os.path.join(folder, "histogram.csv"), newline="", encoding="utf-8") as file:
        rows = list(csv.reader(file))[1:]
    return numpy.array([float(row[0]) for row in rows] + [float(rows[-1][1])]), numpy.array([int(row[2]) for row in rows])


def read_plane(folder, plane, name):
    """(rows, columns) of bytes; None if there is no such file."""
    path = os.path.join(folder, f"plane_{plane}_{name}.pgm")
    if not os.path.isfile(path):
        return None
    with open(path, "rb") as file:
        if file.readline() != b"P5\n":
            raise MissingResult(f"{path} is no PGM file")
        columns, rows = map(int, file.readline().split())
        file.readline()
        return numpy.frombuffer(file.read(), numpy.uint8).reshape(rows, columns)


def scan_in_plane(folder, axis):
    """Grey values (rows, columns) of the middle plane across an axis, their extent [m], and the place of the plane [m] in the
    scene by which the folder's image was segmented."""
    report = read_json(folder, "image.json")
    if "segmentation" not in report:
        raise MissingResult(f"{folder} tells no place in a scene; make it by stroma image --segment SCENE.prm")
    grey = read_plane(folder, "xyz".replace(axis, ""), "scan")
    if grey is None:
        raise MissingResult(f"{folder} has no plane across {axis}")
    corner, edges, size = report["segmentation"]["corner_m"], report["voxel_m"], report["voxels"]
    right, up = (i for i in range(3) if "xyz"[i] != axis)
    across = "xyz".index(axis)
    extent = (corner[right], corner[right] + grey.shape[1] * edges[right], corner[up], corner[up] + grey.shape[0] * edges[up])
    return grey, extent, corner[across] + (size[across] // 2 + .5) * edges[across]


def draw_histogram(folder, path):
    report = read_json(folder, "image.json")
    edges, counts = read_histogram(folder)
    figure, axes = picture.subplots(1, 1, 6.4, 4.)
    axes = axes[0, 0]
    axes.stairs(counts, edges, fill=True, color="0.7")
    axes.set_yscale("log")
    for name, suggestion in report["suggested_thresholds"].items():
        axes.axvline(suggestion["threshold"], label=f"{name}: {suggestion['threshold']:g}", **LINES[name])
    for name, value in zip(("lower", "upper"), report.get("segmentation", {}).get("thresholds", [])):
        axes.axvline(value, label=f"{name}, of the scene: {value:g}", **LINES[name])
    axes.set(xlabel="grey value", ylabel="voxels")
    if axes.get_legend_handles_labels()[0]:
        axes.legend()
    picture.save(figure, path)


def colours_of(labels):
    """(rows, columns, 4): a colour for each material, nothing where there is none."""
    table = numpy.array([(0., 0., 0., 0.)] + [plt.get_cmap("tab10")(i % 10)[:3] + (.45,) for i in range(255)])
    return table[labels]


def draw_plane(axes, scan, labels, plane, edges, uncoloured=0):
    """The scan in grey; over it all materials but one."""
    extent = (0., scan.shape[1] * edges["xyz".index(plane[0])], 0., scan.shape[0] * edges["xyz".index(plane[1])])
    axes.imshow(scan, origin="lower", extent=extent, cmap="gray", vmin=0, vmax=255, interpolation="nearest")
    if labels is not None:
        shown = colours_of(labels)
        shown[labels == uncoloured] = 0.
        axes.imshow(shown, origin="lower", extent=extent, interpolation="nearest")
    axes.set_aspect("equal")
    axes.set(xlabel=f"{plane[0]} [µm]", ylabel=f"{plane[1]} [µm]")


def keys(segmentation, labels, uncoloured):
    """Of the colours of all materials that there are."""
    held = {material["name"] for material in segmentation["materials"]}
    return [plt.Line2D([], [], linestyle="", marker="s", markeredgecolor="black", markeredgewidth=.5,
                       color="white" if label == uncoloured else plt.get_cmap("tab10")((label - 1) % 10),
                       label=name + (" (not coloured)" if label == uncoloured else "")) for label, name in labels.items() if name in held]


def draw_planes(folder, path):
    report = read_json(folder, "image.json")
    edges = [1e6 * edge for edge in report["voxel_m"]]
    planes = [plane for plane in ("xy", "xz", "yz") if read_plane(folder, plane, "scan") is not None]
    segmentation = report.get("segmentation")
    rows = [False, True] if segmentation else [False]
    lengths = dict(zip("xyz", (n * edge for n, edge in zip(report["voxels"], edges))))
    heights = [max(.2, lengths[plane[1]] / lengths[plane[0]]) for plane in planes]
    if picture.is_narrow():  # a row a plane
        figure, axes = picture.subplots(len(planes), len(rows), 4. * len(rows), .8 + sum(3. * height + 1.2 for height in heights),
                                        gridspec_kw={"height_ratios": heights})
        axes = axes.T
    else:
        figure, axes = picture.subplots(len(rows), len(planes), 5. * len(planes), 4.2 * len(rows))
    labels = {int(label): name for label, name in segmentation["labels_of_file"].items()} if segmentation else {}
    most = max(segmentation["materials"], key=lambda one: one["fraction"])["name"] if segmentation else ""
    uncoloured = next((label for label, name in labels.items() if name == most), 0)
    for row, with_labels in zip(axes, rows):
        for one, plane in zip(row, planes):
            draw_plane(one, read_plane(folder, plane, "scan"), read_plane(folder, plane, "materials") if with_labels else None,
                       plane, edges, uncoloured)
    if segmentation:
        picture.legend_below(figure, keys(segmentation, labels, uncoloured))
    figure.suptitle(f"{os.path.basename(report['file'])}, middle planes")
    picture.save(figure, path)


def main():
    parser = picture.Parser(description="Draws histogram.png and planes.png of a report of stroma image.")
    parser.add_argument("folder", type=picture.folder, help="the report's folder")
    picture.add_options(parser, "report")
    arguments = parser.parse_args()
    folder = arguments.folder
    picture.use_options(arguments)
    picture.draw_all(arguments.out or folder, {f"histogram.{arguments.format}": lambda path: draw_histogram(folder, path),
                                               f"planes.{arguments.format}": lambda path: draw_planes(folder, path)})


if __name__ == "__main__":
    main()
