"""Forms in memory: arrays, dictionaries, frames and logs."""

import math
from collections.abc import Iterator
from typing import Any

import numpy as np
import pyarrow as pa

import six_wheel as sw
from tests.logs.forms.drives import PAIR, SIX, TICKS, Course
from tests.logs.forms.form import Form


def of(name: str, *source: Any, drive: Course = PAIR, **more: Any) -> Form:
    """A form of arguments of `dead_reckon`."""
    return Form(name, "Python", lambda folder: source, drive.rover, drive.pose, **more)


def frames(made: dict[str, Any]) -> Iterator[tuple[str, Any]]:
    """One table in every library that is there."""
    yield "dict", made
    yield "arrow", pa.table(made)
    for library in ("pandas", "polars"):
        try:
            yield library, __import__(library).DataFrame(made)
        except ModuleNotFoundError:
            continue


def memory() -> Iterator[Form]:
    """Counts, milliseconds, degrees and wraps, wherever they come from."""
    times, counts = PAIR.stamps, PAIR.counts
    known = {"wheel_encoders": sw.Encoder(TICKS)}
    says = ("wheel_encoders=Encoder(",)
    yield of("arrays", None, PAIR.angles, times)
    yield of("arrays: counts", None, counts, times, fix=known, says=says)
    yield of("arrays: counts said", None, counts, times, options=known)
    yield of(
        "arrays: ms",
        None,
        PAIR.angles,
        np.rint(1e3 * times),
        fix={"stamp_unit": "ms"},
        says=('stamp_unit="ms"',),
    )
    yield of(
        "arrays: ns",
        None,
        PAIR.angles,
        np.rint(1e9 * times).astype(np.int64),
        fix={"stamp_unit": "ns"},
        says=('stamp_unit="ns"',),
    )
    wrapped = (counts + 65_000) % 65_536
    wraps = {"wheel_encoders": sw.Encoder(TICKS, wraps_at=65_536)}
    yield of("arrays: 16 bit", None, wrapped, times, options=known, fix=wraps, says=("wraps_at=65536",))
    yield of(
        "arrays: degrees",
        None,
        np.degrees(PAIR.angles),
        times,
        fix={"wheel_encoders": sw.Encoder(360)},
        says=("ticks_per_turn=360",),
    )
    around = {"wheel_encoders": sw.Encoder(wraps_at=math.tau)}
    yield of(
        "arrays: wraps at 2 pi",
        None,
        PAIR.angles % math.tau,
        times,
        fix=around,
        says=("wraps_at=6.28318531",),
    )
    yield of("arrays: rates", None, PAIR.rates, times, options={"readings": "speeds"})
    steered = {"steering_encoders": sw.Encoder(360)}
    yield of(
        "arrays: steering in degrees",
        3.0 * np.degrees(SIX.steering),
        SIX.angles,
        SIX.stamps,
        drive=SIX,
        says=("steering_encoders=Encoder(ticks_per_turn=360)",),
    )
    yield of(
        "arrays: steering in degrees, said",
        np.degrees(SIX.steering),
        SIX.angles,
        SIX.stamps,
        drive=SIX,
        options=steered,
    )
    log = sw.WheelLog(times, None, counts)
    yield of("WheelLog: counts", log, fix=known, says=says)
    yield of("WheelLog: counts said", sw.WheelLog(times, None, counts, options=known))
    yield of("WheelLog: rad", sw.WheelLog(times, None, PAIR.angles))
    for name, frame in frames({"time": times, "left": PAIR.angles[:, 0], "right": PAIR.angles[:, 1]}):
        yield of(f"{name}: rad", frame)
    for name, frame in frames({"time": times, "left": counts[:, 0], "right": counts[:, 1]}):
        yield of(f"{name}: counts", frame, fix=known, says=says)
    degrees = np.degrees(PAIR.angles)
    for name, frame in frames(
        {"time_ms": 1e3 * times, "left [deg]": degrees[:, 0], "right [deg]": degrees[:, 1]}
    ):
        yield of(f"{name}: units in headers", frame)
    for name, frame in frames({"time": times, "left_ticks": counts[:, 0], "right_ticks": counts[:, 1]}):
        yield of(f"{name}: ticks", frame, options=known)
        yield of(f"{name}: ticks unsaid", frame, fix=known, says=("ticks_per_turn=COUNTS",))
    for name, frame in frames({"time": times, "encL": counts[:, 0], "encR": counts[:, 1]}):
        mapped = {"columns": {"encL": "left [ticks]", "encR": "right [ticks]"}}
        yield of(f"{name}: odd names", frame, options={**known, **mapped})
    for name, frame in frames(
        {"time": np.rint(1e3 * times).astype(int), "left": PAIR.angles[:, 0], "right": PAIR.angles[:, 1]}
    ):
        yield of(f"{name}: ms", frame, fix={"stamp_unit": "ms"}, says=('stamp_unit="ms"',))
