"""The index of shapes."""

import json

import numpy as np
import pytest

import ricci


@pytest.fixture
def shapes(tmp_path):
    folder = tmp_path / "shapes"
    folder.mkdir()
    for faces in (700, 1000):
        ricci.generate("eight", faces=faces).save(folder / f"eight{faces}.off")
    ricci.generate("bolza", faces=900).save(folder / "other.len")
    for major in (1.5, 3.0):
        ricci.generate("torus", faces=600, major=major).save(folder / f"torus{major}.off")
    return folder


def test_build_and_query(shapes, run_ricci):
    seen = []
    index = ricci.Index.build("shapes.h5", shapes, max_length=3.0, progress=seen.append)
    assert index.types == {"g1b0": 2, "g2b0": 3} and len(index) == 5
    assert seen[-1].solves_done == 5
    assert {b.status for b in index.built} == {"converged"} and not any(b.reused for b in index.built)
    near = index.query(shapes / "eight700.off", k=3)
    assert near[0].file.endswith("eight700.off") and near[0].distance == 0
    assert near[1].file.endswith("eight1000.off")
    reported = json.loads(run_ricci("index", "query", "shapes.h5", shapes / "eight700.off", "-k", 3, "--json"))
    assert [(n.file, n.distance) for n in near] == [(n["file"], n["distance"]) for n in reported["neighbours"]]
    by_mesh = index.query(ricci.load(shapes / "eight700.off"), k=3)
    assert [n.file for n in by_mesh] == [n.file for n in near] and by_mesh[0].distance < 1e-12
    assert not any("eight700" in n.file for n in index.query(shapes / "eight700.off", others=True))
    assert index.query(ricci.generate("sphere", faces=300)) == []


def test_same_index_as_the_command_line(shapes, run_ricci):
    run_ricci("index", "build", shapes, "-o", "program.h5", "--max-length", 3)
    ricci.Index.build("module.h5", shapes, max_length=3)
    a, b = ricci.Index("program.h5"), ricci.Index("module.h5")
    for x, y in zip(a.entries, b.entries):
        assert x.file == y.file and np.array_equal(x.fingerprint, y.fingerprint)
        assert np.array_equal(x.coordinates, y.coordinates) and np.array_equal(x.lengths, y.lengths)
    assert a.config == b.config


def test_add_and_remove(shapes):
    index = ricci.Index.build("shapes.h5", shapes / "eight700.off", max_length=2.5)
    index.add([shapes / "eight1000.off", shapes / "eight700.off"])
    assert len(index) == 2 and [b.reused for b in index.built] == [True, False] or len(index.built) == 2
    entry = index.entries[0]
    assert (entry.genus, entry.boundaries) == (2, 0) and len(entry.names) == len(entry.coordinates) == 7
    assert not entry.fingerprint.flags.writeable
    assert index.remove("*eight1000*") == 1 and len(index) == 1
    with pytest.raises(KeyError, match="nothing at"):
        index.remove("no such shape")


def test_failures_and_mistakes(shapes):
    (shapes / "broken.off").write_text("OFF\n1 1 0\n")
    index = ricci.Index.build("shapes.h5", [shapes / "broken.off", shapes / "torus1.5.off"])
    assert [f.stage for f in index.failures] == ["load"] and len(index) == 1
    with pytest.raises(ValueError, match="could not be described"):
        index.query(shapes / "broken.off")
    with pytest.raises(ricci.FileError):
        ricci.Index("missing.h5")
    with pytest.raises(ValueError):
        index.query(shapes / "torus1.5.off", metric="x")
    with pytest.raises(ValueError):
        ricci.Index.build("x.h5", shapes, scheme="x")
    with pytest.raises(ValueError):
        index.distances("genus 2")


def test_distances(shapes):
    index = ricci.Index.build("shapes.h5", shapes, max_length=2.5)
    d = index.distances("g2b0", clusters=2)
    assert d.distance.shape == (3, 3) and np.array_equal(d.distance, d.distance.T)
    assert np.all(np.diag(d.distance) == 0) and len(d.merges) == 2 and sorted(d.leaf_order) == [0, 1, 2]
    by_name = {name.rsplit("/")[-1]: cluster for name, cluster in zip(d.names, d.cluster)}
    assert by_name["eight700.off"] == by_name["eight1000.off"] != by_name["other.len"]
