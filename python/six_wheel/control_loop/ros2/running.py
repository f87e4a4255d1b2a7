"""The process of a node: started with ROS arguments, ended by a signal, the rover stopped before."""

import contextlib
import gc
import re
import signal
import time
from collections.abc import Callable, Iterator, Sequence
from types import FrameType
from typing import Any, Literal

from six_wheel.control_loop import Settings
from six_wheel.control_loop.ros2.description import Load, settings_by_parameters
from six_wheel.control_loop.ros2.loading import rclpy
from six_wheel.kinematics.errors import one_line

PATIENCE = 4.0  # [s] from the first signal on in which the rover stops within its limits; then it is halted
LATEST = 4.5  # [s] from the first signal on at which the last command is sent, in motion or not
SENDING = 0.05  # [s] for the middleware to send it
TURN = 0.05  # [s] between looks at the signals
# Signals that a terminal, a launcher or a service manager sends, as far as the system has them.
ENDING = [
    getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP", "SIGQUIT") if hasattr(signal, name)
]


def run(
    kind: Literal["node", "filter"], settings: Settings | None, arguments: Sequence[str], load: Load
) -> int:
    """Run a node until a signal ends it, its last joint command zero; the exit code.

    After the first signal the rover stops within its limits, from the second one or `PATIENCE` on by a halt,
    and `LATEST` after the first one its wheels are commanded to rest in one step. The process is meant to end
    afterwards: later signals are ignored.

    Without `settings` those of its parameters, or of the topic robot_description, count: `load` reads a rover
    that parameters name. `arguments` are ``--ros-args`` and what follows it. Raises `ModuleNotFoundError` if
    there is no rclpy. Raises `ValueError` if arguments or parameters cannot be used.
    """
    ros = rclpy()
    from rclpy.signals import SignalHandlerOptions

    try:
        ros.init(args=["six-wheel", *arguments], signal_handler_options=SignalHandlerOptions.NO)
    except Exception as error:  # rclpy has no class for it that all versions share
        raise ValueError(f"ROS arguments cannot be used: {one_line(error)}") from None
    before = {number: signal.getsignal(number) for number in ENDING}
    try:
        signals = _Signals()
        if settings is None:
            settings = settings_by_parameters(ros, node_name(None, kind), load, lambda: signals.count > 0)
        if settings is not None:
            _spin(ros, kind, settings, signals)
    except BaseException:
        for number, handler in before.items():
            signal.signal(number, handler)
        raise
    finally:
        ros.try_shutdown()
    for number in ENDING:
        signal.signal(number, signal.SIG_IGN)
    return 0


class _Signals:
    """The signals that came, from here on: `count`, and by the monotonic clock when the `first` did [s]."""

    def __init__(self) -> None:
        self.count, self.first = 0, 0.0
        for number in ENDING:
            # SIGHUP stays ignored under nohup. SIGINT, which a shell ignores in the background, is taken.
            if number in (signal.SIGINT, signal.SIGTERM) or signal.getsignal(number) != signal.SIG_IGN:
                signal.signal(number, self._note)

    def _note(self, number: int, frame: FrameType | None) -> None:
        self.count += 1
        if self.count == 1:
            self.first = time.monotonic()

    @property
    def since(self) -> float:
        """Time since the first one [s]."""
        return time.monotonic() - self.first if self.count else 0.0


def _spin(ros: Any, kind: str, settings: Settings, signals: _Signals) -> None:
    name = node_name(settings.parameters.node, kind)
    if kind == "node":
        from six_wheel.control_loop.ros2.node import RoverNode

        node: Any = RoverNode(name, settings)
    else:
        from six_wheel.control_loop.ros2.filter import FilterNode

        node = FilterNode(name, settings)
    executor = _executor(ros)
    executor.add_node(node)
    try:
        with _no_collecting():
            if node.options["autostart"]:
                _start(node)
            while not signals.count:
                _turn(executor, node)
            _stop(executor, node, signals)
    finally:
        node.send_rest()
        time.sleep(SENDING)
        node.end_record()
        executor.shutdown()
        node.destroy_node()


def _stop(executor: Any, node: Any, signals: _Signals) -> None:
    """Bring the rover to rest: within its limits, by a halt, or not at all when it is too late for both."""
    _serve(node, node.stop)
    halted = False
    while not node.loop.stopped and signals.since < LATEST:
        if not halted and (signals.count > 1 or signals.since > PATIENCE):
            halted = True
            _serve(node, node.halt)
        _turn(executor, node)


def _turn(executor: Any, node: Any) -> None:
    """Serve what has come."""
    _serve(node, lambda: executor.spin_once(timeout_sec=TURN))


def _serve(node: Any, call: Callable[[], object]) -> None:
    """A rover in motion must not be left alone for a request that fails, or a record that is full."""
    try:
        call()
    except Exception as error:  # of any callback, rclpy's own among them
        if not node.context.ok():
            raise
        node.failed(error)


def _start(node: Any) -> None:
    from rclpy.lifecycle import TransitionCallbackReturn

    for transition in (node.trigger_configure, node.trigger_activate):
        if transition() != TransitionCallbackReturn.SUCCESS:
            raise ValueError("the node could not start; its log says why")


def _executor(ros: Any) -> Any:
    """The quicker one where there is one."""
    try:
        from rclpy.experimental.events_executor import EventsExecutor
    except ImportError:
        return ros.executors.SingleThreadedExecutor()
    return EventsExecutor()


def node_name(node: str | None, kind: str) -> str:
    """A name from that of the file, which may be a pattern."""
    last = (node or "").rstrip("/").rsplit("/", 1)[-1]
    if re.fullmatch(r"[A-Za-z_][A-Za-z0-9_]*", last):
        return last
    return "rover" if kind == "node" else "command_filter"


@contextlib.contextmanager
def _no_collecting() -> Iterator[None]:
    """Garbage is collected with every report, and never between joint states and commands."""
    gc.collect()
    gc.freeze()
    gc.disable()
    try:
        yield
    finally:
        gc.enable()
        gc.unfreeze()
