"""Logs of microcontroller boards over a serial line: prints, counters of few bits, pulses, resets."""

from collections.abc import Iterator

import numpy as np

from tests.logs.loggers.logged import (
    BACK,
    COUNTS,
    ONWARD,
    PAIR,
    QUICK,
    SKID,
    Logged,
    as_ticks,
    lines_of,
    table,
    text,
    wheels,
)

KNOWN = {"COUNTS": COUNTS}


def prints() -> Iterator[Logged]:
    """Words, tabs and times as a terminal shows them."""
    ms, counts = PAIR.ms, PAIR.counts
    ticks = wheels(PAIR, counts, "{0}_ticks")
    yield Logged("millis and ticks", table({"millis": ms, **ticks}), owner=KNOWN)
    yield Logged("micros and ticks", table({"micros": 1000 * ms, **ticks}), owner=KNOWN)
    said = [f"Time: {t} L: {left} R: {right}" for t, (left, right) in zip(ms, counts, strict=True)]
    yield Logged("words in every row", text("log.txt", said), says=("columns",), owner={})
    comma = [f"t={t},left={left},right={right}" for t, (left, right) in zip(ms, counts, strict=True)]
    yield Logged("name=value in every cell", text("log.csv", comma), says=("columns",))
    monitor = [
        f"18:{t // 60000:02d}:{t // 1000 % 60:02d}.{t % 1000:03d} -> {left},{right}"
        for t, (left, right) in zip(ms, counts, strict=True)
    ]
    yield Logged("serial monitor with times", text("log.txt", monitor), says=("columns",))
    yield Logged(
        "short names and tabs",
        table({"t_ms": ms, "encL": counts[:, 0], "encR": counts[:, 1]}, "\t", "log.txt"),
        owner=as_ticks(("encL", "encR")),
    )
    boot = ["Booting...", "MPU6050 OK, offsets: 12, -4, 88", "SD card 31.9 GB"]
    yield Logged("boot messages", text("log.csv", [*boot, *lines_of({"time_ms": ms, **ticks})]), owner=KNOWN)
    rows = lines_of({"time_ms": ms, **ticks})
    again = [*rows[:400], rows[0], *rows[400:900], "", rows[0], *rows[900:]]
    yield Logged("header again in the middle", text("log.csv", again), owner=KNOWN)
    noise = [*rows[:300], "E (3121) wifi: disconnected", *rows[300:700], "Guru Meditation", *rows[700:]]
    yield Logged("messages between rows", text("log.csv", noise), owner=KNOWN)
    yield Logged("semicolon at the end", text("log.csv", [f"{row}," for row in rows]), owner=KNOWN)
    spaced = lines_of({"Time (ms)": ms, "Left (ticks)": counts[:, 0], "Right (ticks)": counts[:, 1]}, ", ")
    yield Logged("spaces behind commas", text("log.csv", spaced), owner=KNOWN)
    yield Logged("last row cut", text("log.csv", [*rows[:-1], rows[-1][:3]], end="\n"), owner=KNOWN)
    nulls = [*rows[:500], "\0\0\0", *rows[500:]]
    yield Logged("zero bytes after a loss of power", text("log.csv", nulls), owner=KNOWN)
    mixed = [row.replace(",", ";") if k and k % 2 else row for k, row in enumerate(rows)]
    yield Logged("two separators", text("log.csv", mixed), owner=KNOWN, knowable=False)
    yield Logged("stars around the header", text("log.csv", [f"# {rows[0]}", *rows[1:]]), owner=KNOWN)
    bare = lines_of({"ms": ms, "left": counts[:, 0], "right": counts[:, 1]})[1:]
    named = {"columns": ["time [ms]", "left [ticks]", "right [ticks]"], **KNOWN}
    yield Logged("numbers alone", text("log.txt", bare), owner=named)
    yield Logged("numbers and spaces", text("log.dat", [r.replace(",", "  ") for r in bare]), owner=named)


def counters() -> Iterator[Logged]:
    """Counters of few bits, that wrap either way, restart or lose their sign."""
    ms, counts = PAIR.ms, PAIR.counts
    for name, bits, first in (
        ("8 bit at 100 Hz", 8, 3),
        ("10 bit", 10, 40),
        ("12 bit", 12, 30),
        ("14 bit", 14, 16_300),
        ("16 bit downwards", 16, 5),
        ("24 bit", 24, 12),
        ("32 bit downwards", 32, 7),
    ):
        drive = QUICK if bits == 8 else BACK if "down" in name else PAIR
        there = (drive.counts + (first if drive is BACK else -first)) % (1 << bits)
        columns = {"time_ms": drive.ms, **wheels(drive, there, "{0}_ticks")}
        yield Logged(name, table(columns), drive, owner=KNOWN)
    signed = (counts + 32_000 + 32_768) % 65_536 - 32_768
    yield Logged("16 bit signed", table({"time_ms": ms, **wheels(PAIR, signed, "{0}_enc")}), owner=KNOWN)
    one = counts.copy()
    one[:, 1] = (counts[:, 1] + 65_000) % 65_536
    yield Logged("one of two wraps", table({"time_ms": ms, **wheels(PAIR, one, "{0}_ticks")}), owner=KNOWN)
    magnet = (counts * 4096 // COUNTS + 77) % 4096
    yield Logged(
        "magnetic angle of 12 bit",
        table({"time_ms": ms, **wheels(PAIR, magnet, "{0}_ticks")}),
        owner={"COUNTS": 4096},
    )
    fine = (np.rint(PAIR.angles / (2 * np.pi) * 16384).astype(int) + 9000) % 16384
    owner = as_ticks(("as5048_l", "as5048_r")) | {"COUNTS": 16384}
    yield Logged(
        "magnetic angle of 14 bit, odd names",
        table({"time_ms": ms, "as5048_l": fine[:, 0], "as5048_r": fine[:, 1]}),
        owner=owner,
    )
    gray = magnet ^ (magnet >> 1)
    yield Logged(
        "gray code",
        table({"time_ms": ms, **wheels(PAIR, gray, "{0}_ticks")}),
        owner={"COUNTS": 4096},
        knowable=False,
    )
    reset = counts.copy()
    reset[800:] -= reset[800]
    yield Logged(
        "both set to zero",
        table({"time_ms": ms, **wheels(PAIR, reset, "{0}_ticks")}),
        owner=KNOWN | {"max_speed": 3.0},
    )
    clock = ms.copy()
    clock[800:] -= clock[800]
    yield Logged(
        "board started anew",
        table({"time_ms": clock, **wheels(PAIR, reset, "{0}_ticks")}),
        owner=KNOWN,
        says=("started anew",),
    )
    micros = (np.rint(1e6 * PAIR.stamps).astype(np.int64) + (1 << 32) - 20_000_000) % (1 << 32)
    yield Logged(
        "micros of 32 bit start over",
        table({"micros": micros, **wheels(PAIR, counts, "{0}_ticks")}),
        owner=KNOWN,
        says=("time goes back",),
    )
    short = ms % 65_536
    yield Logged(
        "milliseconds of 16 bit start over",
        table({"time_ms": short, **wheels(PAIR, counts, "{0}_ticks")}),
        owner=KNOWN,
        says=("time",),
    )


def pulses() -> Iterator[Logged]:
    """Pulses without a sign, directions beside them, what was turned in a row, commands."""
    ms, steps = PAIR.ms, PAIR.steps
    signs = wheels(PAIR, np.where(steps < 0, -1, 1), "{0}_dir")
    unsigned = wheels(PAIR, np.abs(steps), "{0}_pulses")
    yield Logged(
        "pulses of a row and direction",
        table({"time_ms": ms, **unsigned, **signs}),
        owner=KNOWN | {"increments": True},
        knowable=False,
    )
    total = wheels(PAIR, np.cumsum(np.abs(steps), axis=0), "{0}_count")
    yield Logged(
        "total of pulses and direction", table({"time_ms": ms, **total, **signs}), owner=KNOWN, knowable=False
    )
    words = {head: np.where(column < 0, "REV", "FWD") for head, column in signs.items()}
    yield Logged("direction in words", table({"time_ms": ms, **total, **words}), owner=KNOWN, knowable=False)
    forward = wheels(ONWARD, np.cumsum(np.abs(ONWARD.steps), axis=0), "{0}_count")
    yield Logged(
        "total of pulses, never backwards", table({"time_ms": ONWARD.ms, **forward}), ONWARD, owner=KNOWN
    )
    rows = wheels(PAIR, steps, "{0}_ticks")
    yield Logged(
        "what was turned in a row", table({"time_ms": ms, **rows}), owner=KNOWN | {"increments": True}
    )
    yield Logged(
        "what was turned in a row, named delta",
        table({"time_ms": ms, **wheels(PAIR, steps, "d_{0}")}),
        owner=as_ticks(("d_left", "d_right")) | {"increments": True},
    )
    keep = np.ones(len(ms), dtype=bool)
    keep[500:540] = False
    lost = {"time_ms": ms[keep], **wheels(PAIR, steps[keep], "{0}_ticks")}
    yield Logged("rows lost of increments", table(lost), owner=KNOWN | {"increments": True}, knowable=False)
    keep = np.random.default_rng(5).random(len(ms)) > 0.03
    lost = {"time_ms": ms[keep], **wheels(PAIR, steps[keep], "{0}_ticks")}
    yield Logged(
        "single rows lost of increments", table(lost), owner=KNOWN | {"increments": True}, knowable=False
    )
    duty = np.rint(PAIR.rates * 30).astype(int)
    yield Logged("PWM", table({"time_ms": ms, **wheels(PAIR, duty, "{0}_pwm")}), knowable=False)
    yield Logged(
        "PWM beside counts",
        table({"time_ms": ms, **wheels(PAIR, duty, "{0}_pwm"), **wheels(PAIR, PAIR.counts, "{0}_ticks")}),
        owner=KNOWN,
    )
    back = PAIR.counts * np.array([1, -1])
    yield Logged(
        "right motor mounted the other way",
        table({"time_ms": ms, **wheels(PAIR, back, "{0}_ticks")}),
        owner=KNOWN,
        knowable=False,
    )
    back = SKID.counts * np.array([1, -1, 1, -1])
    yield Logged(
        "right motors of four the other way",
        table({"time_ms": SKID.ms, **wheels(SKID, back, "{0}_ticks")}),
        SKID,
        owner=KNOWN,
        knowable=False,
    )
    back = SKID.counts * np.array([1, 1, 1, -1])
    yield Logged(
        "one motor of four the other way",
        table({"time_ms": SKID.ms, **wheels(SKID, back, "{0}_ticks")}),
        SKID,
        owner=KNOWN,
        knowable=False,
    )
    stuck = PAIR.counts.copy()
    stuck[600:, 1] = stuck[600, 1]
    yield Logged(
        "a wheel stops counting",
        table({"time_ms": ms, **wheels(PAIR, stuck, "{0}_ticks")}),
        owner=KNOWN,
        knowable=False,
    )
