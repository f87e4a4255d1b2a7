"""Clocks: seconds and microseconds apart, weeks of GPS, steps of NTP, zones, rows twice or out of order."""

from collections.abc import Iterator

import numpy as np

from tests.logs.loggers.logged import PAIR, START, Logged, clock, lines_of, table, text, wheels

RAD = wheels(PAIR, PAIR.angles, "{0} [rad]")
RATES = wheels(PAIR, PAIR.rates, "{0} [rad/s]")


def stamps() -> Iterator[Logged]:
    """Names and units of one or two columns."""
    t, whole = PAIR.stamps, np.rint(1e6 * PAIR.stamps).astype(np.int64)
    for name, columns in {
        "sec and usec": {"sec": START + whole // 10**6, "usec": whole % 10**6},
        "tv_sec and tv_usec": {"tv_sec": START + whole // 10**6, "tv_usec": whole % 10**6},
        "secs and nsecs": {"secs": START + whole // 10**6, "nsecs": whole % 10**6 * 1000},
        "seconds and milliseconds": {"seconds": START + whole // 10**6, "milliseconds": whole // 1000 % 1000},
        "timestamp_s": {"timestamp_s": t},
        "Timestamp(us)": {"Timestamp(us)": whole},
        "utime": {"utime": START * 10**6 + whole},
        "epoch_ms": {"epoch_ms": START * 1000 + whole // 1000},
        "TimeUS": {"TimeUS": whole},
        "time_boot_ms": {"time_boot_ms": whole // 1000},
        "system_time": {"system_time": START + t},
        "recv_time and send_time": {"recv_time": START + t + 0.002, "send_time": START + t},
        "Elapsed (s)": {"Elapsed (s)": t},
        "T[s]": {"T[s]": t},
        "frame and time": {"frame": np.arange(len(t)), "time": t},
        "time and stamp": {"time": t, "stamp": t},
        "time and timestamp of another clock": {"time": t, "timestamp_ns": whole * 1000 + 7},
    }.items():
        owner = {} if len(columns) < 2 else {"columns": {list(columns)[-1]: ""}}
        owner = {} if "sec" in name and len(columns) == 2 else owner
        if len(columns) == 1:
            head = next(iter(columns))
            unit = {"utime": "us", "TimeUS": "us", "time_boot_ms": "ms", "epoch_ms": "ms"}.get(head, "s")
            owner = {"columns": {head: f"time [{unit}]"}}
        yield Logged(f"stamps: {name}", table({**columns, **RAD}), owner=owner)
    for unit, power in (("ms", 3), ("us", 6), ("ns", 9)):
        there = np.rint(10.0**power * t).astype(np.int64)
        yield Logged(f"bare t in {unit}", table({"t": there, **RAD}), owner={"stamp_unit": unit})
        yield Logged(f"bare t in {unit}, rates", table({"t": there, **RATES}), owner={"stamp_unit": unit})
        since = START * 10**power + there
        yield Logged(
            f"bare timestamp in {unit} since 1970",
            table({"timestamp": since, **RATES}),
            owner={"stamp_unit": unit},
        )
    minutes = t / 60.0
    yield Logged("minutes", table({"time [min]": minutes, **RAD}), says=("unit",))
    yield Logged("bare minutes", table({"time": minutes, **RATES}), knowable=False)
    hundredths = {"time": np.rint(100 * t).astype(int), **RATES}
    yield Logged("hundredths of a second", table(hundredths), owner={"stamp_unit": None}, knowable=False)
    coarse = (START + t).astype(np.float32)
    yield Logged(
        "seconds since 1970 of 32 bit",
        table({"timestamp": [f"{x:.1f}" for x in coarse], **RATES}),
        knowable=False,
    )


def satellites() -> Iterator[Logged]:
    """GPS time, NMEA, leap of a week."""
    t = PAIR.stamps
    week = {"gps_week": np.full(len(t), 2443), "gps_tow": 345_600.0 + t}
    yield Logged(
        "week and second of the week", table({**week, **RAD}), owner={"columns": {"gps_tow": "time [s]"}}
    )
    tow = np.round(604_770.0 + t, 3) % 604_800
    yield Logged(
        "second of the week starts over",
        table({"tow_time": tow, **RAD}),
        owner={"columns": {"tow_time": "time [s]"}},
        says=("time goes back",),
    )
    lines = lines_of({"time": t, **RAD})
    nmea = [
        x
        for k, line in enumerate(lines)
        for x in (
            [line, f"$GPRMC,{k:06d},A,5215.1,N,00617.2,E,0.1,84.4,261126,,*5F"] if k % 20 == 10 else [line]
        )
    ]
    yield Logged("sentences of NMEA between", text("log.csv", nmea))
    utc = [f"{clock(x, '%H%M%S.%f', START + 36_570)}" for x in t]
    yield Logged("hhmmss.sss of NMEA", table({"utc": utc, **RAD}))
    yield Logged("hhmmss.sss of NMEA, rates", table({"utc": utc, **RATES}), knowable=False)
    compact = [clock(x, "%Y%m%d%H%M%S%f", START + 36_570) for x in t]
    yield Logged("date and time in one number", table({"timestamp": compact, **RATES}), knowable=False)


def zones() -> Iterator[Logged]:
    """Dates with zones, with clocks that are put back, in many spellings."""
    t = PAIR.stamps
    for name, texts in {
        "with a zone": [clock(x, "%Y-%m-%dT%H:%M:%S.%f") + "+01:00" for x in t],
        "with a zone without a colon": [clock(x, "%Y-%m-%d %H:%M:%S.%f") + "+0100" for x in t],
        "with UTC": [clock(x, "%Y-%m-%d %H:%M:%S.%f") + " UTC" for x in t],
        "American with a half": [
            clock(x, "%m/%d/%Y %I:%M:%S", START + 46_000) + f".{x % 1 * 1000:03.0f} PM" for x in t
        ],
        "with decimal comma": [clock(x, "%Y-%m-%d %H:%M:%S") + f",{x % 1 * 1000:03.0f}" for x in t],
        "year first with strokes": [clock(x, "%Y/%m/%d %H:%M:%S.%f") for x in t],
        "colon before milliseconds": [clock(x, "%H:%M:%S") + f":{x % 1 * 1000:03.0f}" for x in t],
        "words of Python": [f"0:{int(x) // 60:02d}:{x % 60:09.6f}" for x in t],
        "days of pandas": [f"0 days 00:{int(x) // 60:02d}:{x % 60:09.6f}" for x in t],
        "hours and letters": [f"18h{int(x) // 60:02d}m{x % 60:06.3f}s" for x in t],
        "compact": [clock(x, "%Y%m%dT%H%M%S.%f") + "Z" for x in t],
        "two digits of a year": [clock(x, "%d.%m.%y %H:%M:%S.%f") for x in t],
        "ctime": [clock(x, "%a %b %d %H:%M:%S.%f").replace("\n", "") + " 2026" for x in t],
    }.items():
        yield Logged(f"dates: {name}", table({"time": texts, **RAD}, ";"), says=("time must be",))
    seconds = np.where(t < 30, t, t - 3600.0)
    back = [clock(x, "%Y-%m-%d %H:%M:%S.%f", START + 10_770) for x in seconds]
    yield Logged("clock put back by an hour", table({"time": back, **RAD}), says=("time goes back",))


def orders() -> Iterator[Logged]:
    """Steps, drift, rows twice, holes."""
    t = PAIR.stamps
    yield Logged("clock set back by half a second", table({"time": np.where(t < 35, t, t - 0.5), **RAD}))
    yield Logged(
        "clock set back by half a second, rates", table({"time": np.where(t < 35, t, t - 0.5), **RATES})
    )
    yield Logged("clock set on by an hour", table({"time": np.where(t < 35, t, t + 3600.0), **RAD}))
    yield Logged(
        "clock set on by an hour, rates",
        table({"time": np.where(t < 35, t, t + 3600.0), **RATES}),
        knowable=False,
    )
    yield Logged("a clock that is 0.1 % slow", table({"time": 0.999 * t, **RAD}))
    twice = np.sort(np.concatenate([np.arange(len(t)), np.arange(0, len(t), 7)]))
    yield Logged("rows twice", table({"time": t[twice], **{h: c[twice] for h, c in RAD.items()}}))
    jitter = t + np.random.default_rng(1).normal(0, 0.004, len(t))
    yield Logged("stamps that jitter", table({"time": jitter, **RAD}))
    swapped = np.arange(len(t))
    swapped[100:1300:50], swapped[101:1301:50] = swapped[101:1301:50].copy(), swapped[100:1300:50].copy()
    yield Logged("neighbours swapped", table({"time": t[swapped], **{h: c[swapped] for h, c in RAD.items()}}))
    backwards = {"time": t[::-1], **{h: c[::-1] for h, c in RAD.items()}}
    yield Logged("newest first", table(backwards), says=("sort the rows",))
    hole = np.ones(len(t), dtype=bool)
    hole[300:420] = False
    yield Logged(
        "six seconds missing",
        table({"time": t[hole], **{h: c[hole] for h, c in RAD.items()}}),
        knowable=False,
    )
    yield Logged(
        "six seconds missing, rates",
        table({"time": t[hole], **{h: c[hole] for h, c in RATES.items()}}),
        knowable=False,
    )
    files = lines_of({"time": t, **RAD})
    yield Logged("the log twice in a file", text("log.csv", [*files, *files[1:]]), says=("started anew",))
    spike = PAIR.angles.copy()
    spike[200, 0], spike[900, 1] = 1e6, -1e6
    yield Logged(
        "single wrong readings",
        table({"time": t, **wheels(PAIR, spike, "{0} [rad]")}),
        owner={"max_speed": 3.0},
    )
    zero = PAIR.angles.copy()
    zero[200, 0] = zero[900] = 0.0
    yield Logged(
        "single zeros", table({"time": t, **wheels(PAIR, zero, "{0} [rad]")}), owner={"max_speed": 3.0}
    )
    none = {h: np.where(np.arange(len(t)) == 200, -999.0, c) for h, c in RAD.items()}
    yield Logged("-999 for none", table({"time": t, **none}), owner={"max_speed": 3.0})
