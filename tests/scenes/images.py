"""What an image's header says is what is computed, and said: the force of a block of 8 x 8 x 8 voxels of 2 um, stretched by
1 %, is E lambda (lambda^2 - 1) / 2 A = 2.598528e-9 N whatever its unit of length; a changed image under a resumed run is
noticed; the parameters that a run leaves can be run where they lie."""
import os
import struct

from program import Folder, block, check, settings, stretched, summary
from server import run

FORCE = 2.598528e-9

GEL = "set Law = linear elastic\n set Young's modulus = 1000\n set Poisson's ratio = 0"
IMAGE = "set Shape = image\n set File = block.nrrd\n set Materials = 1: gel, 2-9: gel, all others: empty"
SCENE = block(3, GEL, body=IMAGE, more=stretched("z", "free; free; 0.01*z*t") + """subsection Units
  set Length = um
end
subsection Time
  set Initial step = 0.5
  set Largest step = 0.5
end
subsection MPM
  set Cells = 2, 2, 2
end
""")


def nrrd(size, directions, unit, voxels):
    units = f'space units: "{unit}" "{unit}" "{unit}"\n' if unit else ""
    return (f"NRRD0004\ntype: uint8\ndimension: 3\nsizes: {size}\nspace dimension: 3\nspace directions: {directions}\n"
            f"{units}encoding: raw\n\n").encode() + voxels


def nifti(unit, spacing, voxels):
    header = bytearray(352)
    struct.pack_into("<i", header, 0, 348)
    struct.pack_into("<8h", header, 40, 3, 8, 8, 8, 1, 1, 1, 1)
    struct.pack_into("<hh", header, 70, 2, 8)
    struct.pack_into("<8f", header, 76, 1, spacing, spacing, spacing, 0, 0, 0, 0)
    struct.pack_into("<f", header, 108, 352)
    header[123] = unit
    header[344:348] = b"n+1\0"
    return bytes(header) + voxels


def diagonal(spacing):
    return f"({spacing},0,0) (0,{spacing},0) (0,0,{spacing})"


def write(name, content):
    with open(os.path.join(folder, name), "wb") as file:
        file.write(content)
    return os.path.join(folder, name)


def force(name, content, entries=(), extra=()):
    """Reaction at the top for an image."""
    output = os.path.join(folder, "output")
    path = write(name, content)
    run(["run", scene, "--overwrite", "--output", output] + settings([f"Bodies/block/File={path}", *entries]) + list(extra))
    return summary(output)["results"]


def check_close(value, right, what):
    check(abs(value - right) <= 1e-6 * abs(right), f"{what}: {value} instead of {right}")


with Folder() as folder:
    scene = write("scene.prm", SCENE.encode())
    ones = b"\1" * 512
    for name, content in (("none.nii", nifti(0, 2, ones)), ("um.nii", nifti(3, 2, ones)), ("mm.nii", nifti(2, .002, ones)),
                          ("um.nrrd", nrrd("8 8 8", diagonal(2), "um", ones)),
                          ("mm.NRRD", nrrd("8 8 8", diagonal(.002), "mm", ones)),
                          ("none.nrrd", nrrd("8 8 8", diagonal(2), "", ones))):
        results = force(name, content)
        check_close(results["reaction_top_z_N"], FORCE, name)
        check_close(results["image_block_extent_z_m"], 16e-6, name)
        check_close(results["image_block_voxel_x_m"], 2e-6, name)
        check(results["image_block_voxels_y"] == 8 and results["image_block_fraction_gel"] == 1, f"report of {name}")

    # A bar of 20 x 4 x 4 voxels whose first stored axis runs along z: section 8 x 8 um.
    bar = nrrd("20 4 4", "(0,0,2) (0,2,0) (2,0,0)", "um", b"\1" * 320)
    check_close(force("bar.nrrd", bar)["reaction_top_z_N"], FORCE / 4, "bar along z")
    check_close(force("bar.nrrd", bar, ["Bodies/block/Axes=stored"])["reaction_top_z_N"], FORCE * 40 * 8 / 256, "stored axes")

    # A run says what it understood, and so does check.
    path = write("two.nrrd", nrrd("8 8 8", diagonal(2), "um", b"\0" * 128 + b"\1" * 384))
    done = run(["check", scene] + settings([f"Bodies/block/File={path}", "Bodies/block/Voxels per point=2, 2, 4"]))
    for words in ("image of block (two.nrrd): 4 x 4 x 2 voxels of 4 x 4 x 8 um, together 16 x 16 x 16 um; unit from the image: um",
                  "volume: gel 50 %, empty 50 %", "before 2 x 2 x 4 voxels were merged into one: gel 75 %, empty 25 %"):
        check(words in done.stdout, f"'{words}' is not in: {done.stdout}")

    # Merging says what was decided by the order of labels: planes of gel at z = 1, 2, 5 of 8, blocks of two along z.
    path = write("ties.nrrd", nrrd("8 8 8", diagonal(2), "um", b"".join((b"\1" if z in (1, 2, 5) else b"\0") * 64 for z in range(8))))
    done = run(["check", scene] + settings([f"Bodies/block/File={path}", "Bodies/block/Voxels per point=1, 1, 2"]), expect=1)
    check("merging leaves no voxel of material 'gel', which had 192" in done.stderr, f"ties that remove all: {done.stderr}")
    turned = settings([f"Bodies/block/File={path}", "Bodies/block/Voxels per point=1, 1, 2",
                       "Bodies/block/Materials=0: empty, 1-9: gel"])
    path = write("ties.nrrd", nrrd("8 8 8", diagonal(2), "um", b"".join((b"\1" if z in (0, 1, 2, 5) else b"\0") * 64 for z in range(8))))
    done = run(["check", scene] + turned)
    check("of 256 merged voxels 128 were ties, given to the lowest label" in done.stdout, f"ties: {done.stdout}")

    # Parameters that a run leaves are run where they lie, by a path relative to the scene.
    output, again = os.path.join(folder, "a#b"), os.path.join(folder, "again")
    write("block.nrrd", nrrd("8 8 8", diagonal(2), "um", ones))
    run(["run", scene, "--output", output] + settings(["Output/Checkpoint every=1"]))
    run(["run", os.path.join(output, "parameters.prm"), "--output", again])
    check(summary(again)["results"]["reaction_top_z_N"] == summary(output)["results"]["reaction_top_z_N"], "run again")

    # A resumed run notices another image, wherever it lies, and another voxel size.
    moved = write("moved.nrrd", nrrd("8 8 8", diagonal(2), "um", ones))
    resumed = ["run", scene, "--output", output, "--resume"] + settings(["Output/Checkpoint every=1"])
    run(resumed + settings([f"Bodies/block/File={moved}"]))
    for changed in (nrrd("8 8 8", diagonal(2), "um", ones[:-1] + b"\0"), nrrd("8 8 8", diagonal(3), "um", ones)):
        write("block.nrrd", changed)
        done = run(resumed, expect=1)
        check("another scene: 'Bodies/block/voxels' was 8 x 8 x 8 (checksum" in done.stderr, f"changed image: {done.stderr}")
