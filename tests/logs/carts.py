"""Tables of a cart with two wheels."""

from pathlib import Path

import six_wheel as sw

CART = sw.Rover.differential(0.5, 0.1)
HEADER = "time,left [rad],right [rad]\n"


def write(path: Path, text: str | bytes) -> Path:
    path.write_bytes(text.encode() if isinstance(text, str) else text)
    return path
