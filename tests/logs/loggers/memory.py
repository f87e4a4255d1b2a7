"""Frames and arrays as notebooks hold them."""

import math
from collections.abc import Iterator
from typing import Any

import numpy as np
import pandas as pd
import pyarrow as pa

import six_wheel as sw
from tests.logs.loggers.logged import (
    COUNTS,
    PAIR,
    SIX,
    START,
    Drive,
    Logged,
    as_unit,
    dead_reckoned,
    table,
    wheels,
)

TAU = 2.0 * np.pi


def held(name: str, source: Any, **more: Any) -> Logged:
    """A form in memory."""
    return Logged(f"memory: {name}", lambda folder: source, **more)


def frames() -> Iterator[Logged]:
    """Frames as pandas makes them of files."""
    t, angles = PAIR.stamps, PAIR.angles
    plain = {"time": t, "left": angles[:, 0], "right": angles[:, 1]}
    yield held("index column", pd.DataFrame({"Unnamed: 0": np.arange(len(t)), **plain}))
    dated = pd.to_datetime(np.rint(1e9 * (START + t)).astype(np.int64))
    yield held("dates in the index", pd.DataFrame({"left": angles[:, 0], "right": angles[:, 1]}, index=dated))
    zoned = dated.tz_localize("Europe/Berlin")
    yield held("dates with a zone", pd.DataFrame({**plain, "time": zoned}))
    yield held("durations", pd.DataFrame({**plain, "time": pd.to_timedelta(t, unit="s")}))
    yield held(
        "texts for numbers",
        pd.DataFrame({h: [f"{v:.6f}" for v in c] for h, c in plain.items()}),
        says=("numbers",),
    )
    yield held(
        "whole numbers that may be missing",
        pd.DataFrame(
            {
                "time": t,
                "left_ticks": pd.array(PAIR.counts[:, 0], dtype="Int64"),
                "right_ticks": pd.array(PAIR.counts[:, 1], dtype="Int64"),
            }
        ),
        owner={"COUNTS": COUNTS},
    )
    some = pd.DataFrame(
        {
            "time": t,
            "left_ticks": pd.array(PAIR.counts[:, 0], dtype="Int64"),
            "right_ticks": pd.array(PAIR.counts[:, 1], dtype="Int64"),
        }
    )
    some.loc[50:55, "left_ticks"] = pd.NA
    yield held("some whole numbers missing", some, owner={"COUNTS": COUNTS})
    yield held(
        "single precision", pd.DataFrame({h: np.asarray(c, dtype=np.float32) for h, c in plain.items()})
    )
    coarse = {**plain, "time": (START + t).astype(np.float32)}
    yield held("seconds since 1970 of single precision", pd.DataFrame(coarse), knowable=False)
    two = pd.DataFrame(
        np.column_stack([t, angles]),
        columns=pd.MultiIndex.from_tuples([("time", ""), ("left", "position"), ("right", "position")]),
    )
    yield held("two rows of names", two, says=("column",))
    double = pd.DataFrame(
        np.column_stack([t, angles, angles]), columns=["time", "left", "right", "left", "right"]
    )
    yield held("names twice", double, says=("once",))
    yield held(
        "whole counts as floats",
        pd.DataFrame({"time": t, "left": PAIR.counts[:, 0] * 1.0, "right": PAIR.counts[:, 1] * 1.0}),
        owner={"COUNTS": COUNTS},
    )
    yield held("sorted the other way", pd.DataFrame(plain).iloc[::-1], says=("sort the rows",))
    yield held(
        "rows without a number",
        pd.DataFrame(plain).mask(np.random.default_rng(2).random((len(t), 3)) < np.array([0, 0.01, 0.01])),
    )
    yield held(
        "units below the header",
        pd.DataFrame({h: ["s" if h == "time" else "rad", *map(str, c)] for h, c in plain.items()}),
        says=("numbers",),
    )
    yield held(
        "Arrow with dates",
        pa.table({"time": pa.array(dated.to_numpy()), "left": angles[:, 0], "right": angles[:, 1]}),
    )
    yield held(
        "Arrow with units",
        pa.table(
            [t, np.degrees(angles[:, 0]), np.degrees(angles[:, 1])],
            schema=pa.schema(
                [
                    pa.field("time", pa.float64()),
                    pa.field("left", pa.float64(), metadata={"unit": "deg"}),
                    pa.field("right", pa.float64(), metadata={"unit": "deg"}),
                ]
            ),
        ),
    )


def arrays() -> Iterator[Logged]:
    """Dictionaries, lists, masks, matrices."""
    t, angles = PAIR.stamps, PAIR.angles
    plain = {"time": t, "left": angles[:, 0], "right": angles[:, 1]}
    yield held("lists", {h: list(map(float, c)) for h, c in plain.items()})
    records = [dict(zip(plain, map(float, row), strict=True)) for row in zip(*plain.values(), strict=True)]
    yield held("records", records, says=("DataFrame",))
    yield held("matrix with times", np.column_stack([t, angles]), says=("stamps",))
    named = np.rec.fromarrays(list(plain.values()), names=list(plain))
    yield held("record array", named, says=("table",))
    masked = np.ma.masked_array(angles.copy(), mask=np.zeros(angles.shape, dtype=bool))
    masked[300:303, 0] = np.ma.masked
    masked.data[300:303, 0] = 1e20
    yield held("masked array", (None, masked, t), says=("without a mask",))
    yield held("masked columns", {"time": t, "left": masked[:, 0], "right": masked[:, 1]})
    yield held("wheels as rows", (None, angles.T, t), says=("shape",))
    yield held("stamps as a column", (None, angles, t[:, None]), says=("stamps",))
    yield held(
        "dates of NumPy",
        (None, angles, np.datetime64("2026-11-26T00:00:00") + np.rint(1e9 * t).astype("timedelta64[ns]")),
    )
    yield held("rates for angles", (None, PAIR.rates, t), owner={"readings": "speeds"}, knowable=False)
    yield held(
        "rates in names",
        {"time": t, **wheels(PAIR, PAIR.rates, "{0}_speed")},
        owner=as_unit(("left_speed", "right_speed"), "rad/s"),
    )
    yield held("degrees for angles", (None, np.degrees(angles), t), knowable=False)
    yield held(
        "degrees a second in names",
        {"time": t, "left": np.degrees(PAIR.rates[:, 0]), "right": np.degrees(PAIR.rates[:, 1])},
        owner=as_unit(("left", "right"), "deg/s"),
        knowable=False,
    )
    yield held(
        "rpm in names",
        {"time": t, "left": 30 / np.pi * PAIR.rates[:, 0], "right": 30 / np.pi * PAIR.rates[:, 1]},
        owner=as_unit(("left", "right"), "rpm"),
        knowable=False,
    )
    yield held("steering in degrees of six", (np.degrees(SIX.steering), SIX.angles, SIX.stamps), drive=SIX)
    yield held(
        "unsigned counts of 16 bit",
        (None, (PAIR.counts + 65_000).astype(np.uint16), t),
        owner={"COUNTS": COUNTS},
    )
    yield held(
        "counts of 8 bit signed",
        (None, PAIR.counts.astype(np.int16).astype(np.int8), t),
        owner={"COUNTS": COUNTS},
        knowable=False,
    )
    yield held("complex numbers", (None, angles.astype(complex), t), says=("wheel_angles",))
    yield held("objects", {h: np.array(list(map(float, c)), dtype=object) for h, c in plain.items()})
    yield held(
        "None among numbers",
        {**plain, "left": [None if k == 40 else float(v) for k, v in enumerate(angles[:, 0])]},
    )
    yield held("columns of another length", {**plain, "left": angles[:-1, 0]}, says=("rows",))


def units() -> Iterator[Logged]:
    """Turns, degrees and metres without a name of their unit, told by steps of the encoder, a gyroscope or a
    truth."""
    t, turns = PAIR.stamps, PAIR.counts / COUNTS
    rev = as_unit(("left", "right"), "rev")
    yield held("counts as turns", (None, turns, t))
    yield held("counts as degrees", (None, 360.0 * turns, t))
    yield held("counts as turns of six digits", (None, turns.round(6), t))
    yield held("names, counts as turns", {"time": t, **wheels(PAIR, turns, "{0}")}, owner=rev)
    yield held("counts as radians", (None, math.tau * turns, t))
    yield held("counts as radians of six digits", (None, (math.tau * turns).round(6), t))
    track = sw.dead_reckon(PAIR.rover, None, PAIR.angles, t, plausibility=False)
    yaw_rate, truth = track.twists[:, 2], sw.GroundTruth(t, track.poses)
    for name, scale in (("turns", 1.0 / math.tau), ("metres", PAIR.rover.wheels[0].radius)):
        yield held(f"{name} beside a gyroscope", sw.WheelLog(t, None, scale * PAIR.angles, yaw_rate=yaw_rate))
        log = sw.WheelLog(t, None, scale * PAIR.angles, truth)
        yield held(f"{name} beside a truth", log, knowable=False)
    six = sw.dead_reckon(SIX.rover, SIX.steering, SIX.angles, SIX.stamps, plausibility=False).twists[:, 2]
    log = sw.WheelLog(SIX.stamps, SIX.steering, SIX.angles / math.tau, yaw_rate=six)
    yield held("turns of six beside a gyroscope", log, drive=SIX)


def impossible() -> Iterator[tuple[Logged, Drive]]:
    """Forms that are to the last digit the log of another drive in radians or seconds, and that drive."""
    t = PAIR.stamps
    for name, scale in (("turns", 1.0 / math.tau), ("metres", PAIR.rover.wheels[0].radius)):
        slower = dead_reckoned(PAIR, scale * PAIR.angles, t)
        yield held(f"{name} as arrays", (None, slower.angles, t)), slower
        yield held(f"{name} as bare names", {"time": t, **wheels(PAIR, slower.angles, "{0}")}), slower
    rows = np.arange(len(t), dtype=float)
    longer = dead_reckoned(PAIR, PAIR.angles * rows[1] / t[1], rows)
    columns = {"time": rows, **wheels(PAIR, PAIR.rates, "{0} [rad/s]")}
    yield Logged("numbers of rows as times of rates", table(columns)), longer
