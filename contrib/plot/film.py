#!/usr/bin/python3
"""Makes a film of a run from all its field files: film.webm where ffmpeg is installed, else film.webp, and always the last
picture as film.png. Bodies of two dimensions are drawn as they are, others by their middle plane.

    film.py FOLDER [--fields degradation_factor,von_mises_Pa] [--rate 12] [--images] [--out FOLDER]
"""
import os
import shutil
import subprocess
import sys
import tempfile

import numpy

import picture
import results
import vtu
from picture import plt

DEFAULT_FIELDS = ("degradation_factor", "von_mises_Pa")


def read_frame(path, time, names):
    """One results.Field a name: scalars, or the length of vectors."""
    mesh = results.read_mesh(path, set(names))
    missing = [name for name in names if name not in mesh.point_data]
    if missing:
        raise results.MissingResult(f"{path} has no field {missing[0]}; it has {', '.join(results.read_mesh(path, None).point_data)}")
    frame = []
    for name in names:
        values = mesh.point_data[name]
        values = values if values.ndim == 1 else numpy.linalg.norm(values, axis=1)
        frame.append(results.Field(name, time, mesh.points.astype(float), values.astype(float)))
    return frame


def read_frames(folder, names):
    path = os.path.join(folder, "points.pvd")
    if not os.path.isfile(path):
        raise results.MissingResult(f"{folder} holds no points.pvd")
    records = vtu.read_pvd(path)
    if not names:
        there = results.read_mesh(records[-1][1], None).point_data
        names = [name for name in DEFAULT_FIELDS if name in there] or [next(iter(there))]
    return [read_frame(file, time, names) for time, file in records]


def limits(frames):
    """The box of the points of all frames: [[left, bottom], [right, top]]."""
    points = [frame[0].points[:, :2] for frame in frames]
    return numpy.array([numpy.min([p.min(axis=0) for p in points], axis=0),
                        numpy.max([p.max(axis=0) for p in points], axis=0)])


def draw_frame(path, frame, scales, box):
    shape = numpy.ptp(box, axis=0)
    height = numpy.clip(4.2 * shape[1] / shape[0], 2.5, 8.)
    figure, all_axes = plt.subplots(1, len(frame), figsize=(5.2 * len(frame), height + .8), constrained_layout=True,
                                    squeeze=False)
    for axes, field, scale in zip(all_axes[0], frame, scales):
        (picture.draw_plane if field.dim == 2 else picture.draw_slice)(axes, field, scale)
        axes.set(xlim=box[:, 0], ylim=box[:, 1])
        picture.show_lengths(axes)
        picture.add_colour_bar(figure, axes, field.name, scale, [field], shrink=.8)
    figure.suptitle(f"{frame[0].time:g} s")
    figure.savefig(path, dpi=100)
    plt.close(figure)


def draw_frames(frames, folder):
    """Paths of the pictures, one a frame, all with the same scales and limits."""
    scales = [picture.colour_scale([frame[k] for frame in frames]) for k in range(len(frames[0]))]
    box = limits(frames)
    paths = [os.path.join(folder, f"frame_{n:05d}.png") for n in range(len(frames))]
    for path, frame in zip(paths, frames):
        draw_frame(path, frame, scales, box)
    return paths


def make_webm(folder, rate, path):
    command = ["ffmpeg", "-y", "-loglevel", "error", "-framerate", str(rate), "-i", os.path.join(folder, "frame_%05d.png"),
               "-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2", "-c:v", "libvpx-vp9", "-pix_fmt", "yuv420p", "-b:v", "0", "-crf", "32", path]
    subprocess.run(command, check=True)


def make_webp(paths, rate, path):
    from PIL import Image  # comes with matplotlib
    images = [Image.open(one).convert("RGB") for one in paths]
    images[0].save(path, save_all=True, append_images=images[1:], duration=round(1000 / rate), loop=0, quality=80)


def make_film(frames, arguments, out):
    os.makedirs(out, exist_ok=True)
    with tempfile.TemporaryDirectory() as scratch:
        if arguments.images:
            scratch = os.path.join(out, "film")
            os.makedirs(scratch, exist_ok=True)
        paths = draw_frames(frames, scratch)
        shutil.copy(paths[-1], os.path.join(out, "film.png"))
        if arguments.images:
            return scratch
        if shutil.which("ffmpeg"):
            make_webm(scratch, arguments.rate, os.path.join(out, "film.webm"))
            return os.path.join(out, "film.webm")
        make_webp(paths, arguments.rate, os.path.join(out, "film.webp"))
        return os.path.join(out, "film.webp")


def main():
    parser = picture.Parser(description="Makes a film of a run from all its field files.")
    parser.add_argument("folder", type=picture.folder, help="the run's results")
    parser.add_argument("--fields", default="", help="between commas (default: those of DEFAULT_FIELDS that there are)")
    parser.add_argument("--rate", type=picture.positive, default=12., help="pictures a second (default: %(default)s)")
    parser.add_argument("--images", action="store_true", help="leave the pictures in FOLDER/film instead of a film")
    parser.add_argument("--out", help="where to put the film (default: the run's folder)")
    arguments = parser.parse_args()
    try:
        frames = read_frames(arguments.folder, [name for name in arguments.fields.split(",") if name])
        print(f"Film {make_film(frames, arguments, arguments.out or arguments.folder)} of {len(frames)} picture{'s' * (len(frames) != 1)}")
    except results.MissingResult as reason:
        sys.exit(f"No film: {reason}")


if __name__ == "__main__":
    main()
