"""What cannot be handed over is said, and keeps nothing else from being written."""
import ctypes
import json
import shutil

import h5py
import numpy as np
import pytest
import vtk_reading
from conftest import export, run
from gltf_reading import Gltf
from test_scripts import polyscope
from test_vtk import item_of, same


@pytest.mark.parametrize("what, hint", [("layout", "has no layout"), ("geodesics", "ricci spectrum"),
                                        ("domains", "has no layout"), ("charts", "--atlas"), ("mesh", "known: surface"),
                                        ("curves", "ricci teichmuller")])
def test_what_an_item_lacks(results, tmp_path, what, hint):
    done = run("export", results.flow(), "-o", tmp_path / "x.vtp", "--what", what, status=2)
    assert hint in done.stderr and not (tmp_path / "x.vtp").exists()


@pytest.mark.parametrize("suffix", ["vtu", "vtkhdf", "obj"])
def test_intrinsic_surfaces(results, tmp_path, suffix):
    done = run("export", results.intrinsic(), "-o", tmp_path / f"x.{suffix}", status=2)
    assert "intrinsic surface" in done.stderr and not (tmp_path / f"x.{suffix}").exists()


def test_the_layout_of_an_intrinsic_surface(results, tmp_path):
    _, h, _ = item_of(results.intrinsic())
    assert "mesh/points" not in h
    block = vtk_reading.read_plainly(export(results.intrinsic(), tmp_path / "layout.vtp", "--what", "layout"))
    same(block.data["point"]["position"], h["layout/position"])
    head = export(results.intrinsic(), tmp_path / "all.vtm")
    assert "surface" not in vtk_reading.leaves(head) and "layout" in vtk_reading.leaves(head)
    file = Gltf(export(results.intrinsic(), tmp_path / "x.glb"))
    assert [scene["name"] for scene in file.root["scenes"]] == ["layout"]


def test_failed_flows(results, tmp_path):
    _, h, _ = item_of(results.failed())
    block = vtk_reading.read_plainly(export(results.failed(), tmp_path / "x.vtp"))
    same(block.data["point"]["conformal_factor"], h["flow/conformal_factor"])
    assert block.data["field"]["flow_status"] == block.data["field"]["layout_status"] == ["max_iterations"]
    done = run("export", results.failed(), "-o", tmp_path / "x.obj", status=2)
    assert "max_iterations" in done.stderr
    Gltf(export(results.failed(), tmp_path / "x.glb"))


def test_several_items(results, tmp_path):
    done = run("export", results.several(), "-o", tmp_path / "x.glb", "--json")
    written = [json.loads(line) for line in done.stdout.splitlines()]
    assert len(written) == 2
    for entry in written:
        Gltf(entry["file"])
        assert entry["item"] in entry["file"]
    assert run("export", results.several(), "-o", tmp_path / "x.glb", "--what", "layout", status=2)
    one = export(results.several(), tmp_path / "one.vtu", "--item", written[0]["item"])
    assert vtk_reading.read_plainly(one).data["field"]["item"] == [written[0]["item"]]


def test_one_item_of_several_fails(results, tmp_path):
    """A sphere beside a surface of genus 2 has no generators: it is named, and the exit status says so."""
    mixed = tmp_path / "mixed.off"
    a, b = results.mesh("eight", 300).read_text().split(), results.mesh("sphere", 200).read_text().split()
    join(a, b, mixed)
    run("layout", mixed, "-o", tmp_path / "mixed.h5", "-q")
    done = run("export", tmp_path / "mixed.h5", "-o", tmp_path / "g.vtp", "--what", "generators", status=1)
    assert "mixed.c1@" in done.stderr and "no generators" in done.stderr
    assert len(list(tmp_path.glob("g.mixed.c0@*.vtp"))) == 1 and not list(tmp_path.glob("g.mixed.c1@*"))


def join(a, b, path):
    """Two OFF files, as words, in one."""
    def parts(words):
        vertices, faces = int(words[1]), int(words[2])
        numbers = words[4:]
        return ([numbers[3 * k:3 * k + 3] for k in range(vertices)],
                [[int(n) for n in numbers[3 * vertices + 4 * k + 1:3 * vertices + 4 * k + 4]] for k in range(faces)])
    (p, f), (q, g) = parts(a), parts(b)
    text = [f"OFF\n{len(p) + len(q)} {len(f) + len(g)} 0"]
    text += [" ".join(x) for x in p] + [f"{float(x) + 10} {y} {z}" for x, y, z in q]
    text += ["3 " + " ".join(str(n) for n in face) for face in f]
    text += ["3 " + " ".join(str(n + len(p)) for n in face) for face in g]
    path.write_text("\n".join(text) + "\n")


@pytest.mark.parametrize("stem", ["a b", 'q"<&>', "ü", "100%", "-dash", "'", ".hidden"])
def test_odd_names(results, tmp_path, stem):
    mesh = tmp_path / f"{stem}.off"
    shutil.copy(results.mesh("eight", 300), mesh)
    result = tmp_path / "odd.h5"
    run("layout", mesh, "-o", result, "-q")
    with h5py.File(result) as file:
        name = list(file["items"])[0]
    for output in (f"{stem}.glb", f"{stem}.gltf"):
        assert Gltf(export(result, tmp_path / output)).root["asset"]["extras"]["item"] == name
    head = export(result, tmp_path / f"{stem}.vtm")
    for file in vtk_reading.leaves(head).values():
        assert vtk_reading.read_plainly(tmp_path / file).data["field"]["item"] == [name]
    polyscope(export(result, tmp_path / f"{stem}.polyscope.py"), tmp_path)


def test_names_that_would_collide(results, tmp_path):
    """Two items whose names differ in what file names cannot hold get files of their own."""
    folders = [tmp_path / "one", tmp_path / "two"]
    meshes = []
    for folder, name in zip(folders, ("a b.off", "a_b.off")):
        folder.mkdir()
        meshes.append(folder / name)
        shutil.copy(results.mesh("eight", 300), meshes[-1])
    run("sweep", *meshes, "--vertices", "sample:1", "-o", tmp_path / "two.h5", "-q")
    done = run("export", tmp_path / "two.h5", "-o", tmp_path / "x.vtu", "--json")
    assert len({json.loads(line)["file"] for line in done.stdout.splitlines()}) == 2
    assert len(list(tmp_path.glob("x.*.vtu"))) == 2


def test_damaged_files(results, tmp_path):
    for cut in (0.3, 0.9):
        damaged = tmp_path / "damaged.h5"
        content = results.layout("eight").read_bytes()
        damaged.write_bytes(content[:int(cut * len(content))])
        done = run("export", damaged, "-o", tmp_path / "x.glb", status=3)
        assert "damaged.h5" in done.stderr and not (tmp_path / "x.glb").exists()


def checksum(content):
    """As the store has it (docs/hdf5.md), by the library that it uses."""
    library = ctypes.CDLL("libxxhash.so.0")
    library.XXH3_64bits.restype, library.XXH3_64bits.argtypes = ctypes.c_uint64, [ctypes.c_char_p, ctypes.c_size_t]
    return np.uint64(library.XXH3_64bits(content, len(content)))


@pytest.mark.parametrize("path, value, message", [
    ("layout/corner_vertex", 10**6, "does not exist"), ("layout/sides/halfedge", 10**7, "does not exist"),
    ("layout/generators/path", -5, "does not exist"), ("layout/generators/path_first", 7, "lists do not fit"),
    ("layout/refinement/input_face", 10**6, "does not exist"), ("atlas/charts/face", 10**6, "does not exist"),
    ("atlas/charts/vertex", -1, "does not exist"), ("layout/position", float("nan"), "not finite"),
    ("layout/copies/element", 1e200, "not finite")])
def test_numbers_that_do_not_fit(results, tmp_path, path, value, message):
    """Contents changed with a checksum that is right: what the numbers mean is looked at too."""
    damaged = tmp_path / "damaged.h5"
    shutil.copy(results.layout("eight"), damaged)
    with h5py.File(damaged, "r+") as file:
        dataset = file["items"][list(file["items"])[0]][path]
        values = dataset[()]
        values.reshape(-1)[-1] = value
        dataset[...] = values
        dataset.attrs.modify("xxh3", checksum(values.tobytes()))
    for output in ("x.vtm", "x.glb", "x.npz", "x.paraview.py"):
        assert message in run("export", damaged, "-o", tmp_path / output, "--what", "all", status=3).stderr


def test_a_folder_that_cannot_be_written(results, tmp_path):
    for name in ("x.vtp", "x.vtm", "x.glb", "x.gltf", "x.npz", "x.obj", "x.blender.py"):
        assert "none" in run("export", results.layout("eight"), "-o", tmp_path / "none" / name, status=3).stderr
