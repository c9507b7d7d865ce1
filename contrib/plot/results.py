"""What a run left in its folder: series.csv and the last fields, as numpy arrays."""
import csv
import json
import os
import re
import sys
from dataclasses import dataclass

import numpy

import vtu

MOST_POINTS = 3_000_000
GRID_DISPLACEMENTS = ("displacement_since_reset_m", "displacement_m")
CELL_VOLUME = "material_volume_m3"
FIXED = "fixed"  # particles of walls and rigid bodies
MATERIAL = "material"
COMPONENTS = {3: ("x", "y", "z"), 4: ("xx", "xy", "yx", "yy"), 6: ("xx", "yy", "zz", "xy", "yz", "xz"),
              9: ("xx", "xy", "xz", "yx", "yy", "yz", "zx", "zy", "zz")}
UNIT = re.compile(r"_((?:N|Pa|J|W|m|s|kg|rad)(?:_?\d)?(?:_per_(?:N|Pa|J|m|s|kg)(?:_?\d)?)*)$")


class MissingResult(Exception):
    """A picture cannot be drawn because the folder does not hold what it needs."""


def label_and_unit(name):
    """("reaction force y", "N") for "reaction_force_y_N"; unit "" if the name has none."""
    match = UNIT.search(name)
    unit = match.group(1).replace("_per_", "/").replace("_", "") if match else ""
    return UNIT.sub("", name).replace("_", " ").replace("mises", "Mises"), unit


def read_json(folder, name):
    """A file of JSON in a folder."""
    path = os.path.join(folder, name)
    if not os.path.isfile(path):
        raise MissingResult(f"{path} does not exist")
    with open(path, encoding="utf-8") as file:
        return json.load(file)


def read_series(folder):
    """Columns of series.csv: name -> (n,) floats; what is not a number becomes NaN."""
    path = os.path.join(folder, "series.csv")
    if not os.path.isfile(path):
        raise MissingResult(f"{path} does not exist")
    with open(path, newline="", encoding="utf-8") as file:
        rows = [row for row in csv.reader(file) if row and not row[0].startswith("#")]
    if len(rows) < 2:
        raise MissingResult(f"{path} holds no row")
    names = [name.strip() for name in rows[0]]
    complete = [row for row in rows[1:] if len(row) == len(names)]
    return {name: numpy.array([number(row[i]) for row in complete]) for i, name in enumerate(names)}


def number(text):
    try:
        return float(text)
    except ValueError:
        return float("nan")


def holds(values):
    """Whether a value stays the same from one step to the next."""
    return bool(numpy.any(numpy.abs(numpy.diff(values)) <= 1e-6 * numpy.ptp(values)))


def abscissa(series):
    """Name of the column to draw against: the strain or stretch if there is one that changes at each step, else the time: a force
    that relaxes is a vertical line over the strain."""
    for name, values in series.items():
        if re.match(r"(engineering_|mean_|shear_)?(strain|stretch)(?!.*_J)", name) and not holds(values):
            return name
    return next((name for name in series if label_and_unit(name)[0] == "time"), next(iter(series)))


def reaction_columns(series):
    """Names of the reaction forces that matter: at least a thousandth of the largest, largest first. Those of a held side
    (reaction_force_...) stand for those of each support, unless the load acts along another direction, as in shear: when a
    support's force is more than twice theirs."""
    size = {name: numpy.nanmax(numpy.abs(values)) for name, values in series.items()
            if name.startswith("reaction_") and not numpy.all(numpy.isnan(values))}
    of_sides = {name: value for name, value in size.items() if name.startswith("reaction_force_")}
    of_supports = {name: value for name, value in size.items() if name not in of_sides}
    largest = max(of_supports.values(), default=0.)
    shown = of_sides if of_sides and (not of_supports or 2. * max(of_sides.values()) >= largest) else of_supports
    largest = max(shown.values(), default=0.)
    return sorted((name for name in shown if shown[name] > 1e-3 * largest), key=lambda name: -shown[name])


@dataclass
class Field:
    """A scalar field at points in deformed positions."""
    name: str
    time: float
    points: numpy.ndarray  # (n, 3)
    values: numpy.ndarray  # (n,)
    component: str = ""  # of a vector or tensor, or "size": its norm
    materials: numpy.ndarray = None  # (n,) index of each point's material, if asked for

    @property
    def label(self):
        """Its name for people: "|cauchy stress|" for a norm."""
        label = label_and_unit(self.name)[0]
        return f"|{label}|" if self.component == "size" else f"{label} {self.component}".strip()

    @property
    def dim(self):
        return 3 if len(self.points) and numpy.ptp(self.points[:, 2]) > 0 else 2


def last_file(folder, stem):
    path = os.path.join(folder, stem + ".pvd")
    times = vtu.read_pvd(path) if os.path.isfile(path) else []
    return times[-1] if times else None


def mean_of_cells(mesh):
    """The cells that hold material: their centres, moved with the grid, and the means of all fields over a cell."""
    fields = {name: values[mesh.cells].mean(axis=1) for name, values in mesh.point_data.items()}
    displacement = next((fields[name] for name in GRID_DISPLACEMENTS if name in fields), 0.)
    centres = mesh.points[mesh.cells].mean(axis=1) + displacement
    filled = fields.get(CELL_VOLUME, numpy.ones(len(centres))) > 0.
    return vtu.Mesh(centres[filled], None, {name: values[filled] for name, values in fields.items()})


def component_of(values, name, component):
    """(n,) values of one component of a field (n, k), and its name; "" of a vector or tensor is its size."""
    if values.ndim == 1:
        if component:
            raise MissingResult(f"{name} has no components")
        return values, ""
    known = ("1", "2", "3") if name.startswith("principal") else COMPONENTS[values.shape[1]]
    if component in ("", "size"):
        twice = 2. if len(known) == 6 else 1.  # of a symmetric tensor xy stands for yx too
        return numpy.sqrt((values[:, :3] ** 2).sum(axis=1) + twice * (values[:, 3:] ** 2).sum(axis=1)), "size"
    if component not in known:
        raise MissingResult(f"{name} has no component {component}; it has {', '.join(known)} and size")
    return values[:, known.index(component)], component


def read_field(folder, name, component="", with_materials=False):
    """The last field of this name: of the points but for fixed ones, or of the grid's cells if there are too many points or
    none. component: of a vector or tensor ("xy"), its size by default."""
    points, grid = last_file(folder, "points"), last_file(folder, "grid")
    if points is None and grid is None:
        raise MissingResult(f"{folder} holds neither points.pvd nor grid.pvd")
    use_grid = points is None or (grid is not None and vtu.count_points(points[1]) > MOST_POINTS)
    time, path = grid if use_grid else points
    if use_grid and points is not None:
        print(f"Too many points to draw: taking the grid's cells of {path}", file=sys.stderr)
    mesh = vtu.read(path, {name, *GRID_DISPLACEMENTS, CELL_VOLUME} if use_grid else {name, FIXED, MATERIAL})
    if len(mesh.points) == 0:
        raise MissingResult(f"{path} holds no points")
    if name not in mesh.point_data:
        raise MissingResult(f"{path} has no field {name}; it has {', '.join(vtu.read(path).point_data)}")
    mesh = mean_of_cells(mesh) if use_grid else mesh
    values, component = component_of(mesh.point_data[name], name, component)
    if with_materials and MATERIAL not in mesh.point_data:
        raise MissingResult(f"{path} has no field {MATERIAL} to draw outlines of")
    shown = numpy.isfinite(values) & (mesh.point_data.get(FIXED, numpy.zeros(len(values))) == 0.)
    materials = mesh.point_data[MATERIAL][shown] if with_materials else None
    return Field(name, time, mesh.points[shown].astype(float), values[shown].astype(float), component, materials)
