"""Forms of text tables: stamps, layout, and units of wheels."""

import gzip
import math
from collections.abc import Callable, Iterator, Sequence
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any

import numpy as np

from tests.logs.forms.drives import PAIR, Course
from tests.logs.forms.form import Form

BEGIN = datetime(2026, 11, 23, 23, 59, 50, tzinfo=UTC)  # midnight passes on the way


def lines(headers: Sequence[str], columns: Sequence[Sequence[Any]], cell: str = ",") -> str:
    """The text of a table."""
    rows = [cell.join(str(each) for each in row) for row in zip(*columns, strict=True)]
    return "\n".join([*([cell.join(headers)] if headers else []), *rows]) + "\n"


def written(text: str | bytes, name: str = "log.csv") -> Callable[[Path], Path]:
    """Writes a file."""

    def write(folder: Path) -> Path:
        path = folder / name
        path.write_bytes(text if isinstance(text, bytes) else text.encode())
        return path

    return write


def of(
    name: str, group: str, text: str | bytes, drive: Course = PAIR, file: str = "log.csv", **more: Any
) -> Form:
    """A form that is one file."""
    return Form(name, group, written(text, file), drive.rover, drive.pose, **more)


def both(
    headers: tuple[str, str] = ("left [rad]", "right [rad]"), scale: float = 1.0
) -> tuple[list[str], list[Any]]:
    """Headers and columns of both wheels."""
    return list(headers), [(scale * column).round(9).tolist() for column in PAIR.angles.T]


def stamps() -> Iterator[Form]:
    """Units, clock times, dates."""
    heads, wheels = both()
    times = PAIR.stamps
    dates = [BEGIN + timedelta(seconds=float(t)) for t in times]

    def form(name: str, header: str, cells: Sequence[Any], **more: Any) -> Form:
        return of(name, "stamps", lines([header, *heads], [cells, *wheels]), **more)

    for symbol, by in (("ms", 1e3), ("us", 1e6), ("ns", 1e9)):
        cells = np.rint(times * by).astype(np.int64).tolist()
        yield form(f"header says {symbol}", f"time_{symbol}", cells)
        yield form(f"bracket says {symbol}", f"t [{symbol}]", cells)
        settle = {"fix": {"stamp_unit": symbol}, "says": (f"--stamp-unit {symbol}",)}
        yield form(f"bare {symbol}", "time", cells, **settle)
        since = (np.rint(times * by) + 1.76e9 * by).astype(np.int64).tolist()
        yield form(f"bare {symbol} since 1970", "timestamp", since, **settle)
    yield form(
        "bare ms with a point",
        "time",
        (times * 1e3 + 0.25).tolist(),
        fix={"stamp_unit": "ms"},
        says=("--stamp-unit ms",),
    )
    yield form("seconds", "time", times.round(3).tolist())
    yield form("seconds since 1970", "stamp", (times + 1.76e9).round(3).tolist())
    yield form("clock", "time", [f"{d:%H:%M:%S}.{d.microsecond // 1000:03d}" for d in dates])
    yield form("minutes and seconds", "time", [f"{int(t // 60)}:{t % 60:06.3f}" for t in times])
    yield form("ISO", "timestamp", [d.isoformat() for d in dates])
    yield form("ISO, Z", "timestamp", [f"{d:%Y-%m-%dT%H:%M:%S.%f}Z" for d in dates])
    yield form("date and time", "datetime", [f"{d:%Y-%m-%d %H:%M:%S.%f}" for d in dates])
    yield form("German date", "time", [f"{d:%d.%m.%Y %H:%M:%S.%f}" for d in dates])
    yield form("underscores", "time", [f"{d:%Y_%m_%d_%H_%M_%S}_{d.microsecond // 1000:03d}" for d in dates])
    whole = [int(t) + 1_760_000_000 for t in times]
    fine = [round((t % 1.0) * 1e9) for t in times]
    for a, b in (
        ("header.stamp.sec", "header.stamp.nanosec"),
        ("stamp_secs", "stamp_nsecs"),
        ("sec", "nanosec"),
    ):
        yield of(f"{a} and {b}", "stamps", lines([a, b, *heads], [whole, fine, *wheels]))
    yield form("with its unit in the cell", "time", [f"{1e3 * t:.0f} ms" for t in times])
    yield of("date in a column of its own", "stamps", lines(
        ["date", "time", *heads],
        [[f"{d:%Y-%m-%d}" for d in dates], [f"{d:%H:%M:%S.%f}" for d in dates], *wheels],
    ))  # fmt: skip
    yield form("no time at all", "speed", times.tolist(), says=("no column for time",))


def layout() -> Iterator[Form]:
    """Separators, commas, marks, comments, header or none."""
    heads, wheels = both()
    headers, columns = ["time", *heads], [PAIR.stamps.round(3).tolist(), *wheels]
    plain = lines(headers, columns)
    for name, cell in (("semicolon", ";"), ("tab", "\t"), ("bar", "|"), ("spaces", "   ")):
        yield of(name, "layout", lines(headers, columns, cell))
    comma = lines(headers, columns, ";").replace(".", ",")
    yield of("decimal comma", "layout", comma)
    yield of("decimal comma and tab", "layout", lines(headers, columns, "\t").replace(".", ","))
    yield of("byte order mark", "layout", "\ufeff".encode() + plain.encode())
    for encoding in ("utf-16", "utf-16-le", "utf-16-be"):
        yield of(encoding, "layout", plain.encode(encoding))
    degrees = lines(["time", "left [°]", "right [°]"], [columns[0], *both(scale=math.degrees(1.0))[1]])
    yield of("Latin-1", "layout", degrees.encode("cp1252"))
    yield of("lines of Windows", "layout", plain.replace("\n", "\r\n"))
    yield of("comments above", "layout", f"# robot 3\n# 2026\n{plain}")
    yield of("one comment above", "layout", f"# robot 3, sand\n{plain}")
    yield of("header in a comment", "layout", f"# {plain}")
    yield of("words above", "layout", f"Robot: three\nDate: 2026\n\n{plain}")
    yield of("Excel names the separator", "layout", "sep=;\n" + lines(headers, columns, ";"))
    units = "s,rad,rad\n"
    bare = ["time", "left", "right"]
    head, _, rows = lines(bare, columns).partition("\n")
    yield of("units below", "layout", f"{head}\n{units}{rows}")
    yield of("units below in brackets", "layout", f"{head}\n[s],[rad],[rad]\n{rows}")
    yield of(
        "quoted headers",
        "layout",
        plain.replace("time,left [rad],right [rad]", '"time","left [rad]","right [rad]"'),
    )
    yield of(
        "separator behind the rows",
        "layout",
        "\n".join([headers and ",".join(headers), *(f"{row}," for row in rows.split("\n") if row)]) + "\n",
    )
    yield of("blank lines between", "layout", plain.replace("\n", "\n\n"))
    yield of("index of pandas", "layout", lines(["", *headers], [range(len(columns[0])), *columns]))
    yield of("zipped", "layout", gzip.compress(plain.encode()), file="log.csv.gz")
    yield of(
        "ending .txt",
        "layout",
        lines(headers, columns, " ").replace("left [rad]", "left_rad").replace("right [rad]", "right_rad"),
        file="log.txt",
    )
    yield of("ending .tsv", "layout", lines(headers, columns, "\t"), file="log.tsv")
    named = {"fix": {"columns": ["time", "left [rad]", "right [rad]"]}, "says": ("--columns",)}
    yield of("no header", "layout", rows, **named)
    yield of("no header, spaces", "layout", rows.replace(",", "  "), file="log.dat", **named)


def units() -> Iterator[Form]:
    """Units of angles and rates."""
    times = PAIR.stamps.round(3).tolist()
    radius = PAIR.rover.wheels[0].radius
    angle = [
        ("rad", 1.0),
        ("deg", math.degrees(1.0)),
        ("rev", 0.5 / math.pi),
        ("m", radius),
        ("mm", 1e3 * radius),
        ("cm", 1e2 * radius),
    ]
    for symbol, by in angle:
        for spelled in ("left [{}]", "left_wheel_{}"):
            heads, wheels = both(
                (spelled.format(symbol), spelled.format(symbol).replace("left", "right")), by
            )
            yield of(f"{spelled} {symbol}", "units", lines(["time", *heads], [times, *wheels]))
    rate = [
        ("rad/s", 1.0),
        ("deg/s", math.degrees(1.0)),
        ("rpm", 30.0 / math.pi),
        ("m/s", radius),
        ("rev/s", 0.5 / math.pi),
    ]
    for symbol, by in rate:
        columns = [(by * column).round(9).tolist() for column in PAIR.rates.T]
        heads = [f"left [{symbol}]", f"right [{symbol}]"]
        yield of(f"rates in {symbol}", "units", lines(["time", *heads], [times, *columns]))
    for headers in (("vel_left", "vel_right"), ("left_speed_ms", "right_speed_ms")):
        by = radius if "ms" in headers[0] else 1.0
        columns = [(by * column).round(9).tolist() for column in PAIR.rates.T]
        yield of(headers[0], "units", lines(["time", *headers], [times, *columns]))
    heads, wheels = both(("left_wheel_joint/position", "right_wheel_joint/position"), math.degrees(1.0))
    meaning = {"left_wheel_joint/position": "left [deg]", "right_wheel_joint/position": "right [deg]"}
    fix = {"fix": {"columns": meaning}, "says": ('--column "left_wheel_joint/position=left [deg]"',)}
    yield of("degrees as positions", "units", lines(["time", *heads], [times, *wheels]), **fix)
    for name, around, low in (("2 pi", math.tau, 0.0), ("pi to either side", math.tau, math.pi)):
        columns = [((column + low) % around - low).round(9).tolist() for column in PAIR.angles.T]
        encoders = {"wraps_at": math.tau}
        yield of(
            f"wraps at {name}",
            "units",
            lines(["time", "left [rad]", "right [rad]"], [times, *columns]),
            fix={"wheel_encoders": encoders},
            says=("--wraps-at 6.28318531",),
        )
    columns = [(np.degrees(column) % 360.0).round(7).tolist() for column in PAIR.angles.T]
    yield of(
        "wraps at 360 degrees",
        "units",
        lines(["time", "left [deg]", "right [deg]"], [times, *columns]),
        fix={"wheel_encoders": {"wraps_at": math.tau}},
        says=("--wraps-at 6.28318531",),
    )
    heads, wheels = both(("left", "right"))
    yield of(
        "no unit",
        "units",
        lines(["time", *heads], [times, *wheels]),
        fix={"columns": {"left": "left [rad]", "right": "right [rad]"}},
        says=("must state its unit",),
    )
