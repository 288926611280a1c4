"""What progress callbacks get. They run in the thread that made the call, at most twenty times a second, and once at
the end; an exception from one ends the call and comes through."""

from typing import NamedTuple


class SweepProgress(NamedTuple):
    """How far a sweep is, or the description of shapes for an index."""

    sources_opened: int
    """Inputs (meshes times resolutions) opened so far."""
    sources: int
    """Inputs in all."""
    solves_done: int
    """Solves (shapes) finished."""
    solves_known: int
    """Solves of the inputs opened so far."""
    seconds: float
    """Since the start."""


class FlowProgress(NamedTuple):
    """The latest step of a flow."""

    iteration: int
    residual_max: float
    """max |K - target| after the step, radians."""
    step: float
    """Share of the Newton direction that was taken (gradient: the time step)."""
    flips: int
    """Edge flips so far."""
    seconds: float
    """Since the start."""
