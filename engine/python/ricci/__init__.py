"""Discrete surface Ricci flow: metrics of prescribed curvature, the structures they induce, sweeps over all vertices.

    import ricci
    mesh = ricci.generate("eight", faces=2000)          # or ricci.load("scan.obj"), ricci.Mesh(points, triangles)
    result = ricci.sweep(mesh, vertices="sample:100")   # every vertex in turn as the only cone
    print(result.best.vertex, result.area_distortion)   # NumPy views of C++ memory

Angles and curvature are radians, vertices are numbered from zero. Results are a status and arrays; exceptions are for
meshes and files that are none (:class:`MeshError`, :class:`FileError`) and for options that there are not (ValueError).
Long calls release the interpreter's lock, end on Ctrl-C, and log to the logger "ricci". docs/python.md has more.
"""

import sys as _sys
import warnings as _warnings

from . import _core
from ._errors import Defect, Failure, FileError, MeshError
from ._files import Recomputed, Verification, read, verify
from ._index import BuiltShape, Distances, Entry, Index, Neighbour
from ._mesh import Mesh, generate, generators, load, load_components, set_max_unpacked, split
from ._progress import FlowProgress, SweepProgress
from ._results import (
    STATUS_NAMES,
    Curve,
    FlowResult,
    Generator,
    Geodesic,
    GroupResult,
    Item,
    KeptFactor,
    Layout,
    Result,
    Run,
    Spectrum,
    SweepResult,
    Teichmuller,
    save,
)
from ._solve import flow, layout, spectrum, teichmuller
from ._sweep import read_config, sweep

__version__: str = _core.version()


def build_info() -> dict[str, str]:
    """What was built and what runs: version, git (commit), solver, processor (what decides the last bits)."""
    return {
        "version": _core.version(),
        "git": _core.git(),
        "solver": _core.solver(),
        "processor": _core.processor(),
    }


def keep_memory() -> None:
    """Lets the process keep memory that is free instead of handing it back to the system, as the command line does.

    Process-wide, for good. Factors of large meshes come and go at every step; where these calls are most of what a
    process does, they are a little faster so.
    """
    _core.keep_memory()


__all__ = [
    "STATUS_NAMES",
    "BuiltShape",
    "Curve",
    "Defect",
    "Distances",
    "Entry",
    "Failure",
    "FileError",
    "FlowProgress",
    "FlowResult",
    "Generator",
    "Geodesic",
    "GroupResult",
    "Index",
    "Item",
    "KeptFactor",
    "Layout",
    "Mesh",
    "MeshError",
    "Neighbour",
    "Recomputed",
    "Result",
    "Run",
    "Spectrum",
    "SweepProgress",
    "SweepResult",
    "Teichmuller",
    "Verification",
    "build_info",
    "flow",
    "generate",
    "generators",
    "keep_memory",
    "layout",
    "load",
    "load_components",
    "read",
    "read_config",
    "save",
    "set_max_unpacked",
    "spectrum",
    "split",
    "sweep",
    "teichmuller",
    "verify",
]

_core.set_command_line("python " + " ".join(_sys.argv))
if not _core.blas_is_safe():
    _warnings.warn(
        "another module has loaded a serial OpenBLAS, which is not safe for several threads: import ricci first, or pass "
        "threads=1",
        RuntimeWarning,
        stacklevel=2,
    )
