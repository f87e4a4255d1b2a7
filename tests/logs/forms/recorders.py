"""Forms of recorders that were not read, not explained or wrong in silence when they were first tried."""

from collections.abc import Iterator, Sequence
from datetime import timedelta
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet

from tests.logs.forms.counts import KNOWN, table
from tests.logs.forms.drives import OMNI, PAIR, TICKS
from tests.logs.forms.form import Form
from tests.logs.forms.text import BEGIN, both, lines, of

SINCE = 1_760_000_000


def clocks() -> Iterator[Form]:
    """Names and ways of clocks; clocks that start anew; rows in another order."""
    heads, wheels = both()
    times = PAIR.stamps
    dates = [BEGIN + timedelta(seconds=float(t)) for t in times]

    def form(name: str, header: str, cells: Sequence[Any], **more: Any) -> Form:
        return of(name, "recorders", lines([header, *heads], [cells, *wheels]), **more)

    for header in ("ts", "log_time", "unix_timestamp", "ros_time", "recorded_at", "timeStamp"):
        yield form(f"clock called {header}", header, times.round(3).tolist())
    whole = np.rint(1e3 * times).astype(np.int64)
    yield form("log_time_ms", "log_time_ms", whole.tolist())
    yield form("PM", "time", [f"{d:%m/%d/%Y %I:%M:%S.%f} {d:%p}" for d in dates])
    yield form("day and month with strokes", "time", [f"{d:%d/%m/%Y %H:%M:%S.%f}" for d in dates])
    seconds = (SINCE + times // 1.0).astype(np.int64).tolist()
    fine = np.rint(1e6 * (times % 1.0)).astype(np.int64).tolist()
    yield of(
        "seconds and microseconds", "recorders", lines(["sec", "usec", *heads], [seconds, fine, *wheels])
    )
    yield form("in minutes", "time [min]", (times / 60.0).tolist(), says=('unit of column "time [min]"',))
    anew = {"says": ("a clock that started anew",)}
    yield form("ms of 16 bit", "time_ms", ((whole + 50_000) % 65_536).tolist(), **anew)
    yield form("started anew", "time", np.where(times < 12.0, times + 100.0, times - 12.0).tolist(), **anew)
    good = lines(["time", *heads], [times.round(3).tolist(), *wheels])
    head, *body = good.splitlines()
    yield of("two logs in one file", "recorders", "\n".join([head, *body, *body]) + "\n", **anew)
    sort = {"says": ("not in the order of time", "sort")}
    yield of("from the last row to the first", "recorders", "\n".join([head, *body[::-1]]) + "\n", **sort)
    mixed = [body[k] for k in np.random.default_rng(0).permutation(len(body))]
    yield of("rows shuffled", "recorders", "\n".join([head, *mixed]) + "\n", **sort)
    yield of("line ends of old", "recorders", good.replace("\n", "\r"))
    commas = [[f'"{str(cell).replace(".", ",")}"' for cell in column] for column in (times.round(3), *wheels)]
    yield of("decimal commas in quotes", "recorders", lines(["time", *heads], commas))
    alone = [
        f"{a},{b}," if k % 2 else f"{a},,{c}" for k, (a, b, c) in enumerate(zip(times, *wheels, strict=True))
    ]
    yield of("a wheel in each row", "recorders", "\n".join([head, *alone]) + "\n", says=("hold one wheel?",))


def names() -> Iterator[Form]:
    """Names of wheels, units, and readings of which nobody said the unit."""
    times = PAIR.stamps.round(3).tolist()
    ticks = [column.tolist() for column in PAIR.counts.T]
    for left, right in (("leftTicks", "rightTicks"), ("LeftEncoder", "RightEncoder")):
        yield of(left, "recorders", lines(["time", left, right], [times, *ticks]), options=KNOWN)
    for heads in (("wheel_left [rad]", "wheel_right [rad]"), ("theta_left", "theta_right")):
        yield of(heads[0], "recorders", lines(["time", *heads], [times, *both(heads)[1]]))
    for heads, by in (
        (("left [mrad]", "right [mrad]"), 1e3),
        (("left [gon]", "right [gon]"), 200.0 / np.pi),
        (("left_distance_m", "right_distance_m"), PAIR.rover.wheels[0].radius),
    ):
        yield of(heads[0], "recorders", lines(["time", *heads], [times, *both(heads, by)[1]]))
    heads = ["FL", "FR", "RL", "RR"]
    meanings = dict(zip(heads, (f"{name}_angle" for name in OMNI.rover.wheel_names), strict=True))
    columns = [OMNI.stamps.round(3).tolist(), *OMNI.angles.T.tolist()]
    yield of("initials", "recorders", lines(["time", *heads], columns), OMNI,
             fix={"columns": meanings}, says=('--column "FL=front_left_angle"',))  # fmt: skip
    for heads, by in (
        (("left_speed", "right_speed"), 30.0 / np.pi),
        (("left_velocity", "right_velocity"), 0.1),
    ):
        rates = [(by * column).tolist() for column in PAIR.rates.T]
        yield of(f"{heads[0]} times {by:.3g}", "recorders", lines(["time", *heads], [times, *rates]),
                 says=("says no unit", "rad/s"))  # fmt: skip
    told = {"columns": {"left_position": "left [ticks]", "right_position": "right [ticks]"}}
    sixteen = {**told, "wheel_encoders": {"ticks_per_turn": 16}}
    few = np.rint(PAIR.angles * 16.0 / (2.0 * np.pi)).astype(np.int64)
    heads = ("left_position", "right_position")
    text = lines(["time", *heads], [times, *PAIR.counts.T.tolist()])
    yield of("counts as positions", "recorders", text, fix={**KNOWN, **told}, says=("left [ticks]", "COUNTS"))
    text = lines(["time", *heads], [times, *few.T.tolist()])
    yield of("few counts as positions", "recorders", text,
             fix=sixteen, says=("left [ticks]", "COUNTS"))  # fmt: skip
    rates = [column.tolist() for column in PAIR.rates.T]
    text = lines(
        ["time", "left [rad]", "right [rad]"], [times, *np.diff(PAIR.angles, axis=0, prepend=0.0).T.tolist()]
    )
    yield of("increments in radians", "recorders", text, says=("no wheel turns by more than",))
    slow = lines(["time", "left [rad/s]", "right [rad/s]"], [(100.0 * PAIR.stamps).tolist(), *rates])
    yield of("rates in hundredths of seconds", "recorders", slow, says=("apart", "--stamp-unit"))


def readings() -> Iterator[Form]:
    """Readings that were lost, wheels that stop, and times of Arrow."""
    lost = PAIR.counts.copy()
    lost[120:132] = 0
    settle = {"fix": {"max_speed": 10.0}, "says": ("--max-speed 10", "row")}
    yield of("lost for twelve rows", "recorders", table(PAIR, lost, "ticks"), options=KNOWN, **settle)
    odd = PAIR.counts.copy()
    odd[77, 0], odd[311, 1] = 65_535, -1
    yield of("spikes", "recorders", table(PAIR, odd, "ticks"), options=KNOWN, **settle)
    other = PAIR.counts.copy()
    other[200:] += 300_000
    yield of("set to another value", "recorders", table(PAIR, other, "ticks"), options=KNOWN, **settle)
    stuck = PAIR.angles.copy() * 4.0
    stuck[200:, 0] = stuck[200, 0]
    yield of("a wheel that stops", "recorders", table(PAIR, stuck, "rad"), says=("from some row on",))
    wheels = {"left [rad]": PAIR.angles[:, 0], "right [rad]": PAIR.angles[:, 1]}
    day = np.rint(1e6 * PAIR.stamps).astype(np.int64) + 3_600_000_000
    texts = pa.array([str(each) for each in (day + SINCE * 1_000_000).astype("datetime64[us]")])
    for name, column in (("time64", pa.array(day, pa.time64("us"))), ("texts", texts.dictionary_encode())):

        def write(folder: Any, column: Any = column) -> Any:
            pa.parquet.write_table(pa.table({"time": column, **wheels}), folder / "log.parquet")
            return folder / "log.parquet"

        yield Form(f"Parquet: {name}", "recorders", write, PAIR.rover, PAIR.pose)


def frames() -> Iterator[Form]:
    """Times of frames, and what they hold instead of numbers."""
    wheels = {"left": PAIR.angles[:, 0], "right": PAIR.angles[:, 1]}
    nanoseconds = np.rint(1e9 * PAIR.stamps).astype(np.int64)
    dates = (nanoseconds + SINCE * 1_000_000_000).astype("datetime64[ns]")

    def form(name: str, *source: Any, **more: Any) -> Form:
        return Form(name, "recorders", lambda folder: source, PAIR.rover, PAIR.pose, **more)

    yield form("arrays: dates", None, PAIR.angles, dates)
    yield form("arrays: durations", None, PAIR.angles, nanoseconds.astype("timedelta64[ns]"))
    yield form("dict: durations", {"time": nanoseconds.astype("timedelta64[ns]"), **wheels})
    words = {"time": PAIR.stamps, **wheels, "left": [str(each) for each in PAIR.angles[:, 0]]}
    yield form("dict: texts", words, says=('column "left" must be numbers',))
    degrees = {"time": PAIR.stamps, "left": np.degrees(PAIR.angles[:, 0]) % 360.0}
    degrees["right"] = np.degrees(PAIR.angles[:, 1]) % 360.0
    from six_wheel import Encoder

    fix = {"wheel_encoders": Encoder(360, wraps_at=360)}
    yield form("dict: degrees around", degrees, fix=fix, says=("wraps_at=360, ticks_per_turn=360",))
    mixed = np.random.default_rng(1).permutation(len(dates))
    rows = {name: np.asarray(column)[mixed] for name, column in {"time": PAIR.stamps, **wheels}.items()}
    yield form("dict: shuffled", rows, says=("not in the order of time",))
    far = PAIR.counts + np.where(np.arange(len(dates)) >= 400, 1 << 32, 0)[:, None] * [1, 0]
    told = {"wheel_encoders": Encoder(TICKS)}
    known = {"wheel_encoders": Encoder(TICKS, wraps_at=1 << 32)}
    yield form("arrays: 2^32 on the way back", None, far, PAIR.stamps, options=told, fix=known,
               says=("wraps_at=4294967296",))  # fmt: skip
    try:
        import pandas as pd
    except ModuleNotFoundError:
        return
    yield form("pandas: index of dates", pd.DataFrame(wheels, index=pd.DatetimeIndex(dates)))
    yield form(
        "pandas: with a zone", pd.DataFrame({"time": pd.DatetimeIndex(dates).tz_localize("UTC"), **wheels})
    )
    both_of = pd.DataFrame(
        np.column_stack([PAIR.stamps, PAIR.angles[:, 0], PAIR.angles]), columns=["t", "left", "left", "right"]
    )
    yield form("pandas: a name twice", both_of, says=('column "left" must be there once',))
