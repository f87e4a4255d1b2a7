"""Rows of joint logs that cannot be used: each costs itself and no other, and memory does not grow."""

import math
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

pa = pytest.importorskip("pyarrow")
parquet = pytest.importorskip("pyarrow.parquet")

from six_wheel.logs import JointLog  # noqa: E402
from six_wheel.logs.headers.columns import TableError  # noqa: E402
from six_wheel.logs.plausibility.findings import MOST_FINDINGS  # noqa: E402
from tests.logs.carts import HEADER, write  # noqa: E402
from tests.rovers import CART  # noqa: E402

GOOD = [f"{k / 10},{k},{2 * k}\n" for k in range(8)]


def findings_of(path: Path, chunk_rows: int = 1000, **options) -> tuple[list[int], list[str]]:
    """The rows that are kept, and what is said of the others without the name of the file."""
    with JointLog(path, CART, **options) as log:
        kept = np.concatenate([part.rows for part in log.chunks(chunk_rows)]).tolist()
        assert all(
            str(each).startswith(f"{path}: row") and "\n" not in str(each) for each in log.findings.listed
        )
        return kept, [str(each).removeprefix(f"{path}: ") for each in log.findings.listed]


@pytest.mark.parametrize(
    ("row", "text", "words"),
    [
        (3, "0.2,nan,4\n", "row 3 (line 4): wheel left must be a finite number, got nan"),
        (3, "0.2,,4\n", "row 3 (line 4): wheel left must be a finite number, got nan"),
        (3, "0.2,2,inf\n", "row 3 (line 4): wheel right must be a finite number, got inf"),
        (3, ",2,4\n", "row 3 (line 4): time must be a number, got"),
        (3, "0.2,fast,4\n", 'row 3 (line 4): wheel left must be a number, got "fast" in column "left [rad]"'),
        (3, "0.2,2\n", "row 3 (line 4): a row must have 3 cells as the header has, got 2"),
        (3, "0.2,2,4,8\n", "row 3 (line 4): a row must have 3 cells as the header has, got 4"),
        (3, "\0\0\0\0\0\n", "row 3 (line 4): a row must have 3 cells as the header has, got 1"),
        (3, '0.2,"2,4\n', "row 3 (line 4): a row must have 3 cells"),
        (3, "0.1,2,4\n", "row 3 (line 4): time must increase, got the same twice: 0.1"),
        (3, "-5,2,4\n", "row 3 (line 4): time must increase, got -5.0 after 0.1"),
        (3, "5000,2,4\n", "row 3 (line 4): time must not run ahead, got 5000.0 before 0.3"),
        (1, "5000,2,4\n", "row 1 (line 2): time must not run ahead, got 5000.0 before 0.1"),
        (8, "0.7,7,1", "row 8 (line 9): the last row must end in a line end"),
        (8, "0.", "row 8 (line 9): the last row must end in a line end"),
        (8, "0.1,7,14\n", "row 8 (line 9): time must increase, got 0.1 after 0.6"),
    ],
    ids=str,
)  # fmt: skip
@pytest.mark.parametrize("chunk_rows", [1, 2, 3, 1000])
def test_a_bad_row_costs_that_row_and_no_other(
    tmp_path: Path, row: int, text: str, words: str, chunk_rows: int
) -> None:
    lines = [*GOOD]
    lines[row - 1] = text
    kept, findings = findings_of(write(tmp_path / "log.csv", HEADER + "".join(lines)), chunk_rows)
    assert kept == [k for k in range(1, 9) if k != row]
    assert len(findings) == 1
    assert findings[0].startswith(words)


@pytest.mark.parametrize("ending", [".csv", ".parquet"])
def test_the_same_in_parquet(tmp_path: Path, ending: str) -> None:
    columns = {"time": [0.0, 0.1, None, 0.3, 0.3, 0.2, 0.4], "left [rad]": [0.0, None, 2, 3, 4, 5, math.nan]}
    columns["right [rad]"] = [0.0] * 7
    path = tmp_path / f"log{ending}"
    if ending == ".parquet":
        parquet.write_table(pa.table(columns), path)
    else:
        cells = [
            ["" if cell is None else str(cell) for cell in row] for row in zip(*columns.values(), strict=True)
        ]
        write(path, HEADER + "".join(",".join(row) + "\n" for row in cells))
    kept, findings = findings_of(path)
    assert kept == [1, 4]
    assert [finding.partition(":")[0].split(" (")[0] for finding in sorted(findings)] == [
        "row 2", "row 3", "row 5", "row 6", "row 7"
    ]  # fmt: skip


def test_rows_are_counted_and_lines_are_those_of_an_editor(tmp_path: Path) -> None:
    text = "\n# " + HEADER + "\n0,0,0\r\n\r\n\n1,nan,1\n\n2,2,2\n3,x,3\n"
    kept, findings = findings_of(write(tmp_path / "log.csv", text))
    assert kept == [1, 3]
    assert [finding.partition(":")[0] for finding in sorted(findings)] == [
        "row 2 (line 7)",
        "row 4 (line 10)",
    ]


def test_rows_with_the_same_flaw_are_one_finding_and_memory_is_bounded(tmp_path: Path) -> None:
    count = 3 * MOST_FINDINGS
    back = "".join(f"{k / 1000},1,1\n" for k in range(count))
    path = write(tmp_path / "log.csv", HEADER + "0,0,0\n100,1,1\n" + back + "101,1,1\n")
    with pytest.raises(TableError, match="time goes back in row 3 and stays behind .* --no-plausibility"):
        findings_of(path)
    kept, findings = findings_of(path, plausibility=False)
    assert kept == [1, 2, count + 3]
    assert findings == [f"rows 3 (line 4) to {count + 2}: time must increase, got 0.0 after 100.0"]
    every_other = "".join(f"{k},{'nan' if k % 2 else k},1\n" for k in range(2 * count))
    with JointLog(write(path, HEADER + every_other), CART) as log:
        assert sum(len(part.rows) for part in log.chunks(1000)) == count
        assert (len(log.findings.listed), log.findings.rows) == (MOST_FINDINGS, count)


@given(
    cells=st.lists(
        st.sampled_from(["0", "1", "2.5", "", "nan", "x", '"', ",", "\n", " ", "-1e3", "\0"]), max_size=40
    ),
    chunk_rows=st.integers(1, 10),
)
def test_any_rows_are_read_or_reported(
    tmp_path_factory: pytest.TempPathFactory, cells: list[str], chunk_rows: int
) -> None:
    text = "".join(cells)
    path = write(tmp_path_factory.mktemp("rows") / "log.csv", HEADER + text)
    rows = [
        line for line in text.split("\n") if line.strip("\r") and (line.strip() or not text.endswith(line))
    ]
    with JointLog(path, CART) as log:
        try:
            parts = list(log.chunks(chunk_rows))
        except TableError as error:
            assert "at least one row" in str(error)  # noqa: PT017
            parts = []
        kept = sum(len(part.rows) for part in parts)
        assert kept + log.findings.rows == len(rows)
        for part in parts:
            assert np.isfinite(part.stamps).all()
            assert np.isfinite(part.wheel_angles).all()
        stamps = np.concatenate([np.empty(0), *(part.stamps for part in parts)])
        assert (np.diff(stamps) > 0).all()


def test_a_table_without_a_usable_row_says_why(tmp_path: Path) -> None:
    with (
        JointLog(write(tmp_path / "log.csv", HEADER + "0,nan,1\n"), CART) as log,
        pytest.raises(TableError, match=r"at least one row.*row 1 \(line 2\): wheel left must be a finite"),
    ):
        list(log.chunks())
    with (
        JointLog(write(tmp_path / "log.csv", HEADER + "1700000000123,1,1\n2700000000123,1,1\n"), CART) as log,
        pytest.raises(TableError, match="time must be in seconds unless its header states a unit"),
    ):
        list(log.chunks())


# --- memory ----------------------------------------------------------------------------------------------


PEAK_MEMORY = """
import re, sys
from pathlib import Path
import six_wheel as sw
from six_wheel.logs import JointLog
with JointLog(sys.argv[1], sw.Rover.differential(0.5, 0.1)) as log:
    rows = sum(len(part.rows) for part in log.chunks(10_000))
print(rows, log.findings.rows, re.search("VmHWM:\\s*(\\d+) kB", Path("/proc/self/status").read_text())[1])
"""


@pytest.mark.slow
@pytest.mark.skipif(
    not Path("/proc/self/status").exists(), reason="Linux says there what a process took at most"
)
def test_memory_does_not_grow_with_the_log(tmp_path: Path) -> None:
    peaks = []
    for count in (400_000, 1_200_000):
        lines = [f"{k / 100},{k},{k}\n" for k in range(count)]
        lines[count // 2] = "cut\n"
        path = write(tmp_path / "log.csv", HEADER + "".join(lines))
        arguments = [sys.executable, "-c", PEAK_MEMORY, path]
        done = subprocess.run(arguments, capture_output=True, text=True, check=True).stdout.split()
        assert done[:2] == [str(count - 1), "1"]
        peaks.append(int(done[2]) / 1024)
    assert path.stat().st_size > 25e6
    assert peaks[1] - peaks[0] < 12  # [MB]; the file has grown by 18 MB, its columns by 19
