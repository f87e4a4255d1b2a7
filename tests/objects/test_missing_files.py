"""Hints at a file that may be meant, or at the folder that is missing."""

from pathlib import Path

import pytest

from six_wheel.robot_description.missing_files import no_file


@pytest.mark.parametrize(
    ("names", "given", "hint"),
    [
        (["Log.CSV"], "log.csv", '; did you mean "{}/Log.CSV"?'),
        (["map.tif", "a.csv"], "nothing.tif", "; there is {}/map.tif"),
        (["1.tif", "2.TIF"], "nothing.tif", "; there are {0}/1.tif, {0}/2.TIF"),
        (["1.tif", "2.tif", "3.tif", "4.tif"], "nothing.tif", ""),
        (["a.csv"], "nothing", ""),
        ([], "nothing.csv", ""),
        ([], "runs/log.csv", '; there is no folder "{}/runs"'),
        (["log.csv"], "log.csv/1.csv", '; there is no folder "{}/log.csv"'),
    ],
)
def test_hints(tmp_path: Path, names: list[str], given: str, hint: str) -> None:
    for name in names:
        (tmp_path / name).write_text("")
    assert no_file(tmp_path / given) == f"{tmp_path / given}: no such file{hint.format(tmp_path)}"
