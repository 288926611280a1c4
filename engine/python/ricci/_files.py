"""Result files, read and checked."""

from __future__ import annotations

import os
from typing import NamedTuple

from . import _core
from ._mesh import Path
from ._results import Run


def read(path: Path) -> Run:
    """Reads a result file of this module or of the command line (HDF5, docs/hdf5.md), all of it, into memory.

    A child process looks at it first, since damaged HDF5 can crash the library. Raises :class:`FileError` on anything
    that does not keep the contract, naming the object.
    """
    return Run(_core.read(os.fspath(path)))


class Recomputed(NamedTuple):
    """A stored solution, rebuilt from the mesh and its conformal factor alone by separate code in long double."""

    item: str
    what: str
    """"best (vertex 17)", "flow", ..."""
    residual_stored: float
    """max |K - target|, radians."""
    residual_recomputed: float
    gauss_bonnet_error_stored: float
    gauss_bonnet_error_recomputed: float
    digits: int
    """Of the recomputation's arithmetic."""
    area_distortion_stored: float
    """NaN for flows."""
    area_distortion_recomputed: float
    flips: int
    sound: bool
    message: str
    """Why not."""


class Verification(NamedTuple):
    """What :func:`verify` found."""

    sound: bool
    complaints: list[str]
    """What is wrong with the file's form or checksums."""
    recomputed: list[Recomputed]


def verify(path: Path, *, recompute: bool = False, threads: int = 0) -> Verification:
    """Checks form, checksums and consistency of a result file; with `recompute` rebuilds every stored solution.

    Raises :class:`FileError` where the check itself cannot be done.
    """
    name = os.fspath(path)
    complaints = _core.verify_structure(name)
    solutions: list[Recomputed] = []
    if recompute and not complaints:
        solutions = [Recomputed(**row) for row in _core.recompute(name, threads)]
    return Verification(not complaints and all(s.sound for s in solutions), complaints, solutions)
