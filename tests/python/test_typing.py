"""Types and docstrings."""

import inspect
import os
import subprocess
import sys
from pathlib import Path

import pytest

import ricci
from conftest import SOURCE


@pytest.fixture(scope="session")
def mypy(tmp_path_factory):
    """Runs mypy, or a module of it; the second run profits from what the first found out about NumPy."""
    cache = tmp_path_factory.mktemp("mypy")

    def run(*arguments, module="mypy"):
        done = subprocess.run([sys.executable, "-m", module, *map(str, arguments)], capture_output=True, text=True,
                              env={**os.environ, "MYPY_CACHE_DIR": str(cache)})  # fmt: skip
        assert "No module named" not in done.stderr, f"Debian: mypy ({done.stderr})"
        return done

    return run


def test_package_examples_and_their_users_are_typed(mypy, tmp_path):
    """One run of mypy for all; the overloads say what a sweep returns, and the one wrong use is found."""
    for example in (SOURCE / "docs/examples").glob("*.py"):
        lenient = "# mypy: no-strict-optional\n"
        (tmp_path / f"example_{example.name}").write_text(lenient + example.read_text())
    (tmp_path / "right.py").write_text(
        "import ricci\n"
        "mesh = ricci.generate('eight')\n"
        "one: ricci.SweepResult = ricci.sweep(mesh)\n"
        "many: ricci.Run = ricci.sweep([mesh, 'x.off'])\n"
        "u = ricci.flow(mesh, cones={0: '-4pi'}).conformal_factor + 1.0\n"
    )
    (tmp_path / "wrong.py").write_text("import ricci\nrun: ricci.Run = ricci.sweep(ricci.generate('eight'))\n")
    done = mypy("--strict", "--ignore-missing-imports", SOURCE / "engine/python/ricci", *sorted(tmp_path.glob("*.py")))
    assert done.returncode == 1, done.stdout
    assert "wrong.py:2: error" in done.stdout and "Found 1 error" in done.stdout, done.stdout


def test_stubs_are_those_of_the_extension(mypy):
    done = mypy("ricci._core", "--ignore-missing-stub", "--ignore-positional-only", "--allowlist",
                SOURCE / "tests/python/stubtest_allowed.txt", module="mypy.stubtest")  # fmt: skip
    assert done.returncode == 0, done.stdout


def public_members(cls):
    return [(name, m) for name, m in vars(cls).items() if not name.startswith("_") and not isinstance(m, int)]


def test_everything_public_has_a_docstring():
    for name in ricci.__all__:
        thing = getattr(ricci, name)
        if not callable(thing):
            continue
        assert inspect.getdoc(thing), name
        if inspect.isclass(thing) and not issubclass(thing, tuple):
            for member, value in public_members(thing):
                if callable(value) or isinstance(value, (property, classmethod)):
                    doc = (value.fget if isinstance(value, property) else value).__doc__
                    assert doc, f"{name}.{member}"


def test_arrays_say_their_shape_and_angles_their_unit():
    for cls in (ricci.FlowResult, ricci.SweepResult, ricci.Layout, ricci.Spectrum, ricci.Teichmuller, ricci.Mesh):
        source = inspect.getsource(cls)
        for member, value in public_members(cls):
            if not isinstance(value, property):
                continue
            returns = str(value.fget.__annotations__.get("return", ""))
            if "Array" in returns:
                assert "(" in value.fget.__doc__ and ")" in value.fget.__doc__, f"{cls.__name__}.{member}: no shape"
            if "residual" in member or member in ("curvature", "target_curvature", "gauss_bonnet_error"):
                assert "radians" in value.fget.__doc__, f"{cls.__name__}.{member}: no unit"
        assert source


def test_all_is_all():
    names = {n for n in vars(ricci) if not n.startswith("_") and not inspect.ismodule(getattr(ricci, n))}
    assert names == set(ricci.__all__)


def test_marked_as_typed():
    assert (Path(ricci.__file__).parent / "py.typed").exists()
