"""Result files: what the command line wrote is read, what was read is written."""

import gc
import shutil

import h5py
import numpy as np
import pytest

import ricci
from conftest import assert_same_results


@pytest.fixture
def written(run_ricci):
    """A file with two items, one of which is a failure."""
    run_ricci("generate", "eight", "--faces", 800, "-o", "eight.off", "-q")
    run_ricci("sweep", "eight.off", "--vertices", "sample:20", "--resolutions", "500,input", "-o", "sweep.h5", "-q")
    return "sweep.h5"


def test_reads_what_the_command_line_wrote(written):
    run = ricci.read(written)
    with h5py.File(written) as file:
        assert [item.name for item in run] == list(file["items"])
        for item in run:
            group = file["items"][item.name]
            for name in ("vertex", "area_distortion", "residual_max", "flips"):
                assert np.array_equal(getattr(item.sweep, name), group["sweep"][name][()])
            assert np.array_equal(item.mesh.points, group["mesh/points"][()])
            assert np.array_equal(item.mesh.triangles, group["mesh/triangles"][()])
            assert np.array_equal(item.sweep.best.conformal_factor, group["sweep/best/conformal_factor"][()])
        assert run.info["config"] == file.attrs["config"] and run.complete
    assert run[run[1].name] is run[1] and len(run) == 2
    with pytest.raises(KeyError):
        run["no such item"]


def test_writes_what_it_read(written, run_ricci):
    ricci.read(written).save("copy.h5")
    assert_same_results(written, "copy.h5")
    run_ricci("verify", "--recompute", "copy.h5")
    ricci.read("copy.h5").save("again.h5")
    assert_same_results(written, "again.h5")


def test_every_kind_of_result_goes_round(run_ricci):
    mesh = ricci.generate("eight", faces=700)
    results = [
        ricci.layout(mesh, quality=True),
        ricci.spectrum(mesh, max_length=2.5),
        ricci.teichmuller(mesh),
        ricci.sweep(mesh, vertices="sample:6", keep=2),
    ]
    ricci.save("all.h5", *results)
    run_ricci("verify", "--recompute", "all.h5")
    run = ricci.read("all.h5")
    assert len(run) == 1
    item = run[0]
    assert item.kinds == ["layout", "quality", "spectrum", "teichmuller"]
    assert np.array_equal(item.layout.position, results[0].position)
    assert [g.word for g in item.layout.generators] == [g.word for g in results[0].generators]
    assert np.array_equal(item.flow.conformal_factor, results[0].flow.conformal_factor)
    assert np.array_equal(item.spectrum.lengths, results[1].lengths)
    assert np.array_equal(item.teichmuller.coordinates, results[2].coordinates)
    assert np.array_equal(item.sweep.area_distortion, results[3].area_distortion)
    assert [k.vertex for k in item.sweep.kept] == [k.vertex for k in results[3].kept]
    assert item.result("quality").attributes == results[0].quality.attributes
    run.save("round.h5")
    assert_same_results("all.h5", "round.h5")
    item.layout.save_uv("uv.obj")


def test_meshes_of_one_name_are_told_apart():
    a, b = ricci.generate("torus", faces=300), ricci.generate("torus", faces=300, jitter=0.1)
    ricci.save("both.h5", ricci.flow(a), ricci.flow(b), ricci.flow(a, target="uniform"))
    names = [item.name for item in ricci.read("both.h5")]
    first = f"torus@{a.faces}"
    assert names == [first, f"{first}~2", f"{first}~3"]
    with pytest.raises(ValueError, match="nothing"):
        ricci.save("none.h5")
    eight = ricci.generate("eight", faces=500)
    with pytest.raises(ValueError, match="keep"):
        ricci.save("x.h5", ricci.sweep(eight, vertices=[3]), ricci.sweep(eight, vertices=[4], keep="none"))


def test_failures_are_written():
    mesh = ricci.generate("eight", faces=500)
    ricci.save("failed.h5", ricci.flow(mesh, max_iterations=1))
    run = ricci.read("failed.h5")
    assert run[0].flow.status == "max_iterations"
    assert [(f.stage, f.status) for f in run.failures] == [("flow", "max_iterations")]
    assert run[0].flow.message == run.failures[0].message


def test_views_of_a_file_outlive_the_run(written):
    factor = ricci.read(written)[0].sweep.best.conformal_factor
    gc.collect()
    with h5py.File(written) as file:
        assert np.array_equal(factor, next(iter(file["items"].values()))["sweep/best/conformal_factor"][()])


def test_damage_is_found(written):
    shutil.copy(written, "damaged.h5")
    with h5py.File("damaged.h5", "r+") as file:
        next(iter(file["items"].values()))["sweep/area_distortion"][0] = 0.5
    report = ricci.verify("damaged.h5")
    assert not report.sound and any("area_distortion" in c for c in report.complaints)
    with pytest.raises(ricci.FileError):
        ricci.read("damaged.h5")
    with open("text.h5", "w") as file:
        file.write("no HDF5")
    assert not ricci.verify("text.h5").sound
    with pytest.raises(ricci.FileError, match="text.h5"):
        ricci.read("text.h5")


def test_wrong_solution_is_found(run_ricci):
    """A residual that lies is found by recomputation."""
    mesh = ricci.generate("eight", faces=500)
    ricci.flow(mesh, cones={0: "-4pi"}).save("flow.h5")
    sound = ricci.verify("flow.h5", recompute=True)
    assert sound.sound and len(sound.recomputed) == 1 and sound.recomputed[0].residual_recomputed < 1e-9
