"""Layouts, spectra, coordinates: the results of the command line, and what they mean."""

import json

import numpy as np
import pytest

import ricci
from conftest import assert_same_results


@pytest.fixture(scope="module")
def eight():
    return ricci.generate("eight", faces=800)


def test_layout_of_the_command_line(eight, run_ricci):
    eight.save("eight.off")
    run_ricci("layout", "eight.off", "-o", "program.h5", "--copies", 50, "--quality", "--atlas", "auto",
              "--uv", "program.obj", "--checker", 8)  # fmt: skip
    layout = ricci.layout(ricci.load("eight.off"), copies=50, quality=True, atlas="auto")
    layout.save("module.h5")
    assert_same_results("program.h5", "module.h5")
    layout.save_uv("module.obj", checker=8)
    with open("program.obj") as a, open("module.obj") as b:
        assert a.read().replace("program.mtl", "") == b.read().replace("module.mtl", "")
    layout.export("domain.svg")
    layout.export("copies.svg", picture="tessellation", model="klein")
    layout.export("angles.svg", picture="angles")
    layout.export("eight.vtu")
    with pytest.raises(ValueError, match="picture"):
        layout.export("x.svg", picture="nothing")
    with pytest.raises(ValueError, match="export writes"):
        layout.export("x.pdf")


def test_layout_is_a_structure(eight):
    layout = ricci.layout(eight)
    assert layout.status == "converged" and layout.geometry == "hyperbolic"
    assert layout.relator_error < 1e-10 and layout.closing_error < 1e-10 and layout.flipped_pieces == 0
    assert [g.name for g in layout.generators] == ["a1", "b1", "a2", "b2"]
    for g in layout.generators:
        assert g.matrix.shape == (2, 2) and np.isclose(np.linalg.det(g.matrix), 1)
        assert abs(np.trace(g.matrix)) > 2  # hyperbolic
        assert g.path[0] in range(eight.vertices)
    product = np.eye(2)
    for a, b in ((0, 1), (2, 3)):
        x, y = layout.generators[a].matrix, layout.generators[b].matrix
        product = product @ x @ y @ np.linalg.inv(x) @ np.linalg.inv(y)
    assert min(np.abs(product - np.eye(2)).max(), np.abs(product + np.eye(2)).max()) < 1e-6
    x, y, t = layout.position.T
    assert np.allclose(t * t - x * x - y * y, 1) and np.all(np.hypot(*layout.conformal.T) < 1)
    assert layout.piece_first[-1] == len(layout.corner_vertex)
    assert layout.corner_vertex.max() < len(layout.position)
    assert np.shares_memory(layout.position, layout.position) and not layout.position.flags.writeable
    assert layout.quality is None and layout.atlas is None and len(layout.copies) == 0
    assert layout.flow.status == "converged"
    with pytest.raises(KeyError, match="copies/element"):
        layout["copies/element"]


def test_failed_layout_says_so(eight):
    layout = ricci.layout(eight, max_iterations=1)
    assert layout.status == "max_iterations" and layout.generators == [] and np.isnan(layout.relator_error)
    with pytest.raises(KeyError, match="max_iterations"):
        _ = layout.position
    with pytest.raises(ValueError):
        ricci.layout(eight, digits=1000)
    with pytest.raises(ValueError):
        ricci.layout(eight, base=10**7)
    with pytest.raises(ValueError):
        ricci.layout(eight, atlas="x")


def test_spectrum_of_the_command_line(eight, run_ricci):
    eight.save("eight.off")
    run_ricci("spectrum", "eight.off", "--max-length", 3, "-o", "program.h5")
    spectrum = ricci.spectrum(ricci.load("eight.off"), max_length=3, draw=0)
    spectrum.save("module.h5")
    assert_same_results("program.h5", "module.h5")
    assert spectrum.complete_up_to == 3 and np.all(np.diff(spectrum.lengths) >= 0)
    for length, power, k in zip(spectrum.lengths, spectrum.power, spectrum.geodesic):
        assert np.isclose(length, power * spectrum.geodesics[k].length)
    drawn = spectrum.geodesics[0].points
    assert drawn.shape[1] == 3 and len(drawn) > 3 and np.shares_memory(drawn, spectrum["geodesics/points"])
    assert len(ricci.spectrum(eight, count=5, words=False).lengths) >= 5
    with pytest.raises(ValueError, match="no length spectrum"):
        ricci.spectrum(ricci.generate("sphere", faces=100))
    with pytest.raises(ValueError):
        ricci.spectrum(eight, max_length=0)


def test_coordinates_of_the_command_line(eight, run_ricci):
    eight.save("eight.off")
    run_ricci("teichmuller", "eight.off", "-o", "program.h5")
    t = ricci.teichmuller(ricci.load("eight.off"))
    t.save("module.h5")
    assert_same_results("program.h5", "module.h5")
    assert len(t.coordinates) == 6 * 2 - 5 and t.names == [c.name for c in t.curves]
    assert np.array_equal(t.coordinates, [c.length for c in t.curves])
    assert t.fenchel_nielsen and t.marking == "geometric" and t.smallest_gap > 0
    with pytest.raises(ValueError, match="neither a torus"):
        _ = t.modulus
    drawn = ricci.teichmuller(eight, draw=True)
    assert all(len(c.points) > 3 for c in drawn.curves)


def test_torus_of_known_modulus():
    torus = ricci.generate("torus", faces=4000, major=2.0, minor=1.0)
    assert abs(ricci.teichmuller(torus).modulus - 1j * np.sqrt(3)) < 0.01
    spectrum = ricci.spectrum(torus, max_length=2)
    assert np.isclose(spectrum.lengths[0], 1) and "shortest" in spectrum.unit
    annulus = ricci.generate("annulus", faces=1000, height=0.5)
    assert abs(ricci.teichmuller(annulus).modulus.imag) == 0


def test_given_curves(eight):
    layout = ricci.layout(eight)
    paths = {g.name: g.path.tolist() for g in layout.generators}
    given = ricci.teichmuller(eight, marking=paths)
    assert given.marking == "curves" and given.names == ["a1", "b1", "a2", "b2"]
    for g, length in zip(layout.generators, given.coordinates):
        assert np.isclose(2 * np.arccosh(abs(np.trace(g.matrix)) / 2), length)
    loops = ricci.teichmuller(eight, loops={"x": paths["a1"]}).loops
    assert loops[0].name == "x" and np.isclose(loops[0].length, given.coordinates[0])
    with pytest.raises(ValueError, match="curve y"):
        ricci.teichmuller(eight, loops={"y": [0, eight.vertices - 1]})


def test_json_agrees(eight, run_ricci):
    eight.save("eight.off")
    reported = json.loads(run_ricci("layout", "eight.off", "--json"))
    layout = ricci.layout(ricci.load("eight.off"))
    assert layout.relator == reported["relator"]
    for g, other in zip(layout.generators, reported["generators"]):
        assert (g.name, g.word) == (other["name"], other["word"]) and np.array_equal(g.matrix, other["matrix"])
