"""Nodes in processes of their own, on this machine only; without rclpy there is nothing to test."""

import os
import signal
import warnings
from collections.abc import Callable, Iterator
from pathlib import Path
from types import ModuleType

import pytest

pytest.importorskip("rclpy", reason="needs rclpy: make test-ros, or a ROS installation")
with warnings.catch_warnings():
    warnings.simplefilter("ignore", DeprecationWarning)  # of a parser that rclpy needs
    pytest.importorskip("rosidl_generator_py")

import six_wheel as sw
from tests.control_loop.ros2.peers import Peer, Process

ROVER = """\
rover_controller:
  ros__parameters:
    d1: 0.4
    d2: 0.5
    d3: 0.5
    d4: 0.45
    wheel_radius: 0.15
    traction_joints: [fl_wheel, fr_wheel, ml_wheel, mr_wheel, rl_wheel, rr_wheel]
    steering_joints: [fl_steer, fr_steer, rl_steer, rr_steer]
    limits: {speed: 1.0, acceleration: 0.5, wheel_speed: 8.0, steering_rate: 1.0}
"""

LONGEST = 600  # [s] that a test may take: then it fails, and its processes are ended


@pytest.fixture(autouse=True)
def _bounded() -> Iterator[None]:
    def late(*_: object) -> None:
        raise TimeoutError(f"the test must end within {LONGEST} s")

    before = signal.signal(signal.SIGALRM, late)
    signal.alarm(LONGEST)
    yield
    signal.alarm(0)
    signal.signal(signal.SIGALRM, before)


@pytest.fixture(autouse=True)
def _domain(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Talk to each other on this machine, in a domain of this process, and to nobody else."""
    monkeypatch.setenv("ROS_DOMAIN_ID", str(1 + os.getpid() % 100))
    monkeypatch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
    monkeypatch.setenv("ROS_LOG_DIR", str(tmp_path / "log"))


@pytest.fixture
def rover_file(tmp_path: Path) -> Path:
    path = tmp_path / "rover.yaml"
    path.write_text(ROVER)
    return path


@pytest.fixture
def start(tmp_path: Path) -> Iterator[Callable[..., Process]]:
    """Start `six-wheel` with these arguments; all that were started are ended."""
    started: list[Process] = []

    def start(*arguments: str) -> Process:
        started.append(Process(*arguments, folder=tmp_path))
        return started[-1]

    yield start
    for process in started:
        process.end()


@pytest.fixture
def cyclone(monkeypatch: pytest.MonkeyPatch, _domain: None) -> ModuleType:
    """The module `tests.control_loop.ros2.cyclone`, where there is its implementation of DDS."""
    pytest.importorskip("cyclonedds", reason="needs pip install cyclonedds")
    from tests.control_loop.ros2 import cyclone

    monkeypatch.setenv("CYCLONEDDS_URI", cyclone.URI)
    return cyclone


@pytest.fixture
def peer(rover_file: Path, _domain: None) -> Iterator[Peer]:
    """Robot, planner and operator."""
    with Peer(sw.load(rover_file)) as peer:
        yield peer
