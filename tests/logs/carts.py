"""Tables of a cart with two wheels."""

from pathlib import Path

HEADER = "time,left [rad],right [rad]\n"


def write(path: Path, text: str | bytes) -> Path:
    path.write_bytes(text.encode() if isinstance(text, str) else text)
    return path
