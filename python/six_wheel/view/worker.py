"""One thread that does the latest thing it was told, and forgets what was overtaken."""

from __future__ import annotations

import threading
from collections.abc import Callable


class Worker:
    """Calls `update` in a thread of its own after `ask`: once, however often it was asked meanwhile.

    Callbacks of sliders come from a pool of threads and overtake each other; what they change is read when
    the update begins, so that the last one always counts. `failed` is called with what `update` raised; the
    thread goes on.
    """

    def __init__(self, update: Callable[[], None], failed: Callable[[Exception], None]) -> None:
        self._update, self._failed = update, failed
        self._changed = threading.Condition()
        self._asked = self._done = 0
        self._open = True
        self._thread = threading.Thread(target=self._run, name="six_wheel view", daemon=True)
        self._thread.start()

    def ask(self) -> None:
        """Have the update done, soon."""
        with self._changed:
            self._asked += 1
            self._changed.notify_all()

    def wait(self, timeout: float | None = None) -> bool:
        """Wait until everything that was asked for is done; whether it is."""
        with self._changed:
            wanted = self._asked
            return self._changed.wait_for(lambda: self._done >= wanted or not self._open, timeout)

    def close(self) -> None:
        """End the thread after what it is doing."""
        with self._changed:
            self._open = False
            self._changed.notify_all()
        if threading.current_thread() is not self._thread:
            self._thread.join(0.2)

    def _run(self) -> None:
        while True:
            with self._changed:
                self._changed.wait_for(lambda: self._asked > self._done or not self._open)
                if not self._open:
                    return
                asked = self._asked
            try:
                self._update()
            except Exception as error:
                # It would end the thread, and the view would stand still without a word.
                self._failed(error)
            with self._changed:
                self._done = asked
                self._changed.notify_all()
