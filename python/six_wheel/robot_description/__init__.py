"""Files that describe a robot: `parameters` (ROS 2 or plain keys) and `urdf` (robot descriptions), read and
written.

`named_rover` opens either, or a preset; `diagnostics` are findings about such files, `joint_names` tells a
wheel's place from the name of its joint.
"""

from six_wheel.kinematics.lazy import attach

__getattr__, __dir__ = attach(
    __name__, {"diagnostics": (), "joint_names": (), "named_rover": (), "parameters": (), "urdf": ()}
)
