"""The vehicles that FIRST robots drive, against the kinematics those robots run: robotpy-wpimath.

Its axes and signs are ours (x forward, y left, counter-clockwise), and so is its order of wheels. It gives
the speed of a wheel at its rim [m/s], and always forwards, where a wheel here may roll backwards at half a
turn less: velocities of the wheels are compared, as vectors, so that nobody's choice of angle matters.
"""

import numpy as np
import pytest

from six_wheel import Rover

pytest.importorskip("wpimath", reason="needs pip install robotpy-wpimath")

from wpimath.geometry import Translation2d
from wpimath.kinematics import (
    ChassisSpeeds,
    DifferentialDriveKinematics,
    DifferentialDriveWheelSpeeds,
    MecanumDriveKinematics,
    SwerveDrive2Kinematics,
    SwerveDrive3Kinematics,
    SwerveDrive4Kinematics,
    SwerveDrive6Kinematics,
)

SWERVES = {
    2: SwerveDrive2Kinematics,
    3: SwerveDrive3Kinematics,
    4: SwerveDrive4Kinematics,
    6: SwerveDrive6Kinematics,
}
LAYOUTS, TWISTS = 100, 1000  # 1e5 cases of every vehicle
ROUNDING = 1e-14  # speeds up to 8 m/s: 1e-15 each, and a few operations


def random_twists(generator: np.random.Generator) -> np.ndarray:
    """Every size down to millimetres per second, crabs, spins and straight lines among them."""
    twists = generator.uniform(-3, 3, (TWISTS, 3)) * 10.0 ** generator.uniform(-3, 0, (TWISTS, 1))
    twists[:50, 2] = twists[50:100, :2] = twists[100:150, 1:] = 0.0
    return twists


def triples(chassis) -> np.ndarray:
    return np.array([(speeds.vx, speeds.vy, speeds.omega) for speeds in chassis])


@pytest.mark.parametrize("modules", SWERVES)
def test_swerve(modules):
    generator = np.random.default_rng(modules)
    worst = worst_twist = 0.0
    for _ in range(LAYOUTS):
        # Their forward kinematics inverts normal equations: keep the modules apart.
        grid = 0.6 * np.array([(i % 2, i // 2) for i in range(modules)])
        spots = grid + generator.uniform(-0.2, 0.2, (modules, 2))
        radius = generator.uniform(0.03, 0.3)
        rover = Rover.swerve(spots, radius)
        theirs = SWERVES[modules](*(Translation2d(x, y) for x, y in spots))
        twists, centre = random_twists(generator), generator.uniform(-1, 1, 2)
        point = Translation2d(*centre)
        states = [theirs.toSwerveModuleStates(ChassisSpeeds(*twist), point) for twist in twists.tolist()]
        expected = np.array([[(s.speed, s.angle.cos(), s.angle.sin()) for s in row] for row in states])
        steering, speeds = rover.inverse(twists, centre=centre)
        rim = radius * speeds
        for ours, part in ((np.cos(steering), 1), (np.sin(steering), 2)):
            worst = max(worst, np.abs(rim * ours - expected[..., 0] * expected[..., part]).max())
        back = triples(theirs.toChassisSpeeds(row) for row in states)
        worst_twist = max(worst_twist, np.abs(rover.forward(steering, speeds) - back).max())
    print(f"swerve, {modules} modules: wheels {worst:.1e} m/s, twist {worst_twist:.1e}")
    assert worst < ROUNDING
    assert worst_twist < 10 * ROUNDING  # two modules may be 0.2 m apart


def test_differential():
    generator = np.random.default_rng(1)
    worst = worst_twist = 0.0
    for track, radius in generator.uniform((0.1, 0.03), (2.0, 0.3), (LAYOUTS, 2)):
        rover, theirs = Rover.differential(track, radius), DifferentialDriveKinematics(track)
        twists = random_twists(generator) * (1, 0, 1)
        wheels = [theirs.toWheelSpeeds(ChassisSpeeds(*twist)) for twist in twists.tolist()]
        expected = np.array([(speeds.left, speeds.right) for speeds in wheels])
        _, speeds = rover.inverse(twists)
        worst = max(worst, np.abs(radius * speeds - expected).max())
        back = triples(
            theirs.toChassisSpeeds(DifferentialDriveWheelSpeeds(*row)) for row in expected.tolist()
        )
        worst_twist = max(worst_twist, np.abs(rover.forward(None, expected / radius) - back).max())
    print(f"differential: wheels {worst:.1e} m/s, twist {worst_twist:.1e}")
    assert worst < ROUNDING
    assert worst_twist < ROUNDING


def test_mecanum():
    generator = np.random.default_rng(2)
    worst = worst_twist = 0.0
    for length, width, radius in generator.uniform((0.1, 0.1, 0.03), (1.0, 1.0, 0.3), (LAYOUTS, 3)):
        rover = Rover.mecanum(2 * length, 2 * width, radius)
        theirs = MecanumDriveKinematics(*(Translation2d(wheel.x, wheel.y) for wheel in rover.wheels))
        twists = random_twists(generator)
        wheels = [theirs.toWheelSpeeds(ChassisSpeeds(*twist)) for twist in twists.tolist()]
        expected = np.array([(w.frontLeft, w.frontRight, w.rearLeft, w.rearRight) for w in wheels])
        _, speeds = rover.inverse(twists)
        worst = max(worst, np.abs(radius * speeds - expected).max())
        back = triples(theirs.toChassisSpeeds(row) for row in wheels)
        worst_twist = max(worst_twist, np.abs(rover.forward(None, expected / radius) - back).max())
    print(f"mecanum: wheels {worst:.1e} m/s, twist {worst_twist:.1e}")
    assert worst < ROUNDING
    assert worst_twist < ROUNDING
