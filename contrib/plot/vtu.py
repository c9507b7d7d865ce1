"""Reads Stroma's and deal.II's PVD, PVTU and VTU files with numpy alone.

A file of points or cells becomes a Mesh; the pieces of a PVTU file are joined.
Source of the format: "VTK XML formats", https://docs.vtk.org.
"""
import base64
import os
import re
import xml.etree.ElementTree as ElementTree
import zlib
from dataclasses import dataclass, field

import numpy

TYPES = {"Float32": "f4", "Float64": "f8", "Int8": "i1", "UInt8": "u1", "Int32": "i4", "UInt32": "u4", "Int64": "i8",
         "UInt64": "u8"}


@dataclass
class Mesh:
    """points: (n, 3); cells: (n_cells, vertices of a cell) or None if all cells are single points;
    point_data, cell_data: name -> (n,) or (n, components); notes: name -> what the file says of itself, as strings."""
    points: numpy.ndarray
    cells: numpy.ndarray = None
    point_data: dict = field(default_factory=dict)
    cell_data: dict = field(default_factory=dict)
    notes: dict = field(default_factory=dict)


class Blocks:
    """The arrays of one VTU file: zlib-compressed in blocks, inline as base64 or appended raw, or plain text."""

    def __init__(self, root, appended):
        self.byte_order = "<" if root.get("byte_order", "LittleEndian") == "LittleEndian" else ">"
        self.word = numpy.dtype(TYPES[root.get("header_type", "UInt32")]).newbyteorder(self.byte_order)
        self.appended = appended

    def header(self, data):
        """[number of blocks, size of a block, size of a last partial one, compressed sizes] at the start of data."""
        n_blocks = int(numpy.frombuffer(data, self.word, 1)[0])
        return numpy.frombuffer(data, self.word, 3 + n_blocks)

    def inflate(self, data, sizes):
        ends = numpy.cumsum(sizes, dtype=numpy.int64)
        return b"".join(zlib.decompress(data[int(end - size):int(end)]) for size, end in zip(sizes, ends))

    def inline(self, text):
        """The header and the blocks are two base64 texts, one right after the other."""
        def length(n_words):
            return -(-n_words * self.word.itemsize // 3) * 4
        n_blocks = int(numpy.frombuffer(base64.b64decode(text[:length(3)]), self.word, 1)[0])
        header = self.header(base64.b64decode(text[:length(3 + n_blocks)]))
        return self.inflate(base64.b64decode(text[length(3 + n_blocks):]), header[3:])

    def at_offset(self, offset):
        data = self.appended[offset:]
        header = self.header(data)
        return self.inflate(data[header.nbytes:], header[3:])

    def array(self, element):
        """The numbers of a DataArray: (n,) or (n, components)."""
        dtype = numpy.dtype(TYPES[element.get("type")]).newbyteorder(self.byte_order)
        text = (element.text or "").strip()
        if element.get("format") == "appended":
            values = numpy.frombuffer(self.at_offset(int(element.get("offset"))), dtype)
        elif element.get("format") == "binary":
            values = numpy.frombuffer(self.inline(text) if text else b"", dtype)
        else:
            values = numpy.array(text.split(), dtype)
        components = int(element.get("NumberOfComponents", 1))
        return values.reshape(-1, components) if components > 1 else values


def split_appended(content):
    """(XML without the appended data, the appended data): raw bytes are no XML."""
    start = content.find(b"<AppendedData")
    if start < 0:
        return content, memoryview(b"")
    if b'encoding="raw"' not in content[start:content.index(b">", start)]:
        raise ValueError("appended data must be raw")
    return content[:start] + b"</VTKFile>", memoryview(content)[content.index(b"_", start) + 1:]


def cells_of(arrays):
    """Connectivity as (n_cells, vertices of a cell), or None if every cell is one point."""
    connectivity, offsets = arrays["connectivity"], arrays["offsets"]
    if len(offsets) == 0 or len(connectivity) == len(offsets):
        return None
    if len(connectivity) != len(offsets) * int(offsets[0]):
        raise ValueError("cells of different kinds in one file")
    return connectivity.reshape(len(offsets), -1).astype(numpy.int64)


def notes_of(root):
    """Strings in a file's field data, each the codes of its characters with a 0 behind."""
    def strings(element):
        codes = bytes(int(code) for code in (element.text or "").split())
        return [text.decode() for text in codes.split(b"\0")[:-1]]
    return {e.get("Name"): strings(e) for e in root.iterfind("./UnstructuredGrid/FieldData/DataArray")
            if e.get("type") == "String"}


def read_vtu(path, wanted=None):
    """One VTU file. wanted: whether a name of data is (None: all are)."""
    with open(path, "rb") as file:
        xml, appended = split_appended(file.read())
    root = ElementTree.fromstring(xml)
    blocks = Blocks(root, appended)

    def arrays(tag, wanted=None):
        elements = root.iterfind(f"./UnstructuredGrid/Piece/{tag}/DataArray")
        return {e.get("Name"): blocks.array(e) for e in elements if wanted is None or wanted(e.get("Name"))}

    points = list(arrays("Points").values())
    if not points or points[0].size == 0:
        return Mesh(numpy.empty((0, 3)), notes=notes_of(root))
    return Mesh(points[0].reshape(-1, 3), cells_of(arrays("Cells", ("connectivity", "offsets").__contains__)),
                arrays("PointData", wanted), arrays("CellData", wanted), notes_of(root))


def join(meshes):
    """The pieces that hold any points, as one mesh."""
    pieces = [m for m in meshes if len(m.points) > 0]
    if not pieces:
        return Mesh(numpy.empty((0, 3)))
    starts = numpy.cumsum([0] + [len(m.points) for m in pieces])
    cells = None
    if all(m.cells is not None for m in pieces):
        cells = numpy.concatenate([m.cells + start for m, start in zip(pieces, starts)])
    return Mesh(numpy.concatenate([m.points for m in pieces]), cells,
                {n: numpy.concatenate([m.point_data[n] for m in pieces]) for n in pieces[0].point_data},
                {n: numpy.concatenate([m.cell_data[n] for m in pieces]) for n in pieces[0].cell_data}, pieces[0].notes)


def piece_paths(path):
    """The VTU files of a PVTU file; the file itself if it is a VTU file."""
    if not path.endswith(".pvtu"):
        return [path]
    pieces = ElementTree.parse(path).getroot().iterfind("./PUnstructuredGrid/Piece")
    return [os.path.join(os.path.dirname(path), piece.get("Source")) for piece in pieces]


def read(path, wanted=None):
    """A PVTU or VTU file as one Mesh. wanted: whether a name of data is (None: all are)."""
    return join([read_vtu(piece, wanted) for piece in piece_paths(path)])


def count_points(path):
    """Number of points in a PVTU or VTU file, without reading them."""
    total = 0
    for piece in piece_paths(path):
        with open(piece, encoding="latin-1") as file:
            total += int(re.search(r'NumberOfPoints="(\d+)"', file.read(4096)).group(1))
    return total


def read_pvd(path):
    """[(time, path of the file)] of a PVD file, in the order of time."""
    sets = ElementTree.parse(path).getroot().iterfind("./Collection/DataSet")
    folder = os.path.dirname(path)
    return sorted((float(s.get("timestep")), os.path.join(folder, s.get("file"))) for s in sets)
