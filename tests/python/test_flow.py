"""Flows: the numbers of the command line, views, options."""

import gc
import json

import numpy as np
import pytest

import ricci
from conftest import assert_same_results


@pytest.fixture(scope="module")
def eight():
    return ricci.generate("eight", faces=1200)


def test_same_bits_as_the_command_line(eight, run_ricci):
    eight.save("eight.off")
    run_ricci("flow", "eight.off", "--cone=0:-2pi", "--cone=99:-2pi", "-o", "program.h5")
    mesh = ricci.load("eight.off")
    for threads in (1, 2, 3):
        result = ricci.flow(mesh, cones={0: -2 * np.pi, 99: "-2pi"}, threads=threads)
        assert result.status == "converged" and result.residual_max <= 1e-10
        result.save(f"module{threads}.h5")
        assert_same_results("program.h5", f"module{threads}.h5")


def test_curvature_and_gauss_bonnet(eight):
    result = ricci.flow(eight, cones=["7:-4pi"])
    assert result.geometry == "euclidean"
    assert np.isclose(result.curvature.sum(), 2 * np.pi * eight.euler_characteristic, atol=1e-8)
    assert abs(result.curvature[7] + 4 * np.pi) <= 1e-10
    assert np.abs(np.delete(result.curvature, 7)).max() <= 1e-10
    assert abs(result.log["residual_max"][-1] - result.residual_max) < 1e-11  # measured again at the end
    assert len(result.log["flips"]) == len(result.log["step"])
    assert result.area > 0


def test_target_array_is_a_target_file(eight):
    # The curvature of a known metric is a target that is reached by it, up to scale.
    u = 0.1 * np.sin(np.arange(len(eight.input_vertex)))
    target = ricci.flow(eight, target="uniform", geometry="euclidean").target_curvature * (1 + u - u.mean())
    target = target * (2 * np.pi * eight.euler_characteristic / target.sum())
    np.savetxt("target.txt", target, fmt="%.17g")
    from_array = ricci.flow(eight, target=target, geometry="euclidean")
    from_file = ricci.flow(eight, target="target.txt", geometry="euclidean")
    assert from_array.status == "converged"
    assert np.array_equal(from_array.conformal_factor, from_file.conformal_factor)
    assert np.abs(from_array.curvature - target).max() <= 1e-10


def test_views(eight):
    result = ricci.flow(eight)
    factor = result.conformal_factor
    assert np.shares_memory(factor, result.conformal_factor)
    assert np.shares_memory(result.triangles, result.triangles)
    assert not factor.flags.writeable and not factor.flags.owndata
    with pytest.raises(ValueError):
        factor[0] = 1
    with pytest.raises(ValueError):
        factor.flags.writeable = True
    kept = factor.copy()
    del result
    gc.collect()
    _ = [np.ones(factor.size) for _ in range(50)]  # would lie where the freed memory was
    assert np.array_equal(factor, kept)


def test_view_of_a_result_that_nobody_holds(eight):
    factor = ricci.flow(eight).conformal_factor
    gc.collect()
    assert np.array_equal(factor, ricci.flow(eight).conformal_factor)


def test_numerical_outcomes_are_a_status(eight):
    result = ricci.flow(eight, max_iterations=1)
    assert result.status == "max_iterations" and len(result.conformal_factor) == eight.vertices
    result = ricci.flow(eight, cones={0: 7.0})  # above 2 pi
    assert result.status == "inadmissible_target" and "2 pi" in result.message
    assert ricci.flow(eight, timeout=1e-9).status == "timeout"


@pytest.mark.parametrize("options", [
    {"geometry": "flat"}, {"scheme": "x"}, {"method": "x"}, {"cones": {0: "x"}}, {"cones": {10**7: 1.0}},
    {"target": "missing.txt"}, {"target": np.zeros(3)}, {"target": np.zeros((2, 2))}, {"target": [np.nan]},
    {"tolerance": 0}, {"tolerance": np.nan}, {"max_iterations": -1}, {"timeout": -1}, {"densify": True},
    {"boundary": "x"}, {"delaunay": "x"}, {"precision": "x"}, {"sphere": "x"}, {"cones": {0: float("inf")}},
])  # fmt: skip
def test_options_that_there_are_not(eight, options):
    with pytest.raises((ValueError, ricci.FileError)):
        ricci.flow(eight, **options)
    with pytest.raises(TypeError):
        ricci.flow(eight, no_such_option=1)


def test_circle_packing(eight, run_ricci):
    eight.save("eight.off")
    out = run_ricci("flow", "eight.off", "--scheme", "inversive-distance", "--geometry", "hyperbolic", "--json")
    result = ricci.flow(ricci.load("eight.off"), scheme="inversive-distance", geometry="hyperbolic")
    reported = json.loads(out)
    assert result.status == reported["status"] == "converged"
    assert result.residual_max == reported["residual_max"]
    assert result.packing_length_error[0] == reported["packing"]["max_length_error"]
