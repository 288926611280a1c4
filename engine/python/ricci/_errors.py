"""What can go wrong with files and meshes, and what is noticed about them."""

from dataclasses import dataclass
from typing import NamedTuple


@dataclass(frozen=True)
class Defect:
    """A defect of a mesh, or a note about it, at one element."""

    code: str
    """Stable identifier in snake_case; docs/mesh_input.md lists them all."""
    element: str
    """"vertex", "edge", "face", "line" or "file"."""
    index: int
    """Zero-based number of the element (lines from 1); -1: none."""
    message: str
    """A sentence: what, where, and which repair helps."""


class Failure(NamedTuple):
    """What failed in a run: an item, a stage of it, or one vertex."""

    item: str
    stage: str
    """"load", "resample", "sweep", "sweep vertex 12", "flow", "layout", "shape" or "describe"."""
    status: str
    message: str


class MeshError(ValueError):
    """A mesh that is no surface. `defects` lists every :class:`Defect`."""

    def __init__(self, message: str, defects: list[Defect]) -> None:
        super().__init__(message)
        self.defects = defects


class FileError(OSError):
    """A file that cannot be read or written, or does not hold what it should."""
