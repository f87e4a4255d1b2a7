"""A planner that sends at 10 kHz: ``python flood.py COUNT SPEED`` prints the rate that it reached [Hz]."""

import sys
import time

import rclpy
from geometry_msgs.msg import TwistStamped

from six_wheel.logs.mcap.frames import planar_twist, twist_stamped

RATE = 10_000.0  # [Hz]


def main() -> None:
    count, speed = int(sys.argv[1]), float(sys.argv[2])
    rclpy.init()
    node = rclpy.create_node("flood")
    publisher = node.create_publisher(TwistStamped, "cmd_vel", 10)
    while not publisher.get_subscription_count():
        time.sleep(0.01)
    message, twist = twist_stamped("base_link"), planar_twist((speed, 0.0, 0.0))
    begin = time.monotonic()
    for number in range(count):
        publisher.publish(message.pack(time.time_ns(), twist))
        if (early := begin + number / RATE - time.monotonic()) > 0.0:
            time.sleep(early)
    print(f"{count / (time.monotonic() - begin):.0f}")
    rclpy.shutdown()


if __name__ == "__main__":
    main()
