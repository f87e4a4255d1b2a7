"""Running a record again: the same inputs through the same loop, or through one with other parameters.

`again` reads the record and runs a node's loop, `drives` a drive through a table; `runs` has what came of it,
`difference` says what became different.
"""

from six_wheel.replay.again import replay
from six_wheel.replay.difference import Difference, compare
from six_wheel.replay.runs import Replayed, Run

__all__ = ["Difference", "Replayed", "Run", "compare", "replay"]
