"""The inner loop knows every crate, and finds the tests of what has changed."""

from pathlib import Path

import pytest

from tests import quick


def test_every_crate_has_python_tests() -> None:
    crates = {path.parent.name for path in (quick.ROOT / "rust").glob("*/Cargo.toml")} - {"fuzz"}
    assert set(quick.TESTS) == crates
    assert all(
        (quick.ROOT / "tests" / folder).is_dir() for folders in quick.TESTS.values() for folder in folders
    )


@pytest.mark.parametrize(
    ("file", "crates", "folders"),
    [
        ("rust/odometry/src/step.rs", ["odometry"], ["core/laws", "kinematics/odometry"]),
        ("rust/fuzz/doors/lib.rs", [], ["core/laws"]),
        ("python/six_wheel/logs/mcap/reader.py", [], ["core/laws", "logs"]),
        ("python/six_wheel/reference/planar/rover.py", [], ["core/laws"]),
        ("tests/control_loop/replay/test_replay.py", [], ["control_loop/replay", "core/laws"]),
        ("tests/house/test_docs.py", [], ["core/laws"]),
        ("tests/limits.py", [], ["core/laws"]),
        ("README.md", [], ["core/laws"]),
    ],
)
def test_tests_of_what_has_changed(
    file: str, crates: list[str], folders: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("CRATE", raising=False)
    monkeypatch.delenv("ROOM", raising=False)
    assert quick.touched([Path(file)]) == (crates, folders)
    monkeypatch.setenv("CRATE", "planner")
    monkeypatch.setenv("ROOM", "maps")
    assert quick.touched([Path(file)]) == (["planner"], ["core/laws", "core/planner", "maps"])
