"""glTF: numbers are those of HDF5, rounded once to single precision."""
import h5py
import numpy as np
import pytest
from conftest import export, run
from gltf_reading import Gltf
from test_vtk import item_of


def same(read, stored):
    stored = np.asarray(stored).astype("<f4")
    assert read.shape == stored.shape and read.tobytes() == stored.tobytes()


@pytest.mark.parametrize("suffix", ["glb", "gltf"])
def test_sweep(results, tmp_path, suffix):
    name, h, _ = item_of(results.sweep())
    file = Gltf(export(results.sweep(), tmp_path / f"sweep.{suffix}"))
    surface = file.attributes("surface")
    same(surface["POSITION"], h["mesh/points"])
    assert (file.indices("surface").reshape(-1, 3) == h["mesh/triangles"]).all()
    vertex = h["sweep/vertex"]
    same(surface["_AREA_DISTORTION"][vertex], h["sweep/area_distortion"])
    assert (np.flatnonzero(surface["_AREA_DISTORTION_KNOWN"]) == vertex).all()
    same(surface["_BEST_CONFORMAL_FACTOR"], h["sweep/best/conformal_factor"])
    assert "images" not in file.root and "TEXCOORD_0" not in surface
    # Colours: grey where nothing is known, the ends of the scale at best and worst.
    about = file.root["asset"]["extras"]
    assert about["item"] == name and about["field"]["name"] == "area_distortion" and about["field"]["unit"] == "1"
    colour = surface["COLOR_0"][:, :3] / 65535
    unknown = np.setdiff1d(np.arange(len(colour)), vertex)
    grey = ((128 / 255 + 0.055) / 1.055) ** 2.4
    assert np.abs(colour[unknown] - grey).max() < 1e-4
    for rank, end in (("best", 0), ("worst", -1)):
        srgb = np.array(about["field"]["colours"][end])
        linear = np.where(srgb <= 0.04045, srgb / 12.92, ((srgb + 0.055) / 1.055) ** 2.4)
        assert np.abs(colour[h[f"sweep/{rank}/vertex"]] - linear).max() < 1e-4
    samples = file.attributes("samples")
    same(samples["POSITION"], h["mesh/points"][vertex])
    same(samples["_AREA_DISTORTION"], h["sweep/area_distortion"])
    # A ball at each cone.
    for rank in ("best", "worst"):
        node = next(n for n in file.root["nodes"] if n["name"] == rank)
        same(np.array(node["translation"], "<f4"), h["mesh/points"][h[f"sweep/{rank}/vertex"]])
        assert node["extras"]["cone_curvature"] == -4 * np.pi and node["extras"]["cone_curvature_unit"] == "rad"


@pytest.mark.parametrize("surface", ["eight", "torus", "sphere", "pants", "disk"])
def test_layout(results, tmp_path, surface):
    _, h, attributes = item_of(results.layout(surface))
    file = Gltf(export(results.layout(surface), tmp_path / "layout.glb"))
    vertex, first = h["layout/refinement_vertex"], h["layout/refinement/first"]
    cut, layout = file.attributes("cut_surface"), file.attributes("layout")
    same(cut["POSITION"], h["layout/refinement/points"][vertex])
    same(cut["_VERTEX"], vertex)
    conformal = h["layout/conformal"]
    uv = conformal if attributes["layout"]["geometry"] == "euclidean" else (conformal + 1) / 2
    uv = np.where(np.isfinite(uv).all(axis=1)[:, None], uv, 0.0)  # the sphere's pole has no image
    uv = np.stack([uv[:, 0], 1 - uv[:, 1]], 1)  # glTF's v runs downwards
    for mesh in (cut, layout):
        same(mesh["TEXCOORD_0"], uv)
    if attributes["layout"]["geometry"] == "spherical":
        same(layout["POSITION"], h["layout/position"])
    else:
        same(layout["POSITION"], np.c_[conformal, np.zeros(len(conformal))])
    # A polygon of n corners is n - 2 triangles.
    assert len(file.indices("cut_surface")) == 3 * (np.diff(first) - 2).sum()
    assert file.image().startswith(b"\x89PNG")
    # Cut or not, a vertex of the surface is shaded in one way.
    order = np.argsort(vertex, kind="stable")
    twice = vertex[order][1:] == vertex[order][:-1]
    assert (cut["NORMAL"][order][1:][twice] == cut["NORMAL"][order][:-1][twice]).all()
    assert [scene["name"] for scene in file.root["scenes"]] == ["space", "layout"]
    paths = h.get("layout/generators/path", [])
    if len(paths):
        start = h["layout/generators/path_first"]
        for k, primitive in enumerate(file.mesh("generators")["primitives"]):
            same(file.attributes("generators", k)["POSITION"], h["mesh/points"][paths[start[k]:start[k + 1]]])
            assert primitive["mode"] == 3 and primitive["extras"]["name"] == h["layout/generators/name"][k].decode()


def test_geodesics(results, tmp_path):
    _, h, _ = item_of(results.spectrum())
    file = Gltf(export(results.spectrum(), tmp_path / "spectrum.glb"))
    start = h["spectrum/geodesics/points_first"]
    primitives = file.mesh("geodesics")["primitives"]
    assert len(primitives) == len(h["spectrum/geodesics/length"])
    for k, primitive in enumerate(primitives):
        same(file.attributes("geodesics", k)["POSITION"], h["spectrum/geodesics/points"][start[k]:start[k + 1]])
        assert primitive["extras"]["length"] == h["spectrum/geodesics/length"][k]


@pytest.mark.parametrize("field", ["curvature", "log_area_ratio", "none"])
def test_fields(results, tmp_path, field):
    file = Gltf(export(results.layout("eight"), tmp_path / "field.glb", "--field", field))
    assert ("COLOR_0" in file.attributes("cut_surface")) == (field != "none")
    about = file.root["asset"]["extras"]["field"]
    assert (about is None) if field == "none" else (about["name"] == field and about["low"] == -about["high"])


def test_large_surfaces_have_wide_indices(results, tmp_path):
    mesh = tmp_path / "large.off"
    run("generate", "torus", "--faces", "140000", "-o", mesh, "-q")
    run("sweep", mesh, "--vertices", "sample:1", "-o", tmp_path / "large.h5", "-q", status=1)  # no cone on a torus
    file = Gltf(export(tmp_path / "large.h5", tmp_path / "large.glb"))
    accessor = file.root["accessors"][file.mesh("surface")["primitives"][0]["indices"]]
    assert accessor["componentType"] == 5125
    with h5py.File(tmp_path / "large.h5") as h:
        item = next(iter(h["items"].values()))
        assert (file.indices("surface").reshape(-1, 3) == item["mesh/triangles"][()]).all()
