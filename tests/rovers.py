"""Rovers that many tests drive, each said once."""

import math

import six_wheel as sw

SIX_SIZES = {
    "front_to_middle": 0.5,
    "middle_to_rear": 0.5,
    "track_width": 0.8,
    "middle_track_width": 0.9,
    "wheel_radius": 0.15,
}
"""Dimensions [m] of `SIX_WHEELS`."""
CORNERS = [(0.4, 0.3), (0.4, -0.3), (-0.4, 0.3), (-0.4, -0.3)]
"""Places of four wheels [m]."""
SIX_WHEELS = sw.Rover.six_wheel(**SIX_SIZES)
LIMITED = sw.Rover.six_wheel(**SIX_SIZES, steering_limit=1.0)
CART = sw.Rover.differential(0.5, 0.1)
PAIR = sw.Rover.differential(0.4, 0.1)
SMALL_PAIR = sw.Rover.differential(0.2, 0.042)
THREE_AXLES = sw.Rover.differential(0.5, 0.1, wheels_per_side=3, wheelbase=0.8)
CAR = sw.Rover.ackermann(2.0, 1.2, 0.3, steering_limit=0.6)
TRICYCLE = sw.Rover.tricycle(1.0, 0.8, 0.2)
SMALL_TRICYCLE = sw.Rover.tricycle(0.6, 0.4, 0.1)
MECANUM = sw.Rover.mecanum(0.6, 0.4, 0.1)
SMALL_MECANUM = sw.Rover.mecanum(0.4, 0.3, 0.05)
TRIANGLE = [(0.2, 0.0), (-0.1, 0.17), (-0.1, -0.17)]
OMNI = sw.Rover.omni(TRIANGLE, [math.radians(angle) for angle in (90, 210, -30)], 0.05)
CASTOR = sw.Rover([*CART.wheels, sw.Wheel("castor", 0.3, 0, radius=0.05, castor=True, trail=0.02)])
SWERVE = sw.Rover.swerve(CORNERS, 0.1)
LOW_SWERVE = sw.Rover.swerve(CORNERS, 0.08)
SMALL_SWERVE = sw.Rover.swerve([(0.3, 0.2), (0.3, -0.2), (-0.3, 0.2), (-0.3, -0.2)], 0.1)
