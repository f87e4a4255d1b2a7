"""Writes reference/other_keys.md, the page of the keys of others' parameter files."""

from pathlib import Path

from six_wheel.robot_description.parameters.foreign.keys_page import page

if __name__ == "__main__":
    (Path(__file__).parent / "reference" / "other_keys.md").write_text(page(), encoding="utf-8")
