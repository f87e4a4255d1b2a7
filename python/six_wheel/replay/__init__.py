"""Running a record again: the same inputs through the same loop, or through one with other parameters.

`again` reads the record and runs it; `difference` says what became different.
"""

from six_wheel.replay.again import Replayed, Run, replay
from six_wheel.replay.difference import Difference, compare

__all__ = ["Difference", "Replayed", "Run", "compare", "replay"]
