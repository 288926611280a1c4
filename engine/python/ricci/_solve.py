"""One mesh, one result. Options have the names and defaults of the command line."""

from __future__ import annotations

import os
from typing import Callable, Mapping, Optional, Sequence, Union

import numpy as np
import numpy.typing as npt

from . import _core
from ._mesh import Mesh, Path
from ._progress import FlowProgress
from ._results import FlowResult, Layout, Spectrum, Teichmuller

Cones = Union[Mapping[int, Union[float, str]], Sequence[Union[str, tuple[int, Union[float, str]]]]]
Target = Union[str, Path, npt.ArrayLike]
FlowCallback = Optional[Callable[[FlowProgress], object]]
NamedCurves = Mapping[str, Sequence[int]]


def curvature_text(value: Union[float, str]) -> str:
    """A curvature as the command line takes it: radians with all digits, or "-4pi", "pi/2"."""
    return value if isinstance(value, str) else repr(float(value))


def _cones(cones: Optional[Cones]) -> list[str]:
    if cones is None:
        return []
    if isinstance(cones, str):
        return [cones]
    pairs = cones.items() if isinstance(cones, Mapping) else cones
    return [pair if isinstance(pair, str) else f"{int(pair[0])}:{curvature_text(pair[1])}" for pair in pairs]


def _target(target: Optional[Target], options: _core.SolveOptions) -> Optional[list[float]]:
    """Names and files go into the options; curvatures come back."""
    if target is None:
        return None
    if isinstance(target, (str, os.PathLike)):
        options.target = os.fspath(target)
        return None
    values = np.asarray(target, dtype=np.float64)
    if values.ndim != 1 or not np.all(np.isfinite(values)):
        raise ValueError("target must be finite curvatures in radians, of the shape (V,)")
    chosen: list[float] = values.tolist()
    return chosen


def _options(
    geometry: str,
    scheme: str,
    method: str,
    sphere: str,
    tolerance: float,
    precision: str,
    max_iterations: int,
    cones: Optional[Cones],
    boundary: Optional[str],
    delaunay: str,
    densify: bool,
    timeout: float,
) -> _core.SolveOptions:
    options = _core.SolveOptions()
    options.geometry, options.scheme, options.method, options.sphere = geometry, scheme, method, sphere
    options.tolerance, options.precision, options.max_iterations = tolerance, precision, max_iterations
    options.cones, options.boundary, options.delaunay = _cones(cones), boundary or "", delaunay
    options.densify, options.timeout = densify, timeout
    return _checked(options)


def _checked(options: _core.SolveOptions) -> _core.SolveOptions:
    if not (0 < options.tolerance < np.inf) or options.max_iterations < 0 or not options.timeout >= 0:
        raise ValueError("tolerance must be positive, max_iterations and timeout not negative")
    return options


def flow(
    mesh: Mesh,
    *,
    geometry: str = "auto",
    scheme: str = "vertex-scaling",
    method: str = "newton",
    sphere: str = "robust",
    target: Optional[Target] = None,
    cones: Optional[Cones] = None,
    boundary: Optional[str] = None,
    delaunay: str = "isometric",
    tolerance: float = 1e-10,
    precision: str = "auto",
    max_iterations: int = 0,
    densify: bool = False,
    timeout: float = 0.0,
    threads: int = 0,
    progress: FlowCallback = None,
) -> FlowResult:
    """One solve: the metric with prescribed curvature.

    Parameters
    ----------
    geometry : "auto", "euclidean", "hyperbolic" or "spherical" background. Without target or cone, auto is hyperbolic
        for chi < 0, Euclidean for chi = 0, spherical for closed genus 0 and disks; else Euclidean.
    scheme : "vertex-scaling", or a circle packing: "inversive-distance", "thurston", "tangential", "virtual-radius".
    method : "newton" or "gradient". sphere : "robust" (through the plane) or "direct".
    target : "flat", "uniform", "boundary", a file of V numbers, or an array of curvatures, (V,), radians.
    cones : {vertex: curvature}, pairs, or texts "0:-4pi"; radians, on top of the target (flat when none is given).
    boundary : "geodesic" (through the double), "free" (u = 0 there) or "curvature" (as the target says).
    delaunay : "isometric", or "none": start from the triangulation as it is.
    tolerance : on max |K - target|, radians. precision : "auto", "double" or "extended".
    max_iterations : 0: 500 Newton steps, 100000 gradient steps. densify : refine around cones (circle packings).
    timeout : seconds; 0: none. threads : 0: all this process may use; the bits do not depend on it.
    progress : called with :class:`FlowProgress` of the latest step.

    Raises ValueError for options that there are not or that do not fit the mesh; what comes out numerically is the
    result's `status`.
    """
    options = _options(geometry, scheme, method, sphere, tolerance, precision, max_iterations, cones, boundary,
                       delaunay, densify, timeout)  # fmt: skip
    values = _target(target, options)
    stored = _core.flow(mesh._engine(), options, values, threads, progress)
    return FlowResult(stored, None if densify else mesh)


def layout(
    mesh: Mesh,
    *,
    geometry: str = "auto",
    scheme: str = "vertex-scaling",
    method: str = "newton",
    sphere: str = "robust",
    target: Optional[Target] = None,
    cones: Optional[Cones] = None,
    boundary: Optional[str] = None,
    delaunay: str = "isometric",
    tolerance: float = 1e-10,
    precision: str = "auto",
    max_iterations: int = 0,
    densify: bool = False,
    subdivide: int = 0,
    base: Optional[int] = None,
    seed_face: Optional[int] = None,
    goal: float = 1e-10,
    digits: int = 800,
    copies: int = 0,
    copies_within: float = 12.0,
    quality: bool = False,
    atlas: Optional[str] = None,
    charts: int = 0,
    timeout: float = 0.0,
    threads: int = 0,
    progress: FlowCallback = None,
) -> Layout:
    """The geometric structure of a surface: generators of its group, one domain laid out, the map onto the mesh.

    The options of :func:`flow` decide the metric (Euclidean ones are scaled to area 1). Further ones:

    subdivide : midpoint subdivisions first (0 to 8). base : vertex that the generators are based at (default: one in
    the middle). seed_face : face laid out first, at the origin. goal : relator and closing error beyond which more
    digits are taken, at most `digits` (16: double only). copies : so many copies of the domain (tessellation), those
    hyperbolic ones within `copies_within` of the origin. quality : measure how conformal the map is. atlas : "auto",
    "affine", "hyperbolic", "projective", "spherical", of about `charts` charts. timeout : of the solve, seconds.
    """
    options = _options(geometry, scheme, method, sphere, tolerance, precision, max_iterations, cones, boundary,
                       delaunay, densify, timeout)  # fmt: skip
    values = _target(target, options)
    if not 0 <= subdivide <= 8 or not 16 <= digits <= 800 or not 0 <= copies <= 1000000 or not goal > 0:
        raise ValueError("subdivide must be 0 to 8, digits 16 to 800, copies 0 to 1000000, goal positive")
    if not 0 <= copies_within <= 30 or charts < 0:
        raise ValueError("copies_within must be 0 to 30, charts not negative")
    wanted = _core.LayoutOptions()
    wanted.subdivide, wanted.goal, wanted.digits = subdivide, goal, digits
    wanted.base = -1 if base is None else base
    wanted.seed_face = -1 if seed_face is None else seed_face
    wanted.copies, wanted.copies_within = copies, copies_within
    wanted.quality, wanted.atlas, wanted.charts = quality, atlas or "", charts
    stored = _core.layout(mesh._engine(), options, values, wanted, threads, progress)
    return Layout(stored, "layout", None if densify or subdivide else mesh)


def _shape_options(tolerance: float, max_iterations: int, delaunay: str, timeout: float) -> _core.SolveOptions:
    options = _core.SolveOptions()
    options.tolerance, options.max_iterations = tolerance, max_iterations
    options.delaunay, options.timeout = delaunay, timeout
    return _checked(options)


def spectrum(
    mesh: Mesh,
    *,
    max_length: float = 4.0,
    count: int = 0,
    words: bool = True,
    draw: Optional[int] = None,
    delaunay: str = "isometric",
    tolerance: float = 1e-10,
    max_iterations: int = 0,
    timeout: float = 0.0,
    threads: int = 0,
    progress: FlowCallback = None,
) -> Spectrum:
    """All closed geodesics up to a length, of the uniformization metric: hyperbolic for chi < 0 (boundaries geodesic),
    flat for tori (the shortest has length 1) and annuli (the core has).

    max_length : complete up to here. count : at least so many lengths instead; the last multiplet is finished.
    words : in the canonical generators. draw : the curves on the mesh too, of the so many shortest primitive ones
    (0: of all). tolerance : on max |K|, radians; 1e-12 is tried first. timeout : of the solve, seconds.

    Raises ValueError for spheres and disks, which have none.
    """
    if not max_length > 0 or not 0 <= count <= 1000000:
        raise ValueError("max_length must be positive, count 0 to 1000000")
    options = _shape_options(tolerance, max_iterations, delaunay, timeout)
    stored = _core.spectrum(
        mesh._engine(), options, max_length, count, words, -1 if draw is None else draw, threads, progress
    )
    return Spectrum(stored, "spectrum", mesh)


def _curves(curves: Optional[NamedCurves]) -> list[tuple[str, list[int]]]:
    paths = [(name, [int(v) for v in vertices]) for name, vertices in (curves or {}).items()]
    # Paths of generators end where they began.
    return [(name, path[:-1] if len(path) > 1 and path[0] == path[-1] else path) for name, path in paths]


def teichmuller(
    mesh: Mesh,
    *,
    marking: Optional[NamedCurves] = None,
    loops: Optional[NamedCurves] = None,
    words: bool = True,
    draw: bool = False,
    delaunay: str = "isometric",
    tolerance: float = 1e-10,
    max_iterations: int = 0,
    timeout: float = 0.0,
    threads: int = 0,
    progress: FlowCallback = None,
) -> Teichmuller:
    """Coordinates in Teichmueller space: lengths of 6g-5+3r geodesics (chi < 0), modulus (torus, annulus), descriptors of
    spheres and disks (docs/shape_space.md).

    marking : {name: closed path of vertices, joined by edges, the last to the first (which may be repeated)}, whose
    geodesics' lengths are the coordinates instead of those by the rule. loops : further closed paths, whose classes and lengths are measured.
    words : in the canonical generators. draw : the coordinates' geodesics on the mesh too.
    """
    options = _shape_options(tolerance, max_iterations, delaunay, timeout)
    stored = _core.teichmuller(
        mesh._engine(), options, _curves(marking), _curves(loops), words, draw, threads, progress
    )
    return Teichmuller(stored, "teichmuller", mesh)
