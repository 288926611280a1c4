"""Build backend (PEP 517) of the Python package: CMake builds the extension, this makes the wheel of it.

Standard library only. Settings, as in ``pip install . --config-settings=build-dir=build``:

build-dir   build folder; one that is configured already is used as it is. Default: build-wheel
cmake-args  further arguments of the configuration, like "-DRICCI_CHOLMOD=OFF"
jobs        parallel jobs of the build
"""

import base64
import hashlib
import io
import os
import re
import shlex
import shutil
import subprocess
import sys
import sysconfig
import tarfile
import tempfile
import tomllib
import zipfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
EPOCH = 315532800  # of everything in an archive: 1980-01-01, the first that zip knows


def _project():
    with open(ROOT / "pyproject.toml", "rb") as file:
        return tomllib.load(file)["project"]


def _version():
    found = re.search(r"project\(ricci VERSION ([0-9.]+)", (ROOT / "CMakeLists.txt").read_text())
    if found is None:
        raise RuntimeError("CMakeLists.txt names no version")
    return found.group(1)


def _metadata():
    project = _project()
    lines = [
        "Metadata-Version: 2.1",
        f"Name: {project['name']}",
        f"Version: {_version()}",
        f"Summary: {project['description']}",
        "License: MIT (sources); GPL-2.0-or-later (an extension that links CHOLMOD's supernodal module)",
        f"Requires-Python: {project['requires-python']}",
        *(f"Requires-Dist: {requirement}" for requirement in project["dependencies"]),
        "Classifier: Operating System :: POSIX :: Linux",
        "Description-Content-Type: text/markdown",
    ]
    return "\n".join(lines) + "\n\n" + (ROOT / project["readme"]).read_text()


def _tag():
    python = f"cp{sys.version_info.major}{sys.version_info.minor}"
    return f"{python}-{python}-{re.sub(r'[^A-Za-z0-9]', '_', sysconfig.get_platform())}"


def _dist_info():
    return f"ricci-{_version()}.dist-info"


def _write_dist_info(folder):
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "METADATA").write_text(_metadata())
    (folder / "WHEEL").write_text(
        f"Wheel-Version: 1.0\nGenerator: ricci_build\nRoot-Is-Purelib: false\nTag: {_tag()}\n"
    )
    shutil.copyfile(ROOT / "LICENSE", folder / "LICENSE")


def _run(*command):
    print("+", shlex.join(map(str, command)), file=sys.stderr, flush=True)
    # stdout of a backend belongs to its caller
    subprocess.run([str(word) for word in command], check=True, stdout=sys.stderr)


def _build(settings, staging):
    """Configures (unless that is done), builds the module alone, and installs it below `staging`."""
    build = Path(settings.get("build-dir") or ROOT / "build-wheel").resolve()
    if not (build / "CMakeCache.txt").exists():
        generator = ["-G", "Ninja"] if shutil.which("ninja") else []
        _run(
            "cmake", "-S", ROOT, "-B", build, *generator, "-DCMAKE_BUILD_TYPE=Release", "-DRICCI_TESTS=OFF",
            "-DRICCI_BENCH=OFF", "-DRICCI_PYTHON=ON", f"-DRICCI_PYTHON_PROGRAM={sys.executable}",
            *shlex.split(settings.get("cmake-args", "")),
        )  # fmt: skip
    jobs = settings.get("jobs") or str(os.cpu_count() or 1)
    _run("cmake", "--build", build, "--target", "ricci_python", "--parallel", jobs)
    _run("cmake", "--install", build, "--component", "python", "--prefix", staging)
    extension = "_core" + sysconfig.get_config_var("EXT_SUFFIX")
    if not (staging / "ricci" / extension).exists():
        raise RuntimeError(f"{build} was built for another Python: it has no {extension}")


def _write_wheel(path, staging):
    files = sorted(file for file in staging.rglob("*") if file.is_file())
    record = f"{_dist_info()}/RECORD"
    rows = []
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as wheel:

        def add(name, data, mode):
            entry = zipfile.ZipInfo(name)
            entry.external_attr = (0o100000 | mode) << 16
            wheel.writestr(entry, data, zipfile.ZIP_DEFLATED)

        for file in files:
            name, data = file.relative_to(staging).as_posix(), file.read_bytes()
            digest = base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()
            rows.append(f"{name},sha256={digest},{len(data)}\n")
            add(name, data, 0o755 if file.suffix == ".so" else 0o644)
        add(record, "".join(rows) + f"{record},,\n", 0o644)


def get_requires_for_build_wheel(config_settings=None):
    return []


def get_requires_for_build_sdist(config_settings=None):
    return []


def prepare_metadata_for_build_wheel(metadata_directory, config_settings=None):
    _write_dist_info(Path(metadata_directory) / _dist_info())
    return _dist_info()


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    name = f"ricci-{_version()}-{_tag()}.whl"
    with tempfile.TemporaryDirectory() as folder:
        staging = Path(folder)
        _build(config_settings or {}, staging)
        _write_dist_info(staging / _dist_info())
        _write_wheel(Path(wheel_directory) / name, staging)
    return name


def _sources():
    """What belongs to the project: what git tracks, or, outside of a clone, all but build folders and caches."""
    if (ROOT / ".git").exists() and shutil.which("git"):
        listed = subprocess.run(
            ["git", "-c", f"safe.directory={ROOT}", "-C", ROOT, "ls-files", "-z"], check=True, capture_output=True
        )
        return sorted(Path(name) for name in listed.stdout.decode().split("\0") if name and (ROOT / name).exists())
    names = (file.relative_to(ROOT) for file in ROOT.rglob("*") if file.is_file())
    return sorted(
        name
        for name in names
        if not name.parts[0].startswith("build") and name.parts[0] != "out" and "__pycache__" not in name.parts
    )


def build_sdist(sdist_directory, config_settings=None):
    stem = f"ricci-{_version()}"
    with tarfile.open(Path(sdist_directory) / f"{stem}.tar.gz", "w:gz", format=tarfile.PAX_FORMAT) as archive:

        def add(name, data, mode):
            entry = tarfile.TarInfo(f"{stem}/{name}")
            entry.size, entry.mode, entry.mtime = len(data), mode, EPOCH
            archive.addfile(entry, io.BytesIO(data))

        for name in _sources():
            file = ROOT / name
            add(name.as_posix(), file.read_bytes(), 0o755 if os.access(file, os.X_OK) else 0o644)
        add("PKG-INFO", _metadata().encode(), 0o644)
    return f"{stem}.tar.gz"
