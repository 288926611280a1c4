"""Sweeps: the bits of the command line, files, what is kept, failures."""

import gc
import os

import numpy as np
import pytest

import ricci
from conftest import assert_same_results


@pytest.fixture(scope="module")
def eight():
    return ricci.generate("eight", faces=800)


@pytest.mark.parametrize("threads", [1, 2, 3])
def test_same_bits_as_the_command_line(run_ricci, threads):
    """From a file, from a mesh, from arrays; in memory and through an output."""
    run_ricci("generate", "eight", "--faces", 800, "-o", "eight.off", "-q")
    run_ricci("sweep", "eight.off", "--vertices", "sample:90:3", "--keep", 3, "-o", "program.h5", "-q")
    options = {"vertices": "sample:90:3", "keep": 3, "threads": threads}
    run = ricci.sweep("eight.off", output="direct.h5", **options)
    assert_same_results("program.h5", "direct.h5")
    run.save("saved.h5")
    assert_same_results("program.h5", "saved.h5")
    mesh = ricci.load("eight.off")
    result = ricci.sweep(mesh, **options)
    result.save("memory.h5")
    assert_same_results("program.h5", "memory.h5")
    arrays = ricci.Mesh(mesh.points.copy(), mesh.triangles.copy(), name="eight")
    ricci.sweep(arrays, output="arrays.h5", **options)
    assert_same_results("program.h5", "arrays.h5", without_attributes=("source", "source_hash"))
    assert np.array_equal(run[0].sweep.area_distortion, result.area_distortion)
    assert result.mesh is mesh


def test_columns_are_views_of_one_table(eight):
    result = ricci.sweep(eight, vertices="sample:40")
    names = ["vertex", "status_code", "area_distortion", "newton_iterations", "residual_max", "flips", "seconds",
             "gauss_bonnet_error", "precision_digits"]  # fmt: skip
    columns = {name: getattr(result, name) for name in names}
    for name, column in columns.items():
        assert column.shape == (40,) and not column.flags.writeable and not column.flags.owndata
        assert np.shares_memory(column, getattr(result, name)), name
    assert columns["vertex"].dtype == np.int32 and columns["newton_iterations"].dtype == np.uint16
    assert np.all(np.diff(columns["vertex"]) > 0)
    kept = {name: column.copy() for name, column in columns.items()}
    best = result.best.conformal_factor
    factor = best.copy()
    del result
    gc.collect()
    assert all(np.array_equal(columns[name], kept[name]) for name in names)
    assert np.array_equal(best, factor)


def test_extremes_and_what_is_kept(eight):
    result = ricci.sweep(eight, vertices="sample:60", keep="all")
    distortion = result.area_distortion
    assert set(result.statuses) == {"converged"} and result.status == "converged"
    assert result.best.vertex == result.vertex[np.argmin(distortion)]
    assert result.best.area_distortion == distortion.min()
    assert result.worst.vertex == result.vertex[np.argmax(distortion)]
    assert len(result.kept) == 60
    order = [k.area_distortion for k in result.kept[2:]]
    assert order == sorted(order)
    one = ricci.flow(eight, cones={result.best.vertex: "-4pi"})
    # Both solve one problem, up to scale, to 1e-10 in curvature.
    difference = one.conformal_factor - result.best.conformal_factor
    assert np.ptp(difference) < 1e-7
    assert ricci.sweep(eight, vertices="sample:5", keep="none").best is None
    values = result.at_vertices()
    assert np.array_equal(values[result.vertex], distortion) and np.isnan(values).sum() == eight.vertices - 60
    assert np.array_equal(result.at_vertices("flips")[result.vertex], result.flips)


def test_vertices_by_number(eight):
    result = ricci.sweep(eight, vertices=np.array([30, 4, 17, 4]))
    assert result.vertex.tolist() == [4, 17, 30]
    with open("vertices.txt", "w") as file:
        file.write("30\n4\n17\n")
    from_file = ricci.sweep(eight, vertices="vertices.txt")
    assert np.array_equal(from_file.area_distortion, result.area_distortion)
    outside = ricci.sweep([eight], vertices=[10**6])
    assert outside[0].sweep is None and outside.failures[0].status == "invalid_input"


def test_several_meshes_and_resolutions(run_ricci, eight):
    eight.save("a.off")
    torus = ricci.generate("torus", faces=300)
    torus.save("b.off")
    run_ricci("generate", "genus-g", "--genus", 3, "--faces", 700, "-o", "c.off", "-q")
    arguments = ["a.off", "c.off", "--vertices", "sample:12", "--resolutions", "400,input", "-o", "program.h5", "-q"]
    run_ricci("sweep", *arguments)
    run = ricci.sweep(["a.off", ricci.load("c.off")], vertices="sample:12", resolutions=[400, "input"])
    assert len(run) == 4 and [item.name.split("@")[0] for item in run] == ["a", "a", "c", "c"]
    run.save("memory.h5")
    assert_same_results("program.h5", "memory.h5")
    assert run[0].mesh.faces == 400 and len(run[0].source_vertex) == len(run[0].mesh.input_vertex)


def test_failures_are_recorded_and_the_rest_goes_on(eight):
    eight.save("a.off")
    ricci.generate("torus", faces=300).save("torus.off")
    with open("broken.off", "w") as file:
        file.write("OFF\n3 1 0\n0 0 0\n1 0 0\n")
    run = ricci.sweep(["broken.off", "a.off", "torus.off", "missing.off"], vertices="sample:4")
    assert [item.name for item in run] == [f"a@{eight.faces}", run[1].name]
    assert {(f.item.split("@")[0], f.stage, f.status) for f in run.failures} == {
        ("broken", "load", "invalid_input"),
        ("torus", "sweep", "inadmissible_target"),
        ("missing", "load", "invalid_input"),
    }
    alone = ricci.sweep(ricci.load("torus.off"))
    assert alone.status == "inadmissible_target" and len(alone.vertex) == 0 and "no cone" in alone.message
    assert alone.best is None


@pytest.mark.parametrize("options", [
    {"vertices": "some"}, {"vertices": "sample:0"}, {"vertices": []}, {"keep": "most"}, {"keep": -1},
    {"resolutions": [3]}, {"resolutions": [400, "input"]}, {"resolutions": []}, {"scheme": "x"}, {"lanes": 17},
    {"solver": "x"}, {"boundary": "curvature"}, {"cone_curvature": "x"}, {"tolerance": -1.0}, {"threads": 5000},
    {"max_memory": "much"}, {"timeout": -1.0}, {"resume": True}, {"repair": "x"},
])  # fmt: skip
def test_options_that_there_are_not(eight, options):
    with pytest.raises((ValueError, ricci.FileError)):
        ricci.sweep(eight, **options)


def test_output_that_cannot_be_written(eight):
    with open("file", "w"):
        pass
    with pytest.raises(ricci.FileError, match="file"):
        ricci.sweep(eight, vertices="sample:2", output="file/y.h5")


def test_output_of_other_options_is_not_resumed(eight):
    def stop(progress):
        if progress.solves_done > 0:
            raise RuntimeError("enough")

    with pytest.raises(RuntimeError):
        ricci.sweep(eight, output="x.h5", progress=stop)
    with pytest.raises(ValueError):
        ricci.sweep(eight, vertices="sample:3", output="x.h5", resume=True)


def test_config(eight):
    eight.save("eight.off")
    with open("sweep.toml", "w") as file:
        file.write('[input]\nmeshes = ["eight.off"]\n[sweep]\nvertices = "sample:5"\n[run]\noutput = "c.h5"\n')
    config = ricci.read_config("sweep.toml")
    run = ricci.sweep(config.pop("mesh"), **config)
    assert len(run[0].sweep.vertex) == 5 and os.path.exists("c.h5")
    with open("bad.toml", "w") as file:
        file.write("[sweep]\nvertexes = 1\n")
    with pytest.raises(ValueError, match="bad.toml:2"):
        ricci.read_config("bad.toml")
