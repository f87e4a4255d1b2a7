"""The house as CONTRIBUTING describes it, and rooms that stay rooms."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import six_wheel

ROOT = Path(__file__).parents[2]
PACKAGE = Path(six_wheel.__file__).parent
ROOMS = sorted(path.parent for path in PACKAGE.rglob("__init__.py"))
CRATES = sorted(
    path for path in (ROOT / "rust").glob("*/Cargo.toml") if path.parent.name not in ("fuzz", "python")
)
LINES = 3_300  # about three thousand
FILES = 12


def tree() -> set[str]:
    """The folders of the tree in CONTRIBUTING.md, with the path of those they are indented under."""
    text = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    block = re.search(r"```text\n(.*?)```", text, re.DOTALL)
    assert block is not None
    found: list[str] = []
    above: list[str] = []
    for line in block[1].splitlines():
        depth = (len(line) - len(line.lstrip())) // 2
        above = [*above[:depth], line.split()[0]]
        found.append("/".join(above))
    assert len(found) == len(set(found))
    return set(found)


def folders() -> set[str]:
    """The folders of the repository that hold a file of it."""
    try:
        listed = subprocess.run(
            ["git", "ls-files"], cwd=ROOT, capture_output=True, text=True, check=True
        ).stdout.splitlines()
    except (OSError, subprocess.CalledProcessError):
        pytest.skip("not a checkout of git")
    files = [Path(name).parent for name in listed]
    above = {folder for file in files for folder in (file, *file.parents)}
    tops = ("python/six_wheel", "tests", "benches", "examples", "docs", "rust/python/src")
    tops += tuple(f"{crate.parent.relative_to(ROOT)}/" for crate in CRATES)
    laid_into_the_environment = "six_wheel.data"  # of the wheel, for ROS 2: as deep as ROS 2 wants it
    rooms = (folder for folder in above if laid_into_the_environment not in folder.parts)
    return {str(folder) for folder in rooms if str(folder).startswith(tops)}


def test_the_tree_in_contributing_is_that_of_the_repository() -> None:
    assert tree() == folders()


@pytest.mark.parametrize("room", ROOMS, ids=lambda room: str(room.relative_to(PACKAGE)))
def test_a_room_is_no_hall(room: Path) -> None:
    modules = [path for path in room.glob("*.py") if path.name not in ("__init__.py", "__main__.py")]
    assert len(modules) <= FILES
    assert sum(len(path.read_text(encoding="utf-8").splitlines()) for path in modules) <= LINES
    assert not [path.name for path in modules if path.name.startswith("_") or path.stem == room.name]


def test_an_import_upwards_or_in_a_circle_breaks_the_contract(tmp_path: Path) -> None:
    watch = Path(sys.executable).with_name("lint-imports")
    if not watch.exists():
        pytest.skip("needs import-linter")
    shutil.copytree(ROOT / "python/six_wheel", tmp_path / "six_wheel")
    command = [watch, "--config", ROOT / "pyproject.toml", "--no-cache"]
    how = {"cwd": tmp_path, "env": os.environ | {"PYTHONPATH": str(tmp_path)}, "capture_output": True}
    assert subprocess.run(command, check=False, **how).returncode == 0
    for low, high in (
        ("kinematics/odometry/tracks", "cli import names"),
        ("logs/tables", "logs import bags"),
    ):
        with (tmp_path / f"six_wheel/{low}.py").open("a", encoding="utf-8") as file:
            file.write(f"\n\ndef later() -> None:\n    from six_wheel.{high}  # lazily\n")
    done = subprocess.run(command, check=False, **how)
    assert done.returncode == 1
    assert b"Imports only go down BROKEN" in done.stdout
    assert b"six_wheel.kinematics.odometry.tracks -> six_wheel.cli" in done.stdout
    assert b"No circles inside a room BROKEN" in done.stdout


@pytest.mark.parametrize(
    "name",
    [room.name for room in ROOMS if room.parent == PACKAGE and room.name not in ("cli", "kinematics")],
)
def test_a_public_package_is_there_when_it_is_asked_for(name: str) -> None:
    code = f"import six_wheel as sw, sys; print('six_wheel.{name}' in sys.modules); print(sw.{name}.__name__)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["False", f"six_wheel.{name}"]


def test_every_name_that_a_package_shows_is_there() -> None:
    from importlib import import_module

    for room in ROOMS:
        package = import_module(".".join(("six_wheel", *room.relative_to(PACKAGE).parts)))
        for name in getattr(package, "__all__", ()):
            assert getattr(package, name) is not None
        beside = set(getattr(package, "_BESIDE", ()))  # left out of `dir`, which is read on a first day
        assert set(getattr(package, "__all__", ())) - beside <= set(dir(package))
