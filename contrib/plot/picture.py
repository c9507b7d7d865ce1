"""Pictures of a scalar field at points: the plane itself, a slice, a projection and an oblique view of the body."""
import argparse
import itertools
import os
import re
import sys

import matplotlib
matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy
from matplotlib.colors import Normalize
from matplotlib.ticker import EngFormatter, FuncFormatter

import results
from results import MissingResult, label_and_unit

COLOURS = plt.get_cmap("viridis").copy()
COLOURS.set_bad("white")
PREFIXES = {"p": 1e-12, "n": 1e-9, "u": 1e-6, "m": 1e-3, "k": 1e3, "M": 1e6, "G": 1e9}
CM_PER_INCH = 2.54
NARROW = 12.  # cm
MANY = 500_000  # points of a picture
MARGIN = .03  # of a picture's larger side
OVER_SCAN = .55  # how much of a field hides the scan underneath
AZIMUTH, ELEVATION = numpy.radians(-62.), numpy.radians(38.)
settings = {"dpi": 130, "width": None}  # of the pictures; see use_options()
LIGHT = numpy.array([-.35, .35, .87])  # right, up, towards the viewer


class Parser(argparse.ArgumentParser):
    """Says what is wrong with the words of a command in one line, with exit code 1."""

    def error(self, message):
        self.exit(1, f"{self.prog}: {message}; see --help\n")


def folder(text):
    """A folder that there is, as a type of arguments."""
    if not os.path.isdir(text):
        raise argparse.ArgumentTypeError(f"'{text}' is a file, not a folder" if os.path.exists(text) else
                                         f"the folder '{text}' does not exist")
    return text


def positive(text):
    """A number above 0, as a type of arguments."""
    if not 0. < results.number(text) < numpy.inf:
        raise argparse.ArgumentTypeError(f"'{text}' is no number above 0")
    return results.number(text)


def add_options(parser, of):
    """Those that all pictures have. of: whose folder they go to by default."""
    parser.add_argument("--out", help=f"where to put the pictures (default: the {of}'s folder)")
    parser.add_argument("--dpi", type=positive, default=130, help="of PNG (default: %(default)s)")
    parser.add_argument("--format", default="png", choices=["png", "svg", "pdf"], help="of the pictures (default: %(default)s)")
    parser.add_argument("--width", type=positive, help="of the pictures in print [cm]: letters and lines then have their size there")


def use_options(arguments):
    """Settings of all pictures to come."""
    settings.update(dpi=arguments.dpi, width=arguments.width)
    if arguments.width:
        plt.rcParams.update({"font.size": 7., "axes.titlesize": 7., "figure.titlesize": 7., "lines.linewidth": 1.,
                             "lines.markersize": 3., "axes.linewidth": .6, "xtick.major.width": .6, "ytick.major.width": .6,
                             "grid.linewidth": .5})


def is_narrow():
    """Whether pictures are for a column of a page, where panels side by side would be too small."""
    return settings["width"] is not None and settings["width"] < NARROW


def subplots(rows, columns, width, height, stack=False, **options):
    """plt.subplots of a figure of width x height inches, or as wide as it is printed. stack: one column of panels in a narrow one."""
    if stack and is_narrow():
        rows, columns, width, height = columns, rows, width / columns * rows, height / rows * columns
    if settings["width"]:
        width, height = settings["width"] / CM_PER_INCH, max(height / width, .5) * settings["width"] / CM_PER_INCH
    return plt.subplots(rows, columns, figsize=(width, height), constrained_layout=True, squeeze=False, **options)


def legend_below(figure, handles):
    """A row of keys below all panels."""
    height = 2.5 * plt.rcParams["font.size"] / 72. / figure.get_figheight()
    figure.get_layout_engine().set(rect=(0., height, 1., 1. - height))
    figure.legend(handles=handles, loc="lower center", ncols=len(handles), frameon=False)


def save(figure, path):
    """In the resolution that is asked for."""
    figure.savefig(path, dpi=settings["dpi"])
    plt.close(figure)


def use_colours(name):
    """Another colour map for all pictures."""
    global COLOURS
    COLOURS = plt.get_cmap(name).copy()
    COLOURS.set_bad("white")


def factor_of(unit, of):
    """What turns numbers in a unit with a prefix ("kPa") into the field's own ("Pa")."""
    if unit == of:
        return 1.
    if of and unit[1:] == of and unit[0] in PREFIXES:
        return PREFIXES[unit[0]]
    raise MissingResult(f"'{unit}' is no unit of this field; it is {of or 'a number'}, with a prefix of {' '.join(PREFIXES)}")


def spacing(points, dim):
    """Mean distance of neighbouring points, as if they filled their bounding box."""
    size = numpy.ptp(points[:, :dim], axis=0)
    return (numpy.prod(size) / len(points)) ** (1. / dim) if numpy.all(size > 0) else max(size.max(), 1e-300)


def neighbours(image):
    """(9, rows, columns): each pixel's 3 x 3 neighbourhood, NaN outside."""
    padded = numpy.pad(image, 1, constant_values=numpy.nan)
    rows, columns = image.shape
    return numpy.stack([padded[i:i + rows, j:j + columns] for i in range(3) for j in range(3)])


def fill_holes(image):
    """Empty pixels (NaN) with at least 5 neighbours that are not empty become their mean; twice."""
    for _ in range(2):
        around = neighbours(image)
        known = numpy.isfinite(around)
        holes = numpy.isnan(image) & (known.sum(axis=0) >= 5)
        image = image.copy()
        image[holes] = numpy.where(known, around, 0.).sum(axis=0)[holes] / known.sum(axis=0)[holes]
    return image


def shown_points(x, y, size, key=0., weight=1.):
    """(image, extent): the point that each pixel shows, -1 where there is none within 3/4 of `size`, the points' distance, to the
    right or up. Of several it is that with the smallest key + weight * distance^2. A pixel is half of a point, or a whole one of many."""
    split = 2 if len(x) < MANY else 1
    pixel, low = size / split, numpy.array([x.min(), y.min()]) - .5 * size
    columns, rows = (int(numpy.ptp(v) / pixel + split + .5) for v in (x, y))
    i, j = ((x - low[0]) / pixel).astype(int), ((y - low[1]) / pixel).astype(int)
    image, least = numpy.full((rows, columns), -1), numpy.full((rows, columns), numpy.inf)
    key = numpy.broadcast_to(key, len(x))
    for across, up in itertools.product(range(-split, split + 1), repeat=2):
        column, row = i + across, j + up
        right, above = low[0] + (column + .5) * pixel - x, low[1] + (row + .5) * pixel - y
        near = (column >= 0) & (column < columns) & (row >= 0) & (row < rows)
        near = numpy.flatnonzero(near & (numpy.maximum(abs(right), abs(above)) <= .75 * size))
        cost = (key + weight * (right ** 2 + above ** 2))[near]
        order = numpy.argsort(-cost, kind="stable")
        near, cost = near[order], cost[order]
        here = (row[near], column[near])
        of_offset = numpy.full_like(least, numpy.inf)
        of_offset[here] = cost  # of several points the last, with the smallest
        wins = (cost == of_offset[here]) & (cost < least[here])
        image[row[near][wins], column[near][wins]] = near[wins]
        least = numpy.minimum(least, of_offset)
    return image, (low[0], low[0] + columns * pixel, low[1], low[1] + rows * pixel)


def values_of(image, values):
    """What the points that pixels show have; NaN where there is none, but in small holes, which take the mean around them."""
    return fill_holes(numpy.where(image < 0, numpy.nan, values[image]))


def colour_scale(fields):
    """One scale for all fields: from 0 (or the lowest values, if negative) to the highest but for 1 in 200."""
    values = numpy.concatenate([f.values for f in fields])
    low, high = numpy.percentile(values, [.5, 99.5])
    low = min(low, 0.)
    return Normalize(low, high if high > low else low + 1.)


def show_multiple(shown, unit, parts=4):
    """Ticks of axes in one multiple of a unit, which their labels name: "force [mN]". shown: [(axis, name)]; parts: between ticks, at most."""
    largest = max(abs(end) for axis, _ in shown for end in axis.get_view_interval())
    has_prefix = unit and not re.match(r"[A-Za-z]+\d", unit)  # a thousandth of m2 is no mm2
    power = max(min(3 * int(numpy.floor(numpy.log10(largest) / 3.)), 9), -12) if largest > 0. and has_prefix else 0
    for axis, name in shown:
        axis.set_label_text(f"{name} [{EngFormatter.ENG_PREFIXES[power]}{unit}]" if unit else name)
        axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value / 10. ** power:.6g}"))
        axis.set_major_locator(plt.MaxNLocator(parts, steps=[1, 2, 5, 10]))


def show_lengths(axes, names="xy"):
    """The same of both axes of a plane. names: "" for an axis that is no length."""
    show_multiple([(axis, name) for axis, name in zip((axes.xaxis, axes.yaxis), names) if name], "m")


def log_text(value):
    """A number of a logarithmic axis, short: 0.02, 500, 2e-5."""
    return f"{value:g}".replace("e-0", "e-").replace("e+0", "e")


def show_logarithm(axis):
    """A logarithmic axis with at least three numbers, where its ends allow it, and so few that they do not touch."""
    low, high = axis.get_view_interval()
    powers = 10. ** numpy.arange(numpy.floor(numpy.log10(low)), numpy.log10(high) + 1.)
    for factors in ((1.,), (1., 2., 5.), (1., 1.5, 2., 3., 5., 7.)):
        ticks = [tick for power in powers for tick in power * numpy.array(factors) if low <= tick <= high]
        if len(ticks) >= 3:
            break
    else:
        ticks = [tick for tick in plt.MaxNLocator(4, steps=[1, 2, 5, 10]).tick_values(low, high) if low <= tick <= high]
    ticks = ticks[::-(-len(ticks) // 6)]
    axis.set_ticks(ticks, [log_text(tick) for tick in ticks])
    axis.set_minor_formatter(plt.NullFormatter())


def show_image(axes, image, extent, scale, scan=None, names="xy"):
    """scan: grey values (rows, columns) and their extent, to be seen underneath. names: of the axes to the right and up."""
    if scan is not None:
        axes.imshow(scan[0], origin="lower", extent=scan[1], cmap="gray", vmin=0, vmax=255, interpolation="nearest")
    colours = COLOURS if scan is None else COLOURS.with_extremes(bad=(0., 0., 0., 0.))
    axes.imshow(numpy.ma.masked_invalid(image), origin="lower", extent=extent, cmap=colours, norm=scale,
                interpolation="nearest", alpha=None if scan is None else OVER_SCAN)
    axes.set_aspect("equal")
    if scan is None:  # white all round, so that a waist is no white strip beside the frame
        left, right, bottom, top = extent
        margin = MARGIN * max(right - left, top - bottom)
        axes.set(xlim=(left - margin, right + margin), ylim=(bottom - margin, top + margin))
    show_lengths(axes, names)


def show_outlines(axes, image, extent):
    """Lines between materials: image holds their numbers."""
    left, right, bottom, top = extent
    columns = left + (right - left) * (numpy.arange(image.shape[1]) + .5) / image.shape[1]
    rows = bottom + (top - bottom) * (numpy.arange(image.shape[0]) + .5) / image.shape[0]
    for one in numpy.unique(image[numpy.isfinite(image)])[1:]:
        axes.contour(columns, rows, numpy.where(numpy.isnan(image), numpy.nan, image >= one - .25), [.5], colors="black",
                     linewidths=.6)


def draw_plane(axes, field, scale, scan=None):
    """A 2D field."""
    image, extent = shown_points(field.points[:, 0], field.points[:, 1], spacing(field.points, 2))
    show_image(axes, values_of(image, field.values), extent, scale, scan)
    if field.materials is not None:
        show_outlines(axes, values_of(image, field.materials), extent)


def draw_slice(axes, field, scale, axis="z", place=None, scan=None):
    """The points nearest to a plane across an axis, the middle one unless its place [m] is given."""
    size = spacing(field.points, 3)
    across = "xyz".index(axis)
    right, up = (i for i in range(3) if i != across)
    z = field.points[:, across]
    distance = numpy.abs(z - (.5 * (z.min() + z.max()) if place is None else place))
    near = distance <= max(3. * size, numpy.ptp(z) / 16.)
    if not numpy.any(near):
        raise MissingResult(f"no point is near {axis} = {place:g} m; the body spans {z.min():g} to {z.max():g} m")
    image, extent = shown_points(field.points[near, right], field.points[near, up], size, distance[near] ** 2)
    show_image(axes, values_of(image, field.values[near]), extent, scale, scan, ("xyz"[right], "xyz"[up]))
    if field.materials is not None:
        show_outlines(axes, values_of(image, field.materials[near]), extent)


def draw_projection(axes, field, scale):
    """The largest value along z."""
    image, extent = shown_points(field.points[:, 0], field.points[:, 1], spacing(field.points, 3), -field.values, 0.)
    show_image(axes, values_of(image, field.values), extent, scale)


def view_axes():
    """Unit vectors of the oblique view: to the right, up, and towards the viewer."""
    right = numpy.array([-numpy.sin(AZIMUTH), numpy.cos(AZIMUTH), 0.])
    viewer = numpy.array([numpy.cos(ELEVATION) * numpy.cos(AZIMUTH), numpy.cos(ELEVATION) * numpy.sin(AZIMUTH),
                          numpy.sin(ELEVATION)])
    return right, numpy.cross(viewer, right), viewer


def median(image):
    """3 x 3 median of the pixels that are not empty; empty ones stay empty."""
    around = numpy.sort(neighbours(image), axis=0)  # NaN last
    count = numpy.isfinite(around).sum(axis=0)
    middle = numpy.take_along_axis(around, (numpy.maximum(count - 1, 0) // 2)[None], axis=0)[0]
    return numpy.where(numpy.isnan(image), numpy.nan, middle)


def shade(depth, pixel):
    """Brightness of each pixel from the slope of the surface seen, .45 to 1; single points are smoothed away."""
    for _ in range(3):
        around = neighbours(depth)
        known = numpy.isfinite(around)
        depth = numpy.where(numpy.isnan(depth), numpy.nan, numpy.where(known, around, 0.).sum(axis=0) / numpy.maximum(known.sum(axis=0), 1))
    level = numpy.where(numpy.isnan(depth), numpy.nanmin(depth), depth)
    slope_up, slope_right = numpy.gradient(level, pixel)
    cosine = LIGHT[2] - slope_right * LIGHT[0] - slope_up * LIGHT[1]
    cosine /= numpy.sqrt(1. + slope_right ** 2 + slope_up ** 2)
    return .45 + .55 * numpy.clip(cosine, 0., 1.)


def draw_body(axes, field, scale):
    """The body seen obliquely from above: in each pixel the point nearest to the viewer, lit by its surface's slope."""
    right, up, viewer = view_axes()
    u, v, depth = field.points @ right, field.points @ up, field.points @ viewer
    size = spacing(field.points, 3)
    image, extent = shown_points(u, v, size, -depth, 0.)
    pixel = (extent[1] - extent[0]) / image.shape[1]
    surface, values = median(values_of(image, depth)), median(values_of(image, field.values))
    colours = COLOURS(scale(numpy.ma.masked_invalid(values)))
    colours[..., :3] *= numpy.where(numpy.isnan(values), 1., shade(median(surface), pixel))[..., None]
    axes.imshow(colours, origin="lower", extent=extent, interpolation="bilinear")
    axes.set_aspect("equal")
    axes.set_axis_off()
    draw_directions(axes, right, up, extent)


def draw_directions(axes, right, up, extent):
    """Arrows of x, y and z below the body."""
    length = .1 * (extent[1] - extent[0])
    origin = numpy.array([extent[0] + .3 * length, extent[2] - .5 * length])
    for i, name in enumerate("xyz"):
        tip = origin + length * numpy.array([right[i], up[i]])
        axes.annotate("", tip, origin, arrowprops={"arrowstyle": "->", "color": "0.3"}, annotation_clip=False)
        axes.annotate(name, origin + 1.25 * (tip - origin), ha="center", va="center", color="0.3",
                      annotation_clip=False)
    axes.set_ylim(extent[2] - length, extent[3])


def bar_format(unit, in_unit):
    """How numbers of a field with this unit are written at a colour bar."""
    if not in_unit:
        return EngFormatter(unit) if unit else None
    factor = factor_of(in_unit, unit)
    return FuncFormatter(lambda value, _: f"{value / factor:g} {in_unit}")


def add_colour_bar(figure, axes, field_name, scale, fields, in_unit=None, **options):
    """A colour bar with the field's name and unit, pointed where values lie beyond the scale, and said how many do."""
    unit = label_and_unit(field_name)[1]
    below = any(f.values.min() < scale.vmin for f in fields)
    above = any(f.values.max() > scale.vmax for f in fields)
    extend = {(False, False): "neither", (True, False): "min", (False, True): "max", (True, True): "both"}
    mappable = plt.cm.ScalarMappable(scale, COLOURS)
    bar = figure.colorbar(mappable, ax=axes, extend=extend[below, above],
                          format=bar_format(unit, in_unit), **options)
    if is_narrow():  # so that numbers of three digits with their unit fit
        bar.locator = plt.MaxNLocator(4, steps=[1, 2, 5, 10])
        bar.update_ticks()
    values = numpy.concatenate([f.values for f in fields])
    cut = [f"{100. * numpy.mean(beyond):.2g} % {word}" for beyond, word in
           ((values < scale.vmin, "below"), (values > scale.vmax, "above")) if numpy.any(beyond)]
    bar.set_label(fields[0].label + (f" ({', '.join(cut)} the bar)" if cut else ""))


def draw_all(folder, pictures, asked=()):
    """Draws each {file name: function of the path} into the folder; says which cannot be drawn, and why. Exit code 1 if that is all of
    them, or one of those that were asked for."""
    os.makedirs(folder, exist_ok=True)
    missing = []
    for name, draw in pictures.items():
        path = os.path.join(folder, name)
        try:
            draw(path)
            print(f"Picture {path}")
        except MissingResult as reason:
            print(f"No {name}: {reason}", file=sys.stderr)
            missing.append(name)
    if len(missing) == len(pictures) or set(missing) & set(asked):
        sys.exit(1)
