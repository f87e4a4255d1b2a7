"""Layouts of published data sets, names in other languages, containers that are no table."""

import gzip
import json
import zipfile
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np

from tests.logs.loggers.logged import (
    COUNTS,
    PAIR,
    SKID,
    START,
    Logged,
    as_ticks,
    as_unit,
    lines_of,
    table,
    text,
    wheels,
)

RAD = wheels(PAIR, PAIR.angles, "{0} [rad]")
LINES = lines_of({"time": PAIR.stamps, **RAD})


def layouts() -> Iterator[Logged]:
    """As the tools of these data sets write them."""
    t, ns = PAIR.stamps, START * 10**9 + np.rint(1e9 * PAIR.stamps).astype(np.int64)
    bare = [f"{n},{left},{right}" for n, (left, right) in zip(ns, PAIR.counts, strict=True)]
    yield Logged(
        "KAIST encoder.csv",
        text("encoder.csv", bare),
        owner={"columns": ["time [ns]", "left [ticks]", "right [ticks]"], "COUNTS": COUNTS},
    )
    nclt = [
        f"{n // 1000}, {left:.6f}, {right:.6f}"
        for n, (left, right) in zip(ns, PAIR.rates * PAIR.rover.wheels[0].radius, strict=True)
    ]
    yield Logged(
        "NCLT wheels.csv",
        text("wheels.csv", nclt),
        owner={"columns": ["time [us]", "left [m/s]", "right [m/s]"]},
    )
    raw = {
        "Timestamp [seconds.microseconds]": [f"{START + x:.6f}" for x in t],
        "Rolling Counter [signed 16bit integer]": np.arange(len(t)) % 32_768,
        "TicksRight [ticks]": PAIR.counts[:, 1],
        "TicksLeft [ticks]": PAIR.counts[:, 0],
        "X [m]": t,
        "Y [m]": t,
        "Theta [rad]": t,
    }
    owner = {
        "columns": {
            "Timestamp [seconds.microseconds]": "time [s]",
            "TicksLeft [ticks]": "left [ticks]",
            "TicksRight [ticks]": "right [ticks]",
        },
        "COUNTS": COUNTS,
    }
    yield Logged("Rawseeds odometry", table(raw), owner=owner)
    euroc = ["#timestamp [ns],left_encoder [ticks],right_encoder [ticks]", *bare]
    yield Logged("EuRoC names", text("data.csv", euroc), owner={"COUNTS": COUNTS})
    tum = [
        "# timestamp left right",
        *(f"{START + x:.4f} {left:.5f} {right:.5f}" for x, (left, right) in zip(t, PAIR.angles, strict=True)),
    ]
    yield Logged("TUM names", text("wheels.txt", tum), owner=as_unit(("left", "right"), "rad"))
    mrclam = [
        "# UTIAS",
        "# Time [s]    forward velocity [m/s]    angular velocity[rad/s]",
        *(f"{x:.3f} {v:.3f} {w:.3f}" for x, (v, w) in zip(START + t, PAIR.rates, strict=True)),
    ]
    yield Logged("UTIAS odometry", text("Robot1_Odometry.dat", mrclam), knowable=False)
    carmen = [
        f"ODOM {a:.4f} {b:.4f} 0.1 0.2 0.0 0.0 {START + x:.3f} host {x:.3f}"
        for x, (a, b) in zip(t, PAIR.angles, strict=True)
    ]
    yield Logged("CARMEN", text("run.log", carmen), knowable=False)
    android = [f"{n},{a:.5f},{b:.5f},9.81" for n, (a, b) in zip(ns, PAIR.rates, strict=True)]
    yield Logged(
        "accelerometer of a telephone", text("Accelerometer.csv", ["time,z,y,x", *android]), knowable=False
    )
    px4 = {
        "timestamp": ns // 1000 % 10**10,
        "wheel_angle[0]": PAIR.angles[:, 0],
        "wheel_angle[1]": PAIR.angles[:, 1],
    }
    yield Logged(
        "PX4 ulog as CSV",
        table(px4),
        owner={**as_unit(("wheel_angle[0]", "wheel_angle[1]"), "rad"), "stamp_unit": "us"},
    )
    ardu = {
        "TimeUS": np.rint(1e6 * t).astype(np.int64),
        "RPM1": PAIR.rates[:, 0] * 30 / np.pi,
        "RPM2": PAIR.rates[:, 1] * 30 / np.pi,
    }
    yield Logged("ArduPilot RPM", table(ardu), owner=as_unit(("RPM1", "RPM2"), "rpm", TimeUS="time [us]"))
    wenc = {
        "TimeUS": np.rint(1e6 * t).astype(np.int64),
        "Dist0": PAIR.angles[:, 0] * 0.09,
        "Qual0": np.full(len(t), 90),
        "Dist1": PAIR.angles[:, 1] * 0.09,
        "Qual1": np.full(len(t), 90),
    }
    yield Logged("ArduPilot WENC", table(wenc), owner=as_unit(("Dist0", "Dist1"), "m", TimeUS="time [us]"))


def languages() -> Iterator[Logged]:
    """Names of wheels and times in other languages, initials, sides."""
    for name, heads in {
        "German": ("Zeit [s]", "Rad links [rad]", "Rad rechts [rad]"),
        "Spanish": ("tiempo [s]", "izquierda [rad]", "derecha [rad]"),
        "French": ("temps [s]", "gauche [rad]", "droite [rad]"),
        "Italian": ("tempo [s]", "ruota_sinistra [rad]", "ruota_destra [rad]"),
        "Chinese": ("时间 [s]", "左轮 [rad]", "右轮 [rad]"),
        "Russian": ("время [s]", "левое [rad]", "правое [rad]"),
        "letters": ("time", "L [rad]", "R [rad]"),
        "camel case": ("time", "leftWheelAngle [rad]", "rightWheelAngle [rad]"),
        "numbers": ("time", "wheel_1 [rad]", "wheel_2 [rad]"),
        "motors": ("time", "motorA [rad]", "motorB [rad]"),
        "names of PLC": ("time", "DB12.DBD4 [rad]", "DB12.DBD8 [rad]"),
        "left and right with lf": ("time", "lf [rad]", "rt [rad]"),
        "swapped order": ("time", "right [rad]", "left [rad]"),
    }.items():
        angles = PAIR.angles[:, ::-1] if name == "swapped order" else PAIR.angles
        owner = {} if name == "swapped order" else as_unit(heads[1:], "rad", **{heads[0]: "time [s]"})
        yield Logged(
            f"names: {name}", table(dict(zip(heads, [PAIR.stamps, *angles.T], strict=True)), ";"), owner=owner
        )
    vl = {"VL": SKID.counts[:, 0], "VR": SKID.counts[:, 1], "HL": SKID.counts[:, 2], "HR": SKID.counts[:, 3]}
    yield Logged(
        "names: VL VR HL HR",
        table({"Zeit": SKID.stamps, **vl}, ";"),
        SKID,
        owner={"columns": {"Zeit": "time [s]", **as_ticks(list(vl), SKID)["columns"]}, "COUNTS": COUNTS},
    )
    yield Logged(
        "names: capital letters",
        table({"TIME": PAIR.stamps, "LEFT_RAD": PAIR.angles[:, 0], "RIGHT_RAD": PAIR.angles[:, 1]}),
    )


def _binary(name: str, made: Callable[[], bytes]) -> Callable[[Path], Path]:
    def write(folder: Path) -> Path:
        (folder / name).write_bytes(made())
        return folder / name

    return write


def _xlsx() -> bytes:
    import io

    cells = "".join(f"<row><c><v>{t}</v></c></row>" for t in range(50))
    sheet = f'<worksheet xmlns="http://schemas.openxmlformats.org/spreadsheetml/2006/main"><sheetData>{cells}</sheetData></worksheet>'
    with zipfile.ZipFile(held := io.BytesIO(), "w") as archive:
        archive.writestr("xl/worksheets/sheet1.xml", sheet)
        archive.writestr("[Content_Types].xml", "<Types/>")
    return held.getvalue()


def _zip() -> bytes:
    import io

    with zipfile.ZipFile(held := io.BytesIO(), "w") as archive:
        archive.writestr("log.csv", "\n".join(LINES) + "\n")
    return held.getvalue()


def containers() -> Iterator[Logged]:
    """Files that are no tables, or not the ones that their endings say."""
    import bz2
    import lzma

    body = ("\n".join(LINES) + "\n").encode()
    yield Logged("csv.gz", _binary("log.csv.gz", lambda: gzip.compress(body)))
    yield Logged("csv.bz2", _binary("log.csv.bz2", lambda: bz2.compress(body)), says=("must",))
    yield Logged("csv.xz", _binary("log.csv.xz", lambda: lzma.compress(body)), says=("must",))
    yield Logged("zip", _binary("log.zip", _zip), says=("must",))
    yield Logged("xlsx", _binary("log.xlsx", _xlsx), says=("save it as",))
    yield Logged("xlsx called csv", _binary("log.csv", _xlsx), says=("save it as",))
    rows = [
        json.dumps({"time": t, "left": a, "right": b})
        for t, (a, b) in zip(PAIR.stamps, PAIR.angles, strict=True)
    ]
    yield Logged("JSON lines", text("log.jsonl", rows), owner=as_unit(("left", "right"), "rad"))
    yield Logged("JSON", text("log.json", ["[", ",\n".join(rows), "]"]), says=("DataFrame",))
    yield Logged("JSON lines called log", text("log.log", rows), says=(".jsonl",))
    yield Logged(
        "NumPy archive",
        lambda folder: (np.savez(folder / "log.npz", time=PAIR.stamps), folder / "log.npz")[1],
        says=("must",),
    )
    yield Logged(
        "MATLAB file", _binary("log.mat", lambda: b"MATLAB 5.0 MAT-file" + bytes(200)), says=("must",)
    )
    yield Logged("HDF5", _binary("log.h5", lambda: b"\x89HDF\r\n\x1a\n" + bytes(200)), says=("must",))
    yield Logged("no ending", text("log", LINES), says=("must",))
    yield Logged("ending in capitals", text("LOG.CSV", LINES))
    yield Logged("ASC", text("log.asc", LINES), says=("must",))
    yield Logged(
        "web page called csv",
        text(
            "log.csv",
            ["<!DOCTYPE html>", "<html><head><title>404</title></head>", "<body>Not found</body></html>"],
        ),
        knowable=False,
    )
    yield Logged(
        "pointer of Git LFS",
        text("log.csv", ["version https://git-lfs.github.com/spec/v1", "oid sha256:4d7a2146", "size 12345"]),
        knowable=False,
    )
    yield Logged("header alone", text("log.csv", LINES[:1]), knowable=False)
    yield Logged("one row", text("log.csv", LINES[:2]), knowable=False)
    yield Logged("empty file", _binary("log.csv", bytes), knowable=False)
    yield Logged(
        "a picture called csv",
        _binary("log.csv", lambda: b"\x89PNG\r\n\x1a\n" + bytes(range(256)) * 9),
        knowable=False,
    )

    def parquet(folder: Path) -> Path:
        import pyarrow as pa
        from pyarrow import parquet

        parquet.write_table(pa.table({"time": PAIR.stamps, **RAD}), folder / "log.csv")
        return folder / "log.csv"

    yield Logged("Parquet called csv", parquet, says=("Parquet",))
    yield Logged("UTF-16 with tabs", text("log.txt", lines_of({"time": PAIR.stamps, **RAD}, "\t"), "utf-16"))
    yield Logged("UTF-16 without a mark", text("log.csv", LINES, "utf-16-le"))
