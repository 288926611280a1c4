"""Scripts for Blender, Polyscope and ParaView, and the archives of arrays beside them."""
import json
import os
import shutil
import struct
import subprocess
import zlib
from pathlib import Path

import numpy as np
import pytest
from conftest import export, need, run_program
from test_vtk import item_of, same

HERE = Path(__file__).resolve().parent
PYTHON = "/usr/bin/python3"


def describe(archive):
    return json.loads(archive["about"].tobytes())


def test_arrays(results, tmp_path):
    name, h, _ = item_of(results.layout("eight"))
    archive = np.load(export(results.layout("eight"), tmp_path / "eight.npz"))
    about = describe(archive)
    assert about["item"] == name and about["field"] is None and about["kappa"] == -1
    same(archive["surface/points"], h["mesh/points"])
    same(archive["surface/corners"].reshape(-1, 3), h["mesh/triangles"])
    same(archive["surface/point_data/conformal_factor"], h["flow/conformal_factor"])
    same(archive["layout/point_data/position"], h["layout/position"])
    same(archive["layout/first"], h["layout/refinement/first"])
    same(archive["cut_surface/cell_data/distortion"], h["quality/distortion"])
    same(archive["generators/cell_data/element"], h["layout/generators/element"])
    assert about["blocks"]["generators"]["texts"]["cell_data/name"] == [t.decode() for t in h["layout/generators/name"]]
    assert about["blocks"]["surface"]["units"]["point_data/curvature"] == "rad"
    assert set(about["blocks"]) == {key.split("/")[0] for key in archive.files} - {"about"}


def test_the_archive_is_a_sound_zip(results, tmp_path):
    import zipfile
    with zipfile.ZipFile(export(results.sweep(), tmp_path / "sweep.npz")) as archive:
        assert archive.testzip() is None


# Blender

def blender(script, report, *words, cwd):
    """Runs a script in Blender; what is in its scene afterwards."""
    run_program([need("blender"), "--background", "--factory-startup", "--python-exit-code", "3", "--python", script,
                 "--python", HERE / "blender_report.py", "--", *words], cwd=cwd,
                env=dict(os.environ, BLENDER_REPORT=str(report)))
    return json.loads(Path(report).read_text())


def test_blender_layout(results, tmp_path):
    _, h, _ = item_of(results.layout("eight"))
    script = export(results.layout("eight"), tmp_path / "eight.blender.py")
    assert (tmp_path / "eight.npz").exists() and str(tmp_path) not in script.read_text()
    # Wherever the two files are, and wherever Blender was started.
    moved = tmp_path / "moved"
    moved.mkdir()
    for file in (script, tmp_path / "eight.npz"):
        shutil.move(file, moved)
    report = blender(moved / script.name, tmp_path / "report.json", cwd="/")
    objects = report["objects"]
    surface = objects["surface"]
    # Sewn together again: a closed surface of genus two.
    assert surface["vertices"] == len(np.unique(h["layout/refinement/vertex"]))
    assert surface["polygons"] == len(h["layout/refinement/input_face"])
    assert surface["loops"] == len(h["layout/refinement/vertex"])
    assert surface["vertices"] - surface["edges"] + surface["polygons"] == -2
    assert surface["uv"] == ["layout"] and surface["materials"]
    used = np.unique(h["layout/refinement/vertex"])
    assert bytes.fromhex(surface["coordinates"]) == h["layout/refinement/points"][used].astype("<f4").tobytes()
    uv = (h["layout/conformal"] + 1) / 2
    assert bytes.fromhex(surface["uv_values"]) == uv[h["layout/corner_vertex"]].astype("<f4").tobytes()
    assert bytes.fromhex(surface["distortion"]) == h["quality/distortion"].astype("<f4").tobytes()
    layout = objects["layout"]
    assert layout["vertices"] == len(h["layout/position"]) and layout["polygons"] == surface["polygons"]
    assert layout["vertices"] - layout["edges"] + layout["polygons"] == 1  # a disk
    assert objects["domains"]["polygons"] == 30 * surface["polygons"]
    for generator in h["layout/generators/name"]:
        curve = objects[f"generators {generator.decode()}"]
        assert curve["type"] == "CURVE" and curve["bevel"] > 0 and curve["cyclic"] == [True]
    assert report["camera"] and report["view_transform"] == "Standard"


def test_blender_sweep(results, tmp_path):
    _, h, _ = item_of(results.sweep())
    report = blender(export(results.sweep(), tmp_path / "sweep.blender.py"), tmp_path / "report.json", cwd=tmp_path)
    surface = report["objects"]["surface"]
    assert (surface["vertices"], surface["polygons"]) == (len(h["mesh/points"]), len(h["mesh/triangles"]))
    assert surface["colours"] == ["field colour"]
    distortion = np.frombuffer(bytes.fromhex(surface["area_distortion"]), "<f4")
    assert distortion[h["sweep/vertex"]].tobytes() == h["sweep/area_distortion"].astype("<f4").tobytes()
    assert report["objects"]["samples"]["polygons"] == 20 * len(h["sweep/vertex"])
    best = np.array(report["objects"]["best"]["location"], "<f4")
    assert best.tobytes() == h["mesh/points"][h["sweep/best/vertex"]].astype("<f4").tobytes()


def test_blender_renders(results, tmp_path):
    script = export(results.flow(), tmp_path / "flow.blender.py")
    picture = tmp_path / "flow.png"
    run_program([need("blender"), "--background", "--factory-startup", "--python-exit-code", "3", "--python", script, "--",
                 "--render", picture, "--size", "64x48", "--samples", "1"])
    assert picture.read_bytes().startswith(b"\x89PNG")


GLB_IMPORT = """
import bpy, sys
import numpy
numpy.bool = bool  # the importer of Blender 3.4 uses a name that Debian's numpy has no more
bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.import_scene.gltf(filepath=sys.argv[-1])
"""


def test_blender_imports_gltf(results, tmp_path):
    _, h, _ = item_of(results.layout("torus"))
    path = export(results.layout("torus"), tmp_path / "torus.glb", "--what", "cut_surface,generators")
    (tmp_path / "import.py").write_text(GLB_IMPORT)
    report = blender(tmp_path / "import.py", tmp_path / "report.json", path, cwd=tmp_path)
    surface = report["objects"]["cut_surface"]
    assert surface["vertices"] == len(h["layout/position"])
    assert surface["polygons"] == (np.diff(h["layout/refinement/first"]) - 2).sum()
    assert surface["uv"] and "checkerboard" in surface["materials"][0]
    assert "generators" in report["objects"]


# Polyscope

def polyscope(script, tmp_path):
    log = tmp_path / "polyscope.json"
    environment = dict(os.environ, PYTHONPATH=str(HERE / "standin"), POLYSCOPE_LOG=str(log))
    done = subprocess.run([PYTHON, script], env=environment, capture_output=True, text=True, cwd="/")
    assert done.returncode == 0, done.stderr
    shown = json.loads(log.read_text())
    assert shown["shown"] == 1
    return shown


def test_polyscope_layout(results, tmp_path):
    _, h, _ = item_of(results.layout("eight"))
    shown = polyscope(export(results.layout("eight"), tmp_path / "eight.polyscope.py"), tmp_path)
    surface, layout = shown["surfaces"]["surface"], shown["surfaces"]["layout"]
    assert surface["vertices"] == len(np.unique(h["layout/refinement/vertex"]))
    assert surface["faces"] == layout["faces"] == (np.diff(h["layout/refinement/first"]) - 2).sum()
    assert layout["vertices"] == len(h["layout/position"]) and layout["transformed"]
    assert surface["parameterizations"]["layout"]["enabled"]
    assert surface["scalars"]["curvature [rad]"] == {"enabled": False, "count": surface["vertices"]}
    assert sum(name.startswith("generators ") for name in shown["curves"]) == len(h["layout/generators/name"])


@pytest.mark.parametrize("kind", ["sweep", "flow", "spectrum", "teichmuller", "failed", "intrinsic"])
def test_polyscope_others(results, tmp_path, kind):
    shown = polyscope(export(getattr(results, kind)(), tmp_path / "x.polyscope.py"), tmp_path)
    assert shown["surfaces"]
    if kind == "sweep":
        assert shown["surfaces"]["surface"]["scalars"]["area_distortion"]["enabled"]
        assert shown["points"]["cones"]["points"] == 2 and shown["points"]["samples"]["points"] == 12
    if kind in ("spectrum", "teichmuller"):
        assert shown["curves"]
    assert ("surface" in shown["surfaces"]) == (kind != "intrinsic")


# ParaView

@pytest.mark.parametrize("kind", ["layout", "sweep"])
def test_paraview_renders(results, tmp_path, request, kind):
    program = need("pvpython")
    display = request.getfixturevalue("display")
    result = results.layout("eight") if kind == "layout" else results.sweep()
    script = export(result, tmp_path / "x.paraview.py")
    assert str(tmp_path) not in script.read_text()
    picture = tmp_path / "x.png"
    output = run_program([program, "--force-offscreen-rendering", script, "--render", picture, "--size", "320x180"],
                         cwd="/", env=display)
    assert "error" not in output.lower() and "warn" not in output.lower(), output
    colours = seen_colours(picture)
    assert (255, 255, 255) in colours and len(colours) > 200


def seen_colours(path):
    """The colours of a PNG of 320 x 180 pixels (ISO/IEC 15948, filters included)."""
    content = path.read_bytes()
    assert content.startswith(b"\x89PNG")
    width, height, depth, kind = *struct.unpack(">II", content[16:24]), content[24], content[25]
    assert (width, height, depth) == (320, 180, 8) and kind in (2, 6)
    place, data, size = 8, b"", 0
    while place < len(content):
        size = struct.unpack(">I", content[place:place + 4])[0]
        if content[place + 4:place + 8] == b"IDAT":
            data += content[place + 8:place + 8 + size]
        place += size + 12
    step = 3 if kind == 2 else 4
    rows = np.frombuffer(zlib.decompress(data), np.uint8).reshape(height, 1 + step * width).astype(int)
    above = np.zeros(step * width, dtype=int)
    colours = set()
    for row in rows:
        line = row[1:].copy()
        for i in range(len(line)):
            a, b, c = line[i - step] if i >= step else 0, above[i], above[i - step] if i >= step else 0
            guess = a + b - c
            paeth = min((a, b, c), key=lambda x: abs(guess - x))
            line[i] = (line[i] + (0, a, b, (a + b) // 2, paeth)[row[0]]) % 256
        colours.update(map(tuple, line.reshape(-1, step)[:, :3].tolist()))
        above = line
    return colours


@pytest.mark.parametrize("words", [("x.py",), ("polyscope.py", "--for", "polyscope"),
                                   ("x.blender.py", "--for", "polyscope")])
def test_mistakes(results, tmp_path, words):
    export(results.flow(), tmp_path / words[0], *words[1:], status=2)
    assert not (tmp_path / words[0]).exists()
