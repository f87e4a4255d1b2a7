"""Rovers, limits and files of closed-loop drives."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import six_wheel as sw
from tests.rovers import CART as DIFFERENTIAL
from tests.rovers import LIMITED as ROVER
from tests.rovers import LOW_SWERVE as SWERVE

pa = pytest.importorskip("pyarrow")
csv = pytest.importorskip("pyarrow.csv")
parquet = pytest.importorskip("pyarrow.parquet")
RATE = 50.0
ROVERS = {"six_wheel": ROVER, "swerve": SWERVE, "differential": DIFFERENTIAL}

LIMITS = sw.Limits(
    speed=0.8,
    yaw_rate=0.6,
    acceleration=0.5,
    jerk=2.0,
    angular_acceleration=1.0,
    wheel_speed=6.0,
    wheel_acceleration=12.0,
    steering_rate=1.0,
    steering_acceleration=5.0,
)


def write(path: Path, time: Any, twists: Any, name: str = "time") -> Path:
    columns = dict(zip(("vx", "vy", "omega"), np.asarray(twists, dtype=float).T, strict=True))
    table = pa.table({name: time, **columns})
    csv.write_csv(table, path) if path.suffix == ".csv" else parquet.write_table(table, path)
    return path


def read(path: Path) -> dict[str, np.ndarray]:
    table = csv.read_csv(path) if path.suffix == ".csv" else parquet.read_table(path)
    return {name: table[name].to_numpy(zero_copy_only=False) for name in table.column_names}


def columns(result: dict[str, np.ndarray], prefix: str = "") -> np.ndarray:
    return np.column_stack([result[f"{prefix}{axis}"] for axis in ("vx", "vy", "omega")])


def wild(seed: int, count: int, every: float = 0.1, sideways: bool = False) -> tuple[Any, np.ndarray]:
    """Commands beyond all limits, each held for a while, at uneven times."""
    random = np.random.default_rng(seed)
    twists = np.repeat(random.uniform(-1.2, 1.2, (count // 8 + 1, 3)), 8, axis=0)[:count]
    twists[:, 1] *= sideways
    twists[random.random(count) < 0.05] = 0.0
    return np.cumsum(random.uniform(0.2, 1.8, count) * every), twists
