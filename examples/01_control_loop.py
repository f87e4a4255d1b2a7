"""A control loop: three floats in, angles and wheel speeds out, nothing allocated on the way."""

import numpy as np

import six_wheel as sw

rover = sw.Rover.six_wheel(
    front_to_middle=0.5,
    middle_to_rear=0.5,
    track_width=0.8,
    middle_track_width=0.9,
    wheel_radius=0.15,
    steering_limit=1.2,
)
steering, speeds = np.zeros(4), np.zeros(6)
print(f"turns of {rover.min_radius:.3f} m and more, spins of {rover.spin_radius:.3f} m and less")

commands = {
    "straight on": (0.5, 0.0, 0.0),
    "a wide turn": (0.5, 0.0, 0.3),
    "too tight, so the tightest": (0.5, 0.0, 1.1),
    "on the spot": (0.0, 0.0, 0.6),
    "rest: the wheels stay": (0.0, 0.0, 0.0),
}
for name, twist in commands.items():
    possible = rover.project(twist, keep="speed")
    rover.inverse(possible, previous=steering, out=(steering, speeds))
    print(f"{name:28}{np.degrees(steering).round(1)} deg {speeds.round(2)} rad/s")
