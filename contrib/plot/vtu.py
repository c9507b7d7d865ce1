"""Reads the PVD, PVTU and VTU files that deal.II writes (zlib-compressed or ascii), with numpy alone.

A file of points or cells becomes a Mesh; the pieces of a PVTU file are joined.
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
    point_data, cell_data: name -> (n,) or (n, components)."""
    points: numpy.ndarray
    cells: numpy.ndarray = None
    point_data: dict = field(default_factory=dict)
    cell_data: dict = field(default_factory=dict)


def decode(text, dtype, header_dtype="u4"):
    """Numbers of a compressed inline array: base64 of the header [n, size, last size, c1..cn], then of n blocks."""
    text = text.strip()
    word = numpy.dtype(header_dtype).itemsize
    n_blocks = int(numpy.frombuffer(base64.b64decode(text[:-(-word // 3) * 4]), header_dtype, 1)[0])
    header_length = -(-(3 + n_blocks) * word // 3) * 4
    header = numpy.frombuffer(base64.b64decode(text[:header_length]), header_dtype)
    blocks = base64.b64decode(text[header_length:])
    ends = numpy.cumsum(header[3:3 + n_blocks], dtype=numpy.int64)
    starts = ends - header[3:3 + n_blocks]
    return numpy.frombuffer(b"".join(zlib.decompress(blocks[a:b]) for a, b in zip(starts, ends)), dtype)


def data_array(element, byte_order, header_dtype):
    dtype = numpy.dtype(TYPES[element.get("type")]).newbyteorder(byte_order)
    text = element.text or ""
    if not text.strip():
        values = numpy.empty(0, dtype)
    elif element.get("format") == "ascii":
        values = numpy.array(text.split(), dtype)
    elif element.get("format") == "binary":
        values = decode(text, dtype, header_dtype)
    else:
        raise ValueError(f"data format {element.get('format')} is not one that deal.II writes")
    components = int(element.get("NumberOfComponents", 1))
    return values.reshape(-1, components) if components > 1 else values


def cells_of(arrays):
    """Connectivity as (n_cells, vertices of a cell), or None if every cell is one point."""
    connectivity, offsets = arrays["connectivity"], arrays["offsets"]
    if len(offsets) == 0 or len(connectivity) == len(offsets):
        return None
    if len(connectivity) != len(offsets) * int(offsets[0]):
        raise ValueError("cells of different kinds in one file")
    return connectivity.reshape(len(offsets), -1).astype(numpy.int64)


def read_vtu(path, names=None):
    """One VTU file. names: the data wanted (None: all)."""
    root = ElementTree.parse(path).getroot()
    byte_order = "<" if root.get("byte_order", "LittleEndian") == "LittleEndian" else ">"
    header_dtype = numpy.dtype(TYPES[root.get("header_type", "UInt32")]).newbyteorder(byte_order)
    if root.get("compressor", "vtkZLibDataCompressor") != "vtkZLibDataCompressor":
        raise ValueError(f"{path}: compressor {root.get('compressor')} is not one that deal.II writes")

    def arrays(tag, wanted):
        elements = root.iterfind(f"./UnstructuredGrid/Piece/{tag}/DataArray")
        return {e.get("Name"): data_array(e, byte_order, header_dtype) for e in elements
                if wanted is None or e.get("Name") in wanted}

    points = list(arrays("Points", None).values())
    if not points or points[0].size == 0:
        return Mesh(numpy.empty((0, 3)))
    return Mesh(points[0].reshape(-1, 3), cells_of(arrays("Cells", ("connectivity", "offsets"))),
                arrays("PointData", names), arrays("CellData", names))


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
                {n: numpy.concatenate([m.cell_data[n] for m in pieces]) for n in pieces[0].cell_data})


def piece_paths(path):
    """The VTU files of a PVTU file; the file itself if it is a VTU file."""
    if not path.endswith(".pvtu"):
        return [path]
    pieces = ElementTree.parse(path).getroot().iterfind("./PUnstructuredGrid/Piece")
    return [os.path.join(os.path.dirname(path), piece.get("Source")) for piece in pieces]


def read(path, names=None):
    """A PVTU or VTU file as one Mesh. names: the data wanted (None: all)."""
    return join([read_vtu(piece, names) for piece in piece_paths(path)])


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
