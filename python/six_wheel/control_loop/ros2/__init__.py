"""ROS 2 nodes: `node` drives a rover, `filter` makes commands possible for a robot with a controller of its
own.

Only this package knows rclpy, and imports it when a node starts: from a ROS installation, or from the extra
``ros``. What the nodes do is `six_wheel.control_loop`; `base` is what both are, `interfaces` the messages of
joint commands, `parameters` what they declare, `running` the process around them.
"""
