"""What was recorded, and what is written: tables, bags, recordings, any of them opened by what it is.

`columns` says what a header means; `tables` reads commands, `joints` readings and `truths` where it was, from
tables (`tolerant` of bad rows) or `bags`; `recordings` are logs in memory, `optiodom` an example of a reader;
`writing` replaces files.
"""

from typing import TYPE_CHECKING

from six_wheel.lazy import attach

if TYPE_CHECKING:
    from six_wheel.logs.columns import TableError
    from six_wheel.logs.joints import JointLog, JointRows
    from six_wheel.logs.opening import LogOptions, open_log, read_log
    from six_wheel.logs.recordings import Log, Truth
    from six_wheel.logs.tables import Chunk, CommandTable, RowError
    from six_wheel.logs.truths import read_truth
    from six_wheel.logs.writing import TableWriter, replacing

__all__ = [
    "Chunk",
    "CommandTable",
    "JointLog",
    "JointRows",
    "Log",
    "LogOptions",
    "RowError",
    "TableError",
    "TableWriter",
    "Truth",
    "open_log",
    "read_log",
    "read_truth",
    "replacing",
]

__getattr__, __dir__ = attach(
    __name__,
    {
        "bag_files": (),
        "bags": (),
        "columns": ("TableError",),
        "joint_columns": (),
        "joints": ("JointLog", "JointRows"),
        "opening": ("LogOptions", "open_log", "read_log"),
        "optiodom": (),
        "recordings": ("Log", "Truth"),
        "tables": ("Chunk", "CommandTable", "RowError"),
        "tolerant": (),
        "truths": ("read_truth",),
        "writing": ("TableWriter", "replacing"),
    },
)
