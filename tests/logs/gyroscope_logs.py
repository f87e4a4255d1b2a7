"""Simulated logs of a gyroscope, and their headers."""

from typing import Any

import numpy as np
from rosbags.typesys import Stores, get_typestore

import six_wheel as sw
from tests.rovers import CART

STORE, STORE_1 = get_typestore(Stores.ROS2_HUMBLE), get_typestore(Stores.ROS1_NOETIC)
TYPES = STORE.types


def simulated(seed: int = 1, **options: Any) -> sw.WheelLog:
    """Rest, a way that winds, rest: 30 s."""
    times = np.arange(0.0, 31.0)
    twists = np.stack((0.3 + 0 * times, 0 * times, 0.8 * np.sin(times)), axis=-1)
    twists[:4] = twists[-4:] = 0.0
    return sw.simulate(CART, (times, twists), gyroscope=sw.Gyroscope(0.002), rate=20.0, seed=seed, **options)


def make(kind: str, /, **fields: Any) -> Any:
    return TYPES[kind](**fields)


def header(stamp: float, frame: str) -> Any:
    second, nanosecond = divmod(round(stamp * 1e9), 10**9)
    time = make("builtin_interfaces/msg/Time", sec=second, nanosec=nanosecond)
    return make("std_msgs/msg/Header", stamp=time, frame_id=frame)
