"""Running a record again: the same inputs through the same loop, or through one with other parameters.

`rerun` reads the record and runs a node's loop, `command_replay` a drive through a table; `run_summary` has
what came of it, `compare_runs` says what became different.
"""

from six_wheel.control_loop.replay.compare_runs import Difference, compare
from six_wheel.control_loop.replay.rerun import replay
from six_wheel.control_loop.replay.run_summary import Replayed, Run

__all__ = ["Difference", "Replayed", "Run", "compare", "replay"]
