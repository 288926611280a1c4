"""glTF 2.0 by a reader that minds what the specification says of buffers, accessors and primitives."""
import json
import struct
import urllib.parse
from pathlib import Path

import numpy as np

COMPONENTS = {5121: ("u1", 1), 5123: ("<u2", 2), 5125: ("<u4", 4), 5126: ("<f4", 4)}
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}


class Gltf:
    def __init__(self, path):
        self.folder = Path(path).parent
        content = Path(path).read_bytes()
        self.binary = None
        if str(path).endswith(".glb"):
            magic, version, length = struct.unpack_from("<4sII", content)
            assert magic == b"glTF" and version == 2 and length == len(content)
            size, kind = struct.unpack_from("<I4s", content, 12)
            assert kind == b"JSON" and size % 4 == 0
            self.root = json.loads(content[20:20 + size])
            rest = 20 + size
            size, kind = struct.unpack_from("<I4s", content, rest)
            assert kind == b"BIN\0" and size % 4 == 0 and rest + 8 + size == len(content)
            self.binary = content[rest + 8:]
        else:
            self.root = json.loads(content)
        assert self.root["asset"]["version"] == "2.0"
        assert len(self.root["buffers"]) == 1
        buffer = self.root["buffers"][0]
        if "uri" in buffer:
            self.binary = (self.folder / urllib.parse.unquote(buffer["uri"])).read_bytes()
            assert len(self.binary) == buffer["byteLength"]
        assert 0 <= len(self.binary) - buffer["byteLength"] < 4
        self.check_scenes()

    def view(self, number):
        view = self.root["bufferViews"][number]
        start = view.get("byteOffset", 0)
        assert start % 4 == 0 and start + view["byteLength"] <= self.root["buffers"][0]["byteLength"]
        return self.binary[start:start + view["byteLength"]]

    def accessor(self, number):
        accessor = self.root["accessors"][number]
        kind, size = COMPONENTS[accessor["componentType"]]
        width, raw = WIDTHS[accessor["type"]], self.view(accessor["bufferView"])
        assert accessor["count"] >= 1 and len(raw) == accessor["count"] * width * size
        values = np.frombuffer(raw, kind).reshape(-1, width)
        if kind == "<f4":
            assert np.isfinite(values).all()
        for key, extreme in (("min", values.min), ("max", values.max)):
            if key in accessor:
                assert (np.array(accessor[key], kind) == extreme(axis=0)).all()
        return values if width > 1 else values[:, 0]

    def check_scenes(self):
        nodes = self.root["nodes"]
        used = [n for scene in self.root["scenes"] for n in scene["nodes"]]
        assert sorted(used) == list(range(len(nodes)))
        for mesh in self.root["meshes"]:
            for primitive in mesh["primitives"]:
                self.check_primitive(primitive)

    def check_primitive(self, primitive):
        attributes = {name: self.accessor(n) for name, n in primitive["attributes"].items()}
        count = len(attributes["POSITION"])
        accessor = self.root["accessors"][primitive["attributes"]["POSITION"]]
        assert "min" in accessor and "max" in accessor
        for name, values in attributes.items():
            assert len(values) == count, name
            kind = self.root["accessors"][primitive["attributes"][name]]
            view = self.root["bufferViews"][kind["bufferView"]]
            assert view["target"] == 34962
            assert kind["componentType"] == 5126 or (name == "COLOR_0" and kind["normalized"])
            assert name in ("POSITION", "NORMAL", "TEXCOORD_0", "COLOR_0") or name[0] == "_"
        if "NORMAL" in attributes:
            assert np.abs(np.linalg.norm(attributes["NORMAL"], axis=1) - 1).max() < 1e-5
        if "indices" in primitive:
            kind = self.root["accessors"][primitive["indices"]]
            assert kind["componentType"] in (5123, 5125)
            assert self.root["bufferViews"][kind["bufferView"]]["target"] == 34963
            indices = self.accessor(primitive["indices"])
            assert indices.max() < count and len(indices) % 3 == 0
            if kind["componentType"] == 5123:
                assert indices.max() < 65535
        material = self.root["materials"][primitive["material"]]
        if "baseColorTexture" in material["pbrMetallicRoughness"]:
            assert "TEXCOORD_0" in attributes

    def mesh(self, name):
        return next(mesh for mesh in self.root["meshes"] if mesh["name"] == name)

    def attributes(self, name, primitive=0):
        chosen = self.mesh(name)["primitives"][primitive]
        return {key: self.accessor(n) for key, n in chosen["attributes"].items()}

    def indices(self, name):
        return self.accessor(self.mesh(name)["primitives"][0]["indices"])

    def image(self):
        image = self.root["images"][0]
        if "uri" in image:
            return (self.folder / urllib.parse.unquote(image["uri"])).read_bytes()
        assert image["mimeType"] == "image/png"
        return self.view(image["bufferView"])
