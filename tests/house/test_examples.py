"""The examples run, and every parameter file among them loads."""

import runpy
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

import six_wheel as sw

EXAMPLES = Path(__file__).parents[2] / "examples"


@pytest.mark.parametrize("example", sorted(EXAMPLES.glob("*.py")), ids=lambda path: path.stem)
def test_examples_run(example, capsys):
    runpy.run_path(str(example), run_name="__main__")
    assert capsys.readouterr().out


@pytest.mark.parametrize("example", sorted(EXAMPLES.glob("*.yaml")), ids=lambda path: path.stem)
def test_parameter_files_load(example):
    rover = sw.load(example)
    twist = rover.project((0.2, 0.0, 0.05))
    assert abs(rover.forward(*rover.inverse(twist)) - twist).max() < 1e-12


THREAD = EXAMPLES / "06_drive_thread.py"


@pytest.mark.parametrize(
    "signals",
    [[signal.SIGINT], [signal.SIGINT, signal.SIGINT, signal.SIGTERM], [signal.SIGTERM]],
    ids=["Ctrl-C", "Ctrl-C and more", "SIGTERM"],
)
def test_the_thread_that_drives_ends_at_rest_by_signals(signals):
    process = subprocess.Popen(
        [sys.executable, "-c", f"import runpy; runpy.run_path({str(THREAD)!r}, run_name='__main__')"],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    assert process.stdout is not None
    assert "driving 0.50 m/s" in process.stdout.readline()  # and it goes on
    for number in signals:
        process.send_signal(number)
        time.sleep(0.05)
    out, err = process.communicate(timeout=60)
    assert out.splitlines()[-1] == "the end: 0.00 rad/s commanded", err
    assert process.returncode != 0


@pytest.fixture
def handlers():
    """Puts handlers of signals back: the example ignores them while it stops, tests after it send some."""
    before = {number: signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)}
    yield
    for number, handler in before.items():
        signal.signal(number, handler)


@pytest.mark.usefixtures("handlers")
def test_the_thread_that_drives_ends_at_rest_by_exceptions():
    example = runpy.run_path(str(THREAD))

    class Broken(example["Bus"]):
        def write(self, commands):
            super().write(commands)
            if any(
                abs(commands[joint]) > 1.0 for joint in example["ROVER"].traction_joints if joint in commands
            ):
                raise OSError("bus off")

    bus = Broken()
    with example["DriveThread"](bus) as rover:
        end = time.monotonic() + 30.0
        while not rover.fault and time.monotonic() < end:
            rover.drive((0.5, 0.0, 0.0))
            time.sleep(0.01)
    assert rover.fault == "OSError: bus off"
    assert not any(bus.joints[joint] for joint in example["ROVER"].traction_joints)
