"""Records: MCAP files of what a rover was told and did, with schemas that viewers know.

`frames` lays messages of a fixed shape out in bytes, `writer` puts them into a file, `rover_record` knows
which topics a rover has, `reader` gives them back in the order they were written, and `layouts` are views of
them for Foxglove and Rerun. Writing and reading need rosbags and mcap (the extra ``bags``).
"""

from six_wheel.logs.mcap.reader import Record, RecordError
from six_wheel.logs.mcap.rover_record import RoverRecord
from six_wheel.logs.mcap.writer import RecordWriter

__all__ = ["Record", "RecordError", "RecordWriter", "RoverRecord"]
