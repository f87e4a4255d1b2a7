"""The inner loop knows every crate, and finds the tests of what has changed."""

from pathlib import Path

import pytest

from tests import quick


def test_every_crate_has_python_tests() -> None:
    crates = {path.parent.name for path in (quick.ROOT / "rust").glob("*/Cargo.toml")} - {"fuzz"}
    assert set(quick.TESTS) == crates
    named = [*quick.SMOKE, *(test for tests in quick.TESTS.values() for test in tests)]
    assert [test for test in named if not (quick.ROOT / "tests" / test).exists()] == []


@pytest.mark.parametrize(
    ("file", "crates", "tests"),
    [
        ("rust/odometry/src/step.rs", ["odometry"], ["kinematics/odometry"]),
        ("rust/fuzz/doors/lib.rs", [], []),
        ("python/six_wheel/logs/mcap/reader.py", [], ["logs"]),
        ("python/six_wheel/reference/planar/rover.py", [], []),
        ("tests/control_loop/replay/test_replay.py", [], ["control_loop/replay/test_replay.py"]),
        ("tests/logs/carts.py", [], ["logs"]),
        ("tests/house/test_docs.py", [], ["house/test_docs.py"]),
        ("tests/house/snippets.py", [], []),
        ("tests/control_loop/ros2/test_node.py", [], []),
        ("tests/limits.py", [], []),
        ("README.md", [], []),
    ],
)
def test_tests_of_what_has_changed(
    file: str, crates: list[str], tests: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("CRATE", raising=False)
    monkeypatch.delenv("ROOM", raising=False)
    assert quick.touched([Path(file)]) == (crates, sorted([*quick.SMOKE, *tests]))
    monkeypatch.setenv("CRATE", "planner")
    monkeypatch.setenv("ROOM", "maps")
    assert quick.touched([Path(file)]) == (["planner"], sorted([*quick.SMOKE, "core/planner", "maps"]))


def test_a_folder_has_its_files(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("CRATE", "kinematics")
    monkeypatch.delenv("ROOM", raising=False)
    assert quick.touched([]) == (["kinematics"], ["core/laws"])
