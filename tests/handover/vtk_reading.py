"""VTK's XML files by two readers: one of our own, strict about the format, and VTK's where it is installed."""
import re
import xml.etree.ElementTree as ET

import numpy as np

TYPES = {"Float64": "<f8", "Int32": "<i4", "Int64": "<i8", "UInt8": "|u1"}


class Block:
    """Points, cells (corners, ends, kind) and data of a .vtp or .vtu; texts are lists, units by array name."""

    def __init__(self):
        self.points, self.corners, self.ends, self.kind = None, None, None, None
        self.data = {"point": {}, "cell": {}, "field": {}}
        self.units, self.texture = {}, None


def texts_of(raw, count):
    parts = bytes(raw).split(b"\0")
    assert parts[-1] == b"" and len(parts) == count + 1, "texts are not closed by zeros, one for each"
    return [part.decode("utf-8") for part in parts[:-1]]


def read_plainly(path):
    """Only what VTK's XML format says: a header, and appended raw arrays without gaps."""
    content = open(path, "rb").read()
    mark = b'<AppendedData encoding="raw">\n_'
    place = content.index(mark)
    appended = content[place + len(mark):]
    tail = b"\n</AppendedData>\n</VTKFile>\n"
    assert appended.endswith(tail)
    appended = appended[:-len(tail)]
    root = ET.fromstring(content[:place] + b"</VTKFile>")
    assert root.tag == "VTKFile" and root.get("header_type") == "UInt64" and root.get("byte_order") == "LittleEndian"
    grid = root[0]
    assert grid.tag == root.get("type")
    piece = grid.find("Piece")
    block = Block()
    used = []
    points, cells = int(piece.get("NumberOfPoints")), 0

    def values(element, rows=None):
        offset = int(element.get("offset"))
        size = int(np.frombuffer(appended, "<u8", 1, offset)[0])
        used.append((offset, offset + 8 + size))
        raw = appended[offset + 8:offset + 8 + size]
        assert len(raw) == size
        components = int(element.get("NumberOfComponents", 1))
        rows = int(element.get("NumberOfTuples", rows if rows is not None else -1))
        if element.get("type") == "String":
            return texts_of(raw, rows * components)
        array = np.frombuffer(raw, TYPES[element.get("type")])
        if rows >= 0:
            assert len(array) == rows * components, element.get("Name")
        return array.reshape(-1, components) if components > 1 else array

    block.points = values(piece.find("Points/DataArray"), points)
    for kind in ("Verts", "Lines", "Polys", "Cells"):
        element = piece.find(kind)
        if element is None:
            continue
        arrays = {array.get("Name"): values(array) for array in element}
        block.kind, block.corners, block.ends = kind, arrays["connectivity"], arrays["offsets"]
        cells = len(block.ends)
        assert int(piece.get("NumberOfCells" if kind == "Cells" else f"NumberOf{kind}")) == cells
        if kind == "Cells":
            assert len(arrays["types"]) == cells
    assert (block.ends[-1] if cells else 0) == len(block.corners)
    sections = (("point", piece.find("PointData"), points), ("cell", piece.find("CellData"), cells),
                ("field", grid.find("FieldData"), None))
    for where, element, rows in sections:
        for array in element:
            block.data[where][array.get("Name")] = values(array, rows)
            unit = array.find("InformationKey")
            if unit is not None:
                assert unit.get("name") == "UNITS_LABEL" and unit.get("location") == "vtkDataArray"
                block.units[array.get("Name")] = unit.text
    block.texture = piece.find("PointData").get("TCoords")
    used.sort()
    assert used[0][0] == 0 and used[-1][1] == len(appended)
    assert all(a[1] == b[0] for a, b in zip(used, used[1:])), "arrays overlap or leave gaps"
    return block


def read_with_vtk(path):
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkCommonCore import vtkDataArray
    from vtkmodules.vtkIOXML import vtkXMLPolyDataReader, vtkXMLUnstructuredGridReader

    reader = vtkXMLPolyDataReader() if str(path).endswith(".vtp") else vtkXMLUnstructuredGridReader()
    reader.SetFileName(str(path))
    problems = []
    reader.AddObserver("ErrorEvent", lambda *_: problems.append("error"))
    reader.AddObserver("WarningEvent", lambda *_: problems.append("warning"))
    reader.Update()
    assert not problems, path
    output = reader.GetOutput()
    block = Block()
    block.points = vtk_to_numpy(output.GetPoints().GetData())
    if str(path).endswith(".vtp"):
        counts = {"Verts": output.GetVerts(), "Lines": output.GetLines(), "Polys": output.GetPolys()}
        block.kind, cells = next((k, c) for k, c in counts.items() if c.GetNumberOfCells() == output.GetNumberOfCells())
    else:
        block.kind, cells = "Cells", output.GetCells()
    block.corners = vtk_to_numpy(cells.GetConnectivityArray())
    block.ends = vtk_to_numpy(cells.GetOffsetsArray())[1:]
    for where, data in (("point", output.GetPointData()), ("cell", output.GetCellData()),
                        ("field", output.GetFieldData())):
        for i in range(data.GetNumberOfArrays()):
            array = data.GetAbstractArray(i)
            if array.GetClassName() == "vtkStringArray":
                block.data[where][array.GetName()] = [array.GetValue(k) for k in range(array.GetNumberOfValues())]
                continue
            block.data[where][array.GetName()] = vtk_to_numpy(array)
            information = array.GetInformation()
            if information.Has(vtkDataArray.UNITS_LABEL()):
                block.units[array.GetName()] = information.Get(vtkDataArray.UNITS_LABEL())
    texture = output.GetPointData().GetTCoords()
    block.texture = texture.GetName() if texture is not None else None
    return block


def has_vtk():
    try:
        import vtkmodules.vtkIOXML  # noqa: F401
    except ImportError:
        return False
    return True


def leaves(path):
    """Names, as paths of branches, and files of a .vtm."""
    root = ET.parse(path).getroot()
    assert root.get("type") == "vtkMultiBlockDataSet"

    def walk(element, prefix):
        for child in element:
            name = prefix + child.get("name")
            if child.tag == "Block":
                yield from walk(child, name + "/")
            else:
                assert re.match(r"[^/]", child.get("file"))
                yield name, child.get("file")
    return dict(walk(root[0], ""))
