"""Results: what result files hold, in memory. Their arrays are read-only NumPy views of C++ memory, which lives as long
as one of them does. Numerical outcomes are a status, never an exception."""

from __future__ import annotations

import os
from typing import Any, Iterator, Mapping, NamedTuple, Optional, Sequence, Union

import numpy as np
import numpy.typing as npt

from . import _core
from ._errors import Failure
from ._mesh import FloatArray, IntArray, Mesh, Path

ByteArray = npt.NDArray[np.uint8]
Attribute = Union[str, float, int, list[str]]
Values = Union[npt.NDArray[Any], list[str]]

STATUS_NAMES: tuple[str, ...] = _core.status_names
"""Names of the status codes 0, 1, ...: converged, max_iterations, inadmissible_target, ..."""


class Result:
    """What all results have."""

    __slots__ = ("_mesh", "_stored")

    def __init__(self, stored: _core.Stored, mesh: Optional[Mesh] = None) -> None:
        self._stored = stored
        self._mesh = mesh

    @property
    def name(self) -> str:
        """Of the item: <mesh name>@<faces>."""
        return self._stored.name

    @property
    def mesh(self) -> Mesh:
        """The mesh that was solved: the caller's, or what resampling, refining or a file made of it."""
        if self._mesh is None:
            self._mesh = Mesh._of(self._stored.surface)
        return self._mesh

    @property
    def message(self) -> str:
        """Why, where the status is not "converged"; notes otherwise. Files keep it among the failures alone."""
        return self._stored.message or "; ".join(f.message for f in self.failures)

    @property
    def failures(self) -> list[Failure]:
        """What failed of this item."""
        return [Failure(*row) for row in self._stored.failures]

    def save(self, path: Path) -> None:
        """Writes a result file (HDF5, docs/hdf5.md) with the mesh and this result. :func:`ricci.save` joins several."""
        _core.write(os.fspath(path), [self._stored])

    def export(self, path: Path, *, model: str = "auto", picture: str = "domain", checker: int = 16,
               what: Sequence[str] = (), field: str = "auto") -> None:
        """Writes what the item holds for other programs, as `ricci export` does (docs/handover.md).

        .vtp, .vtu, .vtkhdf: one block, the surface with every field unless `what` names another; .vtm: all blocks; .glb,
        .gltf: surface, curves, layout; .obj: the refined mesh with the layout as texture coordinates and a
        checkerboard of `checker` squares (0: none); .npz: arrays; .blender.py, .polyscope.py, .paraview.py: a script
        with its data beside it; .svg: a picture of the layout ("domain", "tessellation", "checkerboard", "surface",
        "distortion", "angles", ...). model: "auto", "plane", "poincare", "klein", "half-plane", "disk", "sphere".
        field: what colours the surface.
        """
        _core.Stored.export(self._stored, os.fspath(path), model, picture, checker, list(what), field)


class FlowResult(Result):
    """A metric of prescribed curvature: conformal factor u, scaling edge lengths by exp((u_i + u_j) / 2)."""

    __slots__ = ()

    def _scalar(self, name: str) -> Any:
        scalars = self._stored.flow_scalars
        assert scalars is not None
        return scalars[name]

    def _array(self, name: str) -> Any:
        arrays = self._stored.flow_arrays
        assert arrays is not None
        return arrays[name]

    @property
    def status(self) -> str:
        """"converged", or one of the other :data:`STATUS_NAMES`."""
        return str(self._scalar("status"))

    @property
    def geometry(self) -> str:
        """Background: "euclidean", "hyperbolic" or "spherical"."""
        return str(self._scalar("geometry"))

    @property
    def scheme(self) -> str:
        """"vertex-scaling", or the circle packing."""
        return str(self._scalar("scheme"))

    @property
    def method(self) -> str:
        """"newton" or "gradient"."""
        return str(self._scalar("method"))

    @property
    def boundary(self) -> str:
        """"geodesic", "free" or "curvature"."""
        return str(self._scalar("boundary"))

    @property
    def conformal_factor(self) -> FloatArray:
        """u at the vertices; 0 at unused ones. (V,)"""
        array: FloatArray = self._array("conformal_factor")
        return array

    @property
    def conformal_factor_low(self) -> FloatArray:
        """Where a double does not hold u: to be added to it, unevaluated. (V,), or (0,) where it does."""
        array: FloatArray = self._array("conformal_factor_low")
        return array

    @property
    def target_curvature(self) -> FloatArray:
        """Curvature asked for, radians. (V,)"""
        array: FloatArray = self._array("target_curvature")
        return array

    @property
    def curvature(self) -> FloatArray:
        """Curvature of the metric, radians. (V,)"""
        array: FloatArray = self._array("curvature")
        return array

    @property
    def triangles(self) -> IntArray:
        """The final triangulation, after edge flips: vertices. (F', 3)"""
        array: IntArray = self._array("triangles")
        return array

    @property
    def twin(self) -> IntArray:
        """Its twins of halfedges 3f+k, -1 on the boundary. (3F',)"""
        array: IntArray = self._array("twin")
        return array

    @property
    def edge_length(self) -> FloatArray:
        """Its lengths of halfedges 3f+k, from corner k to the next, in the background geometry. (3F',)"""
        array: FloatArray = self._array("edge_length")
        return array

    @property
    def doubled(self) -> bool:
        """Whether the final triangulation is that of the double of a surface with boundary."""
        return bool(self._scalar("doubled"))

    @property
    def residual_max(self) -> float:
        """max |K - target| over the vertices whose curvature is prescribed, radians."""
        return float(self._scalar("residual_max"))

    @property
    def gauss_bonnet_error(self) -> float:
        """|sum K + kappa A - 2 pi chi|, radians."""
        return float(self._scalar("gauss_bonnet_error"))

    @property
    def precision_digits(self) -> int:
        """Digits of the arithmetic in which both were measured: 16, 19 or 50."""
        return int(self._scalar("precision_digits"))

    @property
    def newton_iterations(self) -> int:
        """Steps taken."""
        return int(self._scalar("newton_iterations"))

    @property
    def flips(self) -> int:
        """Edge flips made."""
        return int(self._scalar("flips"))

    @property
    def seconds(self) -> float:
        """Time of the solve, seconds."""
        return float(self._scalar("seconds"))

    @property
    def area(self) -> float:
        """Of the final metric, in squared units of its lengths; NaN where read from a file."""
        return self._stored.area

    @property
    def packing_length_error(self) -> tuple[float, float]:
        """Circle packings: by how much the initial packing's lengths were off, largest and mean, relative; else NaN."""
        return self._stored.max_length_error, self._stored.mean_length_error

    @property
    def log(self) -> dict[str, npt.NDArray[Any]]:
        """Per step: residual_max (radians), step, flips (so far), seconds (since the start). (n,) each"""
        return {name: self._array(f"log_{name}") for name in ("residual_max", "step", "flips", "seconds")}

    def __repr__(self) -> str:
        return f"<ricci.FlowResult {self.name!r}: {self.status}, {self.geometry}, residual {self.residual_max:.3g}>"


class KeptFactor(NamedTuple):
    """The solution of one vertex of a sweep."""

    vertex: int
    area_distortion: float
    conformal_factor: FloatArray
    """(V,), read-only view."""


class SweepResult(Result):
    """Every vertex (or those chosen) in turn as the only cone: one row for each, ascending by vertex. (M rows)"""

    __slots__ = ()

    def _column(self, name: str, dtype: type) -> Any:
        columns = self._stored.sweep_columns
        return np.empty(0, dtype) if columns is None else columns[name]

    @property
    def status(self) -> str:
        """Of the item as a whole: "converged" where it could be swept (single vertices: `status_code`)."""
        return next((f.status for f in self.failures if f.stage == "sweep"), "converged")

    @property
    def vertex(self) -> IntArray:
        """The cone's vertex. (M,)"""
        array: IntArray = self._column("vertex", np.int32)
        return array

    @property
    def status_code(self) -> ByteArray:
        """Number of the row's status in :data:`STATUS_NAMES`; 0: converged. (M,)"""
        array: ByteArray = self._column("status_code", np.uint8)
        return array

    @property
    def statuses(self) -> list[str]:
        """Names of the rows' statuses. (M)"""
        return [STATUS_NAMES[code] for code in self.status_code]

    @property
    def area_distortion(self) -> FloatArray:
        """Mean square of the logarithm of how the shares of the faces in the area change; NaN unless converged. (M,)"""
        array: FloatArray = self._column("area_distortion", np.float64)
        return array

    @property
    def newton_iterations(self) -> npt.NDArray[np.uint16]:
        """Steps of each solve. (M,)"""
        array: npt.NDArray[np.uint16] = self._column("newton_iterations", np.uint16)
        return array

    @property
    def residual_max(self) -> FloatArray:
        """max |K - target|, radians. (M,)"""
        array: FloatArray = self._column("residual_max", np.float64)
        return array

    @property
    def gauss_bonnet_error(self) -> FloatArray:
        """|sum K - 2 pi chi|, radians. (M,)"""
        array: FloatArray = self._column("gauss_bonnet_error", np.float64)
        return array

    @property
    def precision_digits(self) -> IntArray:
        """Digits of the arithmetic in which these were measured: 16, 19 or 50. (M,)"""
        array: IntArray = self._column("precision_digits", np.int32)
        return array

    @property
    def flips(self) -> IntArray:
        """Edge flips of each solve. (M,)"""
        array: IntArray = self._column("flips", np.int32)
        return array

    @property
    def seconds(self) -> npt.NDArray[np.float32]:
        """Time of its thread that went into each solve, seconds. (M,)"""
        array: npt.NDArray[np.float32] = self._column("seconds", np.float32)
        return array

    @property
    def kept(self) -> list[KeptFactor]:
        """Conformal factors that were kept: best, worst, then the others, the best first."""
        return [KeptFactor(*row) for row in self._stored.sweep_kept[0]]

    @property
    def best(self) -> Optional[KeptFactor]:
        """The vertex of least area distortion (ties: the lowest); None where none converged, or not kept."""
        return self._kept_of(1)

    @property
    def worst(self) -> Optional[KeptFactor]:
        """The vertex of largest area distortion (ties: the lowest); None where none converged, or not kept."""
        return self._kept_of(2)

    def _kept_of(self, which: int) -> Optional[KeptFactor]:
        vertex = self._stored.sweep_kept[which]
        return next((k for k in self.kept if k.vertex == vertex), None)

    def at_vertices(self, column: str = "area_distortion") -> FloatArray:
        """A column at the mesh's vertices, NaN where a vertex was not solved: (V,) float64, a new array."""
        values = np.full(len(self._stored.source_vertex), np.nan)
        values[self.vertex] = getattr(self, column)
        return values

    def __repr__(self) -> str:
        solved = int(np.count_nonzero(self.status_code == 0))
        best = self.best
        text = "" if best is None else f", best vertex {best.vertex} ({best.area_distortion:.4g})"
        return f"<ricci.SweepResult {self.name!r}: {solved} of {len(self.vertex)} vertices converged{text}>"


class GroupResult(Result):
    """A result of any kind as its group of the file has it: attributes, and arrays by their paths (docs/hdf5.md)."""

    __slots__ = ("_kind",)

    def __init__(self, stored: _core.Stored, kind: str, mesh: Optional[Mesh] = None) -> None:
        super().__init__(stored, mesh)
        self._kind = kind

    @property
    def kind(self) -> str:
        """Name of the group."""
        return self._kind

    @property
    def status(self) -> str:
        """"converged", or one of the other :data:`STATUS_NAMES`; the arrays are there where it is "converged"."""
        return self._stored.result(self._kind)[0]

    @property
    def attributes(self) -> dict[str, Attribute]:
        """Single values by name."""
        return self._stored.result(self._kind)[1]

    @property
    def arrays(self) -> Mapping[str, Values]:
        """Arrays by path: read-only views, texts as lists."""
        return self._stored.result(self._kind)[2]

    def __contains__(self, path: str) -> bool:
        return path in self.arrays

    def __getitem__(self, path: str) -> Values:
        """An array by its path, like result["generators/matrix"]."""
        try:
            return self.arrays[path]
        except KeyError:
            raise KeyError(f"{self.name}/{self._kind} has no {path} (status {self.status})") from None

    def _array(self, path: str) -> Any:
        return self[path]

    def _texts(self, path: str) -> list[str]:
        values = self[path]
        assert isinstance(values, list)
        return values

    def _number(self, name: str) -> float:
        value = self.attributes.get(name, np.nan)
        assert not isinstance(value, (str, list))
        return float(value)

    def _lists(self, path: str) -> list[npt.NDArray[Any]]:
        """Lists of different lengths, stored one after another."""
        if path not in self:
            return []
        values, first = self._array(path), self._array(f"{path}_first")
        return [values[first[k] : first[k + 1]] for k in range(len(first) - 1)]

    @property
    def geometry(self) -> str:
        """"euclidean", "hyperbolic" or "spherical"."""
        return str(self.attributes.get("geometry", ""))

    @property
    def residual_max(self) -> float:
        """Of the metric: max |K - target|, radians."""
        return self._number("residual_max")

    @property
    def gauss_bonnet_error(self) -> float:
        """Of the metric: |sum K + kappa A - 2 pi chi|, radians."""
        return self._number("gauss_bonnet_error")

    def __repr__(self) -> str:
        return f"<ricci.{type(self).__name__} {self.name!r}: {self._kind}, {self.status}>"


class Generator(NamedTuple):
    """A generator of the deck transformation group."""

    name: str
    word: str
    """In the letters of the homotopy basis."""
    matrix: FloatArray
    """(2, 2) in SL(2, R) where hyperbolic; (3, 3) rigid motion, or rotation."""
    path: IntArray
    """The loop on the mesh: vertices. (n,)"""


class Layout(GroupResult):
    """The geometric structure of a surface: group, one fundamental domain laid out, the map onto the mesh.

    The input's faces are cut into P convex pieces with C corners in all; L points of the layout.
    """

    __slots__ = ()

    @property
    def flow(self) -> FlowResult:
        """The metric it was made from."""
        return FlowResult(self._stored, self._mesh)

    @property
    def position(self) -> FloatArray:
        """Points as (x, y, t) with kappa (x^2 + y^2) + t^2 = 1: hyperboloid, plane t = 1, or sphere. (L, 3)"""
        array: FloatArray = self._array("position")
        return array

    @property
    def conformal(self) -> FloatArray:
        """The same in the plane: Poincare disk, plane, or stereographic projection. (L, 2)"""
        array: FloatArray = self._array("conformal")
        return array

    @property
    def corner_vertex(self) -> IntArray:
        """Of each corner of the pieces: its point of the layout. (C,)"""
        array: IntArray = self._array("corner_vertex")
        return array

    @property
    def piece_first(self) -> IntArray:
        """First corner of each piece. (P+1,)"""
        array: IntArray = self._array("refinement/first")
        return array

    @property
    def piece_face(self) -> IntArray:
        """The face of the mesh that each piece lies in. (P,)"""
        array: IntArray = self._array("refinement/input_face")
        return array

    @property
    def generators(self) -> list[Generator]:
        """Canonical generators: a1, b1, ..., then boundaries and cones."""
        if "generators/name" not in self:
            return []
        paths = self._lists("generators/path")
        matrix = self["generators/half_plane" if self.geometry == "hyperbolic" else "generators/matrix"]
        assert isinstance(matrix, np.ndarray)
        names, words = self._texts("generators/name"), self._texts("generators/word")
        return [Generator(*row) for row in zip(names, words, matrix, paths)]

    @property
    def relator(self) -> str:
        """The relation of the group, in the letters of the homotopy basis."""
        return str(self.attributes.get("relator", ""))

    @property
    def relator_error(self) -> float:
        """Largest entry of |relator - identity|."""
        return self._number("relator_error")

    @property
    def closing_error(self) -> float:
        """By how much the sides of the domain miss each other."""
        return self._number("closing_error")

    @property
    def flipped_pieces(self) -> int:
        """Pieces of the map that are turned over."""
        return int(self._number("flipped_pieces"))

    @property
    def copies(self) -> FloatArray:
        """Deck transformations of the tessellation as (Re a, Im a, Re b, Im b); (0, 4) where none were asked for."""
        array: FloatArray = self._array("copies/element") if "copies/element" in self else np.empty((0, 4))
        return array

    @property
    def quality(self) -> Optional[GroupResult]:
        """How conformal the map is, where asked for: angle ratios, quasi-conformal and area distortion."""
        return GroupResult(self._stored, "quality", self._mesh) if "quality" in self._stored.kinds else None

    @property
    def atlas(self) -> Optional[GroupResult]:
        """Charts and transition maps, where asked for."""
        return GroupResult(self._stored, "atlas", self._mesh) if "atlas" in self._stored.kinds else None

    def save_uv(self, path: Path, *, model: str = "auto", checker: int = 0) -> None:
        """Writes .obj: the refined mesh with the layout as texture coordinates; checker: a texture of so many squares."""
        self.export(path, model=model, checker=checker)


class Geodesic(NamedTuple):
    """A primitive closed geodesic, up to orientation."""

    length: float
    boundary: int
    """The boundary curve that it is, or -1."""
    word: str
    """In the canonical generators; "" where not asked for."""
    points: FloatArray
    """The curve on the mesh, (n, 3) in its units; (0, 3) where not drawn."""


class Spectrum(GroupResult):
    """The length spectrum: all closed geodesics up to a length, powers included, with multiplicity."""

    __slots__ = ()

    @property
    def lengths(self) -> FloatArray:
        """Ascending. Hyperbolic, or in units of the shortest (torus) or of the core (annulus). (n,)"""
        array: FloatArray = self._array("length")
        return array

    @property
    def power(self) -> IntArray:
        """1: primitive. (n,)"""
        array: IntArray = self._array("power")
        return array

    @property
    def geodesic(self) -> IntArray:
        """Number in `geodesics`. (n,)"""
        array: IntArray = self._array("geodesic")
        return array

    @property
    def geodesics(self) -> list[Geodesic]:
        """The primitive ones, ascending."""
        lengths, boundary = self._array("geodesics/length"), self._array("geodesics/boundary")
        points = self._lists("geodesics/points") or [np.empty((0, 3))] * len(lengths)
        words = self._texts("geodesics/word")
        return [Geodesic(*row) for row in zip(lengths.tolist(), boundary.tolist(), words, points)]

    @property
    def complete_up_to(self) -> float:
        """Proved: all geodesics up to this length are there."""
        return self._number("complete_up_to")

    @property
    def relator_error(self) -> float:
        """Of the deck transformation group: largest entry of |relator - identity|."""
        return self._number("relator_error")

    @property
    def unit(self) -> str:
        """What lengths are measured in; "": the hyperbolic metric."""
        return str(self.attributes.get("unit", ""))


class Curve(NamedTuple):
    """A curve of a marking: the geodesic in its class."""

    name: str
    length: float
    word: str
    points: FloatArray
    """On the mesh, (n, 3) in its units; (0, 3) where not drawn."""


class Teichmuller(GroupResult):
    """A point of Teichmueller space: coordinates by a marking that depends on the geometry alone, or by given curves."""

    __slots__ = ()

    @property
    def coordinates(self) -> FloatArray:
        """6g-5+3r hyperbolic lengths (chi < 0); (Re, Im) of the modulus (torus); the modulus (annulus); descriptors
        (sphere, disk). (n,)"""
        array: FloatArray = self._array("coordinates")
        return array

    @property
    def names(self) -> list[str]:
        """Names of the coordinates. (n)"""
        return self._texts("names")

    @property
    def marking(self) -> str:
        """"geometric", "curves" (given), or "none" needed."""
        return str(self.attributes.get("marking", ""))

    @property
    def smallest_gap(self) -> float:
        """By how much the marking's choices were better than the next, relative; small: unstable."""
        return self._number("smallest_gap")

    @property
    def modulus(self) -> complex:
        """Of a torus, reduced to the standard fundamental domain; of an annulus height / circumference."""
        values = self.coordinates
        if "modulus_re" in self.names:
            return complex(values[0], values[1])
        if self.names == ["modulus"]:
            return complex(values[0])
        raise ValueError(f"{self.name} is neither a torus nor an annulus")

    @property
    def curves(self) -> list[Curve]:
        """The curves whose lengths are the coordinates (chi < 0)."""
        return self._curves("curves")

    @property
    def loops(self) -> list[Curve]:
        """Further curves that were asked about."""
        return self._curves("loops")

    def _curves(self, path: str) -> list[Curve]:
        if f"{path}/name" not in self:
            return []
        names, words, lengths = self._texts(f"{path}/name"), self._texts(f"{path}/word"), self._array(f"{path}/length")
        points = self._lists(f"{path}/points") or [np.empty((0, 3))] * len(names)
        return [Curve(*row) for row in zip(names, lengths.tolist(), words, points)]

    @property
    def fenchel_nielsen(self) -> list[tuple[str, float, float]]:
        """(name, length, twist) of the pants decomposition, hyperbolic lengths."""
        if "fenchel_nielsen/name" not in self:
            return []
        names = self._texts("fenchel_nielsen/name")
        lengths, twists = self._array("fenchel_nielsen/length"), self._array("fenchel_nielsen/twist")
        return list(zip(names, lengths.tolist(), twists.tolist()))


class Item:
    """One mesh of a run with all its results."""

    __slots__ = ("_mesh", "_stored")

    def __init__(self, stored: _core.Stored, mesh: Optional[Mesh] = None) -> None:
        self._stored = stored
        self._mesh = mesh

    @property
    def name(self) -> str:
        """<mesh name>@<faces>, made unique by ~2, ~3."""
        return self._stored.name

    @property
    def source(self) -> str:
        """The file that the mesh came from."""
        return self._stored.source

    @property
    def source_hash(self) -> str:
        """XXH3-64 of its bytes, 16 hexadecimal digits."""
        return self._stored.source_hash

    @property
    def source_vertex(self) -> IntArray:
        """Nearest vertex of the input, of a resampled mesh; else its number there. (V,)"""
        return self._stored.source_vertex

    @property
    def mesh(self) -> Mesh:
        """The mesh as it was solved."""
        if self._mesh is None:
            self._mesh = Mesh._of(self._stored.surface)
        return self._mesh

    @property
    def sweep(self) -> Optional[SweepResult]:
        """Its sweep, or None."""
        return None if self._stored.sweep_columns is None else SweepResult(self._stored, self._mesh)

    @property
    def flow(self) -> Optional[FlowResult]:
        """Its flow, or None."""
        return None if self._stored.flow_scalars is None else FlowResult(self._stored, self._mesh)

    @property
    def kinds(self) -> list[str]:
        """Kinds of its further results."""
        return self._stored.kinds

    def result(self, kind: str) -> GroupResult:
        """A further result of any kind. Raises KeyError."""
        if kind not in self._stored.kinds:
            raise KeyError(f"{self.name} has no result {kind!r} (it has {self.kinds})")
        return {"layout": Layout, "spectrum": Spectrum, "teichmuller": Teichmuller}.get(kind, GroupResult)(
            self._stored, kind, self._mesh
        )

    @property
    def layout(self) -> Optional[Layout]:
        """Its layout, or None."""
        return Layout(self._stored, "layout", self._mesh) if "layout" in self._stored.kinds else None

    @property
    def spectrum(self) -> Optional[Spectrum]:
        """Its length spectrum, or None."""
        return Spectrum(self._stored, "spectrum", self._mesh) if "spectrum" in self._stored.kinds else None

    @property
    def teichmuller(self) -> Optional[Teichmuller]:
        """Its Teichmueller coordinates, or None."""
        return Teichmuller(self._stored, "teichmuller", self._mesh) if "teichmuller" in self._stored.kinds else None

    @property
    def failures(self) -> list[Failure]:
        """What failed of it."""
        return [Failure(*row) for row in self._stored.failures]

    def export(self, path: Path, *, model: str = "auto", picture: str = "domain", checker: int = 16,
               what: Sequence[str] = (), field: str = "auto") -> None:
        """As :meth:`Result.export`."""
        self._stored.export(os.fspath(path), model, picture, checker, list(what), field)

    def __repr__(self) -> str:
        has = [kind for kind in ("sweep", "flow") if getattr(self, kind) is not None] + self.kinds
        return f"<ricci.Item {self.name!r}: {', '.join(has) or 'mesh alone'}>"


class Run:
    """A result file in memory: items in input order, and failures. Items by number or by name."""

    __slots__ = ("_core", "_items")

    def __init__(self, core: _core.Run) -> None:
        self._core = core
        self._items = [Item(stored) for stored in core.items]

    @property
    def items(self) -> list[Item]:
        """In input order."""
        return list(self._items)

    @property
    def failures(self) -> list[Failure]:
        """Of inputs, items and vertices."""
        return [Failure(*row) for row in self._core.failures]

    @property
    def complete(self) -> bool:
        """Whether the run was finished."""
        return self._core.complete

    @property
    def info(self) -> dict[str, Union[str, int]]:
        """software_version, git, command, config (TOML), host, threads, created (ISO 8601, UTC)."""
        return self._core.info

    def save(self, path: Path) -> None:
        """Writes a result file with the same datasets."""
        _core.write_run(os.fspath(path), self._core)

    def __len__(self) -> int:
        return len(self._items)

    def __iter__(self) -> Iterator[Item]:
        return iter(self._items)

    def __getitem__(self, key: Union[int, str]) -> Item:
        if isinstance(key, int):
            return self._items[key]
        for item in self._items:
            if item.name == key:
                return item
        raise KeyError(f"no item {key!r} (there are {[item.name for item in self._items]})")

    def __repr__(self) -> str:
        return f"<ricci.Run: {len(self)} items, {len(self.failures)} failures>"


def save(path: Path, *results: Union[Result, Item]) -> None:
    """Writes one result file (HDF5) of several results. Those of one mesh (same name, same arrays) become one item;
    other meshes of the same name get ~2, ~3. Raises ValueError for sweeps that kept different factors,
    :class:`FileError`."""
    _core.write(os.fspath(path), [result._stored for result in results])
