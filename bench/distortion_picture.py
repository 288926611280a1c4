#!/usr/bin/env python3
"""The area distortion of a sweep, painted on the surface: which vertex makes the best only cone.

Reads a result file of `ricci sweep` (every vertex of one surface); without one, generates an eight of 2,000 faces and
sweeps it. Orthographic view, back faces culled, the rest painted from back to front.
"""

import argparse
import math
import sys

import h5py
import numpy as np

import running
import svg

# Anchors of the viridis colour map (public domain, CC0).
ANCHORS = np.array([[68, 1, 84], [72, 40, 120], [62, 74, 137], [49, 104, 142], [38, 130, 142], [31, 158, 137],
                    [53, 183, 121], [110, 206, 88], [181, 222, 43], [253, 231, 37]], float)
WIDTH, HEIGHT = 900, 560
LIGHT = np.array([-0.35, 0.55, 0.76])


def colour(t):
    """Along the map, t in [0, 1]. // (n, 3)"""
    position = np.clip(t, 0.0, 1.0) * (len(ANCHORS) - 1)
    low = np.minimum(position.astype(int), len(ANCHORS) - 2)
    part = (position - low)[:, None]
    return (1 - part) * ANCHORS[low] + part * ANCHORS[low + 1]


def read(path):
    """Points, triangles, and per vertex the area distortion (NaN where not converged)."""
    with h5py.File(path) as run:
        items = list(run["items"].values())
        if len(items) != 1 or "sweep" not in items[0]:
            sys.exit(f"{path}: expected one item with a sweep")
        mesh, sweep = items[0]["mesh"], items[0]["sweep"]
        points, triangles = mesh["points"][:], mesh["triangles"][:]
        values = np.full(len(points), np.nan)
        values[sweep["vertex"][:]] = sweep["area_distortion"][:]
    if np.isnan(values).any():
        sys.exit(f"{path}: {np.isnan(values).sum()} vertices have no value: sweep every vertex")
    return points, triangles, values


def rotation(azimuth, elevation):
    """Rows: right, up, towards the viewer; angles in degrees."""
    a, e = math.radians(azimuth), math.radians(elevation)
    towards = np.array([math.cos(e) * math.cos(a), math.cos(e) * math.sin(a), math.sin(e)])
    right = np.array([-math.sin(a), math.cos(a), 0.0])
    return np.array([right, np.cross(towards, right), towards])


def vertex_normals(points, triangles):
    normal = np.zeros_like(points)
    corners = points[triangles]
    weighted = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    for k in range(3):
        np.add.at(normal, triangles[:, k], weighted)
    return normal / np.linalg.norm(normal, axis=1, keepdims=True)


def hidden(points, triangles, vertex):
    """Whether a face lies before the vertex, in viewing coordinates."""
    a, b, c = (points[triangles[:, k]] for k in range(3))
    p = points[vertex]

    def side(q, r):
        return (r[:, 0] - q[:, 0]) * (p[1] - q[:, 1]) - (r[:, 1] - q[:, 1]) * (p[0] - q[:, 0])
    w = np.stack([side(b, c), side(c, a), side(a, b)], axis=1)
    total = w.sum(axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        w = w / total[:, None]
    inside = (w >= 0).all(axis=1) & (np.abs(total) > 0) & ~(triangles == vertex).any(axis=1)
    depth = w[:, 0] * a[:, 2] + w[:, 1] * b[:, 2] + w[:, 2] * c[:, 2]
    return bool((inside & (depth > p[2] + 1e-9)).any())


def choose_view(points, triangles, marked):
    """The first of a few views from which all marked vertices are seen."""
    normal = vertex_normals(points, triangles)
    views = [(azimuth, sign * elevation) for elevation in (52, 40, 30, 65) for sign in (1, -1)
             for azimuth in (-70, -110, 70, 110, -90, 90, -50, 50, -130, 130)]
    for view in views:
        turn = rotation(*view)
        seen = points @ turn.T
        if all(normal[v] @ turn[2] > 0.15 and not hidden(seen, triangles, v) for v in marked):
            return turn
    return rotation(*views[0])


def quartered(points, normals, values, triangles):
    """Every face in four, values and normals interpolated, for smoother shading: (4F, 3, ...) each."""
    def split(field):
        corner = field[triangles]
        middle = 0.5 * (corner + np.roll(corner, -1, axis=1))
        pieces = [np.stack([corner[:, k], middle[:, k], middle[:, k - 1]], axis=1) for k in range(3)]
        return np.concatenate([*pieces, middle])
    return split(points), split(normals), split(values)


def paint_surface(document, points, triangles, parameter, turn):
    """Paints the visible faces; returns the map from viewing coordinates to the page."""
    seen = points @ turn.T
    low, high = seen[:, :2].min(axis=0), seen[:, :2].max(axis=0)
    scale = min((WIDTH - 200) / (high[0] - low[0]), (HEIGHT - 110) / (high[1] - low[1]))
    centre = 0.5 * (low + high)

    def page(p):
        return np.stack([(WIDTH - 130) / 2 + scale * (p[..., 0] - centre[0]),
                         (HEIGHT + 36) / 2 - scale * (p[..., 1] - centre[1])], axis=-1)
    corner, normal, value = quartered(seen, vertex_normals(seen, triangles), parameter, triangles)
    flat = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
    visible = flat[:, 2] * scale * scale > 1.0  # twice the area on the page; less is not seen
    corner, normal, value = corner[visible], normal[visible].mean(axis=1), value[visible].mean(axis=1)
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    light = LIGHT / np.linalg.norm(LIGHT)
    half = light + np.array([0.0, 0.0, 1.0])
    half /= np.linalg.norm(half)
    diffuse = 0.52 + 0.52 * np.clip(normal @ light, 0, 1)
    shine = 0.13 * np.clip(normal @ half, 0, 1) ** 14
    rgb = np.clip(colour(value) * diffuse[:, None] + 255 * shine[:, None], 0, 255).astype(int)
    flatpage = page(corner)
    # Tenths of a pixel as integers keep the file small; each face is stroked in its own colour, so that no background
    # shines through between neighbours.
    document.add("<style>.s path{fill:currentColor;stroke:currentColor;stroke-width:9;stroke-linejoin:round}</style>"
                 "<g class='s' transform='scale(.1)'>")
    whole = np.round(10 * flatpage).astype(int)
    faces = []
    for f in np.argsort(corner[:, :, 2].mean(axis=1), kind="stable"):
        (ax, ay), (bx, by), (cx, cy) = whole[f]
        steps = f"{bx - ax} {by - ay} {cx - bx} {cy - by}".replace(" -", "-")
        faces.append("<path color='#%02x%02x%02x' d='M%d %dl%sz'/>" % (*rgb[f], ax, ay, steps))
    document.add("".join(faces) + "</g>")
    return seen, page


def mark(document, place, words, side):
    x, y = place
    document.add(f"<circle cx='{x:.1f}' cy='{y:.1f}' r='6.5' fill='none' stroke='#fff' stroke-width='4.5'/>")
    document.add(f"<circle cx='{x:.1f}' cy='{y:.1f}' r='6.5' fill='none' stroke='{svg.INK}' stroke-width='2'/>")
    tip_x, tip_y = side
    for stroke, width in (("#fff", 3.0), (svg.INK, 1.3)):
        document.line(x, y + math.copysign(8, tip_y - y), tip_x, tip_y, stroke, width)
    document.text(tip_x, tip_y + (16 if tip_y > y else -6), words, 13, "end" if tip_x > WIDTH / 2 else "middle", weight="bold")


def colour_bar(document, low, high):
    """Logarithmic, at the right."""
    left, top, width, height, steps = WIDTH - 92, 96, 18, HEIGHT - 190, 32
    shades = colour((np.arange(steps) + 0.5) / steps)
    for k in range(steps):
        y = top + height * (1 - (k + 1) / steps)
        document.rectangle(left, y, width, height / steps + 0.5, fill="#%02x%02x%02x" % tuple(shades[k].astype(int)))
    document.rectangle(left, top, width, height, stroke=svg.INK, stroke_width=0.8)
    ticks = [d * 10.0 ** e for e in range(-4, 5) for d in (1, 2, 5) if low <= d * 10.0 ** e <= high]
    for tick in ticks:
        y = top + height * (1 - math.log(tick / low) / math.log(high / low))
        document.line(left + width, y, left + width + 5, y)
        document.text(left + width + 9, y + 4, f"{tick:g}", 12)
    document.text(left + width / 2 + 8, top - 30, "area", 12, "middle")
    document.text(left + width / 2 + 8, top - 14, "distortion", 12, "middle")


def picture(points, triangles, values):
    best, worst = int(np.argmin(values)), int(np.argmax(values))
    low, high = values[best], values[worst]
    turn = choose_view(points, triangles, (best, worst))
    document = svg.Document(WIDTH, HEIGHT)
    document.text(28, 38, f"Every vertex in turn as the only cone: {len(points)} flat metrics of one surface", 17, weight="bold")
    seen, page = paint_surface(document, points, triangles, np.log(values / low) / math.log(high / low), turn)
    colour_bar(document, low, high)
    for vertex, name, value in ((best, "best", low), (worst, "worst", high)):
        x, y = page(seen[vertex])
        tip = HEIGHT - 34 if y > HEIGHT / 2 else 74
        mark(document, (x, y), f"{name}: vertex {vertex}, {value:.3g}", (x, tip))
    return str(document)


def own_sweep(arguments):
    folder = running.ROOT / "out" / "distortion_picture"
    folder.mkdir(parents=True, exist_ok=True)
    mesh, output = folder / "eight.off", folder / "eight.h5"
    for command in (["generate", "eight", "--faces", "2000", "-o", str(mesh)],
                    ["sweep", str(mesh), "-o", str(output), "--threads", str(arguments.threads)]):
        status, _, error = running.run([arguments.ricci, *command, "--quiet"])
        if status != 0:
            sys.exit(f"ricci {command[0]}: exit {status}\n{error}")
    return output


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    running.add_common_arguments(parser)
    parser.add_argument("sweep", nargs="?", help="result file of a sweep over every vertex of one surface")
    parser.add_argument("-o", "--output", default=str(running.RESULTS / "eight_distortion.svg"))
    arguments = parser.parse_args()
    running.write(arguments.output, picture(*read(arguments.sweep or own_sweep(arguments))))


if __name__ == "__main__":
    main()
