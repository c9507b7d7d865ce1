#!/usr/bin/python3
"""Writes a study of cells of averaged stiffness: linear elements, each with the mean moduli of the voxels in it, in steps of a per cent.

    averaged_cells.py SCENE.prm IMAGE.nrrd FOLDER --voxels 16,16,4 8,8,4 [--voxel-size 1.05,1.05,1]
                      [--crop-first 144,400,0 --crop-size 96,96,52]

SCENE.prm has the body 'construct' of 'collagen' and 'vessel', and Constants/cells, mu_c, ratio, nu, as those of parameters/guilkey2006.
FOLDER/averaged.prm is the study for `stroma study`: a case a size of the cells, each of as many voxels as --voxels says. Needs numpy.
"""
import argparse
import os
import sys

import numpy

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "plot"))
import nrrd

STEPS = 100
RESULTS = ("reaction_force_y_N", "von_mises_p50_Pa", "von_mises_p99_Pa", "von_mises_p999_Pa")


def triple(text):
    return tuple(int(word) for word in text.split(","))


def means(voxels, block):
    """Per cent of vessel in each block of (x, y, z) voxels of an array (z, y, x)."""
    z, y, x = (n // b for n, b in zip(voxels.shape, block[::-1]))
    if (z * block[2], y * block[1], x * block[0]) != voxels.shape:
        sys.exit(f"blocks of {block} voxels do not fill {voxels.shape[::-1]}")
    blocks = voxels.reshape(z, block[2], y, block[1], x, block[0])
    return numpy.rint(STEPS * blocks.mean(axis=(1, 3, 5))).astype("u1")


def write_image(path, labels, spacing):
    """An image of labels (z, y, x); spacing along x, y, z [um]."""
    axes = " ".join(f"({', '.join(f'{s:.9g}' if i == k else '0' for k in range(3))})" for i, s in enumerate(spacing))
    header = ("NRRD0004", "type: uint8", "dimension: 3", "space dimension: 3", "sizes: " + " ".join(map(str, labels.shape[::-1])),
              f"space directions: {axes}", 'space units: "um" "um" "um"', "space origin: (0, 0, 0)", "encoding: raw", "", "")
    with open(path, "wb") as file:
        file.write("\n".join(header).encode() + labels.tobytes())


def material(label):
    return {0: "collagen", STEPS: "vessel"}.get(label, f"mixture {label}")


def scene(base, images, shares):
    """The study's text. images: [(cells along x, voxel of the image [um], its path, its labels)]; shares: labels of all."""
    mixtures = [s for s in shares if s not in (0, STEPS)]
    materials = "".join(f"  subsection {material(s)}\n    set Law             = neo-Hookean\n"
                        f"    set Shear modulus   = mu_c*(1 + {s / STEPS:g}*(ratio - 1))\n    set Poisson's ratio = nu\n  end\n" for s in mixtures)
    cases = "".join(f"    subsection averaged cells {cells}\n      set Set = Constants/cells = {cells}, Bodies/construct/Voxel size = "
                    f"{', '.join(f'{s:.9g}' for s in spacing)}, Bodies/construct/File = {path}, Bodies/construct/Materials = "
                    f"{', '.join(f'{s}: {material(s)}' for s in found)}\n    end\n" for cells, spacing, path, found in images)
    return (f"include {os.path.abspath(base)}\n\nset Method = fem\n\nsubsection Materials\n{materials}end\n\n"
            f"subsection FEM\n  set Material at = cell\nend\n\nsubsection Output\n  set Point fields = none\n  set Grid fields  = false\nend\n\n"
            f"subsection Study\n  set Results = {', '.join(RESULTS)}\n  subsection Cases\n{cases}  end\nend\n")


def main():
    parser = argparse.ArgumentParser(description="Writes a study of cells of averaged stiffness.")
    parser.add_argument("scene")
    parser.add_argument("image", help="labels; what is not 0 is vessel")
    parser.add_argument("folder")
    parser.add_argument("--voxels", nargs="+", type=triple, required=True, help="of a cell along x,y,z, from coarse to fine")
    parser.add_argument("--voxel-size", type=lambda text: [float(word) for word in text.split(",")], help="[um]; default: the header's")
    parser.add_argument("--crop-first", type=triple, default=(0, 0, 0))
    parser.add_argument("--crop-size", type=triple)
    arguments = parser.parse_args()
    image = nrrd.read(arguments.image)
    first = arguments.crop_first[::-1]
    size = arguments.crop_size[::-1] if arguments.crop_size else tuple(n - f for n, f in zip(image.voxels.shape, first))
    voxels = image.voxels[tuple(slice(f, f + n) for f, n in zip(first, size))] > 0
    spacing = arguments.voxel_size or image.spacing
    os.makedirs(arguments.folder, exist_ok=True)
    images, shares = [], set()
    for block in arguments.voxels:
        labels = means(voxels, block)
        path = os.path.join(os.path.abspath(arguments.folder), f"averaged_{labels.shape[2]}.nrrd")
        voxel = [s * b for s, b in zip(spacing, block)]
        write_image(path, labels, voxel)
        found = numpy.unique(labels).tolist()
        images.append((labels.shape[2], voxel, path, found))
        shares.update(found)
    with open(os.path.join(arguments.folder, "averaged.prm"), "w", encoding="utf-8") as file:
        file.write(scene(arguments.scene, images, sorted(shares)))


if __name__ == "__main__":
    main()
