"""Thousands of shapes by their conformal structure."""

from __future__ import annotations

import os
from typing import NamedTuple, Sequence, Union

import numpy as np

from . import _core
from ._errors import Failure
from ._mesh import FloatArray, Mesh, Path
from ._sweep import SweepCallback


class Neighbour(NamedTuple):
    """A shape of the index near a query."""

    file: str
    component: int
    """Of its file."""
    components: int
    distance: float
    """Metric "spectrum": between fingerprints (torus, annulus: Teichmueller distance); "coordinates": Euclidean."""


class Entry(NamedTuple):
    """A shape of the index."""

    file: str
    component: int
    components: int
    genus: int
    boundaries: int
    vertices: int
    faces: int
    message: str
    """Notes, such as a near-tie in the marking."""
    fingerprint: FloatArray
    """Where neighbours are sought: a vector of one size per topological type. (K,)"""
    coordinates: FloatArray
    """Teichmueller coordinates. (C,), or (0,) where there are none"""
    names: list[str]
    """Of the coordinates. (C)"""
    lengths: FloatArray
    """Length spectrum, ascending. (n,)"""
    complete_up_to: float
    marking_gap: float
    residual_max: float
    """Of the metric: max |K - target|, radians."""


class BuiltShape(NamedTuple):
    """What became of a shape that was to be described."""

    file: str
    component: int
    components: int
    reused: bool
    """Known before by the bytes of its file."""
    stage: str
    """Where it failed, or ""."""
    status: str
    message: str


class Distances(NamedTuple):
    """All distances within a topological type, and a tree of clusters."""

    names: list[str]
    """Files, with #c1 for components; shapes without a distance are left out. (N)"""
    distance: FloatArray
    """(N, N), symmetric."""
    merges: list[tuple[int, int, float, int]]
    """(first, second, height, members): 0 ... N-1 are the shapes, N + k is what merge k made. (N-1)"""
    leaf_order: list[int]
    """Shapes such that no branches of the tree cross. (N)"""
    cluster: list[int]
    """Cluster of each shape. (N)"""


def _paths(paths: Union[Path, Sequence[Path]]) -> list[str]:
    if isinstance(paths, (str, os.PathLike)):
        return [os.fspath(paths)]
    return [os.fspath(path) for path in paths]


class Index:
    """An index of shapes in a file (HDF5). :meth:`build` makes one, ``Index(path)`` opens one.

    Raises :class:`FileError` for a file that is none.
    """

    def __init__(self, path: Path) -> None:
        self._path = os.fspath(path)
        self._built: list[BuiltShape] = []
        self._reload()

    def _reload(self) -> None:
        self._contents = _core.index_contents(self._path)
        self._search: dict[str, _core.IndexSearch] = {}

    @classmethod
    def build(
        cls,
        path: Path,
        shapes: Union[Path, Sequence[Path]],
        *,
        max_length: float = 4.0,
        count: int = 0,
        fingerprint: int = 12,
        coordinates: bool = True,
        resolutions: Sequence[Union[int, str]] = ("input",),
        scheme: str = "vertex-scaling",
        delaunay: str = "isometric",
        tolerance: float = 1e-10,
        max_iterations: int = 0,
        repair: str = "",
        timeout: float = 0.0,
        max_memory: Union[int, str] = "",
        threads: int = 0,
        resume: bool = False,
        progress: SweepCallback = None,
    ) -> Index:
        """Describes many shapes and writes the index; unchanged ones of an older index there are not described again.

        shapes : files, folders or globs. max_length : length spectra complete up to here, or at least `count` lengths.
        fingerprint : lengths that neighbours are sought by. coordinates : Teichmueller coordinates too. resolutions :
        face counts, or "input"; the finest is the entry, the others its error bars. timeout : seconds per shape.
        resume : continue what an interrupted build finished (in <path>.parts). progress : called with
        :class:`SweepProgress`, whose solves are shapes. Failures of shapes are in `failures` and `built`.
        """
        options = _core.IndexOptions()
        options.max_length, options.count, options.fingerprint = max_length, count, fingerprint
        options.coordinates, options.resolutions = coordinates, [str(r) for r in resolutions]
        options.scheme, options.delaunay, options.tolerance = scheme, delaunay, tolerance
        options.max_iterations, options.repair, options.timeout = max_iterations, repair, timeout
        if not (0 < max_length < np.inf and 0 < tolerance < np.inf) or min(count, max_iterations, timeout) < 0:
            raise ValueError("max_length and tolerance must be positive, count, max_iterations and timeout not negative")
        if not 1 <= fingerprint <= 1000:
            raise ValueError("fingerprint must be 1 to 1000")
        name = os.fspath(path)
        rows = _core.index_build(name, _paths(shapes), options, threads, resume, str(max_memory), progress)
        index = cls(name)
        index._built = [BuiltShape(*row) for row in rows]
        return index

    def add(
        self,
        shapes: Union[Path, Sequence[Path]],
        *,
        max_memory: Union[int, str] = "",
        threads: int = 0,
        resume: bool = False,
        progress: SweepCallback = None,
    ) -> None:
        """Describes more shapes, with the index's own options, and writes it anew; files it has are read again."""
        rows = _core.index_add(self._path, _paths(shapes), threads, resume, str(max_memory), progress)
        self._reload()
        self._built = [BuiltShape(*row) for row in rows]

    def remove(self, shapes: Union[Path, Sequence[Path]]) -> int:
        """Takes shapes out: paths as the index has them, folders above them, or globs. The number of shapes removed.

        Raises KeyError for paths that name nothing, after the others are removed."""
        removed, _, missing = _core.index_remove(self._path, _paths(shapes))
        self._reload()
        if missing:
            raise KeyError(f"{self._path} holds nothing at {missing}")
        return removed

    def query(
        self, shape: Union[Mesh, Path], k: int = 5, *, others: bool = False, metric: str = "spectrum"
    ) -> list[Neighbour]:
        """The `k` shapes of the same topological type that are most alike, nearest first.

        shape : a mesh, or a file of one component; a file that the index has is not described again. others : leave
        out entries with the same bytes as a queried file. metric : "spectrum" (free of markings) or "coordinates".
        Raises ValueError for a shape that cannot be described.
        """
        if k < 1:
            raise ValueError("k must be positive")
        if metric not in self._search:
            self._search[metric] = _core.IndexSearch(self._path, metric)
        search = self._search[metric]
        if isinstance(shape, Mesh):
            answers = search.ask_surface(shape._engine(), k, others)
        else:
            answers = search.ask_file(os.fspath(shape), k, others)
        if len(answers) != 1:
            raise ValueError(f"{len(answers)} components: ask for each mesh of ricci.load_components")
        return [Neighbour(*row) for row in answers[0][4]]

    def distances(
        self,
        type: str,
        *,
        metric: str = "spectrum",
        linkage: str = "average",
        clusters: int = 1,
        threads: int = 0,
    ) -> Distances:
        """All distances between the shapes of a topological type like "g2b0", and their tree of clusters.

        linkage : "average", "single" or "complete". clusters : the tree is cut into so many.
        """
        genus, _, boundaries = type.removeprefix("g").partition("b")
        if not (type.startswith("g") and genus.isdecimal() and boundaries.isdecimal()):
            raise ValueError(f"{type!r} is no topological type like 'g2b0'")
        return Distances(
            *_core.index_distances(self._path, int(genus), int(boundaries), metric, linkage, clusters, threads)
        )

    @property
    def path(self) -> str:
        """The file."""
        return self._path

    @property
    def types(self) -> dict[str, int]:
        """Number of shapes of each topological type, "g<genus>b<boundaries>"."""
        return self._contents.types

    @property
    def entries(self) -> list[Entry]:
        """The shapes, in the order of the index; their arrays are read-only views."""
        return [Entry(**row) for row in self._contents.entries]

    @property
    def failures(self) -> list[Failure]:
        """Shapes that could not be read or described."""
        return [Failure(*row) for row in self._contents.failures]

    @property
    def built(self) -> list[BuiltShape]:
        """What became of each shape of the last build or addition by this object."""
        return list(self._built)

    @property
    def config(self) -> str:
        """Options that the shapes were described by, as TOML."""
        return self._contents.config

    def __len__(self) -> int:
        return sum(self.types.values())

    def __repr__(self) -> str:
        return f"<ricci.Index {self._path!r}: {len(self)} shapes>"


