"""Files of the tests of the command line: a rover and its commands."""

from collections.abc import Callable
from typing import TypeAlias

ROVER = """\
traction_joints: [front_left, front_right, middle_left, middle_right, rear_left, rear_right]
steering_joints: [turn_front_left, turn_front_right, turn_rear_left, turn_rear_right]
d1: 0.4
d2: 0.5
d3: 0.5
d4: 0.45
wheel_radius: 0.15
steering_limit: 1.0
"""
COMMANDS = "time,vx,omega\n0,0.5,0\n1,0.5,0.2\n2,0.5,0\n3,0,0\n"

Run: TypeAlias = Callable[..., tuple[int, str, str]]
