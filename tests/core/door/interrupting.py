"""Ctrl-C at a moment of a call, sent by another process, and how long the call then goes on."""

import math
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

BOUND = 0.3  # [s] from the signal to the end of the call
# A machine with other work is late by chance; a call that asks too rarely is late every time.
TRIES = 4
KEPT = 10.0  # [s] after which a signal has not reached this process

# A thread of this process would wait for the interpreter's lock just as the call's own question does.
SENDER = """
import os, select, signal, sys, time
for line in iter(sys.stdin.buffer.raw.readline, b""):
    if select.select([sys.stdin.buffer.raw], [], [], float(line))[0]:
        sys.stdin.buffer.raw.readline()
        print("too late", flush=True)
        continue
    os.kill(os.getppid(), signal.SIGINT)
    print(time.monotonic(), flush=True)
    sys.stdin.buffer.raw.readline()
"""


class Interrupter:
    """Sends SIGINT to this process, and measures."""

    def __init__(self) -> None:
        command = [sys.executable, "-SEc", SENDER]
        self._sender = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        self._armed = False
        self._heard = threading.Event()

    def _handle(self, *_: Any) -> None:
        self._heard.set()
        if self._armed:
            self._armed = False
            raise KeyboardInterrupt

    def during(self, call: Callable[[], object], moment: float) -> tuple[bool, float]:
        """True for a call that was interrupted `moment` [s] after its begin, and the time it went on [s].

        One that ends before goes on for less than no time. Its errors are answers.
        """
        was_interrupted = False
        self._heard.clear()
        self._armed = True
        self._tell(f"{moment}")
        try:
            call()
            self._armed = False
        except KeyboardInterrupt:
            was_interrupted = True
        except Exception:  # its answer
            pass
        self._armed = False
        end = time.monotonic()
        self._tell("ended")
        assert self._sender.stdout is not None
        sent = self._sender.stdout.readline()
        if sent.startswith("too late"):
            return False, -math.inf
        # A library that handles signals while it reads may keep one: the wait for it had no end.
        heard = self._heard.wait(KEPT)
        return was_interrupted, end - float(sent) if heard else math.inf

    def _tell(self, text: str) -> None:
        assert self._sender.stdin is not None
        self._sender.stdin.write(f"{text}\n")
        self._sender.stdin.flush()

    def lateness(self, call: Callable[[], object], moment: float) -> tuple[bool, float]:
        """The same; the least time of several tries where it is more than `BOUND`."""
        was_interrupted, late = self.during(call, moment)
        for _ in range(TRIES - 1):
            if late <= BOUND:
                break
            was_interrupted, again = self.during(call, moment)
            late = min(late, again)
        return was_interrupted, late

    def close(self) -> None:
        self._sender.kill()
        self._sender.communicate()


@contextmanager
def interrupter() -> Iterator[Interrupter]:
    """An `Interrupter`, with its handler in place of that of this process."""
    made = Interrupter()
    before = signal.signal(signal.SIGINT, made._handle)
    try:
        yield made
    finally:
        signal.signal(signal.SIGINT, before)
        made.close()
