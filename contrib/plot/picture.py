"""Pictures of a scalar field at points: the plane itself, a slice, a projection and an oblique view of the body."""
import os
import sys

import matplotlib
matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy
from matplotlib.colors import Normalize
from matplotlib.ticker import EngFormatter, FuncFormatter

from results import MissingResult, label_and_unit

COLOURS = plt.get_cmap("viridis").copy()
COLOURS.set_bad("white")
PREFIXES = {"p": 1e-12, "n": 1e-9, "u": 1e-6, "m": 1e-3, "k": 1e3, "M": 1e6, "G": 1e9}
AZIMUTH, ELEVATION = numpy.radians(-62.), numpy.radians(38.)
LIGHT = numpy.array([-.35, .35, .87])  # right, up, towards the viewer


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


def raster(x, y, values, pixel, priority=None):
    """(image, extent): the value of the point with the highest priority in each pixel, NaN where there is none."""
    left, bottom = x.min() - .5 * pixel, y.min() - .5 * pixel
    i, j = ((x - left) / pixel).astype(int), ((y - bottom) / pixel).astype(int)
    image = numpy.full((j.max() + 1, i.max() + 1), numpy.nan)
    order = numpy.arange(len(x)) if priority is None else numpy.argsort(priority, kind="stable")
    image[j[order], i[order]] = values[order]
    return image, (left, left + image.shape[1] * pixel, bottom, bottom + image.shape[0] * pixel)


def colour_scale(fields):
    """One scale for all fields: from 0 (or the lowest values, if negative) to the highest but for 1 in 200."""
    values = numpy.concatenate([f.values for f in fields])
    low, high = numpy.percentile(values, [.5, 99.5])
    low = min(low, 0.)
    return Normalize(low, high if high > low else low + 1.)


def show_image(axes, image, extent, scale):
    axes.imshow(image, origin="lower", extent=extent, cmap=COLOURS, norm=scale, interpolation="nearest")
    axes.set_aspect("equal")
    axes.set(xlabel="x", ylabel="y")
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_formatter(EngFormatter("m"))
        axis.set_major_locator(plt.MaxNLocator(4))


def show_outlines(axes, x, y, materials, pixel, extent, priority=None):
    """Lines between materials."""
    image = fill_holes(raster(x, y, materials.astype(float), pixel, priority)[0])
    columns = extent[0] + pixel * (numpy.arange(image.shape[1]) + .5)
    rows = extent[2] + pixel * (numpy.arange(image.shape[0]) + .5)
    for one in numpy.unique(materials)[1:]:
        axes.contour(columns, rows, numpy.where(numpy.isnan(image), numpy.nan, image >= one - .25), [.5], colors="black",
                     linewidths=.6)


def draw_plane(axes, field, scale):
    """A 2D field."""
    x, y = field.points[:, 0], field.points[:, 1]
    pixel = 1.3 * spacing(field.points, 2)
    image, extent = raster(x, y, field.values, pixel)
    show_image(axes, fill_holes(image), extent, scale)
    if field.materials is not None:
        show_outlines(axes, x, y, field.materials, pixel, extent)


def draw_slice(axes, field, scale, axis="z", place=None):
    """The points nearest to a plane across an axis, the middle one unless its place [m] is given."""
    pixel = 1.5 * spacing(field.points, 3)
    across = "xyz".index(axis)
    right, up = (i for i in range(3) if i != across)
    z = field.points[:, across]
    distance = numpy.abs(z - (.5 * (z.min() + z.max()) if place is None else place))
    near = distance <= max(2. * pixel, numpy.ptp(z) / 16.)
    if not numpy.any(near):
        raise MissingResult(f"no point is near {axis} = {place:g} m; the body spans {z.min():g} to {z.max():g} m")
    x, y = field.points[near, right], field.points[near, up]
    image, extent = raster(x, y, field.values[near], pixel, -distance[near])
    show_image(axes, fill_holes(image), extent, scale)
    axes.set(xlabel="xyz"[right], ylabel="xyz"[up])
    if field.materials is not None:
        show_outlines(axes, x, y, field.materials[near], pixel, extent, -distance[near])


def draw_projection(axes, field, scale):
    """The largest value along z."""
    x, y = field.points[:, 0], field.points[:, 1]
    image, extent = raster(x, y, field.values, 1.5 * spacing(field.points, 3), field.values)
    show_image(axes, fill_holes(image), extent, scale)


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
    """Brightness of each pixel from the slope of the surface seen, .45 to 1."""
    level = numpy.where(numpy.isnan(depth), numpy.nanmin(depth), depth)
    slope_up, slope_right = numpy.gradient(level, pixel)
    cosine = LIGHT[2] - slope_right * LIGHT[0] - slope_up * LIGHT[1]
    cosine /= numpy.sqrt(1. + slope_right ** 2 + slope_up ** 2)
    return .45 + .55 * numpy.clip(cosine, 0., 1.)


def draw_body(axes, field, scale):
    """The body seen obliquely from above: in each pixel the point nearest to the viewer, lit by its surface's slope."""
    right, up, viewer = view_axes()
    u, v, depth = field.points @ right, field.points @ up, field.points @ viewer
    pixel = 1.5 * spacing(field.points, 3)
    surface, extent = raster(u, v, depth, pixel, depth)
    values, _ = raster(u, v, field.values, pixel, depth)
    surface, values = median(fill_holes(surface)), median(fill_holes(values))
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
    values = numpy.concatenate([f.values for f in fields])
    cut = [f"{100. * numpy.mean(beyond):.2g} % {word}" for beyond, word in
           ((values < scale.vmin, "below"), (values > scale.vmax, "above")) if numpy.any(beyond)]
    bar.set_label(fields[0].label + (f" ({', '.join(cut)} the bar)" if cut else ""))


def draw_all(folder, pictures):
    """Draws each {file name: function of the path} into the folder; says which cannot be drawn, and why."""
    os.makedirs(folder, exist_ok=True)
    for name, draw in pictures.items():
        path = os.path.join(folder, name)
        try:
            draw(path)
            print(f"Picture {path}")
        except MissingResult as reason:
            print(f"No {name}: {reason}", file=sys.stderr)
