"""Pages of `ricci report` in a headless browser without network: nothing is asked of anyone, nothing goes wrong, what
is shown is what the file holds, and it looks as somebody once found that it should look (expected/).

To renew the pictures after a change: RICCI_RENEW_PICTURES=1 pytest tests/report, then look at each of them.
"""
import json
import os
import pathlib
import re

import h5py
import numpy
import pytest
from PIL import Image

EXPECTED = pathlib.Path(__file__).parent / "expected"
KINDS = ["sweep", "failures", "flow", "stopped", "structure", "torus", "ball", "intrinsic", "spectrum", "coordinates",
         "index", "distances", "paths"]
VIEWED = ["sweep", "failures", "flow", "stopped", "structure", "torus", "ball", "spectrum", "coordinates"]


def ink(pixels):
    """Share of pixels that are not the background."""
    return float(numpy.mean(numpy.any(numpy.asarray(pixels) < 245, axis=-1)))


def compare(picture, name):
    """Whether a picture looks like the one expected: as 64 squares across, in colours that differ by less than what
    fonts and rasterisers change."""
    file = EXPECTED / f"{name}.png"
    small = picture.resize((360, round(360 * picture.height / picture.width)), Image.LANCZOS)
    if os.environ.get("RICCI_RENEW_PICTURES"):
        small.quantize(200, dither=Image.Dither.NONE).save(file, optimize=True)
    expected = Image.open(file).convert("RGB")
    assert abs(small.height - expected.height) <= 12, f"{name}: another shape"
    size = (64, max(1, 64 * expected.height // expected.width))
    a, b = (numpy.asarray(p.resize(size, Image.BOX), dtype=float) for p in (small, expected))
    difference = numpy.abs(a - b).mean(axis=-1)
    assert difference.mean() < 4.0 and numpy.quantile(difference, 0.98) < 48.0, (
        f"{name}: differs from {file.name} by {difference.mean():.1f} on average, "
        f"{numpy.quantile(difference, 0.98):.0f} at its worst places")


def test_a_page_is_one_file_that_names_no_other(results):
    for kind in KINDS:
        text = results.page(kind).read_text()
        assert len(text) < 10_000_000, kind
        body = text[:text.index("<script")]
        assert not re.search(r'(?:src|href|action|data)\s*=\s*"(?!#)', body), kind
        assert "@import" not in body and not re.search(r"url\((?!#)", body), kind
        assert "Content-Security-Policy" in body


@pytest.mark.parametrize("kind", KINDS)
def test_nothing_goes_wrong_and_nothing_is_asked_for(results, browser, kind):
    page = results.page(kind)
    browser.open(page)
    views = browser.run("return document.querySelectorAll('figure.view').length;")
    assert (views > 0) == (kind in VIEWED)
    for k in range(views):
        assert ink(browser.pixels(k)) > 0.03, f"view {k} is empty"
    browser.run("for (const d of document.querySelectorAll('details')) d.open = true;")
    browser.run("for (const b of document.querySelectorAll('[role=tab]')) b.click();")
    browser.show("body")
    console, requests = browser.messages()
    assert console == []
    assert [r for r in requests if r != page.resolve().as_uri() and not r.startswith(("data:", "blob:"))] == []


def readout(browser, number=0):
    pairs = browser.run("return [...document.querySelectorAll('figure.view')[arguments[0]].querySelectorAll('.readout div')]"
                        ".map((d) => [d.children[0].textContent, d.children[1].textContent]);", number)
    return dict(pairs)


def click_middle(browser, number=0):
    """Clicks the view as a hand does, at the surface's point nearest to the middle."""
    pixels = browser.pixels(number)
    rows, columns = numpy.nonzero(numpy.any(pixels < 235, axis=-1))
    height, width = pixels.shape[:2]
    best = numpy.argmin((rows - height / 2) ** 2 + (columns - width / 2) ** 2)
    box = browser.run("const b = document.querySelectorAll('figure.view canvas')[arguments[0]].getBoundingClientRect();"
                      "return [b.left, b.top, b.width, b.height];", number)
    x, y = box[0] + columns[best] * box[2] / width, box[1] + rows[best] * box[3] / height
    for kind in ("mousePressed", "mouseReleased"):
        browser.driver.execute_cdp_cmd("Input.dispatchMouseEvent", {
            "type": kind, "x": float(x), "y": float(y), "button": "left", "clickCount": 1})


def test_a_click_on_a_vertex_shows_its_row(results, browser):
    browser.open(results.page("sweep"))
    with h5py.File(results.file("sweep")) as file:
        items = list(file["items"])
        for number, item in enumerate(items):
            click_middle(browser, number)
            shown = readout(browser, number)
            vertex = int(shown["vertex"])
            sweep = file["items"][item]["sweep"]
            rows = list(sweep["vertex"][:])
            for v in (vertex, int(sweep["best/vertex"][()]), int(sweep["worst/vertex"][()]), rows[3]):
                browser.run("const f = document.querySelectorAll('figure.view')[arguments[0]]; f.view.pickVertex(arguments[1]);",
                            number, int(v))
                shown, k = readout(browser, number), rows.index(v)
                assert int(shown["vertex"]) == v
                assert shown["status"] == "converged"
                assert float(shown["area distortion"]) == pytest.approx(sweep["area_distortion"][k], rel=1e-5)
                assert int(shown["Newton iterations"]) == sweep["newton_iterations"][k]
                assert float(shown["residual"]) == pytest.approx(sweep["residual_max"][k], rel=1e-5)
                assert int(shown["flips"]) == sweep["flips"][k]
                factor = sweep["best/conformal_factor"][v]
                assert float(shown["u of best, log of the scale factor"]) == pytest.approx(factor, rel=1e-4, abs=1e-5)


def test_a_vertex_without_a_row_says_so(results, browser):
    browser.open(results.page("failures"))
    browser.show("figure.view", 0)
    titles = browser.run("return [...document.querySelectorAll('figure.view')].map((f) => f.view ? f.view.d.title : '');")
    number = next(k for k, title in enumerate(titles) if title.startswith("eight"))
    with h5py.File(results.file("failures")) as file:
        rows = set(file["items"][titles[number]]["sweep/vertex"][:].tolist())
    v = next(v for v in range(100) if v not in rows)
    browser.show("figure.view", number)
    browser.run("document.querySelectorAll('figure.view')[arguments[0]].view.pickVertex(arguments[1]);", number, v)
    shown = readout(browser, number)
    assert shown["status"] == "no row" and shown["area distortion"] == "\u2013"


def test_a_flow_shows_its_metric(results, browser):
    browser.open(results.page("flow"))
    click_middle(browser)
    shown = readout(browser)
    with h5py.File(results.file("flow")) as file:
        flow = next(iter(file["items"].values()))["flow"]
        v = int(shown["vertex"])
        assert float(shown["u, log of the scale factor"]) == pytest.approx(flow["conformal_factor"][v], rel=1e-4, abs=1e-5)
    assert browser.run("return document.querySelectorAll('svg').length;") >= 3


def test_the_view_and_the_domain_are_linked(results, browser):
    browser.open(results.page("structure"))
    browser.show("figure.view")
    browser.run("document.querySelector('figure.view').view.pickVertex(10);")
    spots = browser.run("return [...document.querySelectorAll('figure[data-link]')].map((f) => f.querySelectorAll('.spot').length);")
    assert len(spots) >= 2 and all(n >= 1 for n in spots)
    # From the spot in the Klein disk back to the same vertex.
    browser.run("document.querySelector('figure.view').view.pickVertex(20);")
    for which in range(2):
        vertex = browser.run("""
            const figure = document.querySelectorAll('figure[data-link]')[arguments[0]], svg = figure.querySelector('svg');
            figure.parentNode.querySelectorAll('[role=tab]')[arguments[0]].click();
            figure.scrollIntoView({block: 'center', behavior: 'instant'});
            const spot = svg.querySelector('.spot'), box = svg.getBoundingClientRect(), frame = svg.viewBox.baseVal;
            document.querySelector('figure.view').view.pickVertex(10);
            svg.dispatchEvent(new MouseEvent('click', {bubbles: true,
                clientX: box.left + spot.cx.baseVal.value * box.width / frame.width,
                clientY: box.top + spot.cy.baseVal.value * box.height / frame.height}));
            return document.querySelector('figure.view').dataset.vertex;""", which)
        assert vertex == "20"
    sides = browser.run("""
        const view = document.querySelector('figure.view').view, colours = new Set();
        for (const c of view.curves.filter((c) => c.curve.link)) {
            view.light(c, true, true);
            const lit = document.querySelectorAll('svg .lit');
            if (lit.length < 2 || lit.length % 2) return 'unlinked ' + c.curve.name;
            for (const side of lit) {
                const rgb = getComputedStyle(side).stroke.match(/\\d+/g).map((x) => Number(x).toString(16).padStart(2, '0')).join('');
                if ('#' + rgb !== c.curve.colour && '#' + [...rgb].filter((x, i) => i % 2).join('') !== c.curve.colour) return c.curve.colour + ' ' + rgb;
            }
            view.light(c, false, true);
        }
        return view.curves.length;""")
    assert sides >= 4
    hidden = browser.run("return document.querySelector('figure.view').view.curves.filter((c) => !c.line.visible).map((c) => c.curve.name);")
    assert hidden == ["generator a1", "generator b1", "generator a2", "generator b2"]


def test_the_keyboard_turns_and_zooms(results, browser):
    browser.open(results.page("torus"))
    before = browser.pixels().astype(int)
    for key, changed in (("ArrowLeft", True), ("+", True), ("r", False)):
        browser.run("""const canvas = document.querySelector('figure.view canvas');
            canvas.focus(); canvas.dispatchEvent(new KeyboardEvent('keydown', {key: arguments[0], bubbles: true}));""", key)
        difference = numpy.mean(numpy.abs(browser.pixels() - before))
        assert difference > 1.0 if changed else difference < 0.3, (key, difference)


def test_a_decimated_view_says_so_and_keeps_the_numbers(results, browser):
    browser.open(results.page("flow", "--view-faces", 300))
    click_middle(browser)
    assert "nearest vertex" in readout(browser)
    page = results.page("sweep", "--view-faces", 300)
    assert "Decimated for viewing only" in page.read_text()
    browser.open(page)
    browser.show("figure.view")
    browser.run("[...document.querySelectorAll('.tools button')].find((b) => b.textContent === 'best').click();")
    with h5py.File(results.file("sweep")) as file:
        sweep = file["items"][browser.run("return document.querySelector('figure.view').view.d.title;")]["sweep"]
        shown = readout(browser)  # the best one is at hand itself
        assert int(shown["vertex"]) == int(sweep["best/vertex"][()])
        assert float(shown["area distortion"]) == pytest.approx(sweep["best/area_distortion"][()], rel=1e-5)


def test_a_sample_of_a_decimated_surface_is_all_there(results, browser):
    browser.open(results.page("failures", "--view-faces", 200))
    number = browser.run("return [...document.querySelectorAll('figure.view')].length;") - 1
    browser.show("figure.view", number)
    with h5py.File(results.file("failures")) as file:
        title = browser.run("return document.querySelectorAll('figure.view')[arguments[0]].view.d.title;", number)
        rows = file["items"][title]["sweep/vertex"][:].tolist()
    assert browser.run("return document.querySelectorAll('figure.view')[arguments[0]].view.dots.geometry.attributes.position.count;",
                       number) == len(rows)
    for v in rows:
        browser.run("document.querySelectorAll('figure.view')[arguments[0]].view.pickVertex(arguments[1]);", number, v)
        shown = readout(browser, number)
        assert int(shown["vertex"]) == v and shown["status"] != "no row"


def test_one_finger_scrolls(results, browser):
    browser.driver.execute_cdp_cmd("Emulation.setTouchEmulationEnabled", {"enabled": True})
    browser.driver.execute_cdp_cmd("Emulation.setEmitTouchEventsForMouse", {"enabled": False})
    try:
        browser.size(390, 844)
        browser.open(results.page("torus"))
        browser.show("figure.view")
        trapped = """
            const canvas = document.querySelector('figure.view canvas'), box = canvas.getBoundingClientRect();
            const touch = new Touch({identifier: 1, target: canvas, clientX: box.left + 50, clientY: box.top + 50});
            return !canvas.dispatchEvent(new TouchEvent('touchstart', {touches: [touch], changedTouches: [touch], bubbles: true, cancelable: true}));"""
        assert not browser.run(trapped)
        browser.run("[...document.querySelectorAll('.tools button')].find((b) => b.textContent === 'turn by touch').click();")
        assert browser.run(trapped)
    finally:
        browser.driver.execute_cdp_cmd("Emulation.setTouchEmulationEnabled", {"enabled": False})
        browser.size(1100, 900)


def test_failures_come_first(results):
    text = results.page("failures").read_text()
    assert text.index("What failed") < text.index("checks that hold") < text.index("<h2>eight@")
    assert "broken" in text and "inadmissible_target" in text
    stopped = results.page("stopped").read_text()
    assert stopped.index("max_iterations") < stopped.index("Checks that fail") < stopped.index("<h2>eight@")


def test_the_numbers_of_the_summary(results):
    for kind in KINDS:
        source = results.file(kind)
        said = results.run("report", source.name, "-o", "again.html", "--json")[0]
        assert said["checks"] > 0 or kind == "paths"
        assert (said["failures"] > 0) == (kind in ("failures", "stopped"))
        assert (said["checks_failed"] > 0) == (kind == "stopped"), (kind, said)
    first, second = ((results.folder / n) for n in ("again.html", "once.html"))
    results.run("report", source.name, "-o", "once.html")
    assert first.read_bytes() == second.read_bytes()


def test_bad_arguments_and_files(results):
    source = results.file("flow").name
    results.run("report", source, "-o", "page.pdf", status=2)
    results.run("report", source, "-o", "page.html", "--item", "nobody", status=2)
    results.run("report", results.file("index").name, "-o", "page.html", "--item", "x", status=2)
    (results.folder / "text.h5").write_text("no HDF5")
    results.run("report", "text.h5", "-o", "page.html", status=3)
    results.run("report", "missing.h5", "-o", "page.html", status=3)
    whole = results.file("flow").read_bytes()
    (results.folder / "cut.h5").write_bytes(whole[: len(whole) // 2])
    results.run("report", "cut.h5", "-o", "page.html", status=3)
    assert not (results.folder / "page.html").exists()


@pytest.mark.parametrize("kind, selector, number, name", [
    ("sweep", "figure.view", 1, "sweep_view"),
    ("sweep", "figure:not(.view)", 0, "sweep_histogram"),
    ("flow", ".tabs figure", 0, "flow_residual"),
    ("structure", "figure.view", 0, "structure_view"),
    ("structure", "figure[data-link]", 0, "structure_domain"),
    ("spectrum", "figure.view", 0, "spectrum_view"),
    ("spectrum", "figure:not(.view)", 0, "spectrum_plot"),
    ("distances", "figure", 0, "distances_heat_map"),
    ("distances", "section:not(#checks) table", 0, "distances_neighbours"),
    ("paths", "figure", 0, "paths_curve"),
    ("failures", "#checks", 0, "failures_first"),
])
def test_it_looks_as_it_should(results, browser, kind, selector, number, name):
    browser.size(1100, 900)
    browser.open(results.page(kind))
    compare(browser.picture(selector, number), name)


def test_it_is_readable_on_a_phone(results, browser):
    browser.size(390, 844)
    try:
        for kind in ("sweep", "structure", "index", "failures"):
            browser.open(results.page(kind))
            browser.run("for (const d of document.querySelectorAll('details')) d.open = true;")
            assert browser.run("return document.documentElement.scrollWidth;") <= 391, kind
    finally:
        browser.size(1100, 900)
