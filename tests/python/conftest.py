"""What the tests of the Python module share. CTest sets PYTHONPATH, RICCI_PROGRAM and RICCI_BUILD."""

import os
import subprocess
from pathlib import Path

import h5py
import numpy as np
import pytest

SOURCE = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="session")
def program():
    path = os.environ.get("RICCI_PROGRAM")
    if not path:
        pytest.fail("RICCI_PROGRAM does not name the program ricci")
    return path


@pytest.fixture
def run_ricci(program, tmp_path):
    """Runs the command line in the test's folder; its exit status must be 0."""

    def run(*arguments):
        done = subprocess.run([program, *map(str, arguments)], cwd=tmp_path, capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
        return done.stdout

    return run


@pytest.fixture(autouse=True)
def in_own_folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


def contents(path, groups=("items", "failures")):
    """Every dataset of a result file by name, but for times, and the attributes of the groups beside them."""
    found = {}

    def take(name, node):
        if name.split("/")[0] not in groups or name.endswith("seconds"):
            return
        attributes = {k: v for k, v in node.attrs.items() if k != "seconds" and "xxh3" not in k}
        values = node[()] if isinstance(node, h5py.Dataset) else None
        found[name] = (values, attributes)

    with h5py.File(path) as file:
        file.visititems(take)
    return found


def assert_same_results(path, other, without_attributes=()):
    """Bit by bit, but for times. `without_attributes`: of items, like the source that arrays do not have."""
    a, b = contents(path), contents(other)
    assert a.keys() == b.keys()
    assert a
    for name, (values, attributes) in a.items():
        others, other_attributes = b[name]
        if values is not None:
            assert values.dtype == others.dtype, name
            assert values.shape == others.shape, name
            assert values.tobytes() == others.tobytes() if values.dtype != object else np.all(values == others), name
        for key, value in attributes.items():
            if key not in without_attributes:
                assert np.array_equal(value, other_attributes[key], equal_nan=isinstance(value, float)), (name, key)
