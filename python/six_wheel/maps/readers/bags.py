"""``grid_map_msgs/GridMap`` in ROS bags, the last one of a topic."""

import math
from pathlib import Path
from typing import Any

import numpy as np

from six_wheel.kinematics.errors import needed
from six_wheel.maps import doubts
from six_wheel.maps.files import Grid, Options, TerrainFileError
from six_wheel.maps.readers.points import OTHERS

LEVEL = 1e-3  # largest tilt of a map [rad]
GRID_MAP = "grid_map_msgs/msg/GridMap"
# Definitions of the messages, for bags that do not carry them (ANYbotics, grid_map_msgs; field names and
# types).
DEFINITIONS = {
    "grid_map_msgs/msg/GridMapInfo": (
        "float64 resolution\nfloat64 length_x\nfloat64 length_y\ngeometry_msgs/Pose pose\n"
    ),
    GRID_MAP: (
        "std_msgs/Header header\ngrid_map_msgs/GridMapInfo info\nstring[] layers\nstring[] basic_layers\n"
        "std_msgs/Float32MultiArray[] data\nuint16 outer_start_index\nuint16 inner_start_index\n"
    ),
}


def read(path: Path, options: Options) -> Grid:
    """The last map of a topic, of a bag of ROS 1 or ROS 2.

    By default the topic is the only one with maps, and the layer, or band, of heights ``elevation`` or the
    only one.
    """
    if options.spacing is not None or options.origin is not None or options.north_up is not None:
        raise TerrainFileError(f"{path} ", *doubts.own_place(options))
    topic, layer = options.topic, options.layer or (None if options.band is None else str(options.band))
    with needed("six-wheel[bags]", "bags need"):
        from rosbags.highlevel import AnyReader, AnyReaderError
        from rosbags.typesys import Stores, get_types_from_msg, get_typestore
    store = get_typestore(Stores.ROS2_HUMBLE)
    for name, definition in DEFINITIONS.items():
        store.register(get_types_from_msg(definition, name))
    try:
        with AnyReader([path], default_typestore=store) as bag:
            maps = [connection for connection in bag.connections if connection.msgtype == GRID_MAP]
            topics = sorted({connection.topic for connection in maps})
            if not topics:
                kinds = sorted({connection.msgtype for connection in bag.connections})[:5]
                have = ", ".join(kinds) or "no messages"
                raise TerrainFileError(f"{path} must hold a {GRID_MAP}, it has {have}")
            if topic is None and len(topics) > 1:
                raise TerrainFileError(
                    f"{path} ", *doubts.several("topics of maps", topics, "topic", topics[0])
                )
            if topic is not None and topic not in topics:
                wrong = doubts.no_name_of_that("map on", topic, topics, "topic", topics[0])
                raise TerrainFileError(f"{path} ", *wrong)
            chosen = [connection for connection in maps if connection.topic == (topic or topics[0])]
            last = None
            for connection, _, raw in bag.messages(chosen):
                last = (connection, raw)
            if last is None:
                raise TerrainFileError(f"{path} has no message on {topic or topics[0]}")
            message: Any = bag.deserialize(last[1], last[0].msgtype)
    except (ImportError, TerrainFileError):
        raise
    except Exception as error:  # rosbags lets through whatever reading damaged bytes raises
        told = error if isinstance(error, AnyReaderError) else f"it is damaged or cut off: {error}"
        raise TerrainFileError(f"{path} must be a bag: {' '.join(str(told).split())}") from None
    return _grid(path, message, topic or topics[0], layer)


def _grid(path: Path, message: Any, topic: str, layer: str | None) -> Grid:
    layers = list(message.layers)
    name = layer or ("elevation" if "elevation" in layers else layers[0] if len(layers) == 1 else None)
    if not layers:
        raise TerrainFileError(f"{path} has a map without layers on {topic}: record one with heights")
    if name is None:
        raise TerrainFileError(f"{path} ", *doubts.several("layers", layers, "layer", layers[0]))
    if name not in layers:
        raise TerrainFileError(f"{path} ", *doubts.no_name_of_that("layer", name, layers, "layer", layers[0]))
    if layer is None and name.lower() in OTHERS:
        raise TerrainFileError(f"{path} ", *doubts.band_by_name("layer", name, "layer", name))
    if len(message.data) != len(layers):
        raise TerrainFileError(
            f"{path} must have an array per layer, got {len(message.data)} of {len(layers)}"
        )
    data = message.data[layers.index(name)]
    shape = [dimension.size for dimension in data.layout.dim]
    cells = np.asarray(data.data, np.float32)
    if len(shape) != 2:
        raise TerrainFileError(f"{path}: layer {name} must have two dimensions, got {len(shape)}")
    if cells.size != shape[0] * shape[1]:
        told = f"must have {shape[0]} x {shape[1]} cells, got {cells.size}"
        raise TerrainFileError(f"{path}: layer {name} {told}")
    cells = cells.reshape(shape)
    if data.layout.dim[0].label == "column_index":
        cells = cells.T
    # A ring buffer: the first row and column are where the start indices say.
    cells = np.roll(cells, (-message.outer_start_index, -message.inner_start_index), (0, 1))
    # Its rows go against x, its columns against y, from the corner where both are largest.
    heights = np.ascontiguousarray(cells[::-1, ::-1].T)
    heights[np.isinf(heights)] = np.nan
    info = message.info
    q = info.pose.orientation
    # z component of the third axis of the map: 1 where it is level.
    tilt = math.acos(max(-1.0, min(1.0, 1 - 2 * (q.x * q.x + q.y * q.y))))
    if tilt > LEVEL:
        told = f"its pose is tilted by {math.degrees(tilt):.2f} degrees: transform it first (grid_map_ros)"
        raise TerrainFileError(f"{path} must hold a level map, {told}")
    yaw = math.atan2(2 * (q.w * q.z + q.x * q.y), 1 - 2 * (q.y * q.y + q.z * q.z))
    rows, columns = heights.shape
    back = (-(columns - 1) * info.resolution / 2, -(rows - 1) * info.resolution / 2)
    cos, sin = math.cos(yaw), math.sin(yaw)
    centre = info.pose.position
    origin = (centre.x + cos * back[0] - sin * back[1], centre.y + sin * back[0] + cos * back[1])
    return Grid(heights, (info.resolution, info.resolution), origin, yaw)
