"""A result of ricci in Polyscope: the surface with its fields and layout coordinates, curves, cones, the layout.

    python3 THIS.py

Needs the packages polyscope and numpy. Everything comes from the archive of arrays beside this file.
"""
import json
import os

import numpy as np
import polyscope as ps

DATA = "DATA_FILE"  # beside this file


class Result:
    """The arrays by block, and what is said about them."""

    def __init__(self, path):
        self.arrays = np.load(path)
        self.about = json.loads(self.arrays["about"].tobytes().decode("utf-8"))
        self.blocks = self.about["blocks"]

    def has(self, block):
        return block in self.blocks

    def get(self, block, name):
        return self.arrays[f"{block}/{name}"]

    def fields(self, block, where):
        """Names, values and units of the numbers of one component."""
        start = f"{block}/{where}/"
        for key in self.arrays.files:
            if key.startswith(start) and self.arrays[key].ndim == 1:
                name = key[len(start):]
                yield name, self.arrays[key], self.blocks[block]["units"].get(f"{where}/{name}", "")


def fans(corners, first):
    """Convex polygons cut into triangles: places in `corners`, (T,3), and the polygon of each triangle, (T)."""
    sizes = np.diff(first)
    polygon = np.repeat(np.arange(len(sizes)), sizes - 2)
    start = first[:-1][polygon]
    step = np.arange(len(polygon)) - np.repeat(np.cumsum(sizes - 2) - (sizes - 2), sizes - 2)
    return np.stack([start, start + step + 1, start + step + 2], axis=1), polygon


def colour_map(field):
    return "coolwarm" if field["low"] < 0.0 < field["high"] else "viridis"


def labelled(name, unit):
    return f"{name} [{unit}]" if unit not in ("", "1") else name


def show_polygons(result, block, name, enabled):
    """A block of polygons. One that is cut open is sewn together again: texture coordinates belong to corners."""
    points, corners, first = (result.get(block, key) for key in ("points", "corners", "first"))
    rows, vertex_of = np.arange(len(points)), np.arange(len(points))
    if block == "cut_surface":
        _, rows, vertex_of = np.unique(result.get(block, "point_data/vertex"), return_index=True, return_inverse=True)
    places, polygon = fans(corners, first)
    mesh = ps.register_surface_mesh(name, points[rows], vertex_of[corners][places], enabled=enabled, smooth_shade=True)
    shown = result.about["field"]
    for where, kind, pick in (("point_data", "vertices", rows), ("cell_data", "faces", polygon)):
        for field, values, unit in result.fields(block, where):
            values = values[pick].astype(float)
            if not np.isfinite(values).any():
                continue
            chosen = bool(shown) and shown["name"] == field and shown["of_faces"] == (kind == "faces")
            extra = {"vminmax": (shown["low"], shown["high"]), "cmap": colour_map(shown)} if chosen else {}
            mesh.add_scalar_quantity(labelled(field, unit), values, defined_on=kind, enabled=chosen, **extra)
    texture = result.blocks[block]["texture"]
    if texture:
        uv = result.get(block, f"point_data/{texture}")[corners][places].reshape(-1, 2)
        mesh.add_parameterization_quantity("layout", uv, defined_on="corners", coords_type="unit",
                                           viz_style="checker", enabled=not shown)
    return mesh


def show_curves(result, block, points, enabled):
    """Networks of curves through these points: one for each, or for each colour where there are many."""
    corners, first = result.get(block, "corners"), result.get(block, "first")
    key = result.blocks[block]["colour_by"]
    numbers = result.get(block, f"cell_data/{key}") if key else np.full(len(first) - 1, -1)
    names = result.blocks[block]["texts"].get("cell_data/name")
    colours = result.about["curve_colours"]
    groups = {}
    for cell, number in enumerate(numbers):
        apart = names and len(numbers) <= 64
        label = f"{cell}: {names[cell]}" if apart else ("boundary" if number < 0 else f"colour {number % len(colours)}")
        groups.setdefault(label, []).append(cell)
    for label, cells in groups.items():
        edges = np.concatenate([np.c_[corners[first[c]:first[c + 1] - 1], corners[first[c] + 1:first[c + 1]]]
                                for c in cells])
        used, edges = np.unique(edges, return_inverse=True)
        number = numbers[cells[0]]
        colour = result.about["boundary_colour"] if number < 0 else colours[number % len(colours)]
        ps.register_curve_network(f"{block} {label}", points[used], edges.reshape(-1, 2), enabled=enabled,
                                  radius=0.004, color=tuple(colour))


def beside(result):
    """What takes the layout to the right of the surface, as large: scale and shift."""
    points = result.get("layout", "points")
    low, size = points.min(axis=0), np.ptp(points, axis=0)
    block = next((name for name in ("cut_surface", "surface") if result.has(name)), None)
    if block is None:
        return 1.0, np.zeros(3)
    space = result.get(block, "points")
    scale = np.ptp(space, axis=0).max() / max(size.max(), 1e-12)
    right = space.max(axis=0)[0] + 0.1 * np.ptp(space, axis=0).max()
    middle = (space.max(axis=0) + space.min(axis=0)) / 2
    return scale, np.array([right - scale * low[0], middle[1] - scale * (low[1] + size[1] / 2),
                            middle[2] - scale * (low[2] + size[2] / 2)])


def main():
    result = Result(os.path.join(os.path.dirname(os.path.abspath(__file__)), DATA))
    ps.set_program_name("ricci: " + result.about["item"])
    ps.init()
    ps.set_ground_plane_mode("none")
    block = next((name for name in ("cut_surface", "surface") if result.has(name)), None)
    if block:
        show_polygons(result, block, "surface", True)
    for name in ("generators", "geodesics", "curves", "loops", "cut"):
        if result.has(name):
            show_curves(result, name, result.get(name, "points"), enabled=name != "cut")
    if result.has("cones"):
        cloud = ps.register_point_cloud("cones", result.get("cones", "points"), radius=0.012, color=(0.05, 0.05, 0.05))
        cloud.add_scalar_quantity("cone_curvature [rad]", result.get("cones", "cell_data/cone_curvature"))
    if result.has("samples"):
        cloud = ps.register_point_cloud("samples", result.get("samples", "points"), enabled=False, radius=0.006)
        for field, values, unit in result.fields("samples", "point_data"):
            cloud.add_scalar_quantity(labelled(field, unit), values.astype(float))
    if result.has("layout"):
        scale, shift = beside(result)
        matrix = np.diag([scale, scale, scale, 1.0])
        matrix[:3, 3] = shift
        show_polygons(result, "layout", "layout", True).set_transform(matrix)
        for name in ("sides", "outlines", "layout_generators"):
            if result.has(name):
                show_curves(result, name, scale * result.get(name, "points") + shift, enabled=name == "sides")
    ps.show()


main()
