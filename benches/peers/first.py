"""robotpy-wpimath: the kinematics of FIRST robots, a swerve module at each of the same wheels.

Bare calls take and return its own objects; the others begin and end with floats, as a caller has them.
"""

import math

from wpimath.geometry import Rotation2d, Translation2d
from wpimath.kinematics import (
    ChassisSpeeds,
    SwerveDrive6Kinematics,
    SwerveDrive6Odometry,
    SwerveModulePosition,
    SwerveModuleState,
)


class First:
    """All wheels steer here, the middle ones too; `wheels` and `radius` as in `Plain`."""

    def __init__(self, wheels, radius):
        self.kinematics = SwerveDrive6Kinematics(*(Translation2d(x, y) for x, y, _ in wheels))
        self.steered, self.radius = [wheel[2] for wheel in wheels], radius
        start = tuple(SwerveModulePosition(0.0, Rotation2d(0.0)) for _ in wheels)
        self.odometry = SwerveDrive6Odometry(self.kinematics, Rotation2d(0.0), start)

    def states(self, steering, speeds):
        angles = iter(steering)
        return tuple(
            SwerveModuleState(self.radius * speed, Rotation2d(next(angles) if steered else 0.0))
            for steered, speed in zip(self.steered, speeds, strict=True)
        )

    def positions(self, steering, angles):
        headings = iter(steering)
        return tuple(
            SwerveModulePosition(self.radius * angle, Rotation2d(next(headings) if steered else 0.0))
            for steered, angle in zip(self.steered, angles, strict=True)
        )

    def inverse(self, vx, vy, omega):
        steering, speeds = [], []
        for state, steered in zip(
            self.kinematics.toSwerveModuleStates(ChassisSpeeds(vx, vy, omega)), self.steered, strict=True
        ):
            angle, speed = state.angle.radians(), state.speed / self.radius
            if abs(angle) > math.pi / 2:
                angle, speed = angle - math.copysign(math.pi, angle), -speed
            if steered:
                steering.append(angle)
            speeds.append(speed)
        return steering, speeds

    def forward(self, steering, speeds):
        twist = self.kinematics.toChassisSpeeds(self.states(steering, speeds))
        return twist.vx, twist.vy, twist.omega

    def update(self, yaw, steering, angles):
        pose = self.odometry.update(Rotation2d(yaw), self.positions(steering, angles))
        return pose.x, pose.y, pose.rotation().radians()


def chassis(twist):
    """A twist as wpimath has it."""
    return ChassisSpeeds(*twist)
