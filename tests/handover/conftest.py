"""Results of every kind, made once by the program, and what reads their exports."""
import os
import shutil
import subprocess
from pathlib import Path

import pytest

RICCI = os.environ.get("RICCI_PROGRAM", str(Path(__file__).resolve().parents[2] / "build/bin/ricci"))


def run(*words, status=0):
    """Runs ricci; its outcome, once the exit status is as expected."""
    done = subprocess.run([RICCI, *map(str, words)], capture_output=True, text=True)
    assert done.returncode == status, f"{words}: {done.returncode}\n{done.stdout}{done.stderr}"
    return done


def run_program(words, **options):
    """Runs another program quietly; its output where it succeeds."""
    done = subprocess.run(list(map(str, words)), capture_output=True, text=True, **options)
    assert done.returncode == 0, f"{words}: {done.returncode}\n{done.stdout}{done.stderr}"
    return done.stdout + done.stderr


def need(program):
    """The path of a program; skips, saying so, where it is not installed."""
    path = shutil.which(program)
    if path is None:
        pytest.skip(f"{program} is not installed")
    return path


def export(result, output, *words, status=0):
    run("export", result, "-o", output, *words, "-q", status=status)
    return output


# Two equilateral triangles glued to a torus with one vertex, which has no points in space.
FLAT_TORUS = """1 2
0 0 0 1 1 1 3 4 5
0 0 0 1 1 1 0 1 2
"""


class Results:
    """Result files by name, made when they are first asked for."""

    def __init__(self, folder):
        self.folder = folder

    def mesh(self, name, faces, *words):
        path = self.folder / f"{name}.off"
        if not path.exists():
            run("generate", name, "--faces", faces, "-o", path, "-q", *words)
        return path

    def make(self, name, *words):
        path = self.folder / f"{name}.h5"
        if not path.exists():
            run(*words, "-o", path, "-q")
        return path

    def sweep(self):
        return self.make("sweep", "sweep", self.mesh("eight", 300), "--vertices", "sample:12", "--keep", "2")

    def flow(self):
        return self.make("flow", "flow", self.mesh("torus", 200), "--cone=0:pi", "--cone=9:-pi")

    def layout(self, name):
        words = {"eight": (self.mesh("eight", 300), "--copies", "30", "--quality", "--atlas", "hyperbolic"),
                 "torus": (self.mesh("torus", 200), "--copies", "9", "--quality"),
                 "sphere": (self.mesh("sphere", 200), "--quality"),
                 "pants": (self.mesh("pants", 200), "--copies", "7"),
                 "disk": (self.mesh("disk", 100), "--quality")}[name]
        return self.make(f"layout-{name}", "layout", *words)

    def spectrum(self):
        return self.make("spectrum", "spectrum", self.mesh("eight", 300), "--max-length", "5", "--curves",
                         self.folder / "geodesics.vtp")

    def teichmuller(self):
        return self.make("teichmuller", "teichmuller", self.mesh("eight", 300), "--curves", self.folder / "curves.vtp")

    def several(self):
        return self.make("several", "sweep", self.mesh("eight", 300), self.mesh("pants", 200), "--vertices", "sample:3")

    def failed(self):
        """A flow that does not converge within one step, and its layout."""
        path = self.folder / "failed.h5"
        if not path.exists():
            run("layout", self.mesh("eight", 300), "--max-iterations", "1", "-o", path, "-q", status=1)
        return path

    def intrinsic(self):
        mesh = self.folder / "flat.len"
        mesh.write_text(FLAT_TORUS)
        return self.make("intrinsic", "layout", mesh, "--copies", "9")


@pytest.fixture(scope="session")
def display():
    """An environment with an X server: the user's, or one of our own without a screen, on a number that it finds free."""
    if os.environ.get("DISPLAY"):
        yield dict(os.environ)
        return
    read, write = os.pipe()
    server = subprocess.Popen([need("Xvfb"), "-displayfd", str(write), "-screen", "0", "1280x1024x24", "-nolisten", "tcp",
                               "-noreset"],  # or it starts anew whenever the last client has left
                              pass_fds=[write], stderr=subprocess.DEVNULL)
    os.close(write)
    try:
        number = os.read(read, 16).decode().strip()
        assert number, "Xvfb did not start"
        yield dict(os.environ, DISPLAY=f":{number}")
    finally:
        os.close(read)
        server.terminate()
        server.wait()


@pytest.fixture(scope="session")
def results(tmp_path_factory):
    return Results(tmp_path_factory.mktemp("results"))
