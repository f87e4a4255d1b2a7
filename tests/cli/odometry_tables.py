"""Tables of a drive on the command line."""

from collections.abc import Callable
from pathlib import Path

import numpy as np

from tests.odometry_logs import drive
from tests.rovers import PAIR

Refused = Callable[..., str]
CART = "kind: differential\ntrack_width: 0.4\nwheel_radius: 0.1\n"
WAY = drive(PAIR, n=100)


def table(*, every: int = 1, scale: float = 1.0, unit: str = "rad", shift: float = 0.0) -> str:
    """The log of `WAY`, with the truth in every `every`-th row; cells without it are empty."""
    lines = [f"time,left [{unit}],right [{unit}],x,y,yaw"]
    for k, (stamp, angles, pose) in enumerate(zip(WAY.stamps, WAY.angles, WAY.poses, strict=True)):
        known = ",".join(map(repr, pose.tolist())) if k % every == 0 else ",,"
        left, right = (angles * scale).tolist()
        lines.append(f"{float(stamp) + shift!r},{left!r},{right!r},{known}")
    return "\n".join(lines) + "\n"


def read(path: str) -> dict[str, np.ndarray]:
    if path.endswith(".parquet"):
        from pyarrow import parquet

        found = parquet.read_table(path)
        return {name: found[name].to_numpy() for name in found.column_names}
    names = Path(path).read_text().partition("\n")[0].split(",")
    return dict(zip(names, np.loadtxt(path, delimiter=",", skiprows=1).T, strict=True))
