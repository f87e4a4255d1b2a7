"""Recordings of real robots are read without a doubt, in memory and as tables of every kind."""

import warnings
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("pyarrow")

import pyarrow as pa
import pyarrow.csv
import pyarrow.parquet

import six_wheel as sw
from six_wheel.logs import optiodom, read_log
from tests import optiodom_data

TICKS = 4096.0
TOLD = {"wheel_encoders": sw.Encoder(TICKS)}


def said_of(call: Callable[[], Sequence[str]]) -> list[str]:
    """Warnings and the refusal of a call, and what it returns."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            lines = list(call())
        except ValueError as error:
            lines = [str(error)]
    return lines + [str(each.message) for each in caught]


def doubts(run: Path, folder: Path) -> list[str]:
    """Remarks on a run in memory and in two tables, as totals in radians and as whole counts."""
    rover = optiodom.read_rover(run)
    log = optiodom.read(run).in_radians(rover)
    counts = np.rint(log.wheel_angles * TICKS / (2.0 * np.pi))
    steering = [] if log.steering is None else list(log.steering.T)
    said: list[str] = []
    for unit, wheels, known in (("rad", log.wheel_angles, {}), ("ticks", counts, TOLD)):
        heard = np.isfinite(wheels).any(axis=0)
        heads = ["time", *(f"{name} [{unit}]" for name in np.array(rover.wheel_names)[heard])]
        heads += [f"{name}_steering [rad]" for name in rover.steered_wheel_names]
        columns = [log.stamps, *wheels.T[heard], *steering]
        files = [folder / f"{run.stem}_{unit}{ending}" for ending in (".csv", ".parquet")]
        made = pa.table(dict(zip(heads, columns, strict=True)))
        pa.csv.write_csv(made, files[0])
        pa.parquet.write_table(made, files[1])
        bare = sw.WheelLog(log.stamps, log.steering, wheels, options=known)
        said += said_of(lambda bare=bare: map(str, sw.dead_reckon(rover, bare).poses[:0]))
        for file in files:
            said += said_of(lambda file=file, known=known: read_log(file, rover, **known)[1].warnings)
    return said


@pytest.mark.slow
@optiodom_data.REQUIRED
def test_no_recording_is_doubted(tmp_path: Path) -> None:
    runs = optiodom.runs(optiodom_data.FOLDER)
    assert len(runs) == 45
    said = {run.stem: found for run in runs if (found := doubts(run, tmp_path))}
    assert said == {}
