"""The readings of a gyroscope: rates about the rover's z from any source."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from six_wheel.kinematics.poses import Floats
from six_wheel.logs.gyroscope.rates import about_z
from six_wheel.logs.headers.columns import Column
from six_wheel.logs.headers.rate_columns import RATES, rate_columns
from six_wheel.logs.headers.renamed import Columns
from six_wheel.logs.headers.time_columns import time_columns
from six_wheel.logs.skip_bad_rows import Sieve, Source, TolerantTable

CHUNK = 65_536  # readings at a time


def readings_of(
    source: Source,
    stated: bool,
    seconds: Callable[[NDArray[Any]], Floats],
    up: Floats,
    keys: Mapping[str, Any],
) -> Iterator[tuple[Floats, Floats]]:
    """Stamps in the clock of the log and rates about the rover's z, from a table or a bag."""
    offset, scale = keys.get("time_offset", 0.0), keys.get("scale", 1.0)
    for batch in Sieve(source.findings, RATES, stated).pass_on(source.batches(CHUNK)):
        rates = about_z(batch.values, up)
        there = np.isfinite(rates)
        yield seconds(batch.time[there]) - offset, scale * rates[there]


def rate_table(path: Path, columns: Columns | None, stamp_unit: str | None = None) -> TolerantTable:
    """The same table again, of which only times and the gyroscope are read."""

    def find(headers: Sequence[str], field_units: Mapping[int, str]) -> dict[str, Column]:
        return time_columns(headers, field_units, stamp_unit) | rate_columns(headers, field_units)

    return TolerantTable(path, find, columns, RATES)
