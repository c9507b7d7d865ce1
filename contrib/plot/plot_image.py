#!/usr/bin/python3
"""Draws what `stroma image` has left in a folder: histogram.png (how often grey values occur, with thresholds) and planes.png
(the scan's middle planes, and over them the materials of its segmentation).

    plot_image.py FOLDER
"""
import argparse
import csv
import os

import numpy

import picture
from picture import plt
from results import MissingResult, read_json

STYLES = {"Otsu": "--", "triangle": ":"}


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


def draw_histogram(folder, path):
    report = read_json(folder, "image.json")
    edges, counts = read_histogram(folder)
    figure, axes = plt.subplots(figsize=(6.4, 4.), constrained_layout=True)
    axes.stairs(counts, edges, fill=True, color="0.7")
    axes.set_yscale("log")
    for name, suggestion in report["suggested_thresholds"].items():
        axes.axvline(suggestion["threshold"], linestyle=STYLES[name], color="C0", label=f"{name}: {suggestion['threshold']:g}")
    for name, value in zip(("lower", "upper"), report.get("segmentation", {}).get("thresholds", [])):
        axes.axvline(value, color="C3", alpha=.7, label=f"{name}, of the scene: {value:g}")
    axes.set(xlabel="grey value", ylabel="voxels")
    if axes.get_legend_handles_labels()[0]:
        axes.legend()
    figure.savefig(path, dpi=130)
    plt.close(figure)


def colours_of(labels):
    """(rows, columns, 4): a colour for each material, nothing where there is none."""
    table = numpy.array([(0., 0., 0., 0.)] + [plt.get_cmap("tab10")(i % 10)[:3] + (.45,) for i in range(255)])
    return table[labels]


def draw_plane(axes, scan, labels, plane, edges):
    """The scan in grey; over it all materials but the most frequent."""
    extent = (0., scan.shape[1] * edges["xyz".index(plane[0])], 0., scan.shape[0] * edges["xyz".index(plane[1])])
    axes.imshow(scan, origin="lower", extent=extent, cmap="gray", vmin=0, vmax=255, interpolation="nearest")
    if labels is not None:
        shown = colours_of(labels)
        shown[labels == numpy.bincount(labels.ravel()).argmax()] = 0.
        axes.imshow(shown, origin="lower", extent=extent, interpolation="nearest")
    axes.set_aspect("equal")
    axes.set(xlabel=f"{plane[0]} [µm]", ylabel=f"{plane[1]} [µm]")


def draw_planes(folder, path):
    report = read_json(folder, "image.json")
    edges = [1e6 * edge for edge in report["voxel_m"]]
    planes = [plane for plane in ("xy", "xz", "yz") if read_plane(folder, plane, "scan") is not None]
    has_labels = "segmentation" in report
    rows = [False, True] if has_labels else [False]
    figure, axes = plt.subplots(len(rows), len(planes), figsize=(5. * len(planes), 4.2 * len(rows)), squeeze=False,
                                constrained_layout=True)
    for row, with_labels in zip(axes, rows):
        for one, plane in zip(row, planes):
            draw_plane(one, read_plane(folder, plane, "scan"), read_plane(folder, plane, "materials") if with_labels else None,
                       plane, edges)
    if has_labels:
        held = {material["name"] for material in report["segmentation"]["materials"]}
        for label, name in ((label, name) for label, name in report["segmentation"]["labels_of_file"].items() if name in held):
            axes[1][0].plot([], [], "s", color=plt.get_cmap("tab10")((int(label) - 1) % 10), label=name)
        axes[1][0].legend(loc="upper right", fontsize="small")
    figure.suptitle(f"{os.path.basename(report['file'])}, middle planes")
    figure.savefig(path, dpi=130)
    plt.close(figure)


def main():
    parser = argparse.ArgumentParser(description="Draws histogram.png and planes.png of a report of stroma image.")
    parser.add_argument("folder", help="the report's folder")
    folder = parser.parse_args().folder
    if not os.path.isdir(folder):
        parser.error(f"{folder} is not a folder")
    picture.draw_all(folder, {"histogram.png": lambda path: draw_histogram(folder, path),
                              "planes.png": lambda path: draw_planes(folder, path)})


if __name__ == "__main__":
    main()
