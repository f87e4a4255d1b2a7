"""Records with a byte changed are replayed, or refused in one line with their path, wherever the byte is.

Names of settings, rows of a drive's table and numbers of channels were once read as they came: a traceback,
or a sentence of a JSON library without the path.
"""

import random
from collections.abc import Callable
from pathlib import Path

import pytest

pytest.importorskip("mcap", reason='needs pip install "six-wheel[bags]"')
pytest.importorskip("pydantic", reason='needs pip install "six-wheel[cli]"')

from six_wheel.control_loop.replay import replay
from six_wheel.kinematics.errors import FileError
from six_wheel.logs.mcap import Record, RecordWriter
from six_wheel.logs.mcap.frames import text
from six_wheel.simulation.drive.run_file import drive
from tests.control_loop.replay.test_replay import record
from tests.rovers import SIX_WHEELS

COPIES = 40
TEXTS = ["5", "[0, 1, 2, null]", "{", '{"set": {"speed": 1}}', '{"pose": [1]}', '{"reset": "x"}']
HARMS = [lambda content: content[: len(content) // 2], lambda content: b""]
HARMS += [lambda content, told=told: text(told) for told in TEXTS]


def of_a_node(path: Path) -> None:
    record(path, 30)


def of_a_drive(path: Path) -> None:
    commands = path.with_suffix(".csv")
    commands.write_text("time,vx,omega\n0,0.5,0.1\n0.1,0.5,0.1\n0.2,0,0\n")
    drive(SIX_WHEELS, commands, path)


def answered(path: Path) -> bool:
    """True if a record is replayed, False if it is refused with its path."""
    try:
        replay(path)
    except FileError as error:
        told = str(error)
    else:
        return True
    assert all(str(path) in line for line in told.splitlines())
    return False


def copied(path: Path, to: Path, topic: str, harm: Callable[[bytes], bytes]) -> None:
    """A copy of a record, in which the content of the second message of a topic is another one."""
    whole, count = Record(path), 0
    with RecordWriter(to, whole.settings, whole.files) as writer:
        for message in whole.messages():
            count += message.topic == topic
            is_harmed = message.topic == topic and count == 2
            content = harm(message.data) if is_harmed else message.data
            writer.write(writer.topic(message.topic, message.kind), message.time, content, message.stamp)


@pytest.mark.parametrize("make", [of_a_node, of_a_drive])
def test_another_content_is_an_answer_or_a_line(tmp_path: Path, make: Callable[[Path], None]) -> None:
    path, copy = tmp_path / "run.mcap", tmp_path / "copy.mcap"
    make(path)
    topics = Record(path).topics()
    answers = set()
    for topic in topics:
        for harm in HARMS:
            copied(path, copy, topic, harm)
            answers.add(answered(copy))
    assert len(topics) > 3
    assert answers == {True, False}


@pytest.mark.parametrize("make", [of_a_node, of_a_drive])
def test_another_byte_is_an_answer_or_a_line(tmp_path: Path, make: Callable[[Path], None]) -> None:
    path = tmp_path / "run.mcap"
    make(path)
    whole = path.read_bytes()
    generator = random.Random(5)
    printable = [place for place, byte in enumerate(whole) if 32 < byte < 127]
    answers = set()
    for k in range(COPIES):
        changed = bytearray(whole)
        place = generator.choice(printable) if k % 2 else generator.randrange(len(whole))
        changed[place] = generator.choice(b'0123456789"{}[]:,.-eN') if k % 2 else generator.randrange(256)
        path.write_bytes(changed)
        answers.add(answered(path))
    assert answers == {True, False}
