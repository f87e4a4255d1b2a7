"""An MCAP file being read: settings, and messages in the order in which they were written.

By order and not by time: time may have jumped back. A file that was cut off is read up to there.
"""

import contextlib
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from six_wheel.kinematics.errors import FileError, one_line
from six_wheel.logs.bags.bag_files import MAGIC
from six_wheel.logs.mcap.writer import FORMAT, SETTINGS, libraries

LATEST = 2**63  # [ns], before which all times are


class RecordError(FileError):
    """A file that is no record of this package."""


class Message(NamedTuple):
    """A message of a record: topic, type, time [ns], its own stamp [ns], and its content in bytes."""

    topic: str
    kind: str
    time: int
    stamp: int
    data: bytes


class Record:
    """A record on disk.

    Attributes
    ----------
    path : Path
    settings : dict of str to str
        Settings of the writer.
    files : dict of str to str
        Texts that go with it, by name.
    count : int
        Messages that there are, or 0 if the file does not say.
    cut_off : bool
        True if the file ends too soon, or is damaged from a message on; known once these have been read.

    Raises
    ------
    RecordError
        If the file is none of this package.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self.settings: dict[str, str] = {}
        self.files: dict[str, str] = {}
        self.cut_off = False
        self.count = 0
        self._mcap, self._store = libraries()
        with path.open("rb") as file:
            if file.read(len(MAGIC)) != MAGIC:
                raise RecordError(f"{path}: the record must be an MCAP file")
        for record in self._records():
            if isinstance(record, self._mcap.records.Metadata) and record.name == SETTINGS:
                self.settings = dict(record.metadata)
            elif isinstance(record, self._mcap.records.Attachment):
                self.files[record.name] = record.data.decode(errors="replace")
            elif isinstance(record, self._mcap.records.Message):
                break
        if not self.settings:
            raise RecordError(f"{path}: the record must be one of drive, odometry, simulate or node")
        if self.settings.get("format") != FORMAT:
            version = self.settings.get("version")
            raise RecordError(f"{path}: the record must have format {FORMAT}, got one of version {version}")

    def messages(self, topics: Sequence[str] | None = None) -> Iterator[Message]:
        """The messages of some topics, or of all, as they were written."""
        records = self._mcap.records
        schemas: dict[int, str] = {}
        channels: dict[int, tuple[str, str]] = {}
        for record in self._records():
            if isinstance(record, records.Message):
                if record.channel_id not in channels or max(record.log_time, record.publish_time) >= LATEST:
                    self.cut_off = True  # what comes from here on is damaged
                    return
                topic, kind = channels[record.channel_id]
                if topics is None or topic in topics:
                    yield Message(topic, kind, record.log_time, record.publish_time, record.data)
            elif isinstance(record, records.Schema):
                schemas[record.id] = record.name
            elif isinstance(record, records.Channel):
                channels[record.id] = record.topic, schemas.get(record.schema_id, "")
            elif isinstance(record, records.DataEnd):
                return

    def topics(self) -> set[str]:
        """The topics that have messages."""
        return {message.topic for message in self.messages()}

    def parsed(self, message: Message) -> Any:
        """The content of a message by the names of its fields.

        Raises
        ------
        RecordError
            If its bytes are damaged.
        """
        with self.reading(f"a message of {message.topic}"):
            return self._store.deserialize_cdr(message.data, message.kind)

    @contextlib.contextmanager
    def reading(self, what: str) -> Iterator[None]:
        """Context in which a part of the record is read: what fails there is damaged.

        Raises
        ------
        RecordError
            With the path, the part and the reason.
        """
        try:
            yield
        except RecordError:
            raise
        except Exception as error:  # of NumPy, JSON, rosbags, missing names, by the place of the damage
            raise RecordError(f"{self.path}: {what} is damaged: {one_line(error)}") from None

    def _records(self) -> Iterator[Any]:
        with self.path.open("rb") as file:
            try:
                yield from self._mcap.stream_reader.StreamReader(file).records
            except Exception:  # every way in which bytes can end too soon
                self.cut_off = True
