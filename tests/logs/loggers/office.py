"""Tables from office programs, MATLAB and LabVIEW: separators, dates, blocks above the header."""

from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from tests.logs.loggers.logged import (
    COUNTS,
    ONWARD,
    PAIR,
    SKID,
    START,
    Drive,
    Logged,
    as_unit,
    clock,
    lines_of,
    table,
    text,
    wheels,
)

KNOWN = {"COUNTS": COUNTS}


def _comma(lines: Sequence[str]) -> list[str]:
    """Lines of semicolons with decimal commas."""
    return [lines[0], *(line.replace(".", ",") for line in lines[1:])]


def _thousands(
    course: Drive, sign: str, start: int = 0, *, decimal: str = ".", delimiter: str = ";"
) -> Callable[[Path], Any]:
    """Counts with a sign between thousands, in quotes where that is the delimiter."""
    rows = [delimiter.join(("time [s]", "left_ticks", "right_ticks"))]
    for t, counts in zip(course.stamps, (course.counts + start).tolist(), strict=True):
        cells = [f"{count:,}".replace(",", sign) for count in counts]
        cells = [f'"{cell}"' if delimiter in cell else cell for cell in cells]
        rows.append(delimiter.join([f"{t:.2f}".replace(".", decimal), *cells]))
    return text("log.csv", rows)


def spreadsheets() -> Iterator[Logged]:
    """Excel and its relatives."""
    rad = wheels(PAIR, PAIR.angles, "{0} [rad]")
    plain = {"time [s]": PAIR.stamps, **rad}
    semi = lines_of(plain, ";")
    yield Logged("sep=; and decimal commas", text("log.csv", ["sep=;", *_comma(semi)]))
    yield Logged("sep=, with carriage returns", text("log.csv", ["sep=,", *lines_of(plain)], end="\r\n"))
    million = 1_000_000
    for name, course, form, more in (
        ("commas", PAIR, _thousands(PAIR, ",", million, delimiter=","), {"says": ("1,0",)}),
        ("points", PAIR, _thousands(PAIR, ".", million, decimal=","), {"says": ("1.0",)}),
        ("points, from 0 on", ONWARD, _thousands(ONWARD, "."), {"says": ("points between thousands",)}),
        ("commas, from 0 on", ONWARD, _thousands(ONWARD, ",", delimiter=","), {"knowable": False}),
        ("apostrophes", PAIR, _thousands(PAIR, "'", million), {"says": ("1'0",)}),
        ("spaces", PAIR, _thousands(PAIR, "\u00a0", million), {"says": ("1\u00a00",)}),
    ):
        yield Logged(f"thousands with {name}", form, course, owner=KNOWN, **more)
    days = 46_352.0 + (64_800.0 + PAIR.stamps) / 86_400.0
    serial = [
        f"{day:.10f},{left:.6f},{right:.6f}" for day, (left, right) in zip(days, PAIR.angles, strict=True)
    ]
    yield Logged(
        "day fractions", text("log.csv", ["time,left [rad],right [rad]", *serial]), owner={"stamp_unit": "d"}
    )
    yield Logged(
        "day fractions named Date",
        text("log.csv", ["Date,left [rad],right [rad]", *serial]),
        owner={"columns": {"Date": "time"}, "stamp_unit": "d"},
    )
    made = {
        "Date": [clock(t, "%d.%m.%Y") for t in PAIR.stamps],
        "Time": [clock(t) for t in PAIR.stamps],
        **rad,
    }
    yield Logged("date and time in two columns", table(made))
    night = {
        "Date": [clock(t, "%Y-%m-%d", START - 30) for t in PAIR.stamps],
        "Time": [clock(t, start=START - 30) for t in PAIR.stamps],
        **rad,
    }
    yield Logged("two columns across midnight", table(night))
    half = {
        "Time": [
            clock(t, "%I:%M:%S.", START + 43_170) + f"{t % 1 * 1000:03.0f}" + clock(t, " %p", START + 43_170)
            for t in PAIR.stamps
        ],
        **rad,
    }
    yield Logged("AM and PM across noon", table(half))
    blunt = {
        "Time": [clock(t, "%I:%M:%S", START + 43_170) + "." + f"{t % 1 * 1000:03.0f}" for t in PAIR.stamps],
        **rad,
    }
    yield Logged(
        "twelve hours without a half, across one o'clock",
        table(
            {
                "Time": [
                    clock(t, "%I:%M:%S", START + 46_770) + f".{t % 1 * 1000:03.0f}" for t in PAIR.stamps
                ],
                **rad,
            }
        ),
        knowable=False,
    )
    yield Logged("twelve hours without a half, across noon", table(blunt))
    whole = {"Time": [clock(t, "%H:%M:%S") for t in PAIR.stamps], **rad}
    yield Logged("fractions of seconds lost", table(whole))
    lost = {"Time": [clock(t, "%H:%M:%S") for t in PAIR.stamps], **wheels(PAIR, PAIR.rates, "{0} [rad/s]")}
    yield Logged("fractions of seconds lost, rates", table(lost), knowable=False)
    bad = lines_of(plain)
    bad[300] = "15.0,#DIV/0!,#NAME?"
    bad[301] = "15.05,#N/A,#N/A"
    yield Logged("errors in cells", text("log.csv", bad))
    yield Logged("title rows", text("log.csv", ["Fahrt 3;;", "Bediener: M. Weber;;", ";;", *_comma(semi)]))
    yield Logged(
        "sums below", text("log.csv", [*lines_of(plain), "", f"mean,{PAIR.angles[:, 0].mean()},", "max,,"])
    )
    quoted = [";".join(f'"{cell}"' for cell in line.split(";")) for line in _comma(semi)]
    yield Logged("quotes around everything", text("log.csv", quoted))
    minus = [line.replace("-", "\u2212") for line in lines_of(plain)]
    yield Logged("minus signs of a word processor", text("log.csv", minus), knowable=True)
    behind = lines_of(
        {
            "time [s]": PAIR.stamps,
            **{
                h: [f"{abs(v)}-" if v < 0 else str(v) for v in c]
                for h, c in wheels(PAIR, PAIR.steps, "{0}_ticks").items()
            },
        }
    )
    yield Logged(
        "minus behind the number", text("log.csv", behind), owner=KNOWN | {"increments": True}, knowable=False
    )
    empty = lines_of(plain)
    yield Logged("many empty columns", text("log.csv", [line + "," * 6 for line in empty]))
    yield Logged("empty rows between", text("log.csv", [line for row in empty for line in (row, ",,")]))
    yield Logged(
        "degree signs of Windows",
        table(
            {"time [s]": PAIR.stamps, **wheels(PAIR, np.degrees(PAIR.rates), "{0} [°/s]")}, encoding="cp1252"
        ),
    )
    units = [
        *lines_of(
            {
                "time": PAIR.stamps,
                "left": PAIR.rates[:, 0] * 30 / np.pi,
                "right": PAIR.rates[:, 1] * 30 / np.pi,
            },
            ";",
        )
    ]
    yield Logged("U/min below the header", text("log.csv", [units[0], "s;U/min;U/min", *units[1:]]))
    yield Logged(
        "units below that nobody knows",
        text("log.csv", [units[0], "s;Umdr.;Umdr.", *units[1:]]),
        knowable=False,
    )
    cut = {"time [ms]": [f"{1000 * (START + t):.4E}".replace("+", "") for t in PAIR.stamps], **rad}
    yield Logged("times cut to 1.76E12", table(cut), knowable=False)


def matlab() -> Iterator[Logged]:
    """Timetables, datenum, ascii matrices."""
    rad = wheels(PAIR, PAIR.angles, "{0}_rad")
    yield Logged("timetable in seconds", table({"Time": [f"{t:g} sec" for t in PAIR.stamps], **rad}))
    yield Logged("timetable of durations", table({"Time": [clock(t) for t in PAIR.stamps], **rad}))
    yield Logged(
        "datetime with month names",
        table({"Time": [clock(t, "%d-%b-%Y %H:%M:%S.%f") for t in PAIR.stamps], **rad}),
    )
    yield Logged(
        "datetime with month first",
        table({"Time": [clock(t, "%b %d, %Y %H:%M:%S.%f").replace(",", "") for t in PAIR.stamps], **rad}),
        says=("time",),
    )
    number = 739_000.5 + PAIR.stamps / 86_400.0
    rows = [
        f"{day:.11f},{left:.6f},{right:.6f}" for day, (left, right) in zip(number, PAIR.angles, strict=True)
    ]
    yield Logged("datenum", text("log.csv", ["time,left_rad,right_rad", *rows]), owner={"stamp_unit": "d"})
    short = {"t": PAIR.stamps, "wL": PAIR.rates[:, 0], "wR": PAIR.rates[:, 1]}
    yield Logged("wL and wR", table(short), owner=as_unit(("wL", "wR"), "rad/s"))
    numbered = {"data_t": PAIR.stamps, "data_q_1": PAIR.angles[:, 0], "data_q_2": PAIR.angles[:, 1]}
    yield Logged(
        "numbers behind names",
        table(numbered),
        owner=as_unit(("data_q_1", "data_q_2"), "rad", data_t="time [s]"),
    )
    matrix = [" ".join(f"{v: .7e}" for v in row) for row in np.column_stack([PAIR.stamps, PAIR.angles])]
    yield Logged(
        "save -ascii", text("log.txt", matrix), owner={"columns": ["time", "left [rad]", "right [rad]"]}
    )
    missing = PAIR.angles.copy()
    missing[100:110, 0] = np.nan
    spelled = {
        "t": PAIR.stamps,
        **{h: ["NaN" if np.isnan(v) else v for v in c] for h, c in wheels(PAIR, missing, "{0}_rad").items()},
    }
    yield Logged("NaN in letters", table(spelled))
    columns = {"t": PAIR.stamps, "left.pos(rad)": PAIR.angles[:, 0], "right.pos(rad)": PAIR.angles[:, 1]}
    yield Logged("points in names", table(columns))
    yield Logged(
        "degrees of SKID in camel case",
        table(
            {
                "Time": SKID.stamps,
                **{
                    f"{n.title().replace('_', '')}Angle_deg": c
                    for n, c in zip(SKID.rover.wheel_names, np.degrees(SKID.angles).T, strict=True)
                },
            }
        ),
        SKID,
    )


def labview() -> Iterator[Logged]:
    """Blocks of names and values above tabs."""
    rad = wheels(PAIR, PAIR.angles, "{0} [rad]")
    block = [
        "LabVIEW Measurement",
        "Writer_Version\t2",
        "Reader_Version\t2",
        "Separator\tTab",
        "Decimal_Separator\t.",
        "***End_of_Header***",
        "",
        "Channels\t2",
        "Samples\t1400\t1400",
        "Date\t2026/11/26\t2026/11/26",
        "Time\t18:00:00\t18:00:00",
        "X_Dimension\tTime\tTime",
        "Delta_X\t0.05\t0.05",
        "***End_of_Header***",
    ]
    rows = lines_of(
        {
            "X_Value": PAIR.stamps,
            "left [rad]": PAIR.angles[:, 0],
            "right [rad]": PAIR.angles[:, 1],
            "Comment": [""] * len(PAIR.stamps),
        },
        "\t",
    )
    yield Logged(
        "measurement file",
        text("log.lvm", [*block, *rows]),
        owner={"columns": {"X_Value": "time [s]"}},
        says=("must",),
    )
    yield Logged(
        "measurement file as text",
        text("log.txt", [*block, *rows]),
        owner={"columns": {"X_Value": "time [s]"}},
    )
    head = ["Versuch\t17", "Datum\t26.11.2026", "Uhrzeit\t18:00", "Rate\t20 Hz", ""]
    yield Logged(
        "values above the header",
        text("log.txt", [*head, *_comma(lines_of({"Zeit [s]": PAIR.stamps, **rad}, "\t"))]),
        owner={"columns": {"Zeit [s]": "time [s]"}},
    )
    since = {"time": 3_877_632_000.0 + PAIR.stamps, **rad}
    yield Logged("seconds since 1904", table(since, "\t", "log.txt"))
    yield Logged(
        "rate above, no times", text("log.txt", ["Rate\t20 Hz", *lines_of(rad, "\t")]), knowable=False
    )
