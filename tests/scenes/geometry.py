"""Bodies have the volume and the place they were drawn with: a column's weight, a padded image, a film between the points."""
import os

from program import Folder, block, check, settings, stretched, summary
from server import run

COLUMN = """
set Dimension = 2
set Thickness = 1
subsection Materials
  subsection soil
    set Law             = linear elastic
    set Young's modulus = 1e8
    set Poisson's ratio = 0
  end
end
subsection Bodies
  subsection column
    set Shape        = box
    set Upper corner = 0.2, 1
    set Material     = soil
  end
end
subsection Supports
  subsection foot
    set Where = side y-min
    set Type  = symmetry
  end
  subsection left
    set Where = side x-min
    set Type  = symmetry
  end
end
subsection Loads
  subsection weight
    set Where         = all
    set Force density = 0; -1e4*t
  end
end
subsection MPM
  set Cells        = 2, 3
  set Upper corner = 0.2, 1.3
end
"""
GEL = "set Law = linear elastic\n set Young's modulus = 1000\n set Poisson's ratio = 0"
IMAGE = "set Shape = image\n set File = {file}\n set Voxel size = 1, 1, 1\n set Materials = {materials}"
BLOCK = block(3, GEL, body=IMAGE, more=stretched("z", "free; free; 0.04*t") + """subsection Units
  set Length = um
end
subsection Time
  set Initial step = 1
  set Largest step = 1
end
subsection {method}
  set Cells = {cells}
end
""")


def write(path, text):
    with open(path, "w") as file:
        file.write(text)
    return path


def padded_image(path, pad):
    """A block of 4 x 4 x 4 voxels of 1 um, with empty ones round it."""
    n = 4 + 2 * pad
    inside = range(pad, pad + 4)
    voxels = bytes(1 if x in inside and y in inside and z in inside else 0
                   for z in range(n) for y in range(n) for x in range(n))
    header = f"NRRD0004\ntype: uint8\ndimension: 3\nsizes: {n} {n} {n}\nspacings: 1 1 1\nencoding: raw\n\n"
    with open(path, "wb") as file:
        file.write(header.encode() + voxels)


def results(folder, name, path, entries=()):
    output = os.path.join(folder, name)
    run(["run", path, "--output", output] + settings(entries))
    return summary(output)["results"]


with Folder() as folder:
    force = results(folder, "column", write(os.path.join(folder, "column.prm"), COLUMN))["reaction_foot_y_N"]
    print(f"weight of the column: {force:.6f} N")
    check(abs(force - 2000) < 1e-6, f"the foot carries {force} N instead of 2000")

    # Supports sit on the specimen, whatever lies round it: E (l + l^2/2) (1 + l) A with l = .01 of St. Venant-Kirchhoff.
    exact = 1000 * (.01 + .01**2 / 2) * 1.01 * 16e-12
    for method, cells in (("MPM", "2, 2, 2"), ("MPM", "1, 1, 1"), ("FEM", "4, 4, 4")):
        for pad in (0, 1, 2):
            name = f"{method}-{cells[0]}-{pad}"
            image = os.path.join(folder, f"pad{pad}.nrrd")
            padded_image(image, pad)
            path = write(os.path.join(folder, name + ".prm"),
                         BLOCK.format(file=image, method=method, cells=cells,
                                      materials="1: gel" + (", 0: empty" if pad else "")))
            found = results(folder, name, path, ["Method=" + method.lower()])
            check(abs(found["reaction_top_z_N"] / exact - 1) < 1e-6, f"{name}: {found['reaction_top_z_N']} instead of {exact}")
            check(abs(found["strain_z"] - .01) < 1e-12, f"{name}: strain {found['strain_z']}")
    print(f"padded images: {exact:.5e} N by all")
