"""The time of a loop: it never goes back a little, and what it does otherwise is told."""

from six_wheel.control_loop.faults import WARN, Faults

SECOND = 1_000_000_000  # [ns]
HICCUP = SECOND // 100  # of a clock that is set back a little: time stands still for so long
JUMP = SECOND  # of time, forward, between two calls, that is worth a word


class Clock:
    """Time [ns], as its callers say it; its `origin` is the start of the loop, or of time that jumped back,
    None before the first call."""

    def __init__(self, faults: Faults) -> None:
        self.origin: int | None = None
        self._faults = faults
        self._now = 0

    def move_on(self, now: int) -> tuple[int, bool]:
        """The time from here on: that given, but never a little earlier than the last one. True if it jumped
        back, so that everything from before is of another time."""
        if self.origin is None:
            self.origin = self._now = now
        since = now - self._now
        if -HICCUP <= since < 0:
            return self._now, False
        if since < 0:
            self._faults.add("time", WARN, "time must not run backwards", f"{-since / SECOND:.6g} s back")
            self.origin = now
        elif since > JUMP:
            self._faults.add("time", WARN, "time must not jump", f"{since / SECOND:.6g} s ahead")
        self._now = now
        return now, since < 0

    def seconds(self, time: int) -> float:
        """Seconds since the origin: doubles hold these, not nanoseconds since 1970."""
        assert self.origin is not None
        return (time - self.origin) / SECOND
