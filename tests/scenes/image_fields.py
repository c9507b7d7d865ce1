"""Fields on the voxels of a scan, read back: each value in the place of its voxel, in the frame of the scan's header."""
import array
import math
import os
import re
import struct

from program import Folder, check
from server import run

SIZE = (7, 5, 4)
SPACING = (1.5, 2., 1.)  # um
ORIGIN = (10., 3., -2.)  # of the first stored voxel, which is the last one along y


def labels():
    """Labels by (x, y, z), 0 where there is nothing; without any symmetry."""
    return {(x, y, z): 0 if (x + 2 * y + 5 * z) % 11 == 7 else 1 + (x * x + 3 * y + 7 * z * x) % 2
            for x in range(SIZE[0]) for y in range(SIZE[1]) for z in range(SIZE[2])}


def write_scan(path, label, reversed_y):
    header = f"""NRRD0004
type: uint8
dimension: 3
space: left-posterior-superior
sizes: {SIZE[0]} {SIZE[1]} {SIZE[2]}
space directions: ({SPACING[0]},0,0) (0,{-SPACING[1] if reversed_y else SPACING[1]},0) (0,0,{SPACING[2]})
space units: "um" "um" "um"
kinds: domain domain domain
space origin: ({ORIGIN[0]},{ORIGIN[1]},{ORIGIN[2]})
endian: little
encoding: raw

"""
    with open(path, "wb") as file:
        file.write(header.encode())
        for z in range(SIZE[2]):
            for y in range(SIZE[1]):
                for x in range(SIZE[0]):
                    file.write(bytes([label[x, SIZE[1] - 1 - y if reversed_y else y, z]]))


def numbers(data, size):
    """{(x, y, z): value}"""
    values = array.array("f")
    values.frombytes(data[:4 * size[0] * size[1] * size[2]])
    places = [(x, y, z) for z in range(size[2]) for y in range(size[1]) for x in range(size[0])]
    check(len(values) == len(places), f"{len(values)} values instead of {len(places)}")
    return dict(zip(places, values))


def read_nrrd(path):
    with open(path, "rb") as file:
        content = file.read()
    end = content.index(b"\n\n")
    fields = dict(line.split(": ", 1) for line in content[:end].decode().splitlines() if ": " in line)
    return fields, numbers(content[end + 2:], [int(n) for n in fields["sizes"].split()])


def read_vti(path):
    with open(path, "rb") as file:
        content = file.read()
    start = content.index(b'encoding="raw">\n_') + len(b'encoding="raw">\n_')
    header = content[:start].decode()
    extent = [int(n) for n in re.search('WholeExtent="([^"]*)"', header)[1].split()]
    size = extent[1::2]
    arrays = {}
    for name, offset in re.findall('Name="([^"]*)" format="appended" offset="([0-9]*)"', header):
        first = start + int(offset)
        check(struct.unpack("<Q", content[first:first + 8])[0] == 4 * size[0] * size[1] * size[2], "size of an array")
        arrays[name] = numbers(content[first + 8:], size)
    return header, arrays


def read_tiff(path):
    """Pages of a little-endian TIFF of one strip a page."""
    with open(path, "rb") as file:
        content = file.read()
    check(content[:4] == b"II*\0", "a TIFF in little-endian order")
    place, pages, description = struct.unpack("<I", content[4:8])[0], [], ""
    while place:
        n = struct.unpack("<H", content[place:place + 2])[0]
        tags = {}
        for i in range(n):
            tag, kind, count, value = struct.unpack("<HHII", content[place + 2 + 12 * i:place + 14 + 12 * i])
            tags[tag] = (kind, count, value & 0xffff if kind == 3 else value)
        if 270 in tags:
            description = content[tags[270][2]:tags[270][2] + tags[270][1] - 1].decode()
        check(tags[258][2] == 32 and tags[339][2] == 3, "numbers of 32 bits, floating")
        pages.append(content[tags[273][2]:tags[273][2] + tags[279][2]])
        place = struct.unpack("<I", content[place + 2 + 12 * n:place + 6 + 12 * n])[0]
    return description, numbers(b"".join(pages), (tags[256][2], tags[257][2], len(pages)))


def supports():
    """Each side slides on its plane, and the upper ones move."""
    motions = {"x-min": "0; free; free", "x-max": "0.1*x*t; free; free", "y-min": "free; 0; free", "y-max": "free; 0.02*y*t; free",
               "z-min": "free; free; 0", "z-max": "free; free; -0.03*z*t"}
    return "subsection Supports\n" + "".join(
        f"  subsection {side}\n    set Where        = side {side}\n    set Displacement = {motion}\n  end\n"
        for side, motion in motions.items()) + "end\n"


def scene(scan, fields):
    return f"""set Dimension = 3
subsection Units
  set Length = um
end
subsection Materials
  subsection soft
    set Law           = neo-Hookean
    set Shear modulus = 500
    set Bulk modulus  = 1000
  end
  subsection other
    set Law           = neo-Hookean
    set Shear modulus = 500
    set Bulk modulus  = 1000
  end
end
subsection Bodies
  subsection scan
    set Shape     = image
    set File      = {scan}
    set Materials = 0: empty, 1: soft, 2: other
  end
end
{supports()}subsection MPM
  set Cells       = 3, 4, 2
  set Integration = two moments
end
subsection Newton
  set Displacement tolerance = 1e-10
  set Energy tolerance       = 1e-20
end
subsection Output
  set Image fields = {fields}
end
"""


def is_place(name, values, label, value):
    """Each voxel with material has the value of its place, the others none."""
    for voxel, found in values.items():
        if label[voxel] == 0:
            check(math.isnan(found), f"{name}: {found} in the empty voxel {voxel}")
        else:
            wanted = value(voxel)
            check(abs(found - wanted) <= 2e-6 * abs(wanted) + 1e-12, f"{name}: {found} in {voxel} instead of {wanted}")


with Folder() as folder:
    scan, prm, output = (os.path.join(folder, name) for name in ("scan.nrrd", "scene.prm", "out"))

    def solve(label, fields, entries=(), ranks=1, reversed_y=True):
        write_scan(scan, label, reversed_y)
        with open(prm, "w") as file:
            file.write(scene(scan, fields))
        run(["run", prm, "--output", output, "--overwrite"] + [w for e in entries for w in ("--set", e)], ranks)
        return lambda name: os.path.join(output, name)

    full = {voxel: max(1, value) for voxel, value in labels().items()}
    stretch = (.1, .02, -.03)
    images = {}
    for ranks in 1, 3:
        path = solve(full, "displacement, J, von_mises, material", ranks=ranks)
        check(not [name for name in os.listdir(output) if name.endswith("vtu")], "other fields only where they are asked for")
        for d, axis in enumerate("xyz"):
            fields, values = read_nrrd(path(f"voxels_displacement_{axis}_m_0000.nrrd"))
            is_place(f"displacement along {axis}", values, full,
                     lambda voxel: stretch[d] * 1e-6 * SPACING[d] * (voxel[d] + .5))
        is_place("J", read_nrrd(path("voxels_J_0000.nrrd"))[1], full, lambda voxel: 1.1 * 1.02 * .97)
        images[ranks] = read_nrrd(path("voxels_von_mises_Pa_0000.nrrd"))[1]
        is_place("material", read_nrrd(path("voxels_material_0000.nrrd"))[1], full, lambda voxel: full[voxel] - 1)
    is_place("von Mises on 3 ranks", images[3], full, lambda voxel: images[1][voxel])
    check(fields["space"] == "left-posterior-superior" and fields["space units"] == '"um" "um" "um"', f"frame: {fields}")
    check(fields["space directions"] == "(1.5,0,0) (0,2,0) (0,0,1)", fields["space directions"])
    check(fields["space origin"] == "(10,-5,-2)", fields["space origin"])  # the stored y runs backwards
    print("NRRD in the frame of the scan: displacement, J and material of each voxel, on 1 and 3 ranks")

    holes = labels()
    path = solve(holes, "material, displacement", ["Output/Image format=vti", "Output/Grid fields=true"], 2)
    header, arrays = read_vti(path("voxels_0000.vti"))
    check(sorted(arrays) == ["displacement_x_m", "displacement_y_m", "displacement_z_m", "material"], str(sorted(arrays)))
    is_place("material, VTI", arrays["material"], holes, lambda voxel: holes[voxel] - 1)
    check('Origin="9.25 -6 -2.5" Spacing="1.5 2 1"' in header, header)
    check(os.path.exists(path("grid_0000.pvtu")), "grid fields that are asked for")

    path = solve(holes, "material", ["Output/Image format=tiff"])
    description, values = read_tiff(path("voxels_material_0000.tif"))
    is_place("material, TIFF", values, holes, lambda voxel: holes[voxel] - 1)
    check(description == "ImageJ=1.53\nimages=4\nslices=4\nunit=um\nspacing=1\n", description)
    print("VTI and TIFF of a body with holes, read back")

    # Cropped: voxel 2, 1, 1 of the scan is the first; two material points a voxel and kept points give the same.
    entries = ["MPM/Integration=all points", "MPM/Points per voxel=2, 1, 1", "Bodies/scan/Crop first=2, 1, 1",
               "Bodies/scan/Crop size=4, 3, 2"]
    path = solve(holes, "material", entries, reversed_y=False)
    fields, values = read_nrrd(path("voxels_material_0000.nrrd"))
    check(fields["space origin"] == "(13,5,-1)", fields["space origin"])
    is_place("material, cropped", values, {v: holes[v[0] + 2, v[1] + 1, v[2] + 1] for v in values},
             lambda voxel: holes[voxel[0] + 2, voxel[1] + 1, voxel[2] + 1] - 1)
    print("cropped, of kept points")
