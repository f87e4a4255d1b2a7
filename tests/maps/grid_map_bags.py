"""Bags with grid maps."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest


def write_bag(
    path: Path,
    cells: Any,
    start: tuple[int, int] = (0, 0),
    label: str = "column_index",
    yaw: float = 0.0,
    *,
    layers: tuple[str, ...] = ("elevation",),
    topics: tuple[str, ...] = ("/map",),
    roll: float = 0.0,
    short: int = 0,
    messages: int = 1,
    kind: str | None = None,
) -> Path:
    """A bag with a grid map; `cells` (rows, columns) as it numbers them, before its ring buffer.

    Every layer has the same cells, `short` of them left out; `kind` is the type of the topics if not GridMap.
    """
    highlevel = pytest.importorskip("rosbags.rosbag2", reason="needs rosbags")
    from rosbags.typesys import Stores, get_types_from_msg, get_typestore

    from six_wheel.maps.readers.bags import DEFINITIONS, GRID_MAP

    store = get_typestore(Stores.ROS2_HUMBLE)
    for name, definition in DEFINITIONS.items():
        store.register(get_types_from_msg(definition, name))
    types = store.types
    stored = np.roll(cells, start, (0, 1)).astype(np.float32)
    rows, columns = cells.shape
    sizes = {"column_index": columns, "row_index": rows}
    other = "row_index" if label == "column_index" else "column_index"
    flat = (stored.T if label == "column_index" else stored).ravel()
    dimension = types["std_msgs/msg/MultiArrayDimension"]
    layout = types["std_msgs/msg/MultiArrayLayout"](
        dim=[
            dimension(label=label, size=sizes[label], stride=flat.size),
            dimension(label=other, size=sizes[other], stride=sizes[other]),
        ],
        data_offset=0,
    )
    turned = yaw / 2, roll / 2
    pose = types["geometry_msgs/msg/Pose"](
        position=types["geometry_msgs/msg/Point"](x=3.0, y=-2.0, z=0.0),
        orientation=types["geometry_msgs/msg/Quaternion"](
            x=math.cos(turned[0]) * math.sin(turned[1]),
            y=math.sin(turned[0]) * math.sin(turned[1]),
            z=math.sin(turned[0]) * math.cos(turned[1]),
            w=math.cos(turned[0]) * math.cos(turned[1]),
        ),
    )
    array = types["std_msgs/msg/Float32MultiArray"](layout=layout, data=flat[: flat.size - short])
    header = types["std_msgs/msg/Header"](
        stamp=types["builtin_interfaces/msg/Time"](sec=0, nanosec=0), frame_id="map"
    )
    message: Any = types[GRID_MAP](
        header=header,
        info=types["grid_map_msgs/msg/GridMapInfo"](
            resolution=0.5, length_x=0.5 * rows, length_y=0.5 * columns, pose=pose
        ),
        layers=list(layers),
        basic_layers=[],
        data=[array] * len(layers),
        outer_start_index=start[0],
        inner_start_index=start[1],
    )
    if kind is not None:
        message = header
    with highlevel.Writer(path, version=9) as writer:
        for topic in topics:
            connection = writer.add_connection(topic, kind or GRID_MAP, typestore=store)
            for number in range(messages):
                writer.write(connection, number, store.serialize_cdr(message, kind or GRID_MAP))
    return path
