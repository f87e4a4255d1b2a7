"""The process of a node: started with ROS arguments, ended by a signal, the rover stopped before."""

import contextlib
import gc
import re
import signal
import time
from collections.abc import Iterator, Sequence
from types import FrameType
from typing import Any, Literal

from six_wheel.control_loop import Settings
from six_wheel.control_loop.ros2.loading import rclpy

__all__ = ["run"]

PATIENCE = 5.0  # [s] for a stop when the process is told to end
TURN = 0.05  # [s] between looks at whether it is


def run(kind: Literal["node", "filter"], settings: Settings, arguments: Sequence[str] = ()) -> int:
    """Run a node until it is told to end.

    Parameters
    ----------
    kind : {"node", "filter"}
    settings : Settings
    arguments : sequence of str
        ROS arguments, ``--ros-args`` and what follows it.

    Returns
    -------
    int
        0.

    Raises
    ------
    ModuleNotFoundError
        If there is no rclpy.
    ValueError
        If arguments or parameters cannot be used.
    """
    ros = rclpy()
    from rclpy.signals import SignalHandlerOptions

    try:
        ros.init(args=["six-wheel", *arguments], signal_handler_options=SignalHandlerOptions.NO)
    except Exception as error:  # rclpy has no class for it that all versions share
        raise ValueError(f"ROS arguments cannot be used: {' '.join(str(error).split())}") from None
    try:
        return _spin(ros, kind, settings)
    finally:
        ros.try_shutdown()


def _spin(ros: Any, kind: str, settings: Settings) -> int:
    name = node_name(settings.parameters.node, kind)
    try:
        if kind == "node":
            from six_wheel.control_loop.ros2.node import RoverNode

            node: Any = RoverNode(name, settings)
        else:
            from six_wheel.control_loop.ros2.filter import FilterNode

            node = FilterNode(name, settings)
    except ros.exceptions.InvalidParameterTypeException as error:
        raise ValueError(" ".join(str(error).split())) from None
    executor = _executor(ros)
    executor.add_node(node)
    try:
        with _told_to_end() as told, _no_collecting():
            if node.options["autostart"]:
                _start(node)
            while not told:
                _turn(executor, node)
            if node.stop():
                end = time.monotonic() + PATIENCE
                while not node.loop.stopped and time.monotonic() < end and len(told) < 2:
                    _turn(executor, node)
    finally:
        node.end_record()
        executor.shutdown()
        node.destroy_node()
    return 0


def _turn(executor: Any, node: Any) -> None:
    """Serve what has come; a rover in motion must not be left alone for somebody's request that fails."""
    try:
        executor.spin_once(timeout_sec=TURN)
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


@contextlib.contextmanager
def _told_to_end() -> Iterator[list[int]]:
    """The signals that came meanwhile."""
    told: list[int] = []

    def note(number: int, frame: FrameType | None) -> None:
        told.append(number)

    before = {number: signal.signal(number, note) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        yield told
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
