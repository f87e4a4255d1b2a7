"""Xacro files among packages: what lies around them is found, what is not here is named."""

import importlib.util
from pathlib import Path

import pytest

from six_wheel.robot_description.parameters import ParameterFileError
from six_wheel.robot_description.urdf import read_urdf
from tests.robot_description.urdf.test_urdf_read import PAIR, robot

pytestmark = pytest.mark.skipif(
    importlib.util.find_spec("xacrodoc") is None, reason="xacrodoc is not installed"
)

XACRO = '<robot xmlns:xacro="http://wiki.ros.org/xacro" '


def package(folder: Path, name: str, files: dict[str, str]) -> Path:
    """A package of ROS with these files."""
    folder.mkdir(parents=True)
    (folder / "package.xml").write_text(f"<package><name>{name}</name></package>")
    for file, text in files.items():
        (folder / file).write_text(text.replace("<robot ", XACRO))
    return folder


def including(what: str, more: str = "") -> str:
    return robot(f'<xacro:include filename="{what}"/>', more)


def refused(path: Path) -> str:
    with pytest.raises(ParameterFileError) as caught:
        read_urdf(path)
    (line,) = str(caught.value).splitlines()
    return line


def wheels(radius: str) -> str:
    """A part that another file includes."""
    return f'<robot name="wheels">{PAIR}</robot>'.replace('radius="0.1"', f'radius="{radius}"')


def test_packages_around_the_file_are_found(tmp_path: Path) -> None:
    for team, radius in (("one", 0.2), ("other", 0.3)):
        ground = tmp_path / team
        parts = package(ground / "src" / "parts" / "wheels", "bot_wheels", {"w.xacro": wheels(f"{radius}")})
        assert parts.is_dir()
        text = including("$(find bot_wheels)/w.xacro", '<xacro:include filename="more.xacro"/>')
        more = '<robot name="more"><plugin file="$(find somewhere)/config/control.yaml"/></robot>'
        bot = package(ground / "src" / "bot", "bot", {"bot.urdf.xacro": text, "more.xacro": more})
        # Of two teams with a package of one name each has its own; a package in a setting need not be here.
        assert read_urdf(bot / "bot.urdf.xacro").rover.wheels[0].radius == radius


def test_what_is_not_here_is_named(tmp_path: Path) -> None:
    files = {
        "absent.xacro": including("$(find camera_description)/urdf/camera.xacro"),
        "argument.xacro": robot('<link name="$(arg prefix)camera"/>'),
        "parts.xacro": '<robot name="parts"><xacro:macro name="wheel"><link name="l"/></xacro:macro></robot>',
        "macro.xacro": robot("<xacro:wheel/>"),
    }
    bot = package(tmp_path / "bot", "bot", files)
    line = refused(bot / "absent.xacro")
    assert "the xacro needs urdf/camera.xacro of the package camera_description, which is not here" in line
    line = refused(bot / "argument.xacro")
    assert "the xacro has no value for its argument prefix" in line
    assert "prefix:=VALUE" in line
    assert "it has parts for other files: give that of the whole robot" in refused(bot / "parts.xacro")
    assert "the xacro cannot be expanded: unknown macro name: xacro:wheel" in refused(bot / "macro.xacro")


def test_a_macro_in_a_comment_is_none(tmp_path: Path) -> None:
    path = tmp_path / "bot.urdf"
    path.write_text(robot('<!-- <xacro:include filename="$(find nowhere)/a.xacro"/> -->', PAIR))
    assert len(read_urdf(path).rover.wheels) == 2


def test_lengths_that_cannot_be_metres_are_a_warning_of_the_file(tmp_path: Path) -> None:
    path = tmp_path / "bot.urdf"
    path.write_text(robot(PAIR).replace('radius="0.1"', 'radius="100.0"'))
    assert any("a wheel has a radius of 100 m" in str(each) for each in read_urdf(path).warnings)
