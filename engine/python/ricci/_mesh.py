"""Meshes: NumPy arrays that the engine understands."""

from __future__ import annotations

import os
from typing import Any, Optional, Union

import numpy as np
import numpy.typing as npt

from . import _core
from ._errors import Defect, MeshError

Path = Union[str, "os.PathLike[str]"]
FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.int32]


def _defects(rows: list[tuple[str, str, int, str]]) -> list[Defect]:
    return [Defect(*row) for row in rows]


def _surfaces(made: _core._Components, what: str) -> list[_core.Surface]:
    surfaces, _, errors = made
    if errors:
        defects = _defects(errors)
        raise MeshError(f"{what}: " + "; ".join(d.message for d in defects), defects)
    return surfaces


def _shares(array: Any, dtype: type) -> bool:
    """Whether the engine can use an array as it is."""
    return isinstance(array, np.ndarray) and array.dtype == dtype and array.flags.c_contiguous and array.flags.aligned


def _rows(values: npt.ArrayLike, dtype: type, what: str, copy: Optional[bool]) -> tuple[npt.NDArray[Any], bool]:
    """The array as (n, 3) of `dtype`, and whether it is the caller's memory."""
    array = np.asarray(values)
    if array.ndim != 2 or array.shape[1] != 3:
        raise ValueError(f"{what} must have the shape (n, 3), not {array.shape}")
    if _shares(array, dtype):
        return (array.copy(), False) if copy else (array, array is values or np.shares_memory(array, values))
    if copy is False:
        raise ValueError(
            f"{what} cannot be used without a copy: {array.dtype}, "
            f"{'C-contiguous' if array.flags.c_contiguous else 'not C-contiguous'}; "
            f"C-contiguous {np.dtype(dtype).name} can"
        )
    if dtype is np.int32:
        if array.dtype.kind not in "iu":
            raise TypeError(f"{what} must be whole numbers, not {array.dtype}")
        if array.size and (array.min() < 0 or array.max() > np.iinfo(np.int32).max):
            raise ValueError(f"{what} must lie between 0 and {np.iinfo(np.int32).max}")
    elif array.dtype.kind not in "iuf":
        raise TypeError(f"{what} must be real numbers, not {array.dtype}")
    return np.array(array, dtype=dtype, order="C"), False


def _read_only(array: npt.NDArray[Any]) -> npt.NDArray[Any]:
    view = array.view()
    view.flags.writeable = False
    return view


class Mesh:
    """A connected, oriented triangle mesh, with or without boundary.

    Parameters
    ----------
    points : (V, 3) float64, C-contiguous
        Vertex positions, in any unit.
    triangles : (F, 3) int32, C-contiguous
        Vertex numbers from zero, counterclockwise seen from outside.
    name : str
        Results are called ``<name>@<faces>``.
    repair : str
        Changes to make, of "orient,weld,drop-degenerate"; nothing happens unasked.
    copy : bool or None
        None: arrays of that form are used as they are, others are copied. False: ValueError where a copy would be
        needed. True: always copied.

    Arrays that are used as they are stay the caller's: `points` and `triangles` of the mesh are read-only views of
    them, and the mesh is what they hold at the time of each call. What the engine computes on, a halfedge structure
    of about 9F + 6V numbers, cannot be a view: it is made from them here, checked, and made again by the next call
    after their contents have changed (which a hash tells). They must not change during a call. A repaired mesh has
    arrays of its own.

    Raises :class:`MeshError` with every defect; ValueError for a mesh of several components, which
    :func:`split` takes.
    """

    __slots__ = ("_given", "_surface")

    def __init__(
        self,
        points: npt.ArrayLike,
        triangles: npt.ArrayLike,
        *,
        name: str = "mesh",
        repair: str = "",
        copy: Optional[bool] = None,
    ) -> None:
        p, shared = _rows(points, np.float64, "points", copy)
        t, also_shared = _rows(triangles, np.int32, "triangles", copy)
        surfaces = _surfaces(_core.from_arrays(p, t, name, repair), name)
        if len(surfaces) != 1:
            raise ValueError(f"{name} has {len(surfaces)} components; ricci.split makes a mesh of each")
        self._surface = surfaces[0]
        self._given: Optional[tuple[FloatArray, IntArray]] = None
        if (shared or also_shared) and not repair:
            self._given = (p, t)

    @classmethod
    def _of(cls, surface: _core.Surface) -> Mesh:
        mesh = cls.__new__(cls)
        mesh._surface = surface
        mesh._given = None
        return mesh

    def _engine(self) -> _core.Surface:
        """The engine's structure of what the arrays hold now."""
        if self._given is not None and not self._surface.matches(*self._given):
            surfaces = _surfaces(_core.from_arrays(*self._given, self.name, ""), self.name)
            if len(surfaces) != 1:
                raise ValueError(f"{self.name} has come to have {len(surfaces)} components")
            self._surface = surfaces[0]
        return self._surface

    @property
    def points(self) -> FloatArray:
        """Vertex positions, (V, 3), read-only view. Raises ValueError for an intrinsic surface, which has none."""
        points = self._surface.points if self._given is None else _read_only(self._given[0])
        if points is None:
            raise ValueError(f"{self.name} is an intrinsic surface: it has edge lengths and no points")
        return points

    @property
    def triangles(self) -> IntArray:
        """Vertex numbers of the faces, (F, 3), read-only view."""
        return self._surface.triangles if self._given is None else _read_only(self._given[1])

    @property
    def twin(self) -> IntArray:
        """Of halfedge 3f+k, which runs from corner k of face f to the next: the halfedge across, -1 on the
        boundary. (3F,), read-only view."""
        return self._engine().twin

    @property
    def edge_length(self) -> FloatArray:
        """Length of halfedge 3f+k in the units of the points. (3F,), read-only view."""
        return self._engine().edge_length

    @property
    def input_vertex(self) -> IntArray:
        """Number of each vertex in the input. (V,), read-only view."""
        return self._engine().input_vertex

    @property
    def name(self) -> str:
        """Results are called ``<name>@<faces>``; of a loaded mesh the file's stem."""
        return self._surface.name

    @property
    def source(self) -> str:
        """The file it was loaded from, or ""."""
        return self._surface.source

    @property
    def intrinsic(self) -> bool:
        """Whether it has edge lengths alone and no points."""
        return self._surface.intrinsic

    @property
    def notes(self) -> list[Defect]:
        """What was noticed that is no defect (unused vertices, triangulated polygons, ...)."""
        return _defects(self._surface.notes)

    @property
    def vertices(self) -> int:
        """Number of vertices that faces use."""
        return self._engine().topology()["vertices"]

    @property
    def edges(self) -> int:
        """Number of edges."""
        return self._engine().topology()["edges"]

    @property
    def faces(self) -> int:
        """Number of faces, F."""
        return len(self.triangles)

    @property
    def genus(self) -> int:
        """Number of handles."""
        return self._engine().topology()["genus"]

    @property
    def boundaries(self) -> int:
        """Number of boundary curves."""
        return self._engine().topology()["boundaries"]

    @property
    def euler_characteristic(self) -> int:
        """V - E + F, which is 2 - 2 genus - boundaries."""
        return self._engine().topology()["euler_characteristic"]

    def save(self, path: Path) -> None:
        """Writes .off, .obj or .ply, or .len (intrinsic), by the suffix, with all digits."""
        self._engine().save(os.fspath(path))

    def __repr__(self) -> str:
        t = self._engine().topology()
        return (
            f"<ricci.Mesh {self.name!r}: {t['vertices']} vertices, {t['faces']} faces, genus {t['genus']}, "
            f"{t['boundaries']} boundaries>"
        )


def split(points: npt.ArrayLike, triangles: npt.ArrayLike, *, name: str = "mesh", repair: str = "") -> list[Mesh]:
    """The components of a mesh, ordered by lowest vertex, as meshes ``<name>.c0``, ``<name>.c1``, ... (one: ``<name>``).

    points: (V, 3); triangles: (F, 3). The meshes own their arrays; `input_vertex` of each tells the numbers here.
    Raises :class:`MeshError`.
    """
    p, _ = _rows(points, np.float64, "points", None)
    t, _ = _rows(triangles, np.int32, "triangles", None)
    return [Mesh._of(s) for s in _surfaces(_core.from_arrays(p, t, name, repair), name)]


def load(path: Path, *, repair: str = "") -> Mesh:
    """Reads OBJ, OFF, PLY, STL (text and binary, each also .gz) or an intrinsic surface (.len).

    The arrays of the mesh are views of the engine's memory. Raises :class:`FileError` where the file cannot be read,
    :class:`MeshError` with every defect, ValueError for several components (:func:`load_components`).
    """
    meshes = load_components(path, repair=repair)
    if len(meshes) != 1:
        raise ValueError(f"{os.fspath(path)} has {len(meshes)} components; ricci.load_components gives all of them")
    return meshes[0]


def load_components(path: Path, *, repair: str = "") -> list[Mesh]:
    """The same for files of several components: each as a mesh, ordered by lowest vertex."""
    name = os.fspath(path)
    return [Mesh._of(s) for s in _surfaces(_core.load(name, repair), name)]


def generate(
    name: str,
    *,
    faces: int = 5000,
    major: float = 2.5,
    minor: float = 1.0,
    semi_axes: tuple[float, float, float] = (1.5, 1.0, 0.75),
    genus: int = 2,
    height: float = 1.0,
    jitter: float = 0.0,
    seed: int = 0,
) -> Mesh:
    """A sample surface with known topology, as `ricci generate` makes it: the same options give the same bits.

    faces: about so many. major, minor: radii of the torus and of the planar annulus. semi_axes: of the ellipsoid.
    genus: of genus-g. height: of the annulus. jitter: moves vertices within the surface by up to this share of an
    edge, 0 to 0.45, with `seed`. :func:`generators` lists the names. Raises ValueError for others.
    """
    options = _core.GenerateOptions()
    options.faces, options.major, options.minor = faces, major, minor
    options.semi_axes = list(semi_axes)
    options.genus, options.height, options.jitter, options.seed = genus, height, jitter, seed
    return Mesh._of(_core.generate(name, options))


def generators() -> dict[str, str]:
    """The names that :func:`generate` knows, each with a line of description."""
    return _core.generators()


def set_max_unpacked(size: int) -> None:
    """Bytes that a .gz may unpack to, for this process (0: 200 times its size, at least 64 MiB)."""
    _core.set_max_unpacked(size)
