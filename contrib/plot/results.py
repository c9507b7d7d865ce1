"""What a run left in its folder: series.csv and the last fields, as numpy arrays."""
import csv
import os
import re
import sys
from dataclasses import dataclass

import numpy

import vtu

MOST_POINTS = 3_000_000
UNIT = re.compile(r"_((?:N|Pa|J|W|m|s|kg|rad)(?:_?\d)?(?:_per_(?:N|Pa|J|m|s|kg)(?:_?\d)?)*)$")


class MissingResult(Exception):
    """A picture cannot be drawn because the folder does not hold what it needs."""


def label_and_unit(name):
    """("reaction force y", "N") for "reaction_force_y_N"; unit "" if the name has none."""
    match = UNIT.search(name)
    unit = match.group(1).replace("_per_", "/").replace("_", "") if match else ""
    return UNIT.sub("", name).replace("_", " "), unit


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


def abscissa(series):
    """Name of the column to draw against: the strain or stretch if there is one that changes, else the time."""
    for name, values in series.items():
        if re.match(r"(engineering_|mean_)?(strain|stretch)(?!.*_J)", name) and numpy.nanstd(values) > 0:
            return name
    return next((name for name in series if label_and_unit(name)[0] == "time"), next(iter(series)))


def reaction_columns(series):
    """Names of the reaction forces that matter: at least a thousandth of the largest, largest first."""
    size = {name: numpy.nanmax(numpy.abs(values)) for name, values in series.items()
            if "reaction" in name and not numpy.all(numpy.isnan(values))}
    largest = max(size.values(), default=0.)
    return sorted((name for name in size if size[name] > 1e-3 * largest), key=lambda name: -size[name])


@dataclass
class Field:
    """A scalar field at points in deformed positions."""
    name: str
    time: float
    points: numpy.ndarray  # (n, 3)
    values: numpy.ndarray  # (n,)

    @property
    def dim(self):
        return 3 if len(self.points) and numpy.ptp(self.points[:, 2]) > 0 else 2


def last_file(folder, stem):
    path = os.path.join(folder, stem + ".pvd")
    times = vtu.read_pvd(path) if os.path.isfile(path) else []
    return times[-1] if times else None


def at_cell_centres(mesh, name):
    """Centres of the cells, moved by their displacement, and their values."""
    def mean(values):
        return values[mesh.cells].mean(axis=1)

    def of_cells(array_name):
        if array_name in mesh.cell_data:
            return mesh.cell_data[array_name]
        return mean(mesh.point_data[array_name])

    centres = mean(mesh.points)
    if "displacement_m" in {**mesh.cell_data, **mesh.point_data}:
        centres = centres + of_cells("displacement_m")
    return centres, of_cells(name)


def read_field(folder, name):
    """The last field of this name: of the points, or of the grid's cells if there are too many points or none."""
    points, grid = last_file(folder, "points"), last_file(folder, "grid")
    if points is None and grid is None:
        raise MissingResult(f"{folder} holds neither points.pvd nor grid.pvd")
    use_grid = points is None or (grid is not None and vtu.count_points(points[1]) > MOST_POINTS)
    time, path = grid if use_grid else points
    if use_grid and points is not None:
        print(f"Too many points to draw: taking the grid's cells of {path}", file=sys.stderr)
    mesh = vtu.read(path, {name, "displacement_m"})
    if len(mesh.points) == 0:
        raise MissingResult(f"{path} holds no points")
    if name not in {**mesh.point_data, **mesh.cell_data}:
        known = vtu.read(path)
        raise MissingResult(f"{path} has no field {name}; it has {', '.join({**known.point_data, **known.cell_data})}")
    positions, values = (mesh.points, mesh.point_data[name]) if mesh.cells is None else at_cell_centres(mesh, name)
    if values.ndim > 1:
        values = numpy.linalg.norm(values, axis=1)
    finite = numpy.isfinite(values)
    return Field(name, time, positions[finite].astype(float), values[finite].astype(float))
