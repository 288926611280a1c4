"""A stand-in for Polyscope's Python module that checks what it is given as the real one does, and notes it.

Names, arguments and shapes follow polyscope 2.x (src/polyscope/{core,surface_mesh,curve_network,point_cloud,structure}.py
of github.com/nmwsharp/polyscope-py); nothing is shown. What was registered is written to $POLYSCOPE_LOG by show().
"""
import json
import os

import numpy as np

_log = {"initialised": False, "surfaces": {}, "curves": {}, "points": {}, "shown": 0}


def _array(values, shape, kinds):
    assert isinstance(values, np.ndarray), "an array is wanted"
    assert values.dtype.kind in kinds, f"wrong type {values.dtype}"
    assert values.ndim == len(shape) and all(want is None or n == want for n, want in zip(values.shape, shape)), \
        f"shape {values.shape}, wanted {shape}"


def _positions(values):
    _array(values, (None, 3), "f")
    assert np.isfinite(values).all(), "positions must be finite"


def _colour(colour):
    assert colour is None or (isinstance(colour, tuple) and len(colour) == 3 and all(0 <= c <= 1 for c in colour))


def _flag(value):
    assert value is None or isinstance(value, bool)


def set_program_name(name):
    assert isinstance(name, str) and not _log["initialised"], "before init"


def init(backend=""):
    _log["initialised"] = True


def set_ground_plane_mode(mode):
    assert mode in ("none", "tile", "tile_reflection", "shadow_only")


def show(forFrames=None):
    assert _log["initialised"]
    _log["shown"] += 1
    with open(os.environ["POLYSCOPE_LOG"], "w") as out:
        json.dump(_log, out)


class _Structure:
    def __init__(self, log):
        self.log = log

    def set_transform(self, matrix):
        _array(matrix, (4, 4), "f")
        assert np.isfinite(matrix).all()
        self.log["transformed"] = True

    def _scalar(self, name, values, count, enabled=None, datatype="standard", vminmax=None, cmap=None, isolines_enabled=None):
        assert isinstance(name, str) and name not in self.log["scalars"], f"{name} is there already"
        _array(values, (count,), "fiu")
        _flag(enabled)
        assert vminmax is None or (len(vminmax) == 2 and vminmax[0] <= vminmax[1])
        assert cmap in (None, "viridis", "coolwarm", "blues", "reds", "pink-green", "phase", "spectral", "rainbow", "jet",
                        "turbo", "magma", "inferno", "plasma", "gray")
        self.log["scalars"][name] = {"enabled": bool(enabled), "count": count}


class SurfaceMesh(_Structure):
    def __init__(self, log, vertices, faces):
        super().__init__(log)
        _positions(vertices)
        _array(faces, (None, 3), "iu")
        assert faces.min() >= 0 and faces.max() < len(vertices)
        log.update(vertices=len(vertices), faces=len(faces), scalars={}, parameterizations={})

    def add_scalar_quantity(self, name, values, defined_on="vertices", **extra):
        count = {"vertices": self.log["vertices"], "faces": self.log["faces"], "corners": 3 * self.log["faces"]}[defined_on]
        self._scalar(name, values, count, **extra)

    def add_parameterization_quantity(self, name, values, defined_on="vertices", coords_type="unit", enabled=None,
                                      viz_style=None, checker_size=None):
        count = {"vertices": self.log["vertices"], "corners": 3 * self.log["faces"]}[defined_on]
        _array(values, (count, 2), "f")
        assert coords_type in ("unit", "world")
        assert viz_style in (None, "checker", "grid", "local_check", "local_rad", "checker_islands")
        _flag(enabled)
        self.log["parameterizations"][name] = {"enabled": bool(enabled)}


class CurveNetwork(_Structure):
    def __init__(self, log, nodes, edges):
        super().__init__(log)
        _positions(nodes)
        _array(edges, (None, 2), "iu")
        assert edges.min() >= 0 and edges.max() < len(nodes)
        assert len(np.unique(edges)) == len(nodes), "nodes that no edge has"
        log.update(nodes=len(nodes), edges=len(edges), scalars={})


class PointCloud(_Structure):
    def __init__(self, log, points):
        super().__init__(log)
        _positions(points)
        log.update(points=len(points), scalars={})

    def add_scalar_quantity(self, name, values, **extra):
        self._scalar(name, values, self.log["points"], **extra)


def _new(kind, name):
    assert _log["initialised"] and isinstance(name, str) and name not in _log[kind], f"{name} is there already"
    return _log[kind].setdefault(name, {})


def register_surface_mesh(name, vertices, faces, enabled=None, color=None, edge_color=None, smooth_shade=None,
                          edge_width=None, material=None, back_face_policy=None, back_face_color=None, transparency=None):
    _flag(enabled), _flag(smooth_shade), _colour(color)
    return SurfaceMesh(_new("surfaces", name), vertices, faces)


def register_curve_network(name, nodes, edges, enabled=None, radius=None, color=None, material=None, transparency=None):
    _flag(enabled), _colour(color)
    assert radius is None or 0 < radius < 1
    return CurveNetwork(_new("curves", name), nodes, edges)


def register_point_cloud(name, points, enabled=None, radius=None, point_render_mode=None, color=None, material=None,
                         transparency=None):
    _flag(enabled), _colour(color)
    return PointCloud(_new("points", name), points)
