"""Images of NRRD files with the axes x, y, z: voxels and their frame."""
import gzip
from dataclasses import dataclass

import numpy

from results import MissingResult

TYPES = {"uint8": "u1", "unsigned char": "u1", "uint16": "u2", "unsigned short": "u2", "int16": "i2", "short": "i2",
         "float": "f4", "double": "f8"}


@dataclass
class Image:
    """voxels: (z, y, x); spacing and origin, the centre of the first voxel: along x, y, z in the file's unit."""
    voxels: numpy.ndarray
    spacing: numpy.ndarray
    origin: numpy.ndarray
    unit: str

    def edges(self, axis):
        """Lower and upper end of the image along an axis."""
        ends = self.origin[axis] + self.spacing[axis] * (numpy.array([0, self.voxels.shape[2 - axis]]) - .5)
        return min(ends), max(ends)


def numbers(text):
    return [float(word) for word in text.replace("(", " ").replace(")", " ").replace(",", " ").split()]


def read(path):
    """The image of a file; voxels that are stored backwards along an axis are turned round."""
    with open(path, "rb") as file:
        content = file.read()
    end = content.find(b"\n\n")
    if not content.startswith(b"NRRD") or end < 0:
        raise MissingResult(f"{path} is no NRRD file with its voxels behind the header")
    fields = dict(line.split(": ", 1) for line in content[:end].decode().splitlines() if ": " in line and line[0] != "#")
    size = [int(word) for word in fields["sizes"].split()]
    directions = numpy.array(numbers(fields["space directions"])).reshape(3, 3)
    if fields["encoding"] not in ("raw", "gzip", "gz") or fields["type"] not in TYPES or len(size) != 3 or \
            numpy.count_nonzero(directions - numpy.diag(numpy.diag(directions))):
        raise MissingResult(f"{path}: only volumes along x, y, z of the types {', '.join(TYPES)}, raw or by gzip, are drawn")
    data = content[end + 2:] if fields["encoding"] == "raw" else gzip.decompress(content[end + 2:])
    order = ">" if fields.get("endian") == "big" else "<"
    voxels = numpy.frombuffer(data, order + TYPES[fields["type"]], size[0] * size[1] * size[2]).reshape(size[::-1])
    spacing, origin = numpy.diag(directions).copy(), numpy.array(numbers(fields["space origin"]))
    for axis in range(3):
        if spacing[axis] < 0:
            voxels = numpy.flip(voxels, 2 - axis)
            origin[axis] += spacing[axis] * (size[axis] - 1)
            spacing[axis] *= -1
    return Image(voxels, spacing, origin, fields.get("space units", "").split('"')[1] if '"' in fields.get("space units", "") else "")
