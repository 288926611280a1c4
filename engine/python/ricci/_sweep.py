"""The main job: every vertex in turn as the only cone."""

from __future__ import annotations

import os
from typing import Any, Callable, Optional, Sequence, Union, overload

from . import _core
from ._mesh import Mesh, Path
from ._progress import SweepProgress
from ._results import Run, SweepResult
from ._solve import curvature_text

Input = Union[Mesh, Path]
SweepCallback = Optional[Callable[[SweepProgress], object]]


def _vertices(vertices: Union[str, Path, Sequence[int]]) -> str:
    if isinstance(vertices, (str, os.PathLike)):
        return os.fspath(vertices)
    return "list:" + ",".join(str(int(v)) for v in vertices)


@overload
def sweep(
    mesh: Mesh,
    *,
    vertices: Union[str, Path, Sequence[int]] = ...,
    resolutions: Sequence[Union[int, str]] = ...,
    keep: Union[str, int] = ...,
    scheme: str = ...,
    boundary: str = ...,
    cone_curvature: Optional[Union[float, str]] = ...,
    delaunay: str = ...,
    tolerance: float = ...,
    max_iterations: int = ...,
    densify: bool = ...,
    solver: str = ...,
    precision: str = ...,
    lanes: int = ...,
    repair: str = ...,
    component: Optional[int] = ...,
    timeout: float = ...,
    max_memory: Union[int, str] = ...,
    threads: int = ...,
    output: Optional[Path] = ...,
    resume: bool = ...,
    retry_failed: bool = ...,
    progress: SweepCallback = ...,
) -> SweepResult: ...


@overload
def sweep(
    mesh: Union[Path, Sequence[Input]],
    *,
    vertices: Union[str, Path, Sequence[int]] = ...,
    resolutions: Sequence[Union[int, str]] = ...,
    keep: Union[str, int] = ...,
    scheme: str = ...,
    boundary: str = ...,
    cone_curvature: Optional[Union[float, str]] = ...,
    delaunay: str = ...,
    tolerance: float = ...,
    max_iterations: int = ...,
    densify: bool = ...,
    solver: str = ...,
    precision: str = ...,
    lanes: int = ...,
    repair: str = ...,
    component: Optional[int] = ...,
    timeout: float = ...,
    max_memory: Union[int, str] = ...,
    threads: int = ...,
    output: Optional[Path] = ...,
    resume: bool = ...,
    retry_failed: bool = ...,
    progress: SweepCallback = ...,
) -> Run: ...


def sweep(
    mesh: Union[Input, Sequence[Input]],
    *,
    vertices: Union[str, Path, Sequence[int]] = "all",
    resolutions: Sequence[Union[int, str]] = ("input",),
    keep: Union[str, int] = "best,worst",
    scheme: str = "vertex-scaling",
    boundary: str = "geodesic",
    cone_curvature: Optional[Union[float, str]] = None,
    delaunay: str = "isometric",
    tolerance: float = 1e-10,
    max_iterations: int = 0,
    densify: bool = False,
    solver: str = "lanes",
    precision: str = "auto",
    lanes: int = 16,
    repair: str = "",
    component: Optional[int] = None,
    timeout: float = 0.0,
    max_memory: Union[int, str] = "",
    threads: int = 0,
    output: Optional[Path] = None,
    resume: bool = False,
    retry_failed: bool = False,
    progress: SweepCallback = None,
) -> Union[SweepResult, Run]:
    """Makes every vertex in turn the only cone of a flat metric and measures the area distortion.

    A :class:`Mesh` gives a :class:`SweepResult`. A path, folder or glob, or a list of these and of meshes, gives a
    :class:`Run` with an item for each component and resolution; what fails is recorded there and the rest goes on.
    The bits are those of `ricci sweep`, for any number of threads.

    Parameters
    ----------
    vertices : "all" interior ones, "sample:N[:SEED]", vertex numbers, or a file of them.
    resolutions : target face counts, or "input": the mesh as it is. A single mesh takes one.
    keep : conformal factors kept: "none", "best", "worst", "best,worst", "all", or a number of further ones.
    boundary : "geodesic" or "free". cone_curvature : radians, or text like "-4pi"; default 2 pi chi.
    solver : "lanes" (several vertices at a time) or "newton". lanes : 1 to 16 at a time on each thread.
    repair, component : for files: changes to make; the only component of each to sweep.
    timeout : seconds for each solve; 0: none. max_memory : bound on the predicted memory, bytes or like "8G".
    threads : 0: all this process may use.
    output : result file (HDF5). What is finished is durable every few seconds in <output>.parts; Ctrl-C, a crash or an
    exception of `progress` leave it there, and `resume` continues. Without it the results are in memory alone.
    resume : continue what an interrupted run with the same options finished. retry_failed : and try what failed again.
    progress : called with :class:`SweepProgress`.
    The other options are as for :func:`flow`.

    Raises ValueError for options that there are not, or that differ from those of the run to be resumed;
    :class:`FileError` where the output is lost; KeyboardInterrupt.
    """
    options = _core.SweepOptions()
    options.vertices, options.keep = _vertices(vertices), str(keep)
    options.resolutions = [str(r) for r in resolutions]
    options.scheme, options.boundary, options.delaunay = scheme, boundary, delaunay
    options.cone_curvature = "" if cone_curvature is None else curvature_text(cone_curvature)
    options.tolerance, options.max_iterations, options.densify = tolerance, max_iterations, densify
    options.solver, options.precision, options.lanes = solver, precision, lanes
    options.repair, options.component = repair, -1 if component is None else component
    options.timeout, options.max_memory, options.threads = timeout, str(max_memory), threads
    options.output = "" if output is None else os.fspath(output)
    options.resume, options.retry_failed = resume, retry_failed
    if (resume or retry_failed) and output is None:
        raise ValueError("resume and retry_failed need an output")
    if isinstance(mesh, Mesh):
        if len(options.resolutions) != 1:
            raise ValueError("several resolutions make several items: give the mesh in a list")
        return _single(mesh, Run(_core.sweep([mesh._engine()], options, progress)), options)
    inputs: list[Input] = [mesh] if isinstance(mesh, (str, os.PathLike)) else list(mesh)
    core = _core.sweep([i._engine() if isinstance(i, Mesh) else os.fspath(i) for i in inputs], options, progress)
    return Run(core)


def _single(mesh: Mesh, run: Run, options: _core.SweepOptions) -> SweepResult:
    if len(run) != 1:
        raise ValueError("; ".join(f.message for f in run.failures) or f"{options.output} holds other meshes too")
    return SweepResult(run[0]._stored, mesh if options.resolutions == ["input"] else None)


def read_config(path: Path) -> dict[str, Any]:
    """Reads a configuration of `ricci sweep` (TOML) as arguments: ``sweep(config.pop("mesh"), **config)``.

    Raises :class:`FileError`; ValueError naming line and key of what is wrong, and for a shard or isolated runs, which
    are the command line's.
    """
    c = _core.read_sweep_config(os.fspath(path))
    if c.shard or c.isolate:
        raise ValueError(f"{os.fspath(path)}: shard and isolate are for the command line")
    return {
        "mesh": c.meshes,
        "vertices": c.vertices,
        "resolutions": c.resolutions,
        "keep": c.keep,
        "scheme": c.scheme,
        "boundary": c.boundary,
        "cone_curvature": c.cone_curvature or None,
        "delaunay": c.delaunay,
        "tolerance": c.tolerance,
        "max_iterations": c.max_iterations,
        "densify": c.densify,
        "solver": c.solver,
        "precision": c.precision,
        "lanes": c.lanes,
        "repair": c.repair,
        "component": None if c.component < 0 else c.component,
        "timeout": c.timeout,
        "max_memory": c.max_memory,
        "threads": c.threads,
        "output": c.output,
    }
