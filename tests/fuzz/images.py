"""Images of every format, mutated: headers, sample data, endings, cuts."""
import gzip
import os
import re
import struct

SIZE = (8, 6, 4)

SCENE = """set Dimension = 3
subsection Materials
  subsection a
    set Law = neo-Hookean
    set Young's modulus = 1000
    set Poisson's ratio = 0.3
  end
  subsection b
    set Law = neo-Hookean
    set Young's modulus = 3000
    set Poisson's ratio = 0.3
  end
end
subsection Bodies
  subsection block
    set Shape = image
    set File = %s
    %s
    set Materials = 0: a, 1: b
  end
end
subsection Supports
  subsection bottom
    set Where = side z-min
    set Type = clamp
  end
  subsection top
    set Where = side z-max
    set Displacement = 0; 0; 0.01*z*t
  end
end
subsection MPM
  set Cells = 4, 3, 2
end
"""


def voxels(kind="B"):
    n = SIZE[0] * SIZE[1] * SIZE[2]
    return struct.pack(f"<{n}{kind}", *((i // 5) % 2 for i in range(n)))


def nrrd():
    head = "NRRD0004\ntype: uint8\ndimension: 3\nspace dimension: 3\nsizes: 8 6 4\nspace directions: (1,0,0) (0,1,0) (0,0,1)\n" \
           'space units: "um" "um" "um"\nencoding: raw\nspace origin: (0,0,0)\n\n'
    return head.encode() + voxels()


def nrrd_text():
    head = "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 8 6 4\nspacings: 1 1 1\nencoding: ascii\n\n"
    return head.encode() + " ".join(str(v) for v in voxels()).encode() + b"\n"


def nrrd_gzip():
    return nrrd().replace(b"encoding: raw", b"encoding: gzip").split(b"\n\n")[0] + b"\n\n" + gzip.compress(voxels(), mtime=0)


def mha():
    head = "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\nDimSize = 8 6 4\n" \
           "DistanceUnits = mm\nElementSpacing = 0.001 0.001 0.001\nElementType = MET_USHORT\nElementDataFile = LOCAL\n"
    return head.encode() + voxels("H")


def nifti(kind="h", code=4, bits=16):
    header = bytearray(352)
    struct.pack_into("<i", header, 0, 348)
    struct.pack_into("<8h", header, 40, 3, *SIZE, 1, 1, 1, 1)
    struct.pack_into("<hh", header, 70, code, bits)
    struct.pack_into("<8f", header, 76, 1, 1, 1, 1, 0, 0, 0, 0)
    struct.pack_into("<f", header, 108, 352)
    header[123] = 3  # micrometres
    header[344:348] = b"n+1\0"
    return bytes(header) + voxels(kind)


def nifti_gzip():
    return gzip.compress(nifti(), mtime=0)


def tiff(kind="B", bits=8, sample_format=1):
    """A page a slice, uncompressed."""
    page = SIZE[0] * SIZE[1] * bits // 8
    data, pixels, offset = b"II*\0" + struct.pack("<I", 8), voxels(kind), 8
    for z in range(SIZE[2]):
        tags = [(256, 3, 1, SIZE[0]), (257, 3, 1, SIZE[1]), (258, 3, 1, bits), (259, 3, 1, 1), (262, 3, 1, 1),
                (273, 4, 1, offset + 2 + 12 * 10 + 4), (277, 3, 1, 1), (278, 3, 1, SIZE[1]), (279, 4, 1, page), (339, 3, 1, sample_format)]
        following = offset + 2 + 12 * len(tags) + 4 + page
        data += struct.pack("<H", len(tags)) + b"".join(struct.pack("<HHII", *t) for t in tags)
        data += struct.pack("<I", following if z + 1 < SIZE[2] else 0) + pixels[z * page:(z + 1) * page]
        offset = following
    return data


FILES = {"a.nrrd": nrrd(), "t.nrrd": nrrd_text(), "g.nrrd": nrrd_gzip(), "a.mha": mha(), "a.nii": nifti(), "a.nii.gz": nifti_gzip(),
         "a.tif": tiff(), "s.tif": tiff("H", 16), "i.tif": tiff("I", 32)}
NUMBERS = ["0", "-1", "4.5", "1e9", "4294967296", "nan", "inf", "1000000", "", "x", "1 2", "8 8 8 8 8"]


def header_number(random, data):
    """A number of a text header becomes another."""
    end = max(data.find(b"\n\n"), data.find(b"LOCAL"))
    found = list(re.finditer(rb"\d+", data[:end])) if end > 0 else []
    if not found:
        return flip(random, data)
    at = random.choice(found)
    return data[:at.start()] + random.choice(NUMBERS).encode() + data[at.end():]


def header_line(random, data):
    end = max(data.find(b"\n\n"), data.find(b"LOCAL"))
    if end < 0:
        return flip(random, data)
    lines = data[:end].split(b"\n")
    i = random.randrange(len(lines))
    if random.random() < 0.5:
        del lines[i]
    else:
        lines.insert(random.randrange(len(lines)), lines[i])
    return b"\n".join(lines) + data[end:]


def flip(random, data):
    """Bytes of the header change."""
    changed = bytearray(data)
    for _ in range(random.choice([1, 1, 2, 8])):
        changed[random.randrange(min(len(changed), 352))] = random.choice([0, 1, 255, 127, random.randrange(256)])
    return bytes(changed)


def cut(random, data):
    return data[:random.randrange(len(data))]


def cut_last(random, data):
    return data[:-random.choice([1, 2, 8])]


def added(random, data):
    return data + bytes(random.randrange(1, 64))


def nothing(random, data):
    return b""


CUTS = (cut, cut_last, nothing)
MUTATIONS = [header_number, header_number, header_line, flip, flip, flip, cut, cut_last, added, nothing]


class Images:
    """An image mutated, then named by a scene that is checked."""

    def case(self, random, sandbox):
        name = random.choice(sorted(FILES))
        mutation = random.choice(MUTATIONS)
        data = mutation(random, FILES[name])
        if random.random() < 0.05:
            name = random.choice(["A.TIF", "a.nrrd", "a.mha", "a.nii", "a.png", "a", "a.nii.gz"])
        sandbox.write(name, data)
        given = "set Voxel size = 1e-6, 1e-6, 1e-6" if name.lower().endswith(".tif") else ""
        sandbox.write("scene.prm", (SCENE % (name, given)).encode())
        whole = name in FILES and data == FILES[name]
        outcome = sandbox.run(["check", "scene.prm"])
        os.remove(os.path.join(sandbox.work, name))
        return mutation.__name__, outcome, lambda *_: self.judge(name, mutation, whole, outcome)

    @staticmethod
    def judge(name, mutation, whole, outcome):
        if whole and outcome.code != 0:
            return "a whole image is refused"
        if mutation in CUTS and outcome.code == 0 and not whole and name in FILES and not (name == "t.nrrd" and mutation is cut_last):
            return f"{name} that ends early is read"
        return None
