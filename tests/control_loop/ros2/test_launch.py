"""The installed package as ROS 2 finds it: by the ament index, for `ros2 run` and `ros2 launch`."""

import os
import sys
import time
from pathlib import Path
from xml.etree import ElementTree

import pytest

import six_wheel as sw
from tests.control_loop.ros2.peers import PATIENCE, Process

index = pytest.importorskip("ament_index_python")


@pytest.fixture(autouse=True)
def share(monkeypatch):
    """Folder of the package's files in a pip installation; skipped where it runs from its sources."""
    monkeypatch.setenv("AMENT_PREFIX_PATH", sys.prefix)
    try:
        return Path(index.get_package_share_directory("six_wheel"))
    except index.PackageNotFoundError:
        pytest.skip("six_wheel is not installed as a wheel here")


def test_the_description_of_the_package_is_that_of_this_version(share):
    package = ElementTree.parse(share / "package.xml").getroot()
    assert (package.findtext("name"), package.findtext("version")) == ("six_wheel", sw.__version__)


def test_executables_of_ros2_run_are_the_commands_of_the_same_name(tmp_path):
    folder = Path(index.get_package_prefix("six_wheel")) / "lib" / "six_wheel"
    assert sorted(path.name for path in folder.iterdir() if os.access(path, os.X_OK)) == ["filter", "node"]
    for name in ("node", "filter"):
        program = [sys.executable, str(folder / name)]  # by its first line it is the Python of the path
        process = Process("missing.yaml", program=program, folder=tmp_path)
        assert process.process.wait(PATIENCE) == 2
        assert "missing.yaml" in process.said


def test_the_launch_file_starts_a_node_and_ends_it(share, rover_file, tmp_path, monkeypatch):
    pytest.importorskip("ros2launch", reason="needs ros2launch: a ROS installation")
    scripts = Path(sys.prefix) / "bin"
    monkeypatch.setenv("PATH", f"{scripts}{os.pathsep}{os.environ['PATH']}")
    program = [str(scripts / "ros2"), "launch", "six_wheel", "rover.launch.py"]
    process = Process(
        f"rover:={rover_file}", "namespace:=mars", "record:=run.mcap", program=program, folder=tmp_path
    )
    latest = time.monotonic() + PATIENCE
    while not (tmp_path / "run.mcap").exists() and time.monotonic() < latest:
        time.sleep(0.1)
    process.end()
    assert "[mars.rover_controller]" in process.said
    assert "process has finished cleanly" in process.said
