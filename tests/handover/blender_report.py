"""Run inside Blender after a script: what is in its scene, as JSON to $BLENDER_REPORT."""
import json
import os

import bpy
import numpy as np


def attribute(mesh, name, kind="value", width=1):
    values = np.zeros(len(mesh.attributes[name].data) * width, dtype=np.float32)
    mesh.attributes[name].data.foreach_get(kind, values)
    return values


report = {"scenes": [], "objects": {}}
for scene in bpy.data.scenes:
    report["scenes"].append(scene.name)
scene = next((s for s in bpy.data.scenes if "source" in s), bpy.data.scenes[0])
report["camera"] = scene.camera is not None
report["view_transform"] = scene.view_settings.view_transform
bpy.context.view_layer.update()
for shown in scene.objects:
    entry = {"type": shown.type, "location": list(shown.location)}
    if shown.type == "MESH":
        mesh = shown.data
        entry.update(vertices=len(mesh.vertices), edges=len(mesh.edges), polygons=len(mesh.polygons), loops=len(mesh.loops),
                     uv=[layer.name for layer in mesh.uv_layers], colours=[c.name for c in mesh.color_attributes],
                     materials=[m.name for m in mesh.materials if m],
                     attributes=sorted(a.name for a in mesh.attributes if not a.name.startswith(".")))
        coordinates = np.zeros(3 * len(mesh.vertices), dtype=np.float32)
        mesh.vertices.foreach_get("co", coordinates)
        entry["coordinates"] = coordinates.tobytes().hex() if len(mesh.vertices) < 5000 else ""
        if len(mesh.uv_layers):
            uv = np.zeros(2 * len(mesh.loops), dtype=np.float32)
            mesh.uv_layers[0].data.foreach_get("uv", uv)
            entry["uv_values"] = uv.tobytes().hex()
        for name in ("area_distortion", "conformal_factor", "distortion"):
            if name in mesh.attributes:
                entry[name] = attribute(mesh, name).tobytes().hex()
    if shown.type == "CURVE":
        entry.update(splines=len(shown.data.splines), points=[len(s.points) for s in shown.data.splines],
                     cyclic=[s.use_cyclic_u for s in shown.data.splines], bevel=shown.data.bevel_depth)
    report["objects"][shown.name] = entry
with open(os.environ["BLENDER_REPORT"], "w") as out:
    json.dump(report, out)
