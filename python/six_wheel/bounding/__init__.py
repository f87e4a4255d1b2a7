"""What the bounds of a pose are worth, what is allowed where a rover stands, and why it may not.

`meaning` has the names behind the codes of the core.
"""

from six_wheel.bounding.meaning import BoundStatus, FeasibleReason, StandLimits, reasons, statuses

__all__ = ["BoundStatus", "FeasibleReason", "StandLimits", "reasons", "statuses"]
