"""One object of every public class, made as its users make it."""

import inspect
from functools import cache
from typing import Any

import numpy as np

import six_wheel as sw
from six_wheel import profiles
from six_wheel.calibration import calibrate
from six_wheel.kinematics.four_axle import FourAxleState
from six_wheel.log_odometry.evaluation import evaluate

ROVER = sw.Rover.preset("perseverance")
TWIST = (0.04, 0.0, 0.02)
LIMITS = sw.Limits(speed=0.2, yaw_rate=0.3, acceleration=0.5, steering_rate=0.5)
ARM = sw.RockerBogie.preset("rocky7")
CENTRE = (0.0, 0.0, 0.1)
BELLY = (-0.2, 0.2, 0.15, -0.02)
DRIVE = [(0, 0.1, 0, 0.0), (4, 0.1, 0, 0.05), (8, 0.1, 0, -0.05), (12, 0.1, 0, 0.0)]


def flag(kind: type) -> bool:
    """True of enumerations, whose members are their samples."""
    return issubclass(kind, int | str)


def public_classes() -> list[type]:
    """Classes of the first page and of `profiles`, without exceptions, warnings and enumerations."""
    found = {getattr(module, name) for module in (sw, profiles) for name in module.__all__}
    kinds = [kind for kind in found if inspect.isclass(kind) and kind.__module__.startswith("six_wheel")]
    kinds = [kind for kind in kinds if not issubclass(kind, BaseException) and not flag(kind)]
    return sorted(kinds, key=lambda kind: kind.__name__)


@cache
def samples() -> dict[str, Any]:
    """An object of every class by the name of the class."""
    made = [*_rovers(), *_logs(), *_ground(), *_motions(), *_axles()]
    return {type(one).__name__: one for one in made}


def _rovers() -> list[Any]:
    steering, speeds = ROVER.inverse(TWIST)
    controller = sw.Controller(ROVER, LIMITS)
    controller.command(TWIST, 0.0)
    output = controller.step(0.02)
    run = sw.Controller(ROVER, LIMITS).run([TWIST], [0.0], np.arange(1, 60) * 0.02)
    x, y = np.meshgrid(np.linspace(-1.0, 3.0, 81), np.linspace(-2.0, 2.0, 81))
    costmap = sw.Costmap(np.exp(-((x - 0.6) ** 2 + y**2) / 0.05), 0.05, (-1.0, -2.0), lethal=0.9)
    planner = sw.Mppi(ROVER, LIMITS, horizon=20, samples=64)
    plan = planner.step((-0.5, 0.0, 0.0), goal=(2.0, 0.5, 1.0), costmap=costmap)
    return [
        ROVER,
        ROVER.wheels[0],
        LIMITS,
        sw.Twist(*TWIST),
        sw.Pose(1.0, 2.0, 0.5),
        ROVER.fit(steering, speeds),
        ROVER.sensitivity(steering, speeds),
        ROVER.mobility(),
        controller,
        output,
        run,
        costmap,
        planner,
        plan,
        ROVER.rollout_cost(np.tile(TWIST, (2, 10, 1)), 0.1),
        sw.Noise(),
        sw.Encoder(4096),
        sw.Gyroscope(noise=0.01),
        sw.body_slip((0.1, 0.0), (0.12, 0.0), np.eye(2) * 1e-4),
    ]


def _logs() -> list[Any]:
    log = sw.simulate(ROVER, DRIVE, seed=1, rate=10.0)
    track = sw.dead_reckon(ROVER, log)
    odometry = sw.Odometry(ROVER, lag=1.0)
    motion = sw.Preintegrated(ROVER)
    for k in range(30):
        odometry.update(log.steering[k], log.wheel_angles[k], log.stamps[k])
        motion.add(log.steering[k], log.wheel_angles[k], log.stamps[k])
    plain = sw.WheelLog(log.stamps, log.steering, log.wheel_angles, log.truth)
    return [
        log,
        plain,
        log.truth,
        track,
        track.slip_report(),
        odometry,
        odometry.state,
        motion,
        evaluate(track, log.truth),
        *track.slip_report().wheels[:1],
    ]


@cache
def terrain() -> sw.Terrain:
    """Ground with bumps of 5 cm."""
    x, y = np.meshgrid(np.arange(81) * 0.1, np.arange(81) * 0.1)
    return sw.Terrain(0.05 * np.sin(1.5 * x) * np.cos(y), 0.1, (-4.0, -4.0))


def _ground() -> list[Any]:
    ground = terrain()
    pose = (0.2, 0.1, 0.3)
    stand = ARM.settle(ground, pose, derivatives=True)
    stability = ARM.stability(stand, mass=10.0, centre_of_mass=CENTRE, belly=BELLY)
    command = ARM.inverse(stand, (0.1, 0.05))
    motion = ARM.forward(stand, command.steering, command.wheel_speeds)
    rates = motion.joint_rates
    drive = sw.simulate(ARM, DRIVE, ground=ground, rate=10.0, seed=1)
    odometry = sw.Odometry3(ARM, ground=ground)
    tracked = sw.dead_reckon(ARM, drive, ground=ground)
    for k in range(3):
        odometry.update(drive.steering[k], drive.wheel_angles[k], drive.stamps[k])
    return [
        ground,
        ARM,
        sw.Suspension.preset("zoe"),
        ARM.links[0],
        stand,
        stability,
        stability.by_pose,
        command,
        motion,
        ARM.steer(0.1, 0.05, (0.0, 0.0, 0.0)),
        ARM.bounds(ground, pose),
        ARM.feasible(ground, pose),
        sw.FeasibilityLimits(),
        ARM.slip(stand, command.wheel_speeds, motion.twist, rates),
        ARM.traction(0.1, 0.0, motion.twist[3:], stand.joints, rates),
        drive,
        odometry,
        odometry.state,
        tracked,
    ]


def _motions() -> list[Any]:
    profile = profiles.trapezoid(0.0, 1.0, 2.0)
    body = profiles.BodyTransition.between(ROVER, (0.0, 0.0, 0.0), TWIST, 2.0)
    ends = (ROVER.inverse(TWIST), ROVER.inverse((0.04, 0.0, -0.02)))
    module = profiles.ModuleTransition.between(ROVER, *ends, 2.0)
    icr = profiles.IcrTransition.between(ROVER, TWIST, (0.04, 0.0, -0.02), steering_rate=0.2)
    return [profile, profile.at(0.5), profile.peaks, body, body.at(0.5), module, icr, icr.phases[0]]


def _axles() -> list[Any]:
    car = sw.FourAxle((0.4, 0.3), 0.2, 0.1)
    sequence = car.turn_sequence(FourAxleState(), 0.5, speed=0.2)
    return [
        car,
        FourAxleState(),
        sequence,
        sequence.steps[0],
        car.mobility((0.0, 0.0, 0.0, 0.0)),
        car.simulate(sequence, 0.1),
        car.forward((0.0, 0.0, 0.0, 0.0), (1.0, 1.0, 1.0, 1.0)),
    ]


@cache
def calibration() -> Any:
    """A calibration of a small rover by one log."""
    from tests.calibration.drives import drive
    from tests.rovers import PAIR

    return calibrate(PAIR, [drive(PAIR, seconds=40.0)], parameters=["track_width"], cross_validation=False)
