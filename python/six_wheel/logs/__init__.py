"""Readers and writers of logs: tables, bags and recordings; the format of a file is detected.

`tables` reads commands, `joints` readings and `ground_truth` where it was, from tables (`skip_bad_rows` goes
on after a bad one) or `bags`; `gyroscope` is rates in either; `log_options` says what a log does not state;
`recordings` are logs in memory, `optiodom` an example of a reader; `detect_reader` opens any of them;
`writing` replaces files. `mcap` has the records of a run. `headers` finds columns, `frames` reads tables in
memory, `plausibility` refuses readings that no rover has.
"""

from typing import TYPE_CHECKING

from six_wheel.kinematics.lazy import attach

if TYPE_CHECKING:
    from six_wheel.kinematics.errors import TableError
    from six_wheel.kinematics.objects.whole_files import replacing
    from six_wheel.logs.detect_reader import open_log, read_log
    from six_wheel.logs.ground_truth import read_truth
    from six_wheel.logs.joint_totals import JointRows
    from six_wheel.logs.joints import JointLog
    from six_wheel.logs.log_options import LogOptions
    from six_wheel.logs.recordings import GroundTruth, WheelLog
    from six_wheel.logs.tables import Chunk, CommandTable, RowError
    from six_wheel.logs.writing import TableWriter

__all__ = [
    "Chunk",
    "CommandTable",
    "GroundTruth",
    "JointLog",
    "JointRows",
    "LogOptions",
    "RowError",
    "TableError",
    "TableWriter",
    "WheelLog",
    "open_log",
    "read_log",
    "read_truth",
    "replacing",
]

__getattr__, __dir__ = attach(
    __name__,
    {
        "bags": (),
        "joint_totals": ("JointRows",),
        "joints": ("JointLog",),
        "detect_reader": ("open_log", "read_log"),
        "log_options": ("LogOptions",),
        "optiodom": (),
        "recordings": ("WheelLog", "GroundTruth"),
        "tables": ("Chunk", "CommandTable", "RowError", "TableError"),
        "skip_bad_rows": (),
        "ground_truth": ("read_truth",),
        "mcap": (),
        "writing": ("TableWriter", "replacing"),
    },
)
