"""The examples run as they stand, and do what they say."""

import os
import re
import subprocess
import sys

import numpy as np
import pytest

import ricci
from conftest import SOURCE

EXAMPLES = SOURCE / "docs/examples"


def run(name, *arguments):
    environment = {**os.environ, "MPLBACKEND": "Agg", "MPLCONFIGDIR": os.getcwd()}
    done = subprocess.run([sys.executable, EXAMPLES / name, *arguments], capture_output=True, text=True,
                          env=environment)  # fmt: skip
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_sweep_and_plot():
    assert len((EXAMPLES / "01_sweep_and_plot.py").read_text().splitlines()) == 10
    run("01_sweep_and_plot.py")
    with open("distortion.png", "rb") as file:
        assert file.read(8) == b"\x89PNG\r\n\x1a\n"
    image = pytest.importorskip("matplotlib.image").imread("distortion.png")
    assert len(np.unique(image.reshape(-1, image.shape[-1]), axis=0)) > 100  # coloured


def test_flow_with_cones():
    out = run("02_flow_with_cones.py")
    assert "converged" in out and re.search(r"total curvature / pi = -4\.0000000", out)
    assert ricci.verify("cones.h5", recompute=True).sound


def test_layout():
    out = run("03_layout.py")
    assert "0 of" in out and "lie in the disk: True" in out
    with open("eight_uv.obj") as file:
        lines = file.read().splitlines()
    uv = np.array([line.split()[1:] for line in lines if line.startswith("vt ")], float)
    assert len(uv) > 1000 and uv.min() >= 0 and uv.max() <= 1
    assert os.path.getsize("eight_tessellation.svg") > 10000 and len(ricci.read("eight_layout.h5")) == 1


def test_compare_shapes():
    out = run("04_compare_shapes.py")
    for found, expected in re.findall(r"modulus ([-+0-9.]+j|\S+), smooth torus (\S+)", out):
        assert abs(complex(found) - complex(expected)) < 0.05
    assert len(re.findall("torus", out)) >= 3
    assert float(re.search(r"two triangulations ([0-9.]+)", out).group(1)) < 0.2


def test_index():
    out = run("05_index.py")
    nearest = re.findall(r"^ +[0-9.]+  (\S+)", out, re.MULTILINE)
    assert len(nearest) == 3 and all("eight" in name for name in nearest[:2])
    clusters = dict((name, number) for number, name in re.findall(r"cluster (\d): (\S+)", out))
    assert clusters["shapes/eight1500.off"] == clusters["shapes/eight2500.off"] != clusters["shapes/bolza.len"]


def test_resume():
    out = run("06_resume.py")
    left = int(re.search(r"(\d+) vertices were left", out).group(1))
    assert 0 < left < 400 and "400 of 400 vertices converged" in out


def test_read_results(run_ricci):
    run_ricci("generate", "eight", "--faces", 600, "-o", "eight.off", "-q")
    run_ricci("sweep", "eight.off", "--vertices", "sample:20", "-o", "sweep.h5", "-q")
    out = run("07_read_results.py", "sweep.h5")
    assert "1 items, 0 failures" in out and out.endswith("sound\n") and "NOT" not in out


def test_every_example_is_tested():
    with open(__file__) as file:
        text = file.read()
    for example in EXAMPLES.glob("*.py"):
        assert f'run("{example.name}"' in text
