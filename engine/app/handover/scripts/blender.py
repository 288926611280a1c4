"""A result of ricci in Blender (3.4 or later): the surface with its field or checkerboard, curves, cones, the layout.

    blender --python THIS.py
    blender --background --python THIS.py -- --render picture.png [--size 1600x900] [--samples 32]

Everything comes from the archive of arrays beside this file. It goes to a scene of its own; nothing that is open is
touched. Every field of the result is an attribute of the mesh, on its points or faces.
"""
import argparse
import json
import os
import sys

import bmesh
import bpy
import numpy as np
from mathutils import Matrix

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

    def names(self, block, where):
        start = f"{block}/{where}/"
        return [key[len(start):] for key in self.arrays.files if key.startswith(start)]

    def texts(self, block, name):
        return self.blocks[block]["texts"].get(name)

    def cells(self, block):
        corners, first = self.get(block, "corners"), self.get(block, "first")
        return [corners[a:b] for a, b in zip(first[:-1], first[1:])]


def linear(colour):
    """sRGB to linear light."""
    c = np.asarray(colour, dtype=float)
    return np.where(c <= 0.04045, c / 12.92, ((c + 0.055) / 1.055) ** 2.4)


def field_colours(field, values):
    """Colours of values on the field's scale, linear light; grey where a value is missing."""
    table = linear(field["colours"])
    span = field["high"] - field["low"] or 1.0
    place = np.clip((values - field["low"]) / span, 0.0, 1.0) * (len(table) - 1)
    known = np.isfinite(values)
    index = np.where(known, place, 0.0)
    colours = np.stack([np.interp(index, np.arange(len(table)), table[:, k]) for k in range(3)], axis=1)
    colours[~known] = linear([0.5, 0.5, 0.5])
    return np.concatenate([colours, np.ones((len(values), 1))], axis=1)


def material(name, colour=(0.8, 0.8, 0.8), image=None, colours=None):
    """A material of one colour, or of vertex colours and an image, multiplied where there are both."""
    made = bpy.data.materials.new(name)
    made.use_nodes = True
    made.diffuse_color = (*colour, 1.0)
    nodes, links = made.node_tree.nodes, made.node_tree.links
    shader = next(node for node in nodes if node.type == "BSDF_PRINCIPLED")
    shader.inputs["Roughness"].default_value = 0.7
    shader.inputs["Base Color"].default_value = (*colour, 1.0)
    sources = []
    if colours:
        node = nodes.new("ShaderNodeAttribute")
        node.attribute_name = colours
        sources.append(node.outputs["Color"])
    if image:
        node = nodes.new("ShaderNodeTexImage")
        node.image, node.interpolation = image, "Closest"
        sources.append(node.outputs["Color"])
    if len(sources) == 2:
        product = nodes.new("ShaderNodeVectorMath")
        product.operation = "MULTIPLY"
        links.new(sources[0], product.inputs[0])
        links.new(sources[1], product.inputs[1])
        sources = [product.outputs["Vector"]]
    if sources:
        links.new(sources[0], shader.inputs["Base Color"])
    return made


def checkerboard(squares, dark):
    """One pixel for each square; square (0, 0), lower left, is dark."""
    image = bpy.data.images.new("checkerboard", squares, squares)
    i, j = np.meshgrid(np.arange(squares), np.arange(squares))
    pixels = np.ones((squares, squares, 4), dtype=np.float32)
    pixels[..., :3] = 0.85
    pixels[(i + j) % 2 == 0, :3] = dark
    image.pixels.foreach_set(pixels.ravel())
    image.pack()
    return image


def add_attributes(mesh, result, block, points):
    """Every field: `points` names the row of each vertex of the mesh."""
    for where, domain, rows in (("point_data", "POINT", points), ("cell_data", "FACE", slice(None))):
        for name in result.names(block, where):
            values = result.get(block, f"{where}/{name}")
            if values.ndim != 1 or name in mesh.attributes:
                continue
            kind = "FLOAT" if values.dtype.kind == "f" else "INT"
            attribute = mesh.attributes.new(name, kind, domain)
            attribute.data.foreach_set("value", values[rows].astype(np.float32 if kind == "FLOAT" else np.int32))


def add_surface(result, block, collection, name, image):
    """A block of polygons. One that is cut open is sewn together again: texture coordinates belong to corners."""
    points, corners, first = (result.get(block, key) for key in ("points", "corners", "first"))
    rows, vertex_of = np.arange(len(points)), np.arange(len(points))
    if block == "cut_surface":
        _, rows, vertex_of = np.unique(result.get(block, "point_data/vertex"), return_index=True, return_inverse=True)
    faces = np.split(vertex_of[corners], first[1:-1])
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(points[rows].tolist(), [], [face.tolist() for face in faces])
    texture = result.blocks[block]["texture"]
    if texture:
        layer = mesh.uv_layers.new(name="layout")
        layer.data.foreach_set("uv", result.get(block, f"point_data/{texture}")[corners].astype(np.float32).ravel())
    add_attributes(mesh, result, block, rows)
    field, coloured = result.about["field"], None
    where = "cell_data" if field and field["of_faces"] else "point_data"
    if field and field["name"] in result.names(block, where):
        values = result.get(block, f"{where}/{field['name']}")
        values = np.repeat(values, np.diff(first)) if field["of_faces"] else values[corners]
        coloured = "field colour"
        layer = mesh.color_attributes.new(name=coloured, type="FLOAT_COLOR", domain="CORNER")
        layer.data.foreach_set("color", field_colours(field, values).astype(np.float32).ravel())
    mesh.polygons.foreach_set("use_smooth", np.ones(len(mesh.polygons), dtype=bool))
    mesh.materials.append(material(name, image=image if texture else None, colours=coloured))
    mesh.update()
    shown = bpy.data.objects.new(name, mesh)
    collection.objects.link(shown)
    return shown


def colour_of(result, number):
    colours = result.about["curve_colours"]
    return tuple(linear(result.about["boundary_colour"] if number < 0 else colours[number % len(colours)]))


def add_curves(result, block, collection, radius):
    """Tubes in the colours of pictures: one object for each curve, or for each colour where there are many."""
    cells, points = result.cells(block), result.get(block, "points")
    key = result.blocks[block]["colour_by"]
    numbers = result.get(block, f"cell_data/{key}") if key else np.full(len(cells), -1)
    names = result.texts(block, "cell_data/name")
    groups = {}
    for i, number in enumerate(numbers):
        colour = "boundary" if number < 0 else f"colour {number % len(result.about['curve_colours'])}"
        groups.setdefault((i, names[i]) if names and len(cells) <= 64 else (0, colour), []).append(i)
    for (_, label), members in groups.items():
        name = f"{block} {label}"
        curve = bpy.data.curves.new(name, "CURVE")
        curve.dimensions, curve.bevel_depth, curve.bevel_resolution = "3D", radius, 3
        for i in members:
            line = points[cells[i]]
            closed = len(line) > 3 and np.array_equal(line[0], line[-1])
            line = line[:-1] if closed else line
            spline = curve.splines.new("POLY")
            spline.points.add(len(line) - 1)
            spline.points.foreach_set("co", np.c_[line, np.ones(len(line))].astype(np.float32).ravel())
            spline.use_cyclic_u = closed
        curve.materials.append(material(name, colour_of(result, int(numbers[members[0]]))))
        collection.objects.link(bpy.data.objects.new(name, curve))


def add_cones(result, collection, radius):
    mesh = bpy.data.meshes.new("cone")
    ball = bmesh.new()
    bmesh.ops.create_icosphere(ball, subdivisions=3, radius=radius)
    ball.to_mesh(mesh)
    ball.free()
    mesh.materials.append(material("cone", (0.02, 0.02, 0.02)))
    for name, point, curvature in zip(result.texts("cones", "cell_data/name"), result.get("cones", "points"),
                                      result.get("cones", "cell_data/cone_curvature")):
        shown = bpy.data.objects.new(name, mesh)
        shown.location = point
        shown["cone_curvature"] = float(curvature)
        collection.objects.link(shown)


def add_samples(result, collection, radius):
    """Where a sweep has rows for a few vertices only: a ball at each, in the field's colour."""
    field, points = result.about["field"], result.get("samples", "points")
    if not field or field["of_faces"] or len(points) > 0.9 * len(result.get("surface", "points")):
        return
    ball = bmesh.new()
    bmesh.ops.create_icosphere(ball, subdivisions=1, radius=radius)
    corners = np.array([vertex.co for vertex in ball.verts])
    faces = np.array([[vertex.index for vertex in face.verts] for face in ball.faces])
    ball.free()
    mesh = bpy.data.meshes.new("samples")
    mesh.from_pydata((points[:, None, :] + corners).reshape(-1, 3).tolist(), [],
                     (np.arange(len(points))[:, None, None] * len(corners) + faces).reshape(-1, 3).tolist())
    colours = np.repeat(field_colours(field, result.get("samples", f"point_data/{field['name']}")), len(corners), axis=0)
    layer = mesh.color_attributes.new(name="field colour", type="FLOAT_COLOR", domain="POINT")
    layer.data.foreach_set("color", colours.astype(np.float32).ravel())
    mesh.polygons.foreach_set("use_smooth", np.ones(len(mesh.polygons), dtype=bool))
    mesh.materials.append(material("samples", colours="field colour"))
    collection.objects.link(bpy.data.objects.new("samples", mesh))


def viewing_axes(points):
    """Right, up and towards the viewer: the least extended axis, a little from above."""
    _, axes = np.linalg.eigh(np.cov(points.T) if len(points) > 3 else np.eye(3))
    towards, up, right = axes[:, 0], axes[:, 1], axes[:, 2]
    right, towards, up = (axis * (-1.0 if axis[np.argmax(np.abs(axis))] < 0 else 1.0) for axis in (right, towards, up))
    if np.dot(np.cross(right, up), towards) < 0:
        right = -right
    tilt = np.radians(25.0)
    towards, up = np.cos(tilt) * towards + np.sin(tilt) * up, np.cos(tilt) * up - np.sin(tilt) * towards
    return np.stack([right, up, towards])


def extent(points, axes):
    seen = points @ axes.T
    return seen.min(axis=0), seen.max(axis=0)


def lit_scene(scene):
    world = bpy.data.worlds.new("white")
    world.use_nodes = True
    world.node_tree.nodes["Background"].inputs["Color"].default_value = (1.0, 1.0, 1.0, 1.0)
    world.node_tree.nodes["Background"].inputs["Strength"].default_value = 0.35
    scene.world = world
    scene.render.film_transparent = True
    scene.view_settings.view_transform = "Standard"
    scene.render.engine = "CYCLES"
    scene.cycles.use_denoising = False


def add_light(scene, axes, direction, strength):
    light = bpy.data.lights.new("sun", "SUN")
    light.energy, light.angle = strength, 0.1
    shown = bpy.data.objects.new("sun", light)
    towards = np.array(direction) @ axes
    towards /= np.linalg.norm(towards)
    side = np.cross(axes[1], towards)
    side /= np.linalg.norm(side)
    shown.matrix_world = Matrix(np.stack([side, np.cross(towards, side), towards], axis=1).tolist()).to_4x4()
    scene.collection.objects.link(shown)


def add_camera(scene, axes, low, high):
    """Orthographic, around everything."""
    camera = bpy.data.cameras.new("camera")
    camera.type = "ORTHO"
    size, middle = high - low, (low + high) / 2
    scene["seen_width"], scene["seen_height"] = float(size[0]), float(size[1])
    depth = size[2] + 2.0 * max(size[0], size[1])
    camera.clip_start, camera.clip_end = depth * 1e-3, 4.0 * depth
    shown = bpy.data.objects.new("camera", camera)
    place = np.array([middle[0], middle[1], high[2] + depth / 2]) @ axes
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = axes.T, place
    shown.matrix_world = Matrix(matrix.tolist())
    scene.collection.objects.link(shown)
    scene.camera = shown
    return shown


def frame(scene, width, height):
    """A picture of so many pixels around everything, with a margin."""
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = width, height, 100
    w, h = scene["seen_width"], scene["seen_height"]
    scale = max(w, h * width / height) if width >= height else max(h, w * height / width)
    scene.camera.data.ortho_scale = 1.06 * scale


def show_space(result, scene, image):
    """The surface with all that lies on it; its points, none where it has no place in space."""
    block = next((name for name in ("cut_surface", "surface") if result.has(name)), None)
    curves = [name for name in ("generators", "geodesics", "curves", "loops") if result.has(name)]
    if not block and not curves:
        return None
    points = np.concatenate([result.get(name, "points") for name in [block] * bool(block) + curves])
    size = np.linalg.norm(np.ptp(points, axis=0))
    collection = bpy.data.collections.new("surface")
    scene.collection.children.link(collection)
    if block:
        add_surface(result, block, collection, "surface", image)
    for name in curves:
        add_curves(result, name, collection, 0.004 * size)
    if result.has("cones"):
        add_cones(result, collection, 0.012 * size)
    if result.has("samples") and result.has("surface"):
        add_samples(result, collection, 0.006 * size)
    return points


def show_plane(result, scene, image, axes, low, high):
    """The layout beside the surface, as large and facing the viewer; its corners as seen."""
    blocks = [name for name in ("layout", "domains", "outlines", "sides", "layout_generators") if result.has(name)]
    if not blocks:
        return None
    points = np.concatenate([result.get(name, "points") for name in blocks])
    size = np.ptp(points, axis=0)
    largest = max(size.max(), 1e-12)
    collection = bpy.data.collections.new("layout")
    scene.collection.children.link(collection)
    if result.has("domains"):
        shown = add_surface(result, "domains", collection, "domains", None)
        paint_copies(result, shown)
    if result.has("layout"):
        add_surface(result, "layout", collection, "layout", image)
    for name in ("outlines", "sides"):
        if result.has(name):
            add_curves(result, name, collection, (0.0015 if name == "outlines" else 0.005) * largest)
    scale = min((high[1] - low[1]) / max(size[1], 1e-12), 1.2 * (high[0] - low[0]) / max(size[0], 1e-12))
    if not np.isfinite(scale) or scale <= 0.0:
        scale = 1.0
    half = scale * size / 2
    gap = 0.08 * (high[0] - low[0])
    middle = np.array([high[0] + gap + half[0], (low[1] + high[1]) / 2, (low[2] + high[2]) / 2])
    matrix = np.eye(4)
    matrix[:3, :3] = axes.T * scale
    matrix[:3, 3] = middle @ axes - axes.T @ (scale * (points.min(axis=0) + size / 2))
    parent = bpy.data.objects.new("layout place", None)
    parent.empty_display_size = 0.01
    parent.matrix_world = Matrix(matrix.tolist())
    collection.objects.link(parent)
    lift = 0.004 * largest
    for shown in collection.objects:
        if shown is not parent:
            shown.parent = parent
            if shown.name.startswith("domains"):
                shown.location = (0.0, 0.0, -lift)
    return middle - half, middle + half


def paint_copies(result, shown):
    """Copies of the domain in colours that differ between neighbours."""
    numbers = result.get("domains", "cell_data/copy_class")
    shown.data.materials.clear()
    for k in range(len(result.about["curve_colours"])):
        pale = tuple(0.45 + 0.55 * np.array(colour_of(result, k)))
        shown.data.materials.append(material(f"copy {k}", pale))
    shown.data.polygons.foreach_set("material_index", numbers.astype(np.int32))


def show_in_windows(scene):
    for window in bpy.context.window_manager.windows:
        window.scene = scene
        for area in window.screen.areas:
            if area.type == "VIEW_3D":
                area.spaces.active.shading.type = "MATERIAL"
                area.spaces.active.region_3d.view_perspective = "CAMERA"


def build(result):
    about = result.about
    scene = bpy.data.scenes.new(about["item"])
    lit_scene(scene)
    image = None
    if about["checker"] > 0:
        image = checkerboard(about["checker"], 0.3 if about["field"] else 0.02)
    axes, low, high = np.eye(3), np.zeros(3), np.ones(3)
    points = show_space(result, scene, image)
    if points is not None:
        axes = viewing_axes(points)
        low, high = extent(points, axes)
    beside = show_plane(result, scene, image, axes, low, high)
    if beside is not None:
        low = beside[0] if points is None else np.minimum(low, beside[0])
        high = beside[1] if points is None else np.maximum(high, beside[1])
    add_light(scene, axes, (-0.5, 0.8, 1.0), 2.0)
    add_light(scene, axes, (0.9, -0.2, 1.0), 0.6)
    add_camera(scene, axes, low, high)
    for key in ("item", "source", "software", "command"):
        scene[key] = about[key]
    return scene


def main():
    words = sys.argv[sys.argv.index("--") + 1:] if "--" in sys.argv else []
    parser = argparse.ArgumentParser(description="A result of ricci in Blender")
    parser.add_argument("--render", metavar="PNG", help="write a picture")
    parser.add_argument("--size", default="1600x900")
    parser.add_argument("--samples", type=int, default=32)
    arguments = parser.parse_args(words)
    width, height = (int(number) for number in arguments.size.split("x"))
    result = Result(os.path.join(os.path.dirname(os.path.abspath(__file__)), DATA))
    scene = build(result)
    frame(scene, width, height)
    show_in_windows(scene)
    if arguments.render:
        scene.cycles.samples = arguments.samples
        scene.render.filepath = os.path.abspath(arguments.render)
        scene.render.image_settings.file_format = "PNG"
        scene.render.image_settings.color_mode = "RGBA"
        bpy.ops.render.render(write_still=True, scene=scene.name)


main()
