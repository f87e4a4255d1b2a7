"""Files of ROS 2 bags: which there are, and what is whole of one that was cut off."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TypeAlias

Topics: TypeAlias = Sequence[str] | Mapping[str, str]
BAGS = (".mcap", ".db3", ".bag")
MCAP, MAGIC, DATA_END, FOOTER = ".mcap", b"\x89MCAP0\r\n", 0x0F, 0x02


def is_bag(path: Path) -> bool:
    """True if a path is read as a bag, by its ending or as a folder."""
    return path.is_dir() or path.suffix.lower() in BAGS


def files_of(path: Path) -> list[Path]:
    """The files of a bag, in order."""
    files = path.iterdir() if path.is_dir() else [path]
    return sorted(file for file in files if file.suffix in (MCAP, ".db3"))


def whole_part(file: Path, folder: Path) -> Path:
    """A copy of the whole records of a MCAP file that was cut off, with the end that it lacks.

    A file is a magic word, records and the magic word again; a record is one byte, its length and its content
    (mcap.dev/spec). The last records are one that ends the data and a footer, here one without an index.
    """
    if file.suffix != MCAP:
        return file
    size, whole = file.stat().st_size, folder / file.name
    with open(file, "rb") as source, open(whole, "wb") as target:
        target.write(source.read(len(MAGIC)))
        while len(head := source.read(9)) == 9:
            length = int.from_bytes(head[1:], "little")
            if head[0] in (DATA_END, FOOTER) or source.tell() + length > size:
                break
            target.write(head)
            while length:
                part = source.read(min(length, 1 << 20))
                target.write(part)
                length -= len(part)
        for kind, length in ((DATA_END, 4), (FOOTER, 20)):
            target.write(bytes([kind]) + length.to_bytes(8, "little") + bytes(length))
        target.write(MAGIC)
    return whole
