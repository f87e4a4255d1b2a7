"""A mesh with a colour for every vertex, as a binary glTF 2.0 file."""

import json

import numpy as np
from numpy.typing import NDArray

from six_wheel.kinematics.poses import Floats
from six_wheel.view.scene.shapes import Mesh

FLOAT, BYTE, INTEGER = 5126, 5121, 5125  # glTF's numbers of component types
VERTICES, INDICES = 34962, 34963  # and of targets
HEADER = np.dtype("<u4")


def colored_glb(mesh: Mesh, colors: NDArray[np.uint8], normals: Floats) -> bytes:
    """The file of a mesh with colours (n, 3) and normals (n, 3): rough, not metallic, seen from both sides.

    Source: The Khronos Group, glTF 2.0 Specification, ch. 3.6 (geometry) and 4 (GLB).
    """
    alpha = np.full((len(colors), 1), 255, np.uint8)
    # Colours of glTF are linear; those of a screen are about the power 2.2 of that.
    linear = (255.0 * (colors / 255.0) ** 2.2).round().astype(np.uint8)
    parts = [
        (mesh.vertices.astype("<f4"), FLOAT, "VEC3", VERTICES, False),
        (normals.astype("<f4"), FLOAT, "VEC3", VERTICES, False),
        (np.hstack([linear, alpha]), BYTE, "VEC4", VERTICES, True),
        (mesh.faces.astype("<u4").ravel(), INTEGER, "SCALAR", INDICES, False),
    ]
    views, accessors, chunks, start = [], [], [], 0
    for number, (values, component, kind, target, normalised) in enumerate(parts):
        data = values.tobytes()
        views.append({"buffer": 0, "byteOffset": start, "byteLength": len(data), "target": target})
        one = {"bufferView": number, "componentType": component, "count": len(values), "type": kind}
        if number == 0:
            one |= {"min": values.min(axis=0).tolist(), "max": values.max(axis=0).tolist()}
        accessors.append(one | ({"normalized": True} if normalised else {}))
        chunks.append(data)
        start += len(data)
    attributes = {"POSITION": 0, "NORMAL": 1, "COLOR_0": 2}
    rough = {"pbrMetallicRoughness": {"metallicFactor": 0.0, "roughnessFactor": 1.0}, "doubleSided": True}
    text = json.dumps(
        {
            "asset": {"version": "2.0"},
            "scene": 0,
            "scenes": [{"nodes": [0]}],
            "nodes": [{"mesh": 0}],
            "meshes": [{"primitives": [{"attributes": attributes, "indices": 3, "material": 0}]}],
            "materials": [rough],
            "buffers": [{"byteLength": start}],
            "bufferViews": views,
            "accessors": accessors,
        }
    ).encode()
    text += b" " * (-len(text) % 4)
    body = b"".join(chunks)
    body += bytes(-len(body) % 4)
    header = np.array([0x46546C67, 2, 28 + len(text) + len(body)], HEADER).tobytes()
    first = np.array([len(text), 0x4E4F534A], HEADER).tobytes()
    second = np.array([len(body), 0x004E4942], HEADER).tobytes()
    return header + first + text + second + body
