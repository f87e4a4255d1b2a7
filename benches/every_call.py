"""Cost of a row of every public batch call, as a multiple of a row of `Rover.inverse` in the same run.

The calls are found by walking the package: whatever takes an array of any number of rows. A new one needs a
row here, or a word why it has none; `tests/core/laws/test_every_call.py` fails until it has.
"""

import inspect
import re
from dataclasses import dataclass

import numpy as np

import six_wheel as sw
from six_wheel.cli.benchmark import Comparison, Grid, Timing, nanoseconds, round_robin

ROWS = 20_000
FEW = 200  # of calls that take long
LIMIT = 1.2  # [rad]
SIX = {
    "front_to_middle": 0.5,
    "middle_to_rear": 0.5,
    "track_width": 0.8,
    "middle_track_width": 0.9,
    "wheel_radius": 0.15,
}
BATCH = re.compile(r"shape \((\.\.\.|n\b|m\b)")

# Calls that take arrays, but no batch of rows of the same question.
NO_BATCH = {
    "Rover.omni": "positions of wheels",
    "Rover.swerve": "positions of wheels",
    "evaluate": "two paths, their stamps matched",
    "simulate": "one log, made sample by sample",
    "umbmark": "two runs of a square",
    "body_slip": "the components of one motion",
    "BodySlip.compensate": "the components of one motion",
}


@dataclass(frozen=True)
class Row:
    """A call: of what it is one, on what it works, and what it may cost in rows of `inverse`."""

    call: str
    label: str
    function: object
    arguments: tuple
    keywords: dict
    rows: int
    goal: float | None = None


def public_calls():
    """Names of the public functions and methods that take any number of rows."""
    found = []
    for name in sw.__all__:
        thing = getattr(sw, name)
        if inspect.isclass(thing):
            members = ((f"{name}.{member}", getattr(thing, member)) for member in vars(thing))
        else:
            members = [(name, thing)]
        for path, call in members:
            public = callable(call) and not path.rpartition(".")[2].startswith("_")
            given = (inspect.getdoc(call) or "").partition("Parameters\n")[2].partition("Returns\n")[0]
            if public and BATCH.search(given):
                found.append(path)
    return sorted(found)


def rovers():
    """The vehicles that are asked."""
    four = [(0.5, 0.4), (0.5, -0.4), (-0.5, 0.4), (-0.5, -0.4)]
    return {
        "six-wheel": sw.Rover.six_wheel(**SIX, steering_limit=LIMIT),
        "swerve": sw.Rover.swerve(four, 0.1, steering_limit=LIMIT),
        "car": sw.Rover.ackermann(1.0, 0.6, 0.1, steering_limit=0.6),
        "swerve, range 3": sw.Rover.swerve(four[:3], 0.1, steering_limit=3.0),
        "scrub and trail": sw.Rover([
            sw.Wheel("a", 0.5, 0.4, radius=0.1, steered=True, steering_limit=LIMIT, scrub=0.05, trail=0.02),
            sw.Wheel("b", 0.5, -0.4, radius=0.1, steered=True, steering_limit=LIMIT, scrub=-0.05, trail=0.02),
            sw.Wheel("c", 0.0, 0.4, radius=0.1),
            sw.Wheel("d", 0.0, -0.4, radius=0.1),
        ]),
    }  # fmt: skip


def listed(rows=ROWS):
    """The rows of the table."""
    random = np.random.default_rng(1)
    few = min(FEW, rows)
    vehicles = rovers()
    rover = vehicles["six-wheel"]
    beyond = random.uniform(-1.0, 1.0, (rows, 3)) * [1.5, 0.3, 1.0]
    inside = np.ascontiguousarray(beyond * [1.0, 0.0, 0.1])
    inside[:, 0] += np.copysign(0.3, inside[:, 0])
    ends = rover.project(beyond)
    out = np.empty((rows, 4)), np.empty((rows, 6))
    steering, speeds = rover.inverse(inside)
    stamps = 0.02 * np.arange(rows)
    totals = np.cumsum(0.02 * speeds, axis=0)
    table = []

    def add(call, label, function, *arguments, rows=rows, goal=None, **keywords):
        table.append(Row(call, label, function, arguments, keywords, rows, goal))

    add("Rover.inverse", "inside the limits", rover.inverse, inside, out=out, goal=1.0)
    add("Rover.inverse", "at the limits", rover.inverse, ends, out=out, goal=1.2)
    add("Rover.inverse", "previous=", rover.inverse, inside, previous=steering, out=out, goal=1.5)
    add(
        "Rover.inverse",
        "previous_wheel_speeds=",
        rover.inverse,
        inside,
        previous_wheel_speeds=speeds,
        out=out,
        goal=2.0,
    )
    add("Rover.inverse", "steering_rates=", rover.inverse, inside, steering_rates=steering, out=out, goal=2.0)
    add("Rover.inverse", "centre=", rover.inverse, inside, centre=(0.0, 0.0), out=out, goal=1.5)
    strided = np.empty((rows, 8))[:, ::2], np.empty((rows, 12))[:, ::2]
    add("Rover.inverse", "out= not contiguous", rover.inverse, inside, out=strided, goal=1.5)
    for name, goal in (("swerve, range 3", 1.3), ("car", 1.2), ("scrub and trail", 2.0)):
        vehicle = vehicles[name]
        possible = vehicle.project(beyond)
        add("Rover.inverse", name, vehicle.inverse, possible, out=vehicle.inverse(possible), goal=goal)
    joints = vehicles["scrub and trail"].inverse(vehicles["scrub and trail"].project(beyond))
    twists = np.empty((rows, 3))
    add("Rover.forward", "six-wheel", rover.forward, steering, speeds, out=twists, goal=1.0)
    add(
        "Rover.forward", "scrub and trail", vehicles["scrub and trail"].forward, *joints, out=twists, goal=2.0
    )
    add("Rover.commands", "six-wheel", rover.commands, inside)
    add("Rover.admissible", "few are", rover.admissible, beyond, goal=0.5)
    add("Rover.admissible", "all are", rover.admissible, inside, goal=0.5)
    add("Rover.project", "inside the limits", rover.project, inside, out=twists, goal=1.5)
    for keep in ("curvature", "nearest", "speed", "yaw_rate"):
        add("Rover.project", f"six-wheel, {keep}", rover.project, beyond, keep, out=twists, goal=2.0)
    for name in ("swerve", "car"):
        add("Rover.project", name, vehicles[name].project, beyond, out=twists, goal=5.0)
    add("Rover.icr", "six-wheel", rover.icr, inside)
    add("Rover.fit", "least squares", rover.fit, steering, speeds, goal=2.0)
    add("Rover.fit", "middle wheels", rover.fit, steering, speeds, method="middle_wheels", goal=2.0)
    noisy = speeds[:few] + random.normal(0.0, 0.05, speeds[:few].shape)
    add("Rover.fit", "robust", rover.fit, steering[:few], noisy, method="robust", rows=few, goal=15.0)
    add(
        "Rover.sensitivity", "six-wheel", rover.sensitivity, steering[:few], speeds[:few], rows=few, goal=10.0
    )
    add("exp", "", sw.exp, inside, 0.1, out=twists, goal=0.5)
    add("log", "", sw.log, inside, 0.1, out=twists, goal=0.5)
    add("compose", "", sw.compose, inside, inside, out=twists, goal=0.5)
    add("differentiate", "", sw.differentiate, inside, 0.1, out=twists[1:], goal=0.5)
    add("wrap_angle", "", sw.wrap_angle, stamps, out=np.empty(rows))
    add("integrate", "one dt", sw.integrate, inside, 0.02)
    add("integrate", "a dt per step", sw.integrate, inside, np.full(rows, 0.02))
    steps = max(rows // 64, 1)
    controls = inside[: rows // steps * steps].reshape(-1, steps, 3)
    count = len(controls) * steps
    add("rollout", "", sw.rollout, controls, 0.02, rows=count)
    add("Rover.rollout_cost", "six-wheel", rover.rollout_cost, controls, 0.02, rows=count)
    plan = sw.Mppi(rover, sw.Limits(speed=1.5, yaw_rate=1.0, steering_rate=1.0), samples=max(rows // 56, 1))
    hills = sw.Costmap(random.random((200, 200)), 0.05)
    add("Mppi.step", "a step of a rollout", plan.step, (5.0, 5.0, 0.3), path=[(5.0, 5.0), (9.0, 8.0)],
        costmap=hills, rows=plan.samples * 56)  # fmt: skip
    add("dead_reckon", "six-wheel", sw.dead_reckon, rover, steering, totals, stamps, goal=5.0)
    turning = {"yaw_rate": inside[:, 2], "gyroscope": sw.Gyroscope()}
    add("dead_reckon", "gyroscope", sw.dead_reckon, rover, steering, totals, stamps, goal=5.0, **turning)
    odometry = sw.Odometry(rover)
    add(
        "Odometry.run",
        "six-wheel",
        lambda *log: sw.Odometry(odometry.rover).run(*log),
        steering,
        totals,
        stamps,
    )
    return table + others(few)


def others(few):
    """The other vehicles, the controller and the ground."""
    random = np.random.default_rng(2)
    table = []

    def add(call, function, *arguments, rows=few):
        table.append(Row(call, "", function, arguments, {}, rows))

    bogie = sw.RockerBogie.preset("open_source_rover")
    joints = random.uniform(-0.2, 0.2, (few, 3))
    add("RockerBogie.frames", bogie.frames, joints)
    add("RockerBogie.icr_offset", bogie.icr_offset, joints)
    add("RockerBogie.jacobians", bogie.jacobians, joints)
    speed, yaw_rate = np.full(few, 0.1), random.uniform(-0.05, 0.05, few)
    add("RockerBogie.steer", bogie.steer, speed, yaw_rate, joints)
    yard = sw.Terrain.yard((12.0, 12.0), 0.1, cover=0.1, seed=1)
    stands = random.uniform([3.0, 3.0, -3.0], [9.0, 9.0, 3.0], (few, 3))
    add("RockerBogie.bounds", bogie.bounds, yard, stands)
    add("RockerBogie.feasible", bogie.feasible, yard, stands)
    axles = sw.FourAxle((0.3, 0.3), 0.4, 0.1)
    centres = np.stack([np.zeros(few), random.uniform(2.0, 3.0, few)], axis=-1)
    add("FourAxle.concurrent_angles", axles.concurrent_angles, centres)
    add("FourAxle.inverse", axles.inverse, np.stack([0 * speed, 0 * speed, yaw_rate], axis=-1))
    rover = rovers()["six-wheel"]
    stamps = 0.02 * np.arange(few)
    command = np.array([[0.3, 0.0, 0.1]])
    add("Controller.run", lambda *log: sw.Controller(rover).run(*log), command, stamps[:1], stamps)
    steering, speeds = rover.inverse(np.tile(command, (few, 1)))
    totals = np.cumsum(0.02 * speeds, axis=0)
    add("Preintegrated.add", lambda *log: sw.Preintegrated(rover).add(*log), steering, totals, stamps)
    ground = sw.Terrain(random.uniform(0.0, 0.1, (32, 32)), 0.1)
    points = random.uniform(1.2, 1.9, (few, 2))
    poses = np.concatenate([points, points[:, :1]], axis=1)
    add("Suspension.settle", bogie.settle, ground, poses)
    stand = bogie.settle(ground, poses)
    turns, rates = np.full((few, 4), 0.1), np.ones((few, 6))
    moved = bogie.forward(stand, turns, rates)
    add("Suspension.forward", bogie.forward, stand, turns, rates)
    add("Suspension.inverse", bogie.inverse, stand, np.stack([speed, yaw_rate], axis=-1))
    add("Suspension.slip", bogie.slip, stand, rates, moved.twist, moved.joint_rates)
    still = np.zeros((few, 3))
    add("Suspension.traction", bogie.traction, speed, yaw_rate, still, joints, still)
    readings = turns, 0.02 * np.cumsum(rates, axis=0), stamps
    by_joints = {"joints": joints / 10.0, "attitude": np.zeros((few, 2))}
    reckoned = {"by joints": by_joints, "by ground": {"ground": ground}}
    for label, known in reckoned.items():
        start = (1.2, 1.5, 0.0)
        table.append(
            Row("dead_reckon", label, sw.dead_reckon, (bogie, *readings), {**known, "start": start}, few)
        )
    add("Odometry3.run", lambda *log: sw.Odometry3(bogie).run(*log, **by_joints), *readings)
    for name in ("contains", "gradient_at", "height_at", "normal_at"):
        add(f"Terrain.{name}", getattr(ground, name), points)
    return table


def measured(rows=ROWS, rounds=20, progress=None):
    """The table, every figure beside `inverse` in the same rounds."""
    table = listed(rows)
    timings = {
        f"{row.call} {row.label}": Timing.of(row.function, *row.arguments, items=row.rows, **row.keywords)
        for row in table
    }
    round_robin([Comparison("every call", timings)], rounds, progress=progress)
    unit = timings["Rover.inverse inside the limits"].best
    grid = Grid(f"Every batch call [ns per row of {rows}]", ["call", "", "ns", "x inverse", "goal", ""])
    for row in table:
        times = timings[f"{row.call} {row.label}"].best
        share = times / unit
        reached = "" if row.goal is None else "reached" if share <= row.goal else f"{share / row.goal:.2g} x"
        goal = "" if row.goal is None else f"{row.goal:g}"
        grid.rows.append([row.call, row.label, nanoseconds(times), f"{share:.2g}", goal, reached])
    return grid
