"""Files that fuzzing began with, their damaged copies, and what it found: `finds`, by the target's name."""

import random
from pathlib import Path

import pytest

from six_wheel.logs import LogOptions, open_log
from tests.fuzz.readers import READERS, ROVER, read

FINDS = sorted((Path(__file__).parent / "finds").glob("*"))
DAMAGED = 30  # of every file


@pytest.mark.parametrize("target", READERS)
def test_files_to_begin_with_and_damaged_ones(target: str, tmp_path: Path) -> None:
    if target == "bag":
        pytest.importorskip("rosbags")
    generator = random.Random(1)
    for content in READERS[target][2]():
        read(target, content, tmp_path)
        for _ in range(DAMAGED):
            damaged = bytearray(content)
            for _ in range(generator.randint(1, 4)):
                place = generator.randrange(len(damaged) + 1)
                end = min(place + generator.choice((0, 0, 1, 4, 40)), len(damaged))
                damaged[place:end] = generator.choice(
                    (b"", b"\0", b"\xff\xfe", b"-", b"1e999", b"\n", damaged[:50])
                )
            read(target, bytes(damaged), tmp_path)


@pytest.mark.parametrize("target", ["bag", "log"])
def test_logs_to_begin_with_are_read_to_their_ends(target: str, tmp_path: Path) -> None:
    """Those of old lacked units and steering angles: fuzzing never came past the names of their joints."""
    if target == "bag":
        pytest.importorskip("rosbags")
    _, ending, contents = READERS[target]
    for content in contents():
        path = tmp_path / f"file{ending}"
        path.write_bytes(content)
        with open_log(path, ROVER, LogOptions()) as opened:
            assert sum(len(rows.rows) for rows in opened.chunks(16)) >= 3


@pytest.mark.parametrize("find", FINDS, ids=lambda path: path.name)
def test_what_fuzzing_found(find: Path, tmp_path: Path) -> None:
    target = find.name.partition("-")[0]
    if target == "bag":
        pytest.importorskip("rosbags")
    read(target, find.read_bytes(), tmp_path)
