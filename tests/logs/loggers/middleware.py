"""Exports of ROS tools: echo -p, PlotJuggler, bagpy, Foxglove, wide logs."""

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from tests.logs.loggers.logged import (
    COUNTS,
    PAIR,
    SKID,
    START,
    Drive,
    Logged,
    as_unit,
    lines_of,
    table,
    text,
    wheels,
)

JOINTS = ("left_wheel_joint", "right_wheel_joint")


def _ns(drive: Drive) -> np.ndarray:
    return START * 10**9 + np.rint(1e9 * drive.stamps).astype(np.int64)


def _const(word: str, drive: Drive = PAIR) -> Sequence[str]:
    return [word] * len(drive.stamps)


def ros1() -> Iterator[Logged]:
    """`rostopic echo -p`, bag_to_csv and bagpy."""
    ns = _ns(PAIR)
    count = np.arange(len(ns))
    head: dict[str, Any] = {
        "%time": ns,
        "field.header.seq": count,
        "field.header.stamp": ns,
        "field.header.frame_id": _const("base_link"),
    }
    names = {f"field.name{k}": _const(joint) for k, joint in enumerate(JOINTS)}
    places = {f"field.position{k}": PAIR.angles[:, k] for k in range(2)}
    speeds = {f"field.velocity{k}": PAIR.rates[:, k] for k in range(2)}
    owner = as_unit(list(places), "rad", **{"%time": "time [ns]", "field.header.stamp": ""})
    yield Logged(
        "rostopic echo -p of joint states", table({**head, **names, **places, **speeds}), owner=owner
    )
    data = {"%time": ns, "field.data": PAIR.counts[:, 0]}
    yield Logged("rostopic echo -p of one wheel", table(data), knowable=False)
    secs = {"Time": START + PAIR.stamps, "header.seq": count}
    secs |= {"header.stamp.secs": ns // 10**9, "header.stamp.nsecs": ns % 10**9}
    flat = {f"position_{k}": PAIR.angles[:, k] for k in range(2)}
    yield Logged("bagpy, one column each", table({**secs, **flat}), owner=as_unit(list(flat), "rad", Time=""))
    rows = [f'"[{left:.6f}, {right:.6f}]"' for left, right in PAIR.angles]
    named = ["\"['left_wheel_joint', 'right_wheel_joint']\""] * len(rows)
    yield Logged("bagpy, lists in cells", table({**secs, "name": named, "position": rows}), says=("columns",))
    tuples = [f'"({left:.6f}, {right:.6f})"' for left, right in PAIR.angles]
    yield Logged(
        "rosbag_to_csv, tuples in cells",
        table({"time": START + PAIR.stamps, ".position": tuples}),
        says=("columns",),
    )
    dotted = {
        f"/{name}/state/process_value": PAIR.angles[:, k] for k, name in enumerate(PAIR.rover.wheel_names)
    }
    yield Logged(
        "topics as names",
        table({"rosbagTimestamp": ns, **dotted}),
        owner=as_unit(list(dotted), "rad", rosbagTimestamp="time [ns]"),
    )


def ros2() -> Iterator[Logged]:
    """`ros2 topic echo --csv`, PlotJuggler and Foxglove."""
    ns = _ns(PAIR)
    cells = [
        f"{t // 10**9},{t % 10**9},base,{JOINTS[0]},{JOINTS[1]},{left:.6f},{right:.6f}"
        for t, (left, right) in zip(ns, PAIR.angles, strict=True)
    ]
    order = ["time.sec", "time.nanosec", "", "", "", "left [rad]", "right [rad]"]
    yield Logged("ros2 topic echo --csv", text("log.csv", cells), owner={"columns": order})
    paths = {f"/joint_states/{joint}/position": PAIR.angles[:, k] for k, joint in enumerate(JOINTS)}
    yield Logged(
        "PlotJuggler",
        table({"__time": START + PAIR.stamps, **paths}),
        owner=as_unit(list(paths), "rad", __time="time [s]"),
    )
    seconds = {
        "/joint_states/header/stamp/sec": ns // 10**9,
        "/joint_states/header/stamp/nanosec": ns % 10**9,
    }
    yield Logged(
        "PlotJuggler with stamps",
        table({"__time": START + PAIR.stamps, **seconds, **paths}),
        owner=as_unit(list(paths), "rad"),
    )
    index = np.argsort(np.concatenate([PAIR.stamps, PAIR.stamps + 0.01]), kind="stable")
    times = np.concatenate([PAIR.stamps, PAIR.stamps + 0.01])[index]
    nothing = np.full(len(PAIR.stamps), np.nan)
    left = np.concatenate([PAIR.angles[:, 0], nothing])[index]
    right = np.concatenate([nothing, PAIR.angles[:, 1]])[index]
    sparse = {"time [s]": times, "left [rad]": left, "right [rad]": right}
    yield Logged("a wheel in each row", table(sparse), says=("forward fill",))
    slow = PAIR.angles.copy()
    slow[np.arange(len(slow)) % 4 != 0, 1] = np.nan
    yield Logged(
        "one wheel four times rarer", table({"time [s]": PAIR.stamps, **wheels(PAIR, slow, "{0} [rad]")})
    )
    held = PAIR.angles.copy()
    held[:, 1] = held[np.arange(len(held)) // 2 * 2, 1]
    yield Logged("last reading held", table({"time [s]": PAIR.stamps, **wheels(PAIR, held, "{0} [rad]")}))
    long: dict[str, list[Any]] = {"elapsed time": [], "topic": [], "value": []}
    for t, pair in zip(PAIR.stamps, PAIR.angles, strict=True):
        for joint, angle in zip(JOINTS, pair, strict=True):
            for column, value in zip(long.values(), (t, joint, angle), strict=True):
                column.append(value)
    yield Logged("Foxglove, one series below the other", table(long), says=("column",))
    odom = {"time": PAIR.stamps, "pose.x": PAIR.angles[:, 0], "twist.linear.x": PAIR.rates[:, 0]}
    yield Logged("odometry without wheels", table(odom), knowable=False)
    stamps = {"stamp.sec": ns // 10**9, "stamp.nanosec": ns % 10**9}
    yield Logged(
        "stamp.sec and stamp.nanosec, deg/s",
        table({**stamps, **wheels(PAIR, np.degrees(PAIR.rates), "{0}_deg_s")}),
    )
    yield Logged(
        "no header, nanoseconds, counts",
        table({f"{k}": c for k, c in enumerate([ns, *PAIR.counts.T])}, name="log.csv"),
        knowable=False,
    )


def wide() -> Iterator[Logged]:
    """Many columns, truth values, words, two rovers."""
    random = np.random.default_rng(3)
    other = {f"sensor_{k}": np.round(random.normal(size=len(PAIR.stamps)), 3) for k in range(200)}
    mine = wheels(PAIR, PAIR.angles, "{0}_wheel_joint/position")
    yield Logged("200 columns", table({"time": PAIR.stamps, **other, **mine}))
    flags = {
        "estop": np.where(PAIR.stamps > 60, "True", "False"),
        "state": _const("DRIVE"),
        "mode": _const(""),
    }
    yield Logged(
        "truth values and words",
        table({"time": PAIR.stamps, **flags, **wheels(PAIR, PAIR.angles, "{0} [rad]")}),
    )
    temperature = wheels(PAIR, 40.0 + PAIR.rates, "{0}_temperature")
    current = wheels(PAIR, PAIR.rates, "{0}_current")
    yield Logged(
        "temperature and current of each wheel",
        table({"time": PAIR.stamps, **temperature, **current, **wheels(PAIR, PAIR.counts, "{0}_encoder")}),
        owner={"COUNTS": COUNTS},
    )
    wanted = wheels(PAIR, PAIR.angles + 0.3 * np.sin(PAIR.stamps)[:, None], "{0}_setpoint_rad")
    yield Logged(
        "setpoints beside", table({"time": PAIR.stamps, **wanted, **wheels(PAIR, PAIR.angles, "{0} [rad]")})
    )
    command = wheels(PAIR, PAIR.rates, "{0}_cmd [rad/s]")
    yield Logged("commands alone", table({"time": PAIR.stamps, **command}), knowable=False)
    both = {**wheels(PAIR, PAIR.angles, "A_{0} [rad]"), **wheels(PAIR, 0.7 * PAIR.angles, "B_{0} [rad]")}
    yield Logged(
        "two rovers beside each other",
        table({"time": PAIR.stamps, **both}),
        owner=as_unit(list(both)[:2], "rad"),
    )
    times = np.repeat(PAIR.stamps, 2) + np.tile([0.0, 0.004], len(PAIR.stamps))
    turned = np.repeat(PAIR.angles, 2, axis=0) * np.tile([1.0, 0.6], len(PAIR.stamps))[:, None]
    label = np.tile(["A", "B"], len(PAIR.stamps))
    yield Logged(
        "two rovers, row by row",
        table({"time": times, "rover": label, **wheels(PAIR, turned, "{0} [rad]")}),
        knowable=False,
    )
    numbers = np.tile([1, 2], len(PAIR.stamps))
    same = {"time": np.repeat(PAIR.stamps, 2), "robot_id": numbers, **wheels(PAIR, turned, "{0} [rad]")}
    yield Logged("two rovers at the same times", table(same), knowable=False)
    m = {f"m{k + 1}": SKID.counts[:, k] for k in range(4)}
    yield Logged(
        "m1 to m4",
        table({"t": SKID.stamps, **m}),
        SKID,
        owner={
            "columns": {h: f"{w} [ticks]" for h, w in zip(m, SKID.rover.wheel_names, strict=True)},
            "COUNTS": COUNTS,
        },
    )
    initials = {
        "FL": SKID.angles[:, 0],
        "FR": SKID.angles[:, 1],
        "RL": SKID.angles[:, 2],
        "RR": SKID.angles[:, 3],
    }
    yield Logged(
        "FL FR RL RR", table({"t": SKID.stamps, **initials}), SKID, owner=as_unit(list(initials), "rad", SKID)
    )
    yield Logged(
        "w_fl_rad and the like",
        table({"t": SKID.stamps, **{f"w_{h.lower()}_rad": c for h, c in initials.items()}}),
        SKID,
        owner=as_unit([f"w_{h.lower()}_rad" for h in initials], "rad", SKID),
    )
    lines = lines_of({"time": SKID.stamps, **wheels(SKID, SKID.angles, "{0} [rad]")})
    yield Logged("two commas at the end", text("log.csv", [f"{line},," for line in lines]), SKID)
    yield Logged(
        "commas at the end of rows alone",
        text("log.csv", [lines[0], *(f"{line},," for line in lines[1:])]),
        SKID,
    )
