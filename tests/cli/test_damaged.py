"""Damaged, foreign and missing files: an answer, or one line and exit code 2, whichever command reads them.

Every command with every kind of file that it reads: cut off, with bits and blocks changed, empty, and with
what is in a file of another kind. `SOAK` in the environment makes as many copies of each.
"""

import os
import random
import zlib
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.cli.command_lines import READ, callbacks, line, read
from tests.cli_runs import Run

COPIES = int(os.environ.get("SOAK", "4"))
CASES = [(name, one.name, file) for name in callbacks() for one in read(name) for file in READ[one.name]]
FOREIGN = ("rover.yaml", "map.tif", "log.mcap", "log.parquet", "truth.csv")


def damaged(content: bytes, generator: random.Random) -> bytes:
    """The content with a few places changed, or cut off."""
    changed = bytearray(content)
    for _ in range(generator.randint(1, 3)):
        place = generator.randrange(len(changed) + 1)
        length = generator.choice((1, 1, 4, 64, 1024))
        match generator.choice(("cut", "bit", "bit", "zeros", "noise", "drop", "twice", "number")):
            case "cut":
                del changed[place:]
            case "bit" if place < len(changed):
                changed[place] ^= 1 << generator.randrange(8)
            case "zeros":
                changed[place : place + length] = bytes(min(length, len(changed) - place))
            case "noise":
                changed[place : place + length] = generator.randbytes(length)
            case "drop":
                del changed[place : place + length]
            case "twice":
                changed[place:place] = changed[place : place + length]
            case _:
                changed[place:place] = generator.choice((b"1e999", b"nan", b"-", b"\n", b"\xff\xfe", b"\0"))
    return bytes(changed)


def copies(file: str, content: bytes, seed: str) -> Iterator[bytes]:
    generator = random.Random(zlib.crc32(seed.encode()))
    yield b""
    yield content[:1]
    for other in FOREIGN:
        if other != file:
            yield Path(other).read_bytes()
    for _ in range(COPIES):
        yield damaged(content, generator)


@pytest.mark.parametrize(("name", "argument", "file"), CASES, ids=["-".join(case) for case in CASES])
@pytest.mark.usefixtures("files")
@pytest.mark.filterwarnings("ignore")
def test_an_answer_or_one_line(run: Run, name: str, argument: str, file: str) -> None:
    content = Path(file).read_bytes()
    outputs = sorted(Path().iterdir())
    for number, copy in enumerate(copies(file, content, f"{name} {file}")):
        Path(file).write_bytes(copy)
        code, _, err = run(*line(name, **{argument: file}))
        told = [text for text in err.splitlines() if "warning" not in text]
        assert code in (0, 2), (number, code, err)
        if code == 2 and name == "check":  # every mistake of a file, a line each
            assert all(text.startswith((file, "six-wheel: ")) for text in told), (number, err)
        elif code == 2:
            assert len(told) == 1, (number, err)
            assert told[0].startswith("six-wheel: "), (number, err)
        assert "Traceback" not in err
        assert err.replace("\n", "").isprintable(), (number, err)
        for made in {*Path().iterdir()} - {*outputs}:
            if made.is_file():
                made.unlink()


@pytest.mark.parametrize(("name", "argument", "file"), CASES, ids=["-".join(case) for case in CASES])
@pytest.mark.usefixtures("files")
def test_a_file_that_is_missing_is_told_with_the_one_that_is_near(
    run: Run, name: str, argument: str, file: str
) -> None:
    """Tables of commands, truths, maps, records and robot descriptions were missing without a remedy."""
    path = Path(file)
    given = path.with_name(f"{path.stem.upper()}1{path.suffix}")
    code, _, err = run(*line(name, **{argument: given}))
    assert (code, err.count("\n")) == (2, 1)
    assert str(given) in err
    assert f'did you mean "{file}"?' in err
