"""Forms of counters: widths, resets, increments, dead wheels; rows, vehicles and containers."""

import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.feather
import pyarrow.parquet

from tests.logs.forms.drives import CAR, OMNI, PAIR, SIX, TICKS, Course
from tests.logs.forms.form import Form
from tests.logs.forms.text import lines, of

KNOWN = {"wheel_encoders": {"ticks_per_turn": TICKS}}


def table(drive: Course, wheels: Any, kind: str, steering: Any = None, unit: str = "rad") -> str:
    """A table with all wheels and steering angles of a drive."""
    heads = [f"{name} [{kind}]" for name in drive.rover.wheel_names]
    columns = [column.tolist() for column in np.asarray(wheels).T]
    if drive.steering is not None:
        heads += [f"{name}_steering [{unit}]" for name in drive.rover.steered_wheel_names]
        angles = drive.steering if steering is None else steering
        columns += [column.tolist() for column in np.asarray(angles).T]
    return lines(["time", *heads], [drive.stamps.round(3).tolist(), *columns])


def counts() -> Iterator[Form]:
    """Counters of every width, from anywhere, one way and the other."""
    for name, drive in (("pair", PAIR), ("six", SIX), ("omni", OMNI)):
        text = table(drive, drive.counts, "ticks")
        yield of(f"{name}: ticks", "counts", text, drive, options=KNOWN)
        yield of(
            f"{name}: ticks per turn unknown",
            "counts",
            text,
            drive,
            fix=KNOWN,
            says=("ticks_per_turn: COUNTS",),
        )
        for bits in (16, 32):
            start = (1 << bits) - 500
            for signed in (False, True):
                half = (1 << (bits - 1)) if signed else 0
                begin = start // 2 if signed else start
                wrapped = (drive.counts + begin + half) % (1 << bits) - half
                wraps = f"wraps_at: {1 << bits}"
                kind = "signed" if signed else "unsigned"
                fix = {"wheel_encoders": {"ticks_per_turn": TICKS, "wraps_at": 1 << bits}}
                if not signed or bits == 32:
                    wrapped = (
                        (drive.counts + (1 << (bits - 1)) - 300 + half) % (1 << bits) - half
                        if signed
                        else wrapped
                    )
                text = table(drive, wrapped, "ticks")
                yield of(
                    f"{name}: {bits} bit {kind}", "counts", text, drive, options=KNOWN, fix=fix, says=(wraps,)
                )
                if bits == 16:
                    yield of(
                        f"{name}: {bits} bit {kind}, ticks per turn unknown",
                        "counts",
                        text,
                        drive,
                        fix=fix,
                        says=(wraps, "ticks_per_turn: COUNTS"),
                    )
    small = np.rint(PAIR.angles * 64.0 / math.tau).astype(np.int64)
    fix = {"wheel_encoders": {"ticks_per_turn": 64, "wraps_at": 256}}
    yield of(
        "8 bit",
        "counts",
        table(PAIR, small % 256, "ticks"),
        options={"wheel_encoders": {"ticks_per_turn": 64}},
        fix=fix,
        says=("wraps_at: 256",),
    )
    fix = {"wheel_encoders": {"ticks_per_turn": TICKS, "wraps_at": TICKS}}
    yield of(
        "wraps every turn",
        "counts",
        table(PAIR, PAIR.counts % int(TICKS), "ticks"),
        options=KNOWN,
        fix=fix,
        says=("wraps_at: 4096",),
    )
    one = PAIR.counts.copy()
    one[250:, 0] += 1 << 32
    fix = {"wheel_encoders": {"ticks_per_turn": TICKS, "wraps_at": 1 << 32}}
    yield of(
        "one wheel by 2^32",
        "counts",
        table(PAIR, one, "ticks"),
        options=KNOWN,
        fix=fix,
        says=("wraps_at: 4294967296",),
    )
    fresh = PAIR.counts - np.where(np.arange(len(PAIR.stamps))[:, None] >= 250, PAIR.counts[250], 0)
    yield of(
        "set to zero",
        "counts",
        table(PAIR, fresh, "ticks"),
        options=KNOWN,
        fix={"max_speed": 10.0},
        says=("--max-speed 10", "row"),
    )
    steps = np.diff(PAIR.counts, axis=0, prepend=PAIR.counts[:1])
    fix = {"wheel_encoders": {"ticks_per_turn": TICKS, "increments": True}}
    yield of(
        "increments",
        "counts",
        table(PAIR, steps, "ticks"),
        options=KNOWN,
        fix=fix,
        says=("increments: true",),
    )
    yield of("increments, said", "counts", table(PAIR, steps, "ticks"), options=fix)
    many = 20.0 * TICKS
    fine = np.diff(np.rint(PAIR.angles * many / (2.0 * math.pi)).astype(np.int64), axis=0, prepend=0)
    yield of(
        "increments of a fine encoder",
        "counts",
        table(PAIR, fine, "ticks"),
        options={"wheel_encoders": {"ticks_per_turn": many}},
        fix={"increments": True},
        says=("--increments", "increments=True in Python"),
    )
    yield of(
        "totals called increments",
        "counts",
        table(PAIR, PAIR.counts, "ticks"),
        options=fix,
        fix=KNOWN,
        says=("a total",),
    )
    dead = PAIR.counts.copy()
    dead[:, 0] = 0
    yield of(
        "a dead wheel of two", "counts", table(PAIR, dead, "ticks"), options=KNOWN, says=("stands still",)
    )
    wrong = {"wheel_encoders": {"ticks_per_turn": 8.0}}
    yield of(
        "far too few counts a turn",
        "counts",
        table(PAIR, PAIR.counts, "ticks"),
        options=wrong,
        fix=KNOWN,
        says=("counts in a turn",),
    )


def rows() -> Iterator[Form]:
    """Rows twice, in another order, missing."""
    good = lines(
        ["time", "left [rad]", "right [rad]"], [PAIR.stamps.round(3).tolist(), *PAIR.angles.T.tolist()]
    )
    head, *body = good.splitlines()
    cut = [head, *body[:200], *body[280:]]
    swapped = [head, *body[:100], body[101], body[100], *body[102:]]
    twice = [head, *(row for k, row in enumerate(body) for _ in range(1 + (k % 50 == 0)))]
    holes = [
        head,
        *(
            ",".join([row.split(",")[0], "nan", row.split(",")[2]]) if k % 60 == 7 else row
            for k, row in enumerate(body)
        ),
    ]
    words = [head, *("error" if k == 77 else row for k, row in enumerate(body))]
    slow, thin = [head, *body[::20]], PAIR.thinned(20)
    for name, kept in (
        ("a gap", cut),
        ("swapped", swapped),
        ("twice", twice),
        ("NaN", holes),
        ("a word", words),
        ("once a second", slow),
    ):
        yield of(f"rows: {name}", "rows", "\n".join(kept) + "\n", thin if kept is slow else PAIR)
    rates = lines(
        ["time", "left [rad/s]", "right [rad/s]"], [PAIR.stamps.round(3).tolist(), *PAIR.rates.T.tolist()]
    )
    head, *body = rates.splitlines()
    yield of(
        "rows: a gap of 4 s in rates",
        "rows",
        "\n".join([head, *body[:60], *body[140:]]) + "\n",
        says=("without rates",),
    )
    far = np.round(PAIR.angles + 100_000.0, 6)
    yield of("rows: from 100,000 rad on", "rows", table(PAIR, far, "rad"))
    whole = lines(["time", "left [rad]", "right [rad]"], [range(0, 25), *PAIR.angles[::20].T.tolist()])
    yield of("rows: slow, in whole seconds", "rows", whole, thin)


def vehicles() -> Iterator[Form]:
    """Steering in degrees and counts; columns that are missing."""
    for name, drive in (("six", SIX), ("car", CAR)):
        degrees = np.degrees(drive.steering)
        yield of(f"{name}: radians", "vehicles", table(drive, drive.angles, "rad"), drive)
        yield of(
            f"{name}: steering in degrees",
            "vehicles",
            table(drive, drive.angles, "rad", degrees, "deg"),
            drive,
        )
        bare = table(drive, drive.angles, "rad", degrees, "X").replace(" [X]", "_angle")
        meaning = {
            f"{wheel}_steering_angle": f"{wheel}_steering [deg]" for wheel in drive.rover.steered_wheel_names
        }
        first = next(iter(meaning.items()))
        yield of(
            f"{name}: degrees unsaid",
            "vehicles",
            bare,
            drive,
            fix={"columns": meaning},
            says=(f'--column "{first[0]}={first[1]}"',),
        )
        ticks = np.rint(drive.steering * 4096 / math.tau).astype(int)
        known = {"steering_encoders": {"ticks_per_turn": 4096}}
        text = table(drive, drive.angles, "rad", ticks, "ticks")
        yield of(f"{name}: steering in ticks", "vehicles", text, drive, options=known)
        yield of(
            f"{name}: steering in ticks, unsaid",
            "vehicles",
            text,
            drive,
            fix=known,
            says=("steering_encoders: {ticks_per_turn: COUNTS}",),
        )
        absolute = table(drive, drive.angles, "rad", ticks % 4096, "ticks")
        wraps = {"steering_encoders": {"ticks_per_turn": 4096, "wraps_at": 4096}}
        yield of(f"{name}: absolute steering", "vehicles", absolute, drive, options=wraps)
    yield of("omni: rad", "vehicles", table(OMNI, OMNI.angles, "rad"), OMNI)
    part = table(SIX, SIX.angles, "rad").splitlines()
    head = part[0].replace("rear_left [rad]", "battery")
    yield of("six: a wheel without a column", "vehicles", "\n".join([head, *part[1:]]) + "\n", SIX)
    dead = SIX.angles.copy()
    dead[:, 2] = 0.0
    yield of(
        "six: a dead wheel",
        "vehicles",
        table(SIX, dead, "rad"),
        SIX,
        fix={"columns": {"middle_left [rad]": ""}},
        says=("stands still", "middle_left"),
    )


def containers() -> Iterator[Form]:
    """Parquet, Feather and Arrow."""
    plain = {"time": PAIR.stamps, "left [rad]": PAIR.angles[:, 0], "right [rad]": PAIR.angles[:, 1]}

    def form(name: str, made: pa.Table, ending: str, **more: Any) -> Form:
        def write(folder: Path) -> Path:
            path = folder / f"log{ending}"
            if ending == ".parquet":
                pa.parquet.write_table(made, path)
            else:
                pa.feather.write_feather(made, path, compression="uncompressed")
            return path

        return Form(name, "containers", write, PAIR.rover, PAIR.pose, **more)

    for ending in (".parquet", ".feather", ".arrow"):
        yield form(f"{ending}", pa.table(plain), ending)
        stated = {
            "time": ("ms", np.rint(1e3 * PAIR.stamps)),
            "left": ("deg", np.degrees(PAIR.angles[:, 0])),
            "right": ("deg", np.degrees(PAIR.angles[:, 1])),
        }
        fields = [pa.field(name, pa.float64(), metadata={"unit": unit}) for name, (unit, _) in stated.items()]
        made = pa.table([pa.array(values) for _, values in stated.values()], schema=pa.schema(fields))
        yield form(f"{ending}: units in metadata", made, ending)
        dates = pa.array(np.rint(1e6 * PAIR.stamps).astype("datetime64[us]"))
        yield form(f"{ending}: dates", pa.table({**plain, "time": dates}), ending)
        bare = pa.table({**plain, "time": np.rint(1e3 * PAIR.stamps).astype(np.int64)})
        yield form(f"{ending}: bare ms", bare, ending, fix={"stamp_unit": "ms"}, says=("--stamp-unit ms",))
