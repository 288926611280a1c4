"""Wavefront OBJ: the same as `ricci layout --uv` writes, with material and image; read by VTK and Blender too."""
import numpy as np
import pytest
import vtk_reading
from conftest import export, run
from test_scripts import blender
from test_vtk import item_of


def read_obj(path):
    """Points, texture coordinates, faces as pairs of numbers, lines; other words by first word."""
    points, uv, faces, lines, words = [], [], [], [], {}
    for line in path.read_text().splitlines():
        first, *rest = line.split()
        if first == "v":
            points.append([float(x) for x in rest])
        elif first == "vt":
            uv.append([float(x) for x in rest])
        elif first == "f":
            faces.append([tuple(int(n) - 1 for n in corner.split("/")) for corner in rest])
        elif first == "l":
            lines.append([int(n) - 1 for n in rest])
        else:
            words.setdefault(first, []).append(" ".join(rest))
    return np.array(points), np.array(uv), faces, lines, words


def test_layout_with_checkerboard(results, tmp_path):
    _, h, _ = item_of(results.layout("eight"))
    points, uv, faces, _, words = read_obj(export(results.layout("eight"), tmp_path / "eight.obj"))
    assert points.tobytes() == h["layout/refinement/points"].tobytes()
    assert uv.tobytes() == ((h["layout/conformal"] + 1) / 2).tobytes()
    corners = np.array([corner for face in faces for corner in face])
    assert (corners[:, 0] == h["layout/refinement/vertex"]).all() and (corners[:, 1] == h["layout/corner_vertex"]).all()
    assert words["mtllib"] == ["eight.mtl"] and words["usemtl"] == ["checkerboard"]
    assert "map_Kd eight.png" in (tmp_path / "eight.mtl").read_text()
    assert (tmp_path / "eight.png").read_bytes().startswith(b"\x89PNG")


def test_the_same_as_layout_writes(results, tmp_path):
    folder = tmp_path / "direct"
    folder.mkdir()
    run("layout", results.mesh("torus", 200), "--uv", folder / "torus.obj", "--checker", "8", "-q")
    export(results.layout("torus"), tmp_path / "torus.obj", "--checker", "8")
    for suffix in ("obj", "mtl", "png"):
        assert (tmp_path / f"torus.{suffix}").read_bytes() == (folder / f"torus.{suffix}").read_bytes()
    export(results.layout("torus"), tmp_path / "plain.obj", "--checker", "0")
    assert not (tmp_path / "plain.mtl").exists() and "mtllib" not in (tmp_path / "plain.obj").read_text()


def test_other_blocks(results, tmp_path):
    _, h, _ = item_of(results.layout("eight"))
    points, uv, faces, _, _ = read_obj(export(results.layout("eight"), tmp_path / "surface.obj", "--what", "surface"))
    assert points.tobytes() == h["mesh/points"].tobytes() and not len(uv)
    assert (np.array(faces)[:, :, 0] == h["mesh/triangles"]).all()
    points, uv, _, _, _ = read_obj(export(results.layout("eight"), tmp_path / "layout.obj", "--what", "layout"))
    assert np.ascontiguousarray(points[:, :2]).tobytes() == h["layout/conformal"].tobytes()
    _, _, _, lines, words = read_obj(export(results.layout("eight"), tmp_path / "g.obj", "--what", "generators"))
    assert words["o"] == [name.decode() for name in h["layout/generators/name"]] and len(lines) == 4


@pytest.mark.skipif(not vtk_reading.has_vtk(), reason="VTK's Python module is not installed")
def test_vtk_reads_it(results, tmp_path):
    from vtkmodules.vtkIOGeometry import vtkOBJReader
    _, h, _ = item_of(results.layout("torus"))
    reader = vtkOBJReader()
    reader.SetFileName(str(export(results.layout("torus"), tmp_path / "torus.obj")))
    reader.Update()
    surface = reader.GetOutput()
    assert surface.GetNumberOfPolys() == len(h["layout/refinement/input_face"])
    assert surface.GetPointData().GetTCoords().GetNumberOfTuples() == surface.GetNumberOfPoints()


OBJ_IMPORT = """
import bpy, sys
bpy.ops.wm.read_factory_settings(use_empty=True)
if hasattr(bpy.ops.wm, "obj_import"):
    bpy.ops.wm.obj_import(filepath=sys.argv[-1])
else:
    bpy.ops.import_scene.obj(filepath=sys.argv[-1])
"""


def test_blender_reads_it(results, tmp_path):
    _, h, _ = item_of(results.layout("torus"))
    path = export(results.layout("torus"), tmp_path / "torus.obj")
    (tmp_path / "import.py").write_text(OBJ_IMPORT)
    report = blender(tmp_path / "import.py", tmp_path / "report.json", path, cwd=tmp_path)
    surface = next(iter(report["objects"].values()))
    assert surface["vertices"] == len(np.unique(h["layout/refinement/vertex"])) and surface["uv"]
    assert surface["polygons"] == len(h["layout/refinement/input_face"])
    assert surface["materials"] == ["checkerboard"]
