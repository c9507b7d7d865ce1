"""`stroma image` says what an image holds: numbers that were put into it, thresholds, a segmentation that comes back from the file
that it writes, pieces without a support, the overlap with labels; and what it refuses, in one line."""
import csv
import json
import os
import struct

from program import Folder, check, settings
from server import run

SCENE = """set Dimension = 3
subsection Units
  set Length = um
end
subsection Materials
  subsection gel
    set Law             = linear elastic
    set Young's modulus = 1000
    set Poisson's ratio = 0
  end
  subsection vessel
    set Law             = linear elastic
    set Young's modulus = 2000
    set Poisson's ratio = 0
  end
end
subsection Bodies
  subsection block
    set Shape           = image
    set File            = phantom
    set Voxel size      = 1, 1, 2
    set Interpretation  = threshold
    set Lower threshold = Otsu
    set Upper threshold = Otsu
    set Materials       = 0: empty, 1: vessel
  end
end
subsection Supports
  subsection bottom
    set Where = side y-min
    set Type  = clamp
  end
end
subsection MPM
  set Cells = 16, 16, 8
end
"""
SIZE = (16, 16, 8)


def tiff(values, kind):
    """A little-endian TIFF stack of numbers of 8 bits or of floating-point ones: behind each slice its directory."""
    code, bits, form = {"uint8": ("B", 8, 1), "float": ("f", 32, 3)}[kind]
    n = SIZE[0] * SIZE[1]
    plane, directory = n * bits // 8, 2 + 10 * 12 + 4
    data = b"II*\0" + struct.pack("<I", 8 + plane)
    for z in range(SIZE[2]):
        tags = [(256, 3, 1, SIZE[0]), (257, 3, 1, SIZE[1]), (258, 3, 1, bits), (259, 3, 1, 1), (262, 3, 1, 1),
                (273, 4, 1, len(data)), (277, 3, 1, 1), (278, 3, 1, SIZE[1]), (279, 4, 1, plane), (339, 3, 1, form)]
        following = len(data) + plane + directory + plane if z < SIZE[2] - 1 else 0
        data += struct.pack(f"<{n}{code}", *values[z * n:(z + 1) * n]) + struct.pack("<H", len(tags))
        data += b"".join(struct.pack("<HHII", *t) for t in tags) + struct.pack("<I", following)
    return data


def voxels(of):
    return [of(x, y, z) for z in range(SIZE[2]) for y in range(SIZE[1]) for x in range(SIZE[0])]


def is_vessel(x, y, z):
    """A bar along y, and a loose block."""
    return 4 <= x < 8 and 2 <= z < 6 or 11 <= x < 14 and 6 <= y < 9 and 3 <= z < 6


def grey(x, y, z):
    return (200 if is_vessel(x, y, z) else 50) + (7 * x + 3 * y + 5 * z) % 11


def write(name, content):
    path = os.path.join(folder, name)
    with open(path, "wb") as file:
        file.write(content)
    return path


def report(name):
    with open(os.path.join(folder, name, "image.json")) as file:
        return json.load(file)


def image(arguments, name, expect=0):
    return run(["image", *arguments, "--output", os.path.join(folder, name)], expect=expect)


with Folder() as folder:
    scene = write("scene.prm", SCENE.encode())
    values = voxels(grey)
    scan = write("scan.tif", tiff(values, "uint8"))
    n, n_vessel = len(values), sum(voxels(is_vessel))

    done = image([scan], "refused", expect=1)
    check("--voxel X,Y,Z in um" in done.stderr and done.stderr.count("\n") == 1, f"no voxel size: {done.stderr}")
    done = image([scan, "--voxel", "1,1,2"], "plain")
    found = report("plain")
    check(found["voxels"] == list(SIZE) and found["voxel_m"] == [1e-6, 1e-6, 2e-6] and found["type"] == "8-bit unsigned", "size")
    check(found["lowest"] == min(values) and found["highest"] == max(values), "range")
    check(abs(found["mean"] - sum(values) / n) < 1e-9, "mean")
    check(dict(map(tuple, found["percentiles"]))[50] == sorted(values)[n // 2], "median")
    otsu = found["suggested_thresholds"]["Otsu"]
    check(61 == otsu["threshold"] and otsu["share_from_there_on"] == n_vessel / n, f"Otsu: {otsu}")
    check("16 x 16 x 8 voxels of 1 x 1 x 2 um, together 16 x 16 x 16 um" in done.stdout, done.stdout)
    with open(os.path.join(folder, "plain", "histogram.csv")) as file:
        counts = {float(row["from"]): int(row["voxels"]) for row in csv.DictReader(file)}
    check(all(counts[v] == values.count(v) for v in set(values)) and sum(counts.values()) == n, "histogram")
    check("holds an earlier report" in image([scan, "--voxel", "1,1,2"], "plain", expect=1).stderr, "earlier report")

    # Floating-point numbers: the same classes.
    done = image([write("float.tif", tiff([.01 * v for v in values], "float")), "--voxel", "1,1,2"], "float")
    otsu = report("float")["suggested_thresholds"]["Otsu"]
    check(otsu["share_from_there_on"] == n_vessel / n and .6 < otsu["threshold"] < 2, f"Otsu of floats: {otsu}")

    # Segmented: its parts, and the file is an image of the same segmentation.
    labels = write("labels.tif", tiff([255 * v for v in voxels(is_vessel)], "uint8"))
    written = os.path.join(folder, "segmentation.tif")
    done = image([scan, "--segment", scene, "--labels", labels, "--write", written], "segmented")
    found = report("segmented")["segmentation"]
    check(found["thresholds"] == [61, 61] and len(found["materials"]) == 1, f"segmentation: {found}")
    vessel = found["materials"][0]
    check(vessel["fraction"] == n_vessel / n and vessel["pieces"] == 2 and vessel["largest_piece_voxels"] == 256, f"{vessel}")
    check(abs(vessel["thickness_p50_m"] - 3.5e-6) < 1e-12, f"thickness: {vessel}")
    check(found["pieces"] == {"all": 2, "without_support": 1, "share_without_support": 27 / n_vessel}, f"pieces: {found}")
    check("2 pieces, 1 of them touch no support" in done.stdout, done.stdout)
    check(found["labels"]["overlap"][0]["dice"] == 1 and "255 taken as label 1" in done.stdout, f"overlap: {found}")
    image([written, "--voxel", "1,1,2"], "again")
    check(report("again")["mean"] * n == 2 * n_vessel, "the file holds the segmentation") # vessel is the second material

    # Where the scan is: a scan whose first voxel is not at zero, in mm, right to left.
    header = ("NRRD0004\ntype: uint8\ndimension: 3\nspace: right-anterior-superior\nsizes: 16 16 8\nspace directions: (.001,0,0) "
              '(0,.001,0) (0,0,.002)\nspace units: "mm" "mm" "mm"\nspace origin: (-.0173,.0045,.099)\nencoding: raw\n\n')
    placed = write("placed.nrrd", header.encode() + bytes(values))
    image([placed, "--segment", scene, *settings([f"Bodies/block/File={placed}", "Bodies/block/Voxel size="])], "placed")
    with open(os.path.join(folder, "placed", "segmentation.nrrd"), "rb") as file:
        lines = dict(line.split(": ", 1) for line in file.read().split(b"\n\n")[0].decode().splitlines()[1:] if ": " in line)
    origin = [float(x) for x in lines["space origin"].strip("()").split(",")]
    check(max(abs(a - b) for a, b in zip(origin, (-17.3, 4.5, 99.))) < 1e-9, f"origin of the segmentation: {lines}")
    check(lines["space"] == "right-anterior-superior", f"space of the segmentation: {lines}")
    done = image([placed, "--voxel", "1,1,1"], "other_size")
    check("voxel size as given, NOT as the image has it: 1 x 1 x 2 um" in done.stdout, done.stdout)

    # Other labels; cleaned: only the bar is left; and check says what a run would be told.
    off = write("off.tif", tiff([3 * v for v in voxels(lambda x, y, z: is_vessel(x - 1, y, z))], "uint8"))
    largest = settings(["Bodies/block/Largest piece only=true", "Bodies/block/Smoothing=median", "Bodies/block/Median radius=0, 0, 0"])
    image([scan, "--segment", scene, "--labels", off, "--label-materials", "0: empty, 3: vessel", *largest], "largest")
    found = report("largest")["segmentation"]
    both = sum(voxels(lambda x, y, z: 5 <= x < 8 and 2 <= z < 6))
    check(found["labels"]["overlap"][0]["dice"] == 2 * both / (256 + n_vessel), f"shifted labels: {found}")
    check(found["materials"][0]["pieces"] == 1 and found["pieces"]["without_support"] == 0, f"cleaned: {found}")
    for method in ("mpm", "fem"):
        same = settings([f"Bodies/block/File={scan}", f"Method={method}", "FEM/Cells=10, 16, 4"])
        done = run(["check", scene, *same])
        check("1 piece of material" in done.stderr and "touches no support" in done.stderr, f"check by {method}: {done.stderr}")
        done = run(["check", scene, *same, *largest])
        check("touches no support" not in done.stderr and "1 of 2 pieces left out (27 voxels)" in done.stdout, f"{done}")

    # What is refused, each in one line.
    for arguments, words in (([scan, "--segment", scene, "--labels", scan], "label 50, which 'Materials' does not name"),
                             ([scan, "--segment", scene, "--set", "Bodies/block/Lower threshold=250",
                               "--set", "Bodies/block/Upper threshold=250"], "the image's values are 50 to 210"),
                             ([scan, "--segment", scene, "--body", "other"], "--body other: choose by --body"),
                             ([scan, "--segment", scene, "--voxel", "1,1,1"], "excludes")):
        done = image(arguments, "bad", expect=1)
        check(words in done.stderr and done.stderr.count("\n") == 1, f"{arguments}: {done.stderr}")
        check(not os.path.exists(os.path.join(folder, "bad")), "nothing is left of what is refused")
