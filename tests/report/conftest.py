"""Result files of every kind, made once, and a browser."""
import json
import os
import pathlib
import subprocess

import pytest

RICCI = os.environ.get("RICCI_PROGRAM", str(pathlib.Path(__file__).parents[2] / "build/bin/ricci"))


def ricci(*arguments, cwd, status=0):
    """Runs the program; its JSON lines."""
    done = subprocess.run([RICCI, *map(str, arguments)], cwd=cwd, capture_output=True, text=True)
    assert done.returncode == status, f"{arguments}: exit {done.returncode}\n{done.stdout}\n{done.stderr}"
    return [json.loads(line) for line in done.stdout.splitlines() if line.startswith("{")]


class Results:
    """Makes result files and pages in one folder, each when it is first asked for."""

    def __init__(self, folder):
        self.folder, self.made = folder, {}

    def run(self, *arguments, status=0):
        return ricci(*arguments, cwd=self.folder, status=status)

    def mesh(self, name, *arguments):
        if not (self.folder / name).exists():
            (self.folder / name).parent.mkdir(exist_ok=True)
            self.run("generate", *arguments, "-o", name)
        return name

    def file(self, kind):
        if kind not in self.made:
            self.made[kind] = getattr(self, "make_" + kind)()
        return self.folder / self.made[kind]

    def page(self, kind, *arguments):
        source = self.file(kind)
        page = source.with_suffix(f".{len(arguments)}.html")
        if not page.exists():
            self.run("report", source.name, "-o", page.name, *arguments)
        return page

    def make_sweep(self):
        self.mesh("small/eight.off", "eight", "--faces", 900)
        self.run("sweep", "small/eight.off", "--resolutions", "500,input", "-o", "sweep.h5")
        return "sweep.h5"

    def make_failures(self):
        self.mesh("sphere.off", "sphere", "--faces", 300)
        self.mesh("eight.off", "eight", "--faces", 1500)
        (self.folder / "broken.off").write_text("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 nonsense\n3 0 1 2\n")
        self.run("sweep", "broken.off", "sphere.off", "eight.off", "--vertices", "sample:20", "-o", "failures.h5", status=1)
        return "failures.h5"

    def make_flow(self):
        self.mesh("eight.off", "eight", "--faces", 1500)
        self.run("flow", "eight.off", "--cone=0:-2pi", "--cone=99:-2pi", "-o", "flow.h5")
        return "flow.h5"

    def make_stopped(self):
        self.mesh("eight.off", "eight", "--faces", 1500)
        self.run("flow", "eight.off", "--max-iterations", 1, "-o", "stopped.h5", status=1)
        return "stopped.h5"

    def make_structure(self):
        self.mesh("eight.off", "eight", "--faces", 1500)
        self.run("layout", "eight.off", "--quality", "--atlas", "hyperbolic", "-o", "structure.h5")
        return "structure.h5"

    def make_torus(self):
        self.mesh("torus.off", "torus", "--faces", 800)
        self.run("layout", "torus.off", "-o", "torus.h5")
        return "torus.h5"

    def make_ball(self):
        self.mesh("sphere.off", "sphere", "--faces", 300)
        self.run("layout", "sphere.off", "-o", "ball.h5")
        return "ball.h5"

    def make_intrinsic(self):
        self.mesh("bolza.len", "bolza")
        self.run("layout", "bolza.len", "-o", "intrinsic.h5")
        return "intrinsic.h5"

    def make_spectrum(self):
        self.mesh("eight.off", "eight", "--faces", 1500)
        self.mesh("eight2.off", "eight", "--faces", 900)
        self.run("spectrum", "eight.off", "eight2.off", "--count", 8, "--curves", "geodesics.vtp", "-o", "spectrum.h5")
        return "spectrum.h5"

    def make_coordinates(self):
        self.mesh("eight.off", "eight", "--faces", 1500)
        self.mesh("eight2.off", "eight", "--faces", 900)
        self.run("teichmuller", "eight.off", "eight2.off", "--curves", "marking.vtp", "-o", "coordinates.h5")
        return "coordinates.h5"

    def tori(self):
        for k in range(7):
            self.mesh(f"shapes/torus{k}.off", "torus", "--faces", 300, "--major", 1.5 + 0.5 * k)
        return "shapes"

    def make_index(self):
        shapes = self.tori()
        self.mesh("shapes/eight.off", "eight", "--faces", 900)
        self.mesh("shapes/eight2.off", "eight", "--faces", 700)
        self.run("index", "build", shapes, "-o", "index.h5")
        return "index.h5"

    def make_distances(self):
        self.file("index")
        self.run("index", "distances", "index.h5", "--type", "g1b0", "--clusters", 3, "-o", "distances.h5")
        return "distances.h5"

    def make_paths(self):
        shapes = self.tori()
        self.run("path", *[f"{shapes}/torus{k}.off" for k in range(7)], "-o", "paths.h5")
        return "paths.h5"


@pytest.fixture(scope="session")
def results(tmp_path_factory):
    return Results(tmp_path_factory.mktemp("results"))


@pytest.fixture(scope="session")
def browser(tmp_path_factory):
    from browser import CHROMIUM, DRIVER, Browser
    if not CHROMIUM or not DRIVER:
        pytest.skip("no chromium and chromedriver (Debian: chromium, chromium-driver)")
    made = Browser(tmp_path_factory.mktemp("chromium"))
    yield made
    made.close()
