"""An MCAP file being written: topics with the schemas of ROS 2, settings beside them."""

import io
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from six_wheel._core import __version__
from six_wheel.kinematics.errors import needed
from six_wheel.kinematics.objects.closing import Closing
from six_wheel.logs.tables import RowError

SETTINGS = "six_wheel"  # the name of the metadata
FORMAT = "1"
LATEST = 2**31 * 1_000_000_000  # [ns] that a stamp of ROS can say
CHUNK = 1 << 18  # [bytes] half a second of a loop at 200 Hz: what is lost at most when the power goes


def libraries() -> tuple[Any, Any]:
    """The package `mcap`, which writes and reads records, and the types of messages that `rosbags` has."""
    with needed("six-wheel[bags]", "records need"):
        import mcap.stream_reader
        import mcap.writer
        from rosbags.typesys import Stores, get_typestore
    return mcap, get_typestore(Stores.LATEST)


def record_stamps(
    times: NDArray[Any], rows: NDArray[np.int64], *, nanoseconds: int = 1_000_000_000, origin: int = 0
) -> NDArray[np.int64]:
    """Times as the stamps of messages [ns].

    Raises `RowError` if a time is one that a message cannot have.

    `times` (n,) are in a unit of so many `nanoseconds`, counted from the second `origin`; `rows` (n,) their
    rows in the file they are from.
    """
    stamps = times * nanoseconds + origin * 1_000_000_000
    outside = ~((stamps >= 0) & (stamps < LATEST))
    if outside.any():
        k = int(outside.argmax())
        rule = "a time in a bag must be from 0 to 2^31 seconds"
        raise RowError(int(rows[k]), f"{rule}, got {stamps[k] / 1e9}")
    whole = times * nanoseconds
    if whole.dtype.kind == "f":  # whole ones stay exact: a double has no digit for nanoseconds since 1970
        whole = np.rint(whole)
    exact: NDArray[np.int64] = whole.astype(np.int64) + origin * 1_000_000_000
    return exact


class RecordWriter(Closing):
    """Messages on topics into one MCAP file, readable up to its last chunk whenever the writer ends.

    Parameters
    ----------
    path : Path
        The file; what is there is replaced.
    settings : mapping of str to str
        Settings, as metadata of the file.
    files : mapping of str to str
        Texts that go with it, by name, as attachments.
    """

    def __init__(
        self, path: Path, settings: Mapping[str, str] | None = None, files: Mapping[str, str] | None = None
    ) -> None:
        mcap, self._store = libraries()
        self._stream: io.BufferedWriter = path.open("wb")
        compression = mcap.writer.CompressionType.LZ4
        self._writer = mcap.writer.Writer(self._stream, chunk_size=CHUNK, compression=compression)
        self._writer.start("ros2", f"six_wheel {__version__}")
        self._writer.add_metadata(SETTINGS, {"format": FORMAT, "version": __version__, **(settings or {})})
        for name, content in (files or {}).items():
            self._writer.add_attachment(0, 0, name, "text/yaml", content.encode())
        self._schemas: dict[str, int] = {}
        self._channels: dict[str, int] = {}

    def topic(self, name: str, kind: str) -> int:
        """The number of a topic of messages such as ``nav_msgs/msg/Odometry``; it is made if need be."""
        if name in self._channels:
            return self._channels[name]
        if kind not in self._schemas:
            definition, _ = self._store.generate_msgdef(kind, ros_version=2)
            self._schemas[kind] = self._writer.register_schema(kind, "ros2msg", definition.encode())
        self._channels[name] = self._writer.register_channel(name, "cdr", self._schemas[kind])
        return self._channels[name]

    def write(self, topic: int, time: int, message: bytes, stamp: int | None = None) -> None:
        """Append a message of that time [ns]; `stamp` is what it says itself."""
        self._writer.add_message(topic, time, message, time if stamp is None else stamp)

    def write_object(self, topic: str, kind: str, time: int, build: Any) -> None:
        """Append a message that `build` makes of the types by their names: for those of changing shape."""
        message = self._store.serialize_cdr(build(self._store.types), kind)
        self.write(self.topic(topic, kind), time, bytes(message))

    def close(self) -> None:
        """End the file."""
        if not self._stream.closed:
            try:
                self._writer.finish()
            finally:
                self._stream.close()
