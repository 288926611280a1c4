"""VTK XML and VTKHDF: every array comes back bit for bit as HDF5 has it."""
import h5py
import numpy as np
import pytest
import vtk_reading
from conftest import export, run

READERS = [vtk_reading.read_plainly,
           pytest.param(vtk_reading.read_with_vtk,
                        marks=pytest.mark.skipif(not vtk_reading.has_vtk(), reason="VTK's Python module is not installed"))]


def item_of(path):
    """The first item of a result file, its datasets and attributes by path."""
    arrays, attributes = {}, {}
    with h5py.File(path) as file:
        name = list(file["items"])[0]
        file["items"][name].visititems(
            lambda key, node: arrays.__setitem__(key, node[()]) if isinstance(node, h5py.Dataset)
            else attributes.__setitem__(key, dict(node.attrs)))
        attributes[""] = dict(file["items"][name].attrs)
    return name, arrays, attributes


def same(read, stored):
    """Bit for bit: NaN, the sign of zero, type and all."""
    stored = np.asarray(stored)
    assert read.dtype == stored.dtype and read.shape == stored.shape
    assert read.tobytes() == stored.tobytes()


def texts(stored):
    return [text.decode() for text in stored]


@pytest.mark.parametrize("read", READERS)
@pytest.mark.parametrize("suffix", ["vtp", "vtu"])
def test_sweep(results, tmp_path, read, suffix):
    name, h, attributes = item_of(results.sweep())
    block = read(export(results.sweep(), tmp_path / f"surface.{suffix}"))
    same(block.points, h["mesh/points"])
    same(block.corners.reshape(-1, 3).astype("i4"), h["mesh/triangles"])
    vertex = h["sweep/vertex"]
    point = block.data["point"]
    for field in ("area_distortion", "residual_max", "gauss_bonnet_error"):
        same(point[field][vertex], h[f"sweep/{field}"])
    for field in ("newton_iterations", "flips", "seconds", "precision_digits"):
        same(point[field][vertex], h[f"sweep/{field}"].astype("f8"))  # exact: narrower types
    same(point["status"][vertex], h["sweep/status"].astype("i4"))
    others = np.setdiff1d(np.arange(len(block.points)), vertex)
    assert len(others) and np.isnan(point["area_distortion"][others]).all() and (point["status"][others] == -1).all()
    for rank in ("best", "worst"):
        same(point[f"{rank}_conformal_factor"], h[f"sweep/{rank}/conformal_factor"])
        assert block.data["field"][f"sweep_{rank}_vertex"][0] == h[f"sweep/{rank}/vertex"]
    for k, v in enumerate(h["sweep/kept/vertex"]):
        same(point[f"conformal_factor_of_vertex_{v}"], h["sweep/kept/conformal_factor"][k])
    assert block.data["field"]["item"] == [name]
    assert block.data["field"]["source_hash"] == [attributes[""]["source_hash"]]
    assert block.data["field"]["status_names"][0] == "converged"
    rows = read(export(results.sweep(), tmp_path / f"samples.{suffix}", "--what", "samples"))
    same(rows.points, h["mesh/points"][vertex])
    same(rows.data["point"]["vertex"], vertex)
    same(rows.data["point"]["area_distortion"], h["sweep/area_distortion"])
    assert block.units["residual_max"] == "rad" and block.units["seconds"] == "s"
    assert block.units["area_distortion"] == "1" and "status" not in block.units


@pytest.mark.parametrize("read", READERS)
def test_flow(results, tmp_path, read):
    _, h, attributes = item_of(results.flow())
    block = read(export(results.flow(), tmp_path / "surface.vtp"))
    for field in ("conformal_factor", "curvature", "target_curvature"):
        same(block.data["point"][field], h[f"flow/{field}"])
    assert block.units["curvature"] == "rad" and block.units["conformal_factor"] == "1"
    assert block.data["field"]["flow_status"] == ["converged"]
    same(block.data["field"]["flow_residual_max"], np.array([attributes["flow"]["residual_max"]]))
    cones = read(export(results.flow(), tmp_path / "cones.vtp", "--what", "cones"))
    same(cones.points, h["mesh/points"][[0, 9]])
    same(cones.data["cell"]["cone_curvature"], h["flow/target_curvature"][[0, 9]])
    assert cones.units["cone_curvature"] == "rad" and cones.data["cell"]["name"] == ["cone at 0", "cone at 9"]


@pytest.mark.parametrize("read", READERS)
@pytest.mark.parametrize("surface", ["eight", "torus", "sphere", "pants", "disk"])
def test_layout(results, tmp_path, read, surface):
    result = results.layout(surface)
    _, h, attributes = item_of(result)
    head = export(result, tmp_path / "all.vtm")
    blocks = {name: read(tmp_path / file) for name, file in vtk_reading.leaves(head).items()}
    vertex = h["layout/refinement_vertex"]
    hyperbolic, spherical = (attributes["layout"]["geometry"] == g for g in ("hyperbolic", "spherical"))
    for name in ("layout", "cut_surface"):
        block = blocks[name]
        same(block.corners.astype("i4"), h["layout/corner_vertex"])
        same(block.ends.astype("i4"), h["layout/refinement/first"][1:])
        same(block.data["point"]["position"], h["layout/position"])
        same(block.data["point"]["conformal"], h["layout/conformal"])
        same(block.data["point"]["vertex"], vertex)
        same(block.data["cell"]["input_face"], h["layout/refinement/input_face"])
        same(block.data["cell"]["final_face"], h["layout/refinement/final_face"])
        conformal = h["layout/conformal"]
        uv = (conformal + 1) / 2 if hyperbolic or spherical else conformal
        same(block.data["point"]["uv"], np.where(np.isfinite(uv).all(axis=1)[:, None], uv, 0.0))  # 0: the sphere's pole
        assert block.texture == "uv"
        # At vertices of the mesh the very numbers, between them what lies between.
        u, of_mesh = h["flow/conformal_factor"], vertex < len(h["mesh/points"])
        same(block.data["point"]["conformal_factor"][of_mesh], u[vertex[of_mesh]])
        between = block.data["point"]["conformal_factor"][~of_mesh]
        assert np.isfinite(between).all() and (between >= u.min()).all() and (between <= u.max()).all()
        if "quality/distortion" in h:
            same(block.data["cell"]["distortion"], h["quality/distortion"])
            same(block.data["field"]["corner_angle_ratio"], h["quality/angles/ratio"])
    same(blocks["cut_surface"].points, h["layout/refinement/points"][vertex])
    if spherical:
        same(blocks["layout"].points, h["layout/position"])
    else:
        same(np.ascontiguousarray(blocks["layout"].points[:, :2]), h["layout/conformal"])
    if "quality/image_area" in h:
        cell = blocks["surface"].data["cell"]
        same(cell["image_area"], h["quality/image_area"])
        same(cell["log_area_ratio"], h["quality/log_area_ratio"])
        same(cell["face_angle_ratio"], h["quality/face_angles/ratio"].reshape(-1, 3))
        same(cell["face_angle_kind"], h["quality/face_angles/kind"].reshape(-1, 3))
    check_generators(blocks, h)
    check_sides(blocks, h)
    check_copies(blocks, h)


def check_generators(blocks, h):
    paths = h.get("layout/generators/path", [])
    if not len(paths):
        assert "generators" not in blocks
        return
    block = blocks["generators"]
    same(block.points, h["mesh/points"][paths])
    same(block.ends.astype("i4"), h["layout/generators/path_first"][1:])
    assert block.data["cell"]["name"] == texts(h["layout/generators/name"])
    assert block.data["cell"]["word"] == texts(h["layout/generators/word"])
    same(block.data["cell"]["element"], h["layout/generators/element"])
    same(block.data["cell"]["matrix"], h["layout/generators/matrix"].reshape(-1, 9))
    if "layout/generators/half_plane" in h:
        same(block.data["cell"]["half_plane"], h["layout/generators/half_plane"].reshape(-1, 4))
    # In the layout each runs through as many points as its edges have, and every point is one of the layout's.
    inner = blocks["layout_generators"]
    known = {tuple(p) for p in blocks["layout"].points.tolist()}
    assert all(tuple(p) in known for p in inner.points.tolist())
    assert set(inner.data["cell"]["name"]) == set(block.data["cell"]["name"])


def check_sides(blocks, h):
    names = texts(h.get("layout/sides/name", []))
    if not names:
        assert "sides" not in blocks and "cut" not in blocks
        return
    sides, cut = blocks["sides"], blocks["cut"]
    assert sides.data["cell"]["name"] == names
    same(sides.data["cell"]["partner"], h["layout/sides/partner"])
    same(sides.data["cell"]["boundary"], h["layout/sides/boundary"])
    same(sides.points, blocks["layout"].points[sides.data["point"]["layout_vertex"]])
    starts = np.r_[0, sides.ends[:-1]]
    # Side after side, round the domain.
    ends_at = sides.data["point"]["layout_vertex"][sides.ends - 1]
    assert (np.roll(sides.data["point"]["layout_vertex"][starts], -1) == ends_at).all()
    same(sides.data["field"]["pairing_element"], h["layout/pairings/element"])
    partner = h["layout/sides/partner"]
    assert len(cut.ends) == sum(p < 0 or p > s for s, p in enumerate(partner))
    points = {tuple(p) for p in h["mesh/points"].tolist()}
    assert all(tuple(p) in points for p in cut.points.tolist())


def check_copies(blocks, h):
    if "layout/copies/element" not in h:
        assert "domains" not in blocks
        return
    copies, pieces = len(h["layout/copies/element"]), len(h["layout/refinement/input_face"])
    domains, vertices = blocks["domains"], len(h["layout/position"])
    assert len(domains.ends) == copies * pieces and len(domains.points) == copies * vertices
    same(domains.data["cell"]["copy"], np.repeat(np.arange(copies, dtype="i4"), pieces))
    same(domains.data["field"]["copy_element"], h["layout/copies/element"])
    same(domains.points[:vertices], blocks["layout"].points)  # the identity comes first
    (ar, ai, br, bi), z = h["layout/copies/element"][-1], h["layout/conformal"] @ [1, 1j]
    a, b = ar + 1j * ai, br + 1j * bi
    kappa = -1 if "layout/generators/half_plane" in h else 0
    if kappa == 0:  # points are half coordinates there, see docs/hdf5.md
        z = (a * z / 2 + b) / np.conj(a) * 2
    else:
        z = (a * z + b) / (np.conj(b) * z + np.conj(a))
    last = domains.points[-vertices:]
    assert np.abs(last[:, 0] + 1j * last[:, 1] - z).max() < 1e-9 * max(1, np.abs(z).max())
    assert len(blocks["outlines"].ends) == copies


@pytest.mark.parametrize("read", READERS)
def test_spectrum_and_coordinates(results, tmp_path, read):
    _, h, _ = item_of(results.spectrum())
    block = read(export(results.spectrum(), tmp_path / "geodesics.vtp", "--what", "geodesics"))
    same(block.points, h["spectrum/geodesics/points"])
    same(block.ends.astype("i4"), h["spectrum/geodesics/points_first"][1:])
    same(block.data["cell"]["length"], h["spectrum/geodesics/length"])
    same(block.data["cell"]["boundary"], h["spectrum/geodesics/boundary"])
    assert block.data["cell"]["word"] == texts(h["spectrum/geodesics/word"])
    same(block.data["field"]["spectrum_length"], h["spectrum/length"])
    same(block.data["field"]["spectrum_power"], h["spectrum/power"])
    same(block.data["field"]["spectrum_geodesic"], h["spectrum/geodesic"])
    _, h, _ = item_of(results.teichmuller())
    block = read(export(results.teichmuller(), tmp_path / "curves.vtp", "--what", "curves"))
    same(block.points, h["teichmuller/curves/points"])
    same(block.data["cell"]["length"], h["teichmuller/curves/length"])
    assert block.data["cell"]["name"] == texts(h["teichmuller/curves/name"])
    same(block.data["field"]["teichmuller_coordinates"], h["teichmuller/coordinates"])
    assert block.data["field"]["teichmuller_names"] == texts(h["teichmuller/names"])
    same(block.data["field"]["fenchel_nielsen_twist"], h["teichmuller/fenchel_nielsen/twist"])


@pytest.mark.parametrize("read", READERS)
def test_charts(results, tmp_path, read):
    _, h, _ = item_of(results.layout("eight"))
    block = read(export(results.layout("eight"), tmp_path / "charts.vtp", "--what", "charts"))
    same(np.ascontiguousarray(block.points[:, :2]), h["atlas/charts/point"])
    same(block.data["point"]["vertex"], h["atlas/charts/vertex"])
    same(block.data["cell"]["input_face"], h["atlas/charts/face"])
    faces = h["mesh/triangles"][block.data["cell"]["input_face"]]
    assert (block.data["point"]["vertex"][block.corners].reshape(-1, 3) == faces).all()


@pytest.mark.parametrize("model", ["klein", "half-plane"])
def test_models(results, tmp_path, model):
    _, h, _ = item_of(results.layout("eight"))
    block = vtk_reading.read_plainly(
        export(results.layout("eight"), tmp_path / "layout.vtp", "--what", "layout", "--model", model))
    x, y, t = h["layout/position"].T
    expected = np.stack([x, y], 1) / t[:, None]
    if model == "half-plane":
        z = (x + 1j * y) / (1 + t)
        w = 1j * (1 + z) / (1 - z)
        turned = 1j * (1 - 1j * z) / (1 + 1j * z)  # whichever way the disk is turned
        got = block.points[:, 0] + 1j * block.points[:, 1]
        assert min(np.abs(got - w).max(), np.abs(got - turned).max(), np.abs(got + np.conj(w)).max()) < 1e-8
        assert (block.points[:, 1] > 0).all()
    else:
        assert np.abs(block.points[:, :2] - expected).max() < 1e-12
    same(block.data["point"]["position"], h["layout/position"])


def test_vtkhdf(results, tmp_path):
    for result, what, group in ((results.sweep(), "surface", "mesh/points"),
                                (results.spectrum(), "geodesics", "spectrum/geodesics/points")):
        _, h, _ = item_of(result)
        path = export(result, tmp_path / f"{what}.vtkhdf", "--what", what)
        with h5py.File(path) as file:
            grid = file["VTKHDF"]
            assert list(grid.attrs["Version"]) == [1, 0] and grid.attrs["Type"] == b"UnstructuredGrid"
            same(grid["Points"][()], h[group])
            if what == "surface":
                same(grid["PointData/area_distortion"][()][h["sweep/vertex"]], h["sweep/area_distortion"])
                assert grid["PointData/residual_max"].attrs["units"] == "rad"
                assert set(grid["Types"][()]) == {5}
            else:
                same(grid["CellData/length"][()], h["spectrum/geodesics/length"])
                assert set(grid["Types"][()]) == {4}


def test_vtkhdf_by_vtk(results, tmp_path):
    pytest.importorskip("vtkmodules.vtkIOHDF", reason="VTK's HDF reader is not installed")
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkIOHDF import vtkHDFReader
    _, h, _ = item_of(results.layout("eight"))
    reader = vtkHDFReader()
    reader.SetFileName(str(export(results.layout("eight"), tmp_path / "cut.vtkhdf", "--what", "cut_surface")))
    reader.Update()
    grid = reader.GetOutput()
    same(vtk_to_numpy(grid.GetPoints().GetData()), h["layout/refinement/points"][h["layout/refinement_vertex"]])
    same(vtk_to_numpy(grid.GetCellData().GetArray("distortion")), h["quality/distortion"])


def test_several_items_in_one_head(results, tmp_path):
    head = export(results.several(), tmp_path / "several.vtm")
    with h5py.File(results.several()) as file:
        names = list(file["items"])
        assert len(names) == 2
        for name in names:
            block = vtk_reading.read_plainly(tmp_path / vtk_reading.leaves(head)[f"{name}/surface"])
            same(block.points, file["items"][name]["mesh/points"][()])


@pytest.mark.skipif(not vtk_reading.has_vtk(), reason="VTK's Python module is not installed")
def test_vtk_reads_the_head(results, tmp_path):
    from vtkmodules.vtkIOXML import vtkXMLMultiBlockDataReader
    reader = vtkXMLMultiBlockDataReader()
    reader.SetFileName(str(export(results.several(), tmp_path / "several.vtm")))
    reader.Update()
    blocks = reader.GetOutput()
    assert blocks.GetNumberOfBlocks() == 2
    for k in range(2):
        inner = blocks.GetBlock(k)
        assert inner.GetMetaData(0).Get(blocks.NAME()) == "surface" and inner.GetBlock(0).GetNumberOfPoints() > 0


def test_fewer_copies_where_there_are_too_many(results, tmp_path):
    result = results.layout("eight")
    _, h, _ = item_of(result)
    pieces = len(h["layout/refinement/input_face"])
    done = run("export", result, "-o", tmp_path / "domains.vtp", "--what", "domains", "--max-cells", 3 * pieces)
    assert "3 of 30 copies" in done.stderr
    assert len(vtk_reading.read_plainly(tmp_path / "domains.vtp").ends) == 3 * pieces
