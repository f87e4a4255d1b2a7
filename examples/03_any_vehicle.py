"""The same three lines for every vehicle: twist to wheels, wheels to twist, what it can do at all."""

import math

import numpy as np

import six_wheel as sw

corners = [(0.3, 0.25), (0.3, -0.25), (-0.3, 0.25), (-0.3, -0.25)]
ring = [(math.cos(a), math.sin(a)) for a in np.radians([60, 180, 300])]
vehicles = {
    "Perseverance": sw.Rover.preset("perseverance"),
    "swerve": sw.Rover.swerve(corners, wheel_radius=0.05),
    "differential": sw.Rover.differential(track_width=0.4, wheel_radius=0.1),
    "tracked, skidding": sw.Rover.tracked(track_width=0.5, wheel_radius=0.1, icr_left=0.4, icr_right=-0.4),
    "car": sw.Rover.ackermann(wheelbase=2.5, track_width=1.5, wheel_radius=0.3, steering_limit=0.6),
    "mecanum": sw.Rover.mecanum(wheelbase=0.4, track_width=0.3, wheel_radius=0.05),
    "three omni wheels": sw.Rover.omni(np.multiply(ring, 0.2), np.radians([150, 270, 30]), wheel_radius=0.05),
}
wanted = (0.4, 0.1, 0.1)
for name, rover in vehicles.items():
    twist = rover.project(wanted)
    steering, speeds = rover.inverse(twist)
    back = rover.forward(steering, speeds)
    degree = rover.mobility().degree_of_manoeuvrability
    print(f"{name:18} {len(rover.wheels)} wheels, manoeuvrability {degree}, drives {back.round(3)}")
