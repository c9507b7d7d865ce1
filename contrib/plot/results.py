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
DISPLACEMENT = "displacement_m"
GRID_DISPLACEMENTS = ("displacement_since_reset_m", DISPLACEMENT)
CELL_VOLUME = "material_volume_m3"
MATERIAL = "material"
HISTOGRAMS = "histograms.csv"
COMPONENTS = {3: ("x", "y", "z"), 4: ("xx", "xy", "yx", "yy"), 6: ("xx", "yy", "zz", "xy", "yz", "xz"),
              9: ("xx", "xy", "xz", "yx", "yy", "yz", "zx", "zy", "zz")}
SYMBOLS = {"m": 1., "mm": 1e-3, "um": 1e-6, "nm": 1e-9, "s": 1., "ms": 1e-3, "us": 1e-6, "min": 60., "h": 3600.,
           "kg": 1., "g": 1e-3, "mg": 1e-6, "ug": 1e-9, "ng": 1e-12, "pg": 1e-15, "N": 1., "mN": 1e-3, "uN": 1e-6, "nN": 1e-9,
           "pN": 1e-12, "Pa": 1., "kPa": 1e3, "MPa": 1e6, "GPa": 1e9, "mPa": 1e-3}  # of section Units, in SI
IN_SI = {**{k: "m" for k in ("mm", "um", "nm")}, **{k: "s" for k in ("ms", "us", "min", "h")},
         **{k: "kg" for k in ("g", "mg", "ug", "ng", "pg")}, **{k: "N" for k in ("mN", "uN", "nN", "pN")},
         **{k: "Pa" for k in ("kPa", "MPa", "GPa", "mPa")}}
ANY_UNIT = re.compile(r"_((?:per_)?(?:%s)\d?(?:_per_(?:%s)\d?)*)$" % (("|".join(SYMBOLS),) * 2))
UNIT = re.compile(r"_((?:N|Pa|J|W|m|s|kg|rad)(?:_?\d)?(?:_per_(?:N|Pa|J|m|s|kg)(?:_?\d)?)*)$")


class MissingResult(Exception):
    """A picture cannot be drawn because the folder does not hold what it needs."""


def label_and_unit(name):
    """("reaction force y", "N") for "reaction_force_y_N"; unit "" if the name has none."""
    match = UNIT.search(name)
    unit = match.group(1).replace("_per_", "/").replace("_", "") if match else ""
    return UNIT.sub("", name).replace("_", " ").replace("mises", "Mises").replace("cauchy", "Cauchy"), unit


def name_in_si(name):
    """(name, factor) of a field in SI: ("velocity_m_per_s", 1e-6) of "velocity_um_per_s"."""
    match = ANY_UNIT.search(name)
    if not match:
        return name, 1.
    factor, sign, words = 1., 1, []
    for word in match.group(1).split("_"):
        symbol, power = re.match(r"([A-Za-z]+)(\d?)", word).groups()
        if symbol == "per":
            sign = -1
        else:
            factor *= SYMBOLS[symbol] ** (sign * int(power or 1))
        words.append(IN_SI.get(symbol, symbol) + power)
    return name[:match.start()] + "_" + "_".join(words), factor


def in_si(mesh):
    """A mesh with places and fields in SI, whatever the units of its file are."""
    if mesh.notes.get("length_unit", ["m"]) == ["m"]:
        return mesh
    def data_in_si(data):
        return {name_in_si(name)[0]: values * name_in_si(name)[1] for name, values in data.items()}
    return vtu.Mesh(mesh.points * SYMBOLS[mesh.notes["length_unit"][0]], mesh.cells, data_in_si(mesh.point_data),
                    data_in_si(mesh.cell_data), mesh.notes)


def read_mesh(path, names):
    """A file of points or cells in SI, with the fields of these names in SI that it has; None: all."""
    return in_si(vtu.read(path, None if names is None else lambda name: name_in_si(name)[0] in names))


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


def when(folder, time):
    """What a run's state of a time is: the strain where the body is driven, and the time."""
    try:
        series = read_series(folder)
    except MissingResult:
        return f"{time:g} s"
    strain = next((name for name, values in series.items() if name.startswith("strain_") and len(name) == 8
                   and numpy.ptp(values) > 0.), None)
    row = numpy.argmin(numpy.abs(series["time_s"] - time))
    return (f"{100. * series[strain][row]:.4g} % strain along {strain[-1]}, " if strain else "") + f"{time:g} s"


def with_micro(unit):
    """"µm" for "um"."""
    return re.sub(r"^u(?=[a-zA-Z])", "µ", unit)


def unit_of_entry(folder, entry):
    """Unit in which the file of a run gives an entry, "Section/name"; "" if it has none or nothing tells it."""
    path = os.path.join(folder, "parameters.prm")
    *wanted, name = entry.split("/")
    section, comment = [], ""
    for line in open(path, encoding="utf-8").read().splitlines() if os.path.isfile(path) else []:
        word, _, rest = line.strip().partition(" ")
        if word == "subsection":
            section.append(rest.strip())
        elif word == "end":
            section.pop()
        elif word == "#":
            comment = rest
        elif word == "set" and section == wanted and rest.partition("=")[0].strip() == name:
            found = re.search(r"\[([A-Za-z][^\],]*)\](?:;|$)", comment)
            return with_micro(found.group(1)) if found else ""
    return ""


def read_histograms(folder):
    """(field, unit) -> group -> rows of histograms.csv, bin by bin."""
    fields = {}
    with open(os.path.join(folder, HISTOGRAMS), newline="", encoding="utf-8") as file:
        for row in csv.DictReader(file):
            fields.setdefault((row["field"], row["unit"]), {}).setdefault(row["group"], []).append(row)
    return fields


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
    """A scalar field at points, where they are now unless it says otherwise."""
    name: str
    time: float
    points: numpy.ndarray  # (n, 3)
    values: numpy.ndarray  # (n,)
    component: str = ""  # of a vector or tensor, or "size": its norm
    materials: numpy.ndarray = None  # (n,) index of each point's material, if asked for
    is_undeformed: bool = False

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


def read_field(folder, name, component="", with_materials=False, undeformed=False):
    """The last field of this name, in SI: of the points, or of the grid's cells if there are too many points or none. component: of a
    vector or tensor ("xy"), its size by default. undeformed: at the places of before."""
    points, grid = last_file(folder, "points"), last_file(folder, "grid")
    if points is None and grid is None:
        raise MissingResult(f"{folder} holds neither points.pvd nor grid.pvd")
    use_grid = points is None or (grid is not None and vtu.count_points(points[1]) > MOST_POINTS)
    time, path = grid if use_grid else points
    if use_grid and points is not None:
        print(f"Too many points to draw: taking the grid's cells of {path}", file=sys.stderr)
    mesh = read_mesh(path, {name, *GRID_DISPLACEMENTS, CELL_VOLUME} if use_grid else {name, MATERIAL, DISPLACEMENT})
    if len(mesh.points) == 0:
        raise MissingResult(f"{path} holds no points")
    if name not in mesh.point_data:
        raise MissingResult(f"{path} has no field {name}; it has {', '.join(read_mesh(path, None).point_data)}")
    mesh = mean_of_cells(mesh) if use_grid else mesh
    values, component = component_of(mesh.point_data[name], name, component)
    if with_materials and MATERIAL not in mesh.point_data:
        raise MissingResult(f"{path} has no field {MATERIAL} to draw outlines of")
    shown = numpy.isfinite(values)
    materials = mesh.point_data[MATERIAL][shown] if with_materials else None
    points = mesh.points.astype(float)
    if undeformed and DISPLACEMENT not in mesh.point_data:
        raise MissingResult(f"{path} has no field {DISPLACEMENT}, which tells where its points were")
    if undeformed:
        moved = mesh.point_data[DISPLACEMENT]
        points[:, :moved.shape[1]] -= moved
    return Field(name, time, points[shown], values[shown].astype(float), component, materials, undeformed)
