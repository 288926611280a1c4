"""`pip install .` without a network, from the build at hand."""

import os
import subprocess
import sys
import tarfile
import venv
import zipfile

import pytest

from conftest import SOURCE


@pytest.fixture(scope="module")
def build():
    folder = os.environ.get("RICCI_BUILD")
    if not folder:
        pytest.fail("RICCI_BUILD does not name the build folder")
    return folder


def test_pip_installs_it(build, tmp_path):
    place = tmp_path / "venv"
    venv.create(place, system_site_packages=True, with_pip=True)
    python = place / "bin/python"
    environment = {k: v for k, v in os.environ.items() if k != "PYTHONPATH"}
    subprocess.run(
        [python, "-m", "pip", "install", "--quiet", "--no-index", "--no-cache-dir", SOURCE,
         f"--config-settings=build-dir={build}"],
        check=True, env=environment,
    )  # fmt: skip
    code = (
        "import ricci, os; mesh = ricci.generate('eight', faces=500);"
        "assert ricci.flow(mesh).status == 'converged';"
        f"assert ricci.__file__.startswith({str(place)!r});"
        "import importlib.metadata as m; assert m.version('ricci') == ricci.__version__;"
        "assert all(f.locate().exists() for f in m.files('ricci'));"
        "assert m.requires('ricci') == ['numpy>=1.21']; print(ricci.__version__)"
    )
    done = subprocess.run([python, "-c", code], env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    subprocess.run([python, "-m", "pip", "uninstall", "--quiet", "--yes", "ricci"], check=True, env=environment)
    assert subprocess.run([python, "-c", "import ricci"], env=environment, capture_output=True).returncode != 0


def test_wheel_and_source_archive(build, tmp_path, monkeypatch):
    monkeypatch.syspath_prepend(SOURCE / "engine/python/build_backend")
    import ricci_build

    name = ricci_build.build_wheel(tmp_path, {"build-dir": build})
    with zipfile.ZipFile(tmp_path / name) as wheel:
        names = wheel.namelist()
        record = next(n for n in names if n.endswith(".dist-info/RECORD"))
        rows = [line.split(",") for line in wheel.read(record).decode().splitlines()]
        metadata = wheel.read(record.replace("RECORD", "METADATA")).decode()
    assert sorted(row[0] for row in rows) == sorted(names)
    assert {"ricci/__init__.py", "ricci/py.typed", "ricci/_core.pyi"} <= set(names)
    assert metadata.startswith("Metadata-Version: 2.1\nName: ricci\n")
    first = (tmp_path / name).read_bytes()
    ricci_build.build_wheel(tmp_path, {"build-dir": build})
    assert (tmp_path / name).read_bytes() == first  # the same build, the same bytes
    archive = ricci_build.build_sdist(tmp_path)
    with tarfile.open(tmp_path / archive) as sources:
        names = sources.getnames()
    stem = archive.removesuffix(".tar.gz")
    assert {f"{stem}/PKG-INFO", f"{stem}/pyproject.toml", f"{stem}/CMakeLists.txt",
            f"{stem}/engine/python/module.cpp"} <= set(names)  # fmt: skip
    assert sys.version_info >= (3, 11)
