"""Meshes: shared memory, conversions, defects."""

import gc
import weakref

import numpy as np
import pytest

import ricci


def tetrahedron():
    points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], dtype=np.float64)
    triangles = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]], dtype=np.int32)
    return points, triangles


def test_arrays_are_shared():
    points, triangles = tetrahedron()
    mesh = ricci.Mesh(points, triangles, copy=False)
    for own, given in ((mesh.points, points), (mesh.triangles, triangles)):
        assert np.shares_memory(own, given)
        assert own.__array_interface__["data"][0] == given.__array_interface__["data"][0]
        assert not own.flags.writeable
    assert points.flags.writeable


def test_mesh_is_what_the_arrays_hold():
    """Points moved in place move the mesh: lengths and curvature are those of the new points."""
    points, triangles = tetrahedron()
    mesh = ricci.Mesh(points, triangles)
    before = mesh.edge_length.copy()
    before_curvature = ricci.flow(mesh, target="uniform", geometry="euclidean").curvature
    points *= 2
    assert np.array_equal(mesh.edge_length, 2 * before)
    points[3] = (0.3, 0.3, 5.0)
    fresh = ricci.Mesh(points.copy(), triangles.copy())
    assert np.array_equal(mesh.edge_length, fresh.edge_length)
    after = ricci.flow(mesh, target="uniform", geometry="euclidean")
    assert np.array_equal(after.conformal_factor,
                          ricci.flow(fresh, target="uniform", geometry="euclidean").conformal_factor)
    assert np.allclose(before_curvature, after.curvature)


def test_mesh_that_is_broken_in_place_is_refused():
    points, triangles = tetrahedron()
    mesh = ricci.Mesh(points, triangles)
    triangles[0] = (0, 1, 9)
    with pytest.raises(ricci.MeshError) as caught:
        ricci.flow(mesh)
    assert caught.value.defects[0].code == "index_out_of_range"


def test_arrays_outlive_their_names():
    points, triangles = tetrahedron()
    mesh = ricci.Mesh(points, triangles)
    expected = points.copy()
    alive = weakref.ref(points)
    del points, triangles
    gc.collect()
    assert alive() is not None
    assert np.array_equal(mesh.points, expected)


@pytest.mark.parametrize("change", [
    lambda p, t: (p.astype(np.float32), t),
    lambda p, t: (p, t.astype(np.int64)),
    lambda p, t: (np.asfortranarray(p), t),
    lambda p, t: (p.tolist(), t.tolist()),
    lambda p, t: (p.astype(">f8"), t),
    lambda p, t: (np.repeat(p, 2, axis=0)[::2], t),
])  # fmt: skip
def test_other_forms_are_copied_or_refused(change):
    points, triangles = tetrahedron()
    p, t = change(points, triangles)
    mesh = ricci.Mesh(p, t)
    assert np.array_equal(mesh.points, points) and np.array_equal(mesh.triangles, triangles)
    assert mesh.points.dtype == np.float64 and mesh.triangles.dtype == np.int32
    with pytest.raises(ValueError, match="without a copy"):
        ricci.Mesh(p, t, copy=False)


def test_copies_are_independent():
    points, triangles = tetrahedron()
    mesh = ricci.Mesh(points, triangles, copy=True)
    points[:] = 0
    assert mesh.points[1, 0] == 1 and not np.shares_memory(mesh.points, points)


@pytest.mark.parametrize("points, triangles, error", [
    (np.zeros((4, 2)), np.zeros((4, 3), np.int32), ValueError),
    (np.zeros((4, 3)), np.zeros((4, 3)), TypeError),
    (np.zeros((4, 3), complex), np.zeros((4, 3), np.int32), TypeError),
    (np.zeros((4, 3)), np.full((4, 3), 2**40), ValueError),
    (np.zeros((4, 3)), np.full((4, 3), -1), ValueError),
    (np.zeros((4, 3)), np.zeros((0, 3), np.int32), ricci.MeshError),
])  # fmt: skip
def test_what_is_no_mesh(points, triangles, error):
    with pytest.raises(error):
        ricci.Mesh(points, triangles)


def test_every_defect_is_listed():
    points, triangles = tetrahedron()
    points[2, 1] = np.nan
    with pytest.raises(ricci.MeshError) as caught:
        ricci.Mesh(points, triangles)
    assert [(d.code, d.element, d.index) for d in caught.value.defects] == [("not_finite", "vertex", 2)]
    points, triangles = tetrahedron()
    triangles[0] = triangles[0, ::-1]
    with pytest.raises(ricci.MeshError) as caught:
        ricci.Mesh(points, triangles)
    codes = {d.code for d in caught.value.defects}
    assert codes == {"unoriented"}
    assert isinstance(caught.value, ValueError)
    repaired = ricci.Mesh(points, triangles, repair="orient")
    assert repaired.genus == 0 and not np.shares_memory(repaired.triangles, triangles)
    assert "oriented" in " ".join(n.message for n in repaired.notes) or repaired.notes


def test_same_defects_as_from_a_file(run_ricci):
    points, triangles = tetrahedron()
    triangles[0] = triangles[0, ::-1]
    lines = ["OFF", "4 4 0"] + [" ".join(map(str, p)) for p in points] + [f"3 {a} {b} {c}" for a, b, c in triangles]
    with open("bad.off", "w") as file:
        file.write("\n".join(lines) + "\n")
    with pytest.raises(ricci.MeshError) as from_file:
        ricci.load("bad.off")
    with pytest.raises(ricci.MeshError) as from_arrays:
        ricci.Mesh(points, triangles)
    assert from_file.value.defects == from_arrays.value.defects


def test_components():
    points, triangles = tetrahedron()
    both = np.vstack([points, points + 5]), np.vstack([triangles, triangles + 4]).astype(np.int32)
    with pytest.raises(ValueError, match="2 components"):
        ricci.Mesh(*both)
    parts = ricci.split(*both, name="pair")
    assert [part.name for part in parts] == ["pair.c0", "pair.c1"]
    assert np.array_equal(parts[1].points, points + 5)
    assert np.array_equal(parts[1].input_vertex, [4, 5, 6, 7])


def test_files_keep_every_digit():
    mesh = ricci.generate("torus", faces=400, jitter=0.2, seed=5)
    for suffix in ("off", "obj", "ply"):
        mesh.save(f"torus.{suffix}")
        again = ricci.load(f"torus.{suffix}")
        assert again.points.tobytes() == mesh.points.tobytes()
        assert np.array_equal(again.triangles, mesh.triangles)
        assert again.source == f"torus.{suffix}" and again.name == "torus"
    assert (mesh.genus, mesh.boundaries, mesh.euler_characteristic) == (1, 0, 0)
    assert mesh.vertices - mesh.edges + mesh.faces == 0


def test_generate_is_that_of_the_command_line(run_ricci):
    run_ricci("generate", "eight", "--faces", 900, "-o", "eight.off", "-q")
    mesh, made = ricci.load("eight.off"), ricci.generate("eight", faces=900)
    assert made.points.tobytes() == mesh.points.tobytes() and np.array_equal(made.triangles, mesh.triangles)
    with pytest.raises(ValueError, match="klein-quartic"):
        ricci.generate("nothing of the kind")


def test_views_of_a_mesh_outlive_it():
    mesh = ricci.generate("torus", faces=400)
    points, lengths = mesh.points, mesh.edge_length
    kept = points.copy(), lengths.copy()
    assert np.shares_memory(points, mesh.points)
    del mesh
    gc.collect()
    assert np.array_equal(points, kept[0]) and np.array_equal(lengths, kept[1])
    with pytest.raises(ValueError):
        points.flags.writeable = True


def test_intrinsic_surface():
    bolza = ricci.generate("bolza", faces=500)
    assert bolza.intrinsic and bolza.genus == 2 and bolza.edge_length.shape == (3 * bolza.faces,)
    with pytest.raises(ValueError, match="no points"):
        _ = bolza.points
    bolza.save("bolza.len")
    again = ricci.load("bolza.len")
    assert np.array_equal(again.edge_length, bolza.edge_length) and np.array_equal(again.twin, bolza.twin)


def test_files_that_are_none():
    with pytest.raises(ricci.FileError, match="missing.off"):
        ricci.load("missing.off")
    with pytest.raises(OSError):
        ricci.load("missing.off")
    with open("empty.off", "w"):
        pass
    with pytest.raises(ricci.MeshError):
        ricci.load("empty.off")
