"""A result of ricci in ParaView (5.11 or later): the surface with its field or checkerboard, curves as tubes, cones,
the layout beside it.

    paraview --script=THIS.py
    pvpython --force-offscreen-rendering THIS.py --render picture.png [--size 1600x900]

Reads the .vtm beside this file; every field of the result can be chosen afterwards.
"""
import argparse
import json
import os
import sys
import xml.etree.ElementTree as ET

import numpy as np
from paraview import simple
from vtkmodules.util.numpy_support import vtk_to_numpy

DATA = "DATA_FILE"  # beside this file


class Result:
    """A reader for each block, and what is said about them."""

    def __init__(self, path):
        folder = os.path.dirname(path)
        self.files = {leaf.get("name"): os.path.join(folder, leaf.get("file")) for leaf in ET.parse(path).iter("DataSet")}
        self.folder = os.path.dirname(next(iter(self.files.values())))
        with open(os.path.join(self.folder, "scene.json"), encoding="utf-8") as text:
            self.about = json.load(text)
        self.readers = {}

    def has(self, block):
        return block in self.files

    def reader(self, block):
        if block not in self.readers:
            reader = simple.XMLPolyDataReader(FileName=[self.files[block]], registrationName=block)
            reader.TimeArray = "None"
            reader.UpdatePipeline()
            self.readers[block] = reader
        return self.readers[block]

    def data(self, block):
        self.reader(block)
        return simple.servermanager.Fetch(self.readers[block])

    def points(self, block):
        points = self.data(block).GetPoints()
        return vtk_to_numpy(points.GetData()) if points is not None else np.zeros((0, 3))


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


def look_at(view, points, axes, aspect, room=0.54):
    """Parallel projection around the points."""
    seen = points @ axes.T
    low, high = seen.min(axis=0), seen.max(axis=0)
    middle, size = (low + high) / 2 @ axes, high - low
    view.CameraParallelProjection = 1
    view.CameraFocalPoint = list(middle)
    view.CameraPosition = list(middle + axes[2] * 2.0 * np.linalg.norm(size))
    view.CameraViewUp = list(axes[1])
    view.CameraParallelScale = room * max(size[1], size[0] / aspect)


def new_view(name):
    view = simple.CreateView("RenderView", name)
    view.UseColorPaletteForBackground = 0
    view.Background = [1.0, 1.0, 1.0]
    view.BackgroundColorMode = "Single Color"
    view.OrientationAxesVisibility = 0
    return view


def colour_table(field):
    """The field's scale as ParaView's, grey where a value is missing."""
    table = simple.GetColorTransferFunction(field["name"])
    count = len(field["colours"])
    table.RGBPoints = [number for i, colour in enumerate(field["colours"])
                       for number in (field["low"] + (field["high"] - field["low"]) * i / (count - 1), *colour)]
    table.ColorSpace = "RGB"
    table.NanColor = [0.5, 0.5, 0.5]
    table.AutomaticRescaleRangeMode = "Never"
    return table


def label(name, unit):
    return name.replace("_", " ") + (f" [{unit}]" if unit not in ("", "1") else "")


def show_surface(result, block, view, bar):
    """A block of polygons with its field and the checkerboard."""
    shown = simple.Show(result.reader(block), view)
    shown.Representation = "Surface"
    shown.AmbientColor = shown.DiffuseColor = [0.85, 0.85, 0.85]
    shown.Specular, shown.Ambient = 0.0, 0.15
    shown.Interpolation = "Gouraud"
    field = result.about["field"]
    shown.ColorArrayName = ["POINTS", ""]
    data = result.data(block)
    kind = "CELLS" if field and field["of_faces"] else "POINTS"
    attributes = data.GetCellData() if kind == "CELLS" else data.GetPointData()
    if field and attributes.HasArray(field["name"]):
        simple.ColorBy(shown, (kind, field["name"]))
        shown.LookupTable = colour_table(field)
        shown.SetScalarBarVisibility(view, bar)
        if bar:
            scale = simple.GetScalarBar(shown.LookupTable, view)
            scale.Title, scale.ComponentTitle = label(field["name"], field["unit"]), ""
            scale.TitleColor = scale.LabelColor = [0.0, 0.0, 0.0]
            scale.Orientation, scale.WindowLocation, scale.ScalarBarLength = "Horizontal", "Lower Center", 0.4
            scale.AddRangeLabels = 0
    image = os.path.join(result.folder, "checker.png")
    texture = result.about["blocks"][block]["texture"]
    if texture and os.path.exists(image):
        shown.SelectTCoordArray = texture
        shown.Texture = simple.CreateTexture(image)
        shown.RepeatTextures = 1
        shown.InterpolateTextures = 0
    return shown


def colour_of(result, number):
    colours = result.about["curve_colours"]
    return result.about["boundary_colour"] if number < 0 else colours[number % len(colours)]


def show_curves(result, block, view, radius):
    """Tubes in the colours of pictures."""
    key = result.about["blocks"][block]["colour_by"]
    source = result.reader(block)
    tube = simple.Tube(Input=source, registrationName=block + " tubes")
    tube.Scalars = ["POINTS", ""]
    tube.Vectors = ["POINTS", "1"]
    tube.Radius, tube.NumberofSides, tube.Capping = radius, 12, 1
    shown = simple.Show(tube, view)
    shown.Representation = "Surface"
    shown.Specular = 0.0
    if not key:
        shown.ColorArrayName = ["POINTS", ""]
        shown.AmbientColor = shown.DiffuseColor = colour_of(result, -1)
        return
    simple.ColorBy(shown, ("CELLS", key))
    numbers = vtk_to_numpy(result.data(block).GetCellData().GetArray(key))
    table = simple.GetColorTransferFunction(key)
    table.InterpretValuesAsCategories = 1
    values = sorted({int(number) for number in numbers})
    table.Annotations = [text for value in values for text in (str(value), str(value))]
    table.IndexedColors = [channel for value in values for channel in colour_of(result, value)]
    shown.LookupTable = table
    shown.SetScalarBarVisibility(view, False)


def show_copies(result, view):
    """Copies of the domain in pale colours that differ between neighbours."""
    shown = simple.Show(result.reader("domains"), view)
    shown.Representation = "Surface"
    simple.ColorBy(shown, ("CELLS", "copy_class"))
    table = simple.GetColorTransferFunction("copy_class")
    table.InterpretValuesAsCategories = 1
    count = len(result.about["curve_colours"])
    table.Annotations = [text for k in range(count) for text in (str(k), str(k))]
    table.IndexedColors = [0.45 + 0.55 * channel for k in range(count) for channel in colour_of(result, k)]
    shown.LookupTable = table
    shown.SetScalarBarVisibility(view, False)
    shown.Position = [0.0, 0.0, -0.01]
    shown.Interpolation, shown.Ambient, shown.Diffuse = "Flat", 1.0, 0.0


def show_samples(result, view, radius):
    """Where a sweep has rows for a few vertices only: a ball at each, in the field's colour."""
    field = result.about["field"]
    known = result.data("samples").GetNumberOfPoints()
    if not field or field["of_faces"] or known > 0.9 * len(result.points("surface")):
        return
    balls = simple.Glyph(Input=result.reader("samples"), GlyphType="Sphere", registrationName="samples as balls")
    balls.OrientationArray, balls.ScaleArray = ["POINTS", "No orientation array"], ["POINTS", "No scale array"]
    balls.ScaleFactor, balls.GlyphMode = 2.0 * radius, "All Points"
    shown = simple.Show(balls, view)
    simple.ColorBy(shown, ("POINTS", field["name"]))
    shown.LookupTable = colour_table(field)


def show_cones(result, view, radius):
    points = result.points("cones")
    for i, point in enumerate(points):
        ball = simple.Sphere(Center=[float(x) for x in point], Radius=radius, ThetaResolution=24, PhiResolution=24,
                             registrationName=result.about["blocks"]["cones"]["texts"]["cell_data/name"][i])
        shown = simple.Show(ball, view)
        shown.AmbientColor = shown.DiffuseColor = [0.1, 0.1, 0.1]
        shown.ColorArrayName = ["POINTS", ""]


def show_space(result, aspect):
    """The surface with all that lies on it; None where it has no place in space."""
    block = next((name for name in ("cut_surface", "surface") if result.has(name)), None)
    curves = [name for name in ("generators", "geodesics", "curves", "loops") if result.has(name)]
    names = [block] * bool(block) + curves
    if not names:
        return None
    view = new_view("surface")
    points = np.concatenate([result.points(name) for name in names])
    size = np.linalg.norm(np.ptp(points, axis=0))
    if block:
        show_surface(result, block, view, True)
    for name in curves:
        show_curves(result, name, view, 0.004 * size)
    if result.has("cones"):
        show_cones(result, view, 0.012 * size)
    if result.has("samples") and result.has("surface"):
        show_samples(result, view, 0.006 * size)
    look_at(view, points, viewing_axes(points), aspect, 0.66 if result.about["field"] else 0.54)
    return view


def show_plane(result, aspect):
    blocks = [name for name in ("layout", "domains", "outlines", "sides") if result.has(name)]
    if not blocks:
        return None
    view = new_view("layout")
    points = np.concatenate([result.points(name) for name in blocks])
    largest = np.ptp(points, axis=0).max()
    if result.has("domains"):
        show_copies(result, view)
    if result.has("layout"):
        shown = show_surface(result, "layout", view, False)
        if result.about["kappa"] != 1:
            shown.Ambient, shown.Diffuse = 1.0, 0.0  # a plane needs no light
    for name in ("outlines", "sides"):
        if result.has(name):
            show_curves(result, name, view, (0.0015 if name == "outlines" else 0.005) * largest)
    look_at(view, points, np.eye(3), aspect)
    return view


def main():
    parser = argparse.ArgumentParser(description="A result of ricci in ParaView")
    parser.add_argument("--render", metavar="PNG", help="write a picture")
    parser.add_argument("--size", default="1600x900")
    arguments, _ = parser.parse_known_args(sys.argv[1:])
    width, height = (int(number) for number in arguments.size.split("x"))
    simple._DisableFirstRenderCameraReset()
    result = Result(os.path.join(os.path.dirname(os.path.abspath(__file__)), DATA))
    space = any(result.has(name) for name in ("cut_surface", "surface", "generators", "geodesics", "curves", "loops"))
    both = space and any(result.has(name) for name in ("layout", "domains", "outlines", "sides"))
    aspect = (width / 2 if both else width) / height
    views = [view for view in (show_space(result, aspect), show_plane(result, aspect)) if view is not None]
    layout = simple.CreateLayout("ricci: " + result.about["item"])
    place = layout.SplitHorizontal(0, 0.5) if len(views) == 2 else 0
    for k, view in enumerate(views):
        simple.AssignViewToLayout(view=view, layout=layout, hint=place + k)
    layout.SetSize(width, height)
    simple.SetActiveView(views[0])
    if arguments.render:
        simple.SaveScreenshot(os.path.abspath(arguments.render), layout, ImageResolution=[width, height])
    else:
        simple.RenderAllViews()


main()
