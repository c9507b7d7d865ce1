"""Field files look alike, whatever the method: points where they are now with the same fields and components, the start as the first
state, walls apart, what positions mean and the names of materials said, and the units that the scene asks for."""
import csv
import os
import sys

import numpy

from program import Folder, HERE, block, check, run, settings, stretched, summary

sys.path.insert(0, os.path.join(HERE, "..", "..", "contrib", "plot"))
sys.dont_write_bytecode = True
import results  # noqa: E402
import vtu  # noqa: E402

METHODS = ("mpm", "fem", "nsph", "sph")
SCENE = block(2, """set Law = hypoelastic
    set Young's modulus = 1
    set Poisson's ratio = .3
    set Density   = 1e-12
    set Viscosity = 1e-3""", """subsection Units
  set Length = um
  set Stress = kPa
end
""" + stretched("y", "0; .02*y*min(t/.002, 1)") + """subsection Time
  set End          = .004
  set Initial step = .001
  set Largest step = .001
end
subsection MPM
  set Cells = 8, 8
end
subsection FEM
  set Cells = 8, 8
end
subsection NSPH
  set Spacing = 1
end
subsection SPH
  set Spacing = 1
end
subsection Output
  set Fields every = 2
  set Results by material = von_mises, cauchy_stress
end
""", """set Shape = box
    set Lower corner = 0, 0
    set Upper corner = 8, 8
    set Material     = gel""")
LAWS = {"mpm": "neo-Hookean", "fem": "neo-Hookean", "nsph": "hypoelastic", "sph": "hypoelastic"}


def files(folder, name):
    return vtu.read_pvd(os.path.join(folder, name))


def start_and_end(method, output):
    """First and last points of a run, with all that is said of them."""
    times = [time for time, _ in files(output, "points.pvd")]
    check(numpy.allclose(times, [0., .002, .004]), f"{method}: states at {times}")
    start, end = (vtu.read(files(output, "points.pvd")[i][1]) for i in (0, -1))
    check(end.notes["positions"] == ["deformed"] and end.notes["material_names"] == ["gel"], f"{method}: {end.notes}")
    check(numpy.allclose(start.points, end.points - displacement(end), atol=1e-5 * numpy.ptp(end.points)),
          f"{method}: the first state is not the start")
    return start, end


def displacement(mesh):
    return next(values for name, values in mesh.point_data.items() if name.startswith("displacement_"))


def histograms(method, output):
    """Parts of the volume sum up to all, and their median is the one that the summary has."""
    with open(os.path.join(output, "histograms.csv"), newline="") as file:
        rows = [row for row in csv.DictReader(file) if row["field"] == "von_mises"]
    parts = numpy.cumsum([float(row["fraction"]) for row in rows])
    median = summary(output)["results"]["von_mises_p50_gel_Pa"]
    check(len(rows) == 50 and abs(parts[-1] - 1) < 1e-12, f"{method}: {len(rows)} bins of {parts[-1]}")
    below, above = (parts[[median >= float(row[end]) for row in rows]].max(initial=0.) for end in ("to", "from"))
    check(below <= .5 + 1e-9 and above >= .5 - 1e-9, f"{method}: {below} to {above} of the volume lie below the median {median}")


with Folder() as folder:
    scene = os.path.join(folder, "scene.prm")
    with open(scene, "w") as file:
        file.write(SCENE)
    shapes = {}
    for method in METHODS:
        output, scaled = os.path.join(folder, method), os.path.join(folder, method + "_scaled")
        entries = [f"Method={method}", f"Materials/gel/Law={LAWS[method]}"]
        run(["run", scene, "--output", output] + settings(entries))
        run(["run", scene, "--output", scaled] + settings(entries + ["Output/Units=scene"]))
        start, end = start_and_end(method, output)
        shapes[method] = {name: values.shape[1:] for name, values in end.point_data.items() if name != "velocity_m_per_s"}
        histograms(method, output)

        # Only particles of layers have walls; those lie beyond the material.
        particles = method.endswith("sph")
        check(os.path.exists(os.path.join(output, "walls.pvd")) == particles, f"{method}: walls")
        if particles:
            walls = vtu.read(files(output, "walls.pvd")[0][1])
            inside = (walls.points[:, 1] > 0) & (walls.points[:, 1] < 8e-6)
            check(len(walls.points) > 0 and not inside.any(), f"{method}: walls in the material")
            check(len(end.points) == 64, f"{method}: {len(end.points)} points of material")
        else:
            grid = vtu.read(files(output, "grid.pvd")[-1][1])
            check(grid.notes["positions"] == ["undeformed"] and grid.notes["length_unit"] == ["m"], f"{method}: grid {grid.notes}")
            in_um = vtu.read(files(scaled, "grid.pvd")[-1][1])
            check(numpy.allclose(in_um.points, 1e6 * grid.points, rtol=1e-5), f"{method}: places of the grid")
            check(numpy.allclose(in_um.point_data["pressure_kPa"], 1e-3 * grid.point_data["pressure_Pa"], rtol=1e-5, atol=1e-9),
                  f"{method}: pressure of the grid")
            check("material_volume_um3" in in_um.point_data, f"{method}: {list(in_um.point_data)}")

        # In the scene's units, and back.
        other = vtu.read(files(scaled, "points.pvd")[-1][1])
        check(other.notes["length_unit"] == ["um"], f"{method}: {other.notes}")
        check({"displacement_um", "von_mises_kPa", "cauchy_stress_kPa", "J", "material"} <= other.point_data.keys(),
              f"{method}: {list(other.point_data)}")
        back = results.in_si(other)
        check(back.point_data.keys() == end.point_data.keys(), f"{method}: {list(back.point_data)}")
        for name, values in [*end.point_data.items(), ("places", end.points)]:
            found = back.points if name == "places" else back.point_data[name]
            check(numpy.allclose(found, values, rtol=1e-5, atol=1e-6 * numpy.abs(values).max()), f"{method}: {name} in other units")
        one = summary(output)["results"]["max_displacement_m"]
        check(one == summary(scaled)["results"]["max_displacement_m"], f"{method}: results change with the units of files")
    check(all(shape == shapes["mpm"] for shape in shapes.values()), f"fields differ: {shapes}")
    check(shapes["mpm"]["cauchy_stress_Pa"] == (6,), f"{shapes}")
print("field files look alike")
