"""Commands end by signals: Ctrl-C, SIGTERM and SIGHUP become exceptions, which remove files half written."""

import contextlib
import os
import signal
import sys
import threading
from collections.abc import Iterator
from importlib.machinery import ExtensionFileLoader
from types import FrameType
from typing import Any

__all__ = ["ended_by_signals"]

AGAIN = 0.1  # [s] until an exception is raised again that a library has lost
# Handler of each signal before a command begins; another one is somebody else's, and counts.
ORDINARY = {
    getattr(signal, name): before
    for name, before in (
        ("SIGINT", signal.default_int_handler),
        ("SIGTERM", signal.SIG_DFL),
        ("SIGHUP", signal.SIG_DFL),
    )
    if hasattr(signal, name)
}


class _Ending:
    """The end of a block that a signal asked for.

    Libraries lose an exception of a handler: code in C that asks for an attribute takes it for its own, and a
    compiled module that is initialised makes another error of it. So none is raised while a compiled module
    is initialised, and it is raised again until the block is on its way out.
    """

    def __init__(self) -> None:
        self.number: int | None = None  # of the first signal
        self._main = threading.get_ident()
        self._ended = threading.Event()
        self._sending = threading.Lock()

    def handle(self, number: int, frame: FrameType | None) -> None:
        if self.number is None:
            self.number = number
            threading.Thread(target=self._repeat, daemon=True).start()
        if not (self._ended.is_set() or _is_ending() or _loads_compiled(frame)):
            raise self.exception()

    def exception(self) -> BaseException:
        """The exception of the first signal."""
        assert self.number is not None
        return KeyboardInterrupt() if self.number == signal.SIGINT else SystemExit(128 + self.number)

    def _repeat(self) -> None:
        while not self._ended.wait(AGAIN):
            with self._sending:
                if self._ended.is_set():
                    return
                if hasattr(signal, "pthread_kill"):
                    signal.pthread_kill(self._main, self.number or 0)
                else:
                    signal.raise_signal(self.number or 0)

    def end(self) -> None:
        """No signal is sent any more."""
        with self._sending:
            self._ended.set()


def _is_ending() -> bool:
    """True within what an exception of a signal runs on its way out of the block."""
    error = sys.exception()
    while error is not None:
        if isinstance(error, KeyboardInterrupt | SystemExit):
            return True
        error = error.__context__
    return False


def _loads_compiled(frame: FrameType | None) -> bool:
    """True while a compiled module is initialised."""
    while frame is not None:
        is_loading = frame.f_code.co_name in ("create_module", "exec_module")
        if is_loading and isinstance(frame.f_locals.get("self"), ExtensionFileLoader):
            return True
        frame = frame.f_back
    return False


@contextlib.contextmanager
def ended_by_signals() -> Iterator[None]:
    """Ctrl-C, SIGTERM and SIGHUP end the block as an exception, the last two then the process as well.

    A handler that somebody else has set, or that a command sets for itself, counts.
    """
    is_main = threading.current_thread() is threading.main_thread()
    numbers = [each for each, before in ORDINARY.items() if is_main and signal.getsignal(each) == before]
    ending, report = _Ending(), sys.unraisablehook

    def unraisable(lost: Any) -> None:
        """Exceptions of a signal that a finalizer loses are raised again, and need no words."""
        if ending.number is None or not isinstance(lost.exc_value, KeyboardInterrupt | SystemExit):
            report(lost)

    for number in numbers:
        signal.signal(number, ending.handle)
    sys.unraisablehook = unraisable
    try:
        yield
    except Exception:
        if ending.number is not None:  # of a library that lost the exception, and then something else
            raise ending.exception() from None
        raise
    finally:
        ending.end()
        sys.unraisablehook = report
        for number in numbers:
            signal.signal(number, ORDINARY[number])
        if ending.number not in (None, signal.SIGINT):
            os.kill(os.getpid(), ending.number)
