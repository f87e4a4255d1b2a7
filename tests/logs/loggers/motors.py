"""Logs of motor controllers: electrical revolutions, tachometers, turns, counts by a gear, rates, ways."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

import six_wheel as sw
from tests.logs.loggers.logged import COUNTS, PAIR, QUICK, SIX, SKID, Logged, as_ticks, as_unit, table, wheels

TAU = 2.0 * np.pi
POLES, GEAR = 7, 15.0


def controllers() -> Iterator[Logged]:
    """VESC, ODrive, Roboclaw, Dynamixel, CANopen."""
    ms = PAIR.ms
    electric = PAIR.rates * 30 / np.pi * POLES * GEAR
    heads = ("left_erpm", "right_erpm")
    yield Logged(
        "VESC erpm", table({"ms_today": ms, **dict(zip(heads, electric.T, strict=True))}, ";"), knowable=False
    )
    tacho = np.rint(PAIR.angles / TAU * 6 * POLES * GEAR).astype(int)
    heads = ("left_tachometer", "right_tachometer")
    owner = as_ticks(heads) | {"COUNTS": 6 * POLES * GEAR}
    owner["columns"]["ms_today"] = "time [ms]"
    columns = {
        "ms_today": ms,
        "left_voltage": np.full(len(ms), 24.1),
        **dict(zip(heads, tacho.T, strict=True)),
    }
    yield Logged("VESC tachometer", table(columns, ";"), owner=owner)
    turns = {f"axis{k}.encoder.pos_estimate": PAIR.angles[:, k] / TAU for k in range(2)}
    yield Logged("ODrive turns", table({"time": PAIR.stamps, **turns}), owner=as_unit(list(turns), "rev"))
    speeds = {f"axis{k}.encoder.vel_estimate": PAIR.rates[:, k] / TAU for k in range(2)}
    yield Logged(
        "ODrive turns a second", table({"time": PAIR.stamps, **speeds}), owner=as_unit(list(speeds), "rev/s")
    )
    wraps = (PAIR.counts - 500) % (1 << 32)
    yield Logged(
        "Roboclaw of 32 bit",
        table({"time": PAIR.stamps, "M1_enc": wraps[:, 0], "M2_enc": wraps[:, 1]}),
        owner=as_ticks(("M1_enc", "M2_enc")),
    )
    qpps = {"M1_qpps": PAIR.rates[:, 0] / TAU * COUNTS, "M2_qpps": PAIR.rates[:, 1] / TAU * COUNTS}
    yield Logged(
        "Roboclaw counts a second",
        table({"time": PAIR.stamps, **qpps}),
        owner=as_unit(list(qpps), "ticks/s") | {"wheel_encoders": None, "COUNTS": COUNTS},
        knowable=False,
    )
    raw = (np.rint(PAIR.angles / TAU * 4096).astype(int) + 2000) % 4096
    ids = {"ID1_present_position": raw[:, 0], "ID2_present_position": raw[:, 1]}
    yield Logged(
        "Dynamixel positions",
        table({"time": PAIR.stamps, **ids}),
        owner=as_ticks(list(ids)) | {"COUNTS": 4096},
    )
    tenth = np.rint(PAIR.rates * 300 / np.pi).astype(int)
    yield Logged(
        "tenths of rpm", table({"time": PAIR.stamps, **wheels(PAIR, tenth, "{0} [0.1 rpm]")}), knowable=False
    )
    steps = np.rint(PAIR.angles / TAU * 3200).astype(int)
    yield Logged(
        "steps of a stepper",
        table({"time": PAIR.stamps, **wheels(PAIR, steps, "{0} [steps]")}),
        owner={"COUNTS": 3200},
    )
    qc = np.rint(PAIR.angles / TAU * 2000).astype(int)
    yield Logged(
        "quad counts", table({"time": PAIR.stamps, **wheels(PAIR, qc, "{0} [qc]")}), owner={"COUNTS": 2000}
    )
    yield Logged(
        "counts called pos",
        table({"time": PAIR.stamps, **wheels(PAIR, qc, "{0}_pos")}),
        owner={"COUNTS": 2000},
    )
    yield Logged(
        "counts called position of a joint",
        table({"time": PAIR.stamps, **wheels(PAIR, qc, "{0}_wheel_joint/position")}),
        owner={"COUNTS": 2000},
    )
    yield Logged(
        "counts a row of decimals",
        table({"time": PAIR.stamps, **wheels(PAIR, qc + 0.0, "{0}")}),
        owner={"columns": {"left": "left [ticks]", "right": "right [ticks]"}, "COUNTS": 2000},
    )
    shaft = np.rint(PAIR.angles * 64 / TAU * 51.4).astype(int)
    yield Logged(
        "counts through a gear",
        table({"time": PAIR.stamps, **wheels(PAIR, shaft, "{0}_enc")}),
        owner={"COUNTS": 64 * 51.4},
    )
    motor = PAIR.rates * 30 / np.pi * GEAR
    yield Logged(
        "rpm of the motor",
        table({"time": PAIR.stamps, **wheels(PAIR, motor, "{0}_motor_rpm")}),
        knowable=False,
    )
    arm = wheels(PAIR, PAIR.angles * GEAR, "{0}_motor [rad]")
    yield Logged("angle of the motor", table({"time": PAIR.stamps, **arm}), knowable=False)


def rates() -> Iterator[Logged]:
    """Rates and ways in the units of drives."""
    rates, radius = PAIR.rates, PAIR.rover.wheels[0].radius
    for unit, scale in (
        ("rpm", 30 / np.pi),
        ("1/min", 30 / np.pi),
        ("U/min", 30 / np.pi),
        ("tr/min", 30 / np.pi),
        ("rev/min", 30 / np.pi),
        ("Hz", 1 / TAU),
        ("turns/s", 1 / TAU),
        ("°/s", 180 / np.pi),
        ("km/h", 3.6 * radius),
        ("m/min", 60 * radius),
        ("mm/s", 1000 * radius),
        ("cm/s", 100 * radius),
        ("mph", radius / 0.44704),
        ("ft/s", radius / 0.3048),
        ("mrad/s", 1000.0),
    ):
        yield Logged(
            f"rates in {unit}",
            table({"time [s]": PAIR.stamps, **wheels(PAIR, scale * rates, f"{{0}} [{unit}]")}),
            says=("must state its unit",),
        )
    for unit, scale in (
        ("°", 180 / np.pi),
        ("Grad", 180 / np.pi),
        ("turn", 1 / TAU),
        ("Umdr", 1 / TAU),
        ("mm", 1000 * radius),
        ("in", radius / 0.0254),
        ("ft", radius / 0.3048),
        ("km", radius / 1000),
    ):
        yield Logged(
            f"ways in {unit}",
            table({"time [s]": PAIR.stamps, **wheels(PAIR, scale * PAIR.angles, f"{{0}} [{unit}]")}),
            says=("must state its unit",),
        )
    whole = np.rint(rates * 30 / np.pi).astype(int)
    rounded = sw.WheelLog(PAIR.stamps, None, whole * np.pi / 30, options={"readings": "speeds"})
    slow = replace(PAIR, pose=sw.dead_reckon(PAIR.rover, rounded).poses[-1])
    yield Logged(
        "whole rpm",
        table(
            {
                "time [s]": QUICK.stamps,
                **wheels(QUICK, np.rint(QUICK.rates * 300 / np.pi).astype(int), "{0}_drpm"),
            }
        ),
        QUICK,
        knowable=False,
    )
    yield Logged(
        "whole rpm of slow wheels",
        table({"time [s]": PAIR.stamps, **wheels(PAIR, whole, "{0}_rpm")}),
        slow,
    )
    yield Logged(
        "rates called by wheel alone",
        table({"time [s]": PAIR.stamps, **wheels(PAIR, rates, "{0}")}),
        owner=as_unit(("left", "right"), "rad/s"),
    )
    yield Logged(
        "speed in mm/s called speed",
        table({"time [s]": PAIR.stamps, **wheels(PAIR, 1000 * radius * rates, "{0}_speed")}),
        owner=as_unit(("left_speed", "right_speed"), "mm/s"),
    )
    yield Logged(
        "speed in m/s called speed",
        table({"time [s]": PAIR.stamps, **wheels(PAIR, radius * rates, "{0}_speed")}),
        owner=as_unit(("left_speed", "right_speed"), "m/s"),
    )
    yield Logged(
        "rpm called vel",
        table({"time [s]": PAIR.stamps, **wheels(PAIR, rates * 30 / np.pi, "vel_{0}")}),
        owner=as_unit(("vel_left", "vel_right"), "rpm"),
    )
    yield Logged(
        "degrees called angle",
        table({"time [s]": PAIR.stamps, **wheels(PAIR, np.degrees(PAIR.angles), "{0}_angle")}),
        owner=as_unit(("left_angle", "right_angle"), "deg"),
    )
    yield Logged(
        "turns called position",
        table({"time [s]": PAIR.stamps, **wheels(PAIR, PAIR.angles / TAU, "{0}_position")}),
        owner=as_unit(("left_position", "right_position"), "rev"),
    )
    yield Logged(
        "degrees from 0 to 360",
        table({"time [s]": PAIR.stamps, **wheels(PAIR, np.degrees(PAIR.angles) % 360, "{0}_deg")}),
    )
    yield Logged(
        "degrees from -180 to 180",
        table(
            {"time [s]": PAIR.stamps, **wheels(PAIR, (np.degrees(PAIR.angles) + 180) % 360 - 180, "{0}_deg")}
        ),
    )
    yield Logged(
        "radians from -pi to pi",
        table({"time [s]": PAIR.stamps, **wheels(PAIR, (PAIR.angles + np.pi) % TAU - np.pi, "{0}_rad")}),
    )
    yield Logged(
        "turns from 0 to 1",
        table({"time [s]": PAIR.stamps, **wheels(PAIR, PAIR.angles / TAU % 1, "{0} [rev]")}),
    )


def vehicles() -> Iterator[Logged]:
    """Six wheels with steering, four with one missing."""
    names, steered = SIX.rover.wheel_names, SIX.rover.steered_wheel_names
    time = {"time": SIX.stamps}
    assert SIX.steering is not None
    joints = wheels(SIX, SIX.angles, "{0}_wheel_joint_position")
    rad = {f"{name}_steering_joint_position": SIX.steering[:, k] for k, name in enumerate(steered)}
    yield Logged("joint names with position", table({**time, **joints, **rad}), SIX)
    deg = {f"{name}_steering": np.degrees(SIX.steering[:, k]) for k, name in enumerate(steered)}
    yield Logged(
        "steering in degrees without a unit",
        table({**time, **wheels(SIX, SIX.angles, "{0} [rad]"), **deg}),
        SIX,
        owner={"columns": {h: f"{h} [deg]" for h in deg}},
    )
    servo = {
        f"{name}_servo_us": np.rint(1500 + SIX.steering[:, k] * 636.6).astype(int)
        for k, name in enumerate(steered)
    }
    yield Logged("servo pulses for steering", table({**time, **joints, **servo}), SIX, knowable=False)
    none = table({**time, **joints})
    yield Logged("no steering at all", none, SIX, knowable=False)
    pot = {
        f"{name}_steering_ticks": np.rint(SIX.steering[:, k] / TAU * 4096).astype(int)
        for k, name in enumerate(steered)
    }
    yield Logged("steering in ticks", table({**time, **joints, **pot}), SIX, owner={"COUNTS": 4096})
    shifted = {f"{name}_steering [rad]": (SIX.steering[:, k] + TAU) % TAU for k, name in enumerate(steered)}
    yield Logged(
        "steering from 0 to 2 pi", table({**time, **wheels(SIX, SIX.angles, "{0} [rad]"), **shifted}), SIX
    )
    osr = {f"{n}_{k}": c for n, c in zip(names, SIX.counts.T, strict=True) for k in ("ticks",)}
    yield Logged(
        "ticks of six, radians of four", table({**time, **osr, **rad}), SIX, owner={"COUNTS": COUNTS}
    )
    three = {h: c for h, c in wheels(SKID, SKID.angles, "{0} [rad]").items() if "rear_right" not in h}
    yield Logged("three wheels of four", table({"time": SKID.stamps, **three}), SKID)
    two = {"left [rad]": SKID.angles[:, 0], "right [rad]": SKID.angles[:, 1]}
    yield Logged(
        "sides of a rover with four wheels",
        table({"time": SKID.stamps, **two}),
        SKID,
        owner={"columns": {"left [rad]": "front_left [rad]", "right [rad]": "front_right [rad]"}},
    )
    dead = SKID.angles.copy()
    dead[:, 2] = 0.0
    yield Logged(
        "a dead wheel of four",
        table({"time": SKID.stamps, **wheels(SKID, dead, "{0} [rad]")}),
        SKID,
        owner={"columns": {"rear_left [rad]": ""}},
    )
    mixed = {
        "front_left [rad]": SKID.angles[:, 0],
        "front_right [deg]": np.degrees(SKID.angles[:, 1]),
        "rear_left [rev]": SKID.angles[:, 2] / TAU,
        "rear_right [rad]": SKID.angles[:, 3],
    }
    yield Logged("a unit for each wheel", table({"time": SKID.stamps, **mixed}), SKID)
    some = {
        "front_left [rad]": SKID.angles[:, 0],
        "front_right [rad]": SKID.angles[:, 1],
        "rear_left [rad/s]": SKID.rates[:, 2],
        "rear_right [rad/s]": SKID.rates[:, 3],
    }
    yield Logged(
        "angles in front, rates behind", table({"time": SKID.stamps, **some}), SKID, says=("one way",)
    )
