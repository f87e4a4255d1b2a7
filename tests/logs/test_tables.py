"""Command tables: headers and units, every way a file can be wrong, and how it is reported."""

import csv
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

pa = pytest.importorskip("pyarrow")
parquet = pytest.importorskip("pyarrow.parquet")

from six_wheel.logs import Chunk, CommandTable, RowError, TableError  # noqa: E402
from six_wheel.logs.headers.columns import QUANTITIES, find_columns  # noqa: E402
from six_wheel.logs.tables import table_format  # noqa: E402


def write(path: Path, text: str | bytes) -> Path:
    path.write_bytes(text.encode() if isinstance(text, str) else text)
    return path


def read(path: Path, chunk_rows: int = 1000) -> tuple[np.ndarray, np.ndarray]:
    """Times and twists of a whole table."""
    with CommandTable(path) as table:
        chunks = list(table.chunks(chunk_rows))
    assert [chunk.first_row for chunk in chunks] == list(
        np.cumsum([1] + [len(chunk.stamps) for chunk in chunks[:-1]])
    )
    return np.concatenate([c.stamps for c in chunks]), np.concatenate([c.twists for c in chunks])


def error(path: Path, chunk_rows: int = 1000) -> str:
    """The message of a table that cannot be read: one line that begins with the file."""
    with pytest.raises(TableError) as caught:
        read(path, chunk_rows)
    message = str(caught.value)
    assert message.startswith(f"{path}: ")
    assert "\n" not in message
    return message.removeprefix(f"{path}: ")


# --- headers ---------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("header", "quantity", "symbol"),
    [
        ("time", "time", "s"),
        ("T", "time", "s"),
        ("sec", "time", "s"),
        ("time [s]", "time", "s"),
        ("time_s", "time", "s"),
        ("Timestamp (ms)", "time", "ms"),
        ("time_us", "time", "us"),
        ("t [µs]", "time", "us"),
        ("stamp_ns", "time", "ns"),
        ("nanoseconds", "time", "ns"),
        ("%time", "time", "s"),
        ("__time", "time", "s"),
        ("field.header.stamp", "time", "s"),
        ("vx", "vx", "m/s"),
        ("V", "vx", "m/s"),
        ("linear.x", "vx", "m/s"),
        ("linear_x", "vx", "m/s"),
        ("twist.linear.x", "vx", "m/s"),
        ("/cmd_vel/twist/linear/x", "vx", "m/s"),
        ("vx_mps", "vx", "m/s"),
        ("vx [mm/s]", "vx", "mm/s"),
        ("speed_km_h", "vx", "km/h"),
        ("vy", "vy", "m/s"),
        ("linear.y (cm/s)", "vy", "cm/s"),
        ("omega", "omega", "rad/s"),
        ("W", "omega", "rad/s"),
        ("angular.z", "omega", "rad/s"),
        ("yaw-rate", "omega", "rad/s"),
        ("omega_deg_s", "omega", "deg/s"),
        ("yaw_rate [deg/s]", "omega", "deg/s"),
        ("yaw_rate [°/s]", "omega", "deg/s"),
        ("turn_rate [rpm]", "omega", "rpm"),
    ],
)
def test_common_spellings_are_understood(header: str, quantity: str, symbol: str) -> None:
    others = [q.name for q in QUANTITIES if q.name != quantity]
    column = find_columns([*others, header])[quantity]
    assert (column.index, column.header, column.unit.symbol) == (3, header, symbol)


@pytest.mark.parametrize("spelling", [(q.name, s) for q in QUANTITIES for s in q.spellings], ids=str)
def test_no_spelling_means_two_quantities(spelling: tuple[str, str]) -> None:
    quantity, header = spelling
    columns = find_columns([header, *(q.name for q in QUANTITIES if q.name != quantity)])
    assert columns[quantity].index == 0
    assert len(columns) == len(QUANTITIES)


@pytest.mark.parametrize(
    ("headers", "words"),
    [
        ("vx,omega", ["no column for time", '"vx", "omega"', "known: time, t, stamp"]),
        ("time,vx,omga", ["no column for omega", 'did you mean "omga"?']),
        ("time,v_target,omega", ["no column for vx", "known: vx, v,"]),
        ("time,vx,linear.x,omega", ["vx must be in one column", '"vx" and "linear.x"']),
        ("time,stamp_ns,vx,omega", ["time must be in one column", '"time" and "stamp_ns"']),
        ("time,vx,vx,omega", ['"vx" and "vx"']),
        ("time,vx [furlong/s],omega", ['"vx [furlong/s]" must be one of m/s,', 'got "furlong/s"']),
        ("0,0.5,0,0.1", ["the first line must name the columns", '"0,0.5,0,0.1"']),
    ],
)
def test_columns_that_are_missing_or_open_are_named(tmp_path: Path, headers: str, words: list[str]) -> None:
    message = error(write(tmp_path / "c.csv", f"{headers}\n0,0,0,0\n"))
    for word in words:
        assert word in message


def test_a_voltage_beside_the_speed_is_not_taken_for_it() -> None:
    columns = find_columns(["time", "V [V]", "vx", "omega"])
    assert columns["vx"].header == "vx"


# --- what is read ----------------------------------------------------------------------------------------


def test_units_become_si(tmp_path: Path) -> None:
    path = write(
        tmp_path / "c.csv", "time_ms,vx [mm/s],vy [cm/s],yaw_rate [deg/s]\n0,500,10,180\n20,-36,0,-90\n"
    )
    time, twists = read(path)
    np.testing.assert_array_equal(time, [0, 20])
    np.testing.assert_allclose(twists, [[0.5, 0.1, np.pi], [-0.036, 0, -np.pi / 2]], rtol=1e-15)


@pytest.mark.parametrize(
    "text",
    [
        "time,vx,omega\n0,0.5,0.1\n1,0.5,-0.1\n",
        "time,vx,omega\r\n0,0.5,0.1\r\n1,0.5,-0.1\r\n",
        "time;vx;omega\n0;0.5;0.1\n1;0.5;-0.1\n",
        "time\tvx\tomega\n0\t0.5\t0.1\n1\t0.5\t-0.1\n",
        '"time", "vx", "omega"\n"0","0.5","0.1"\n1, 0.5, -0.1\n',
        "\ufefftime,vx,omega\n0,0.5,0.1\n1,0.5,-0.1\n",
        "# time,vx,omega\n0,+0.5,1e-1\n1.,.5,-0.1\n",
        "\ntime,vx,omega\n\n0,0.5,0.1\n\n\n1,0.5,-0.1\n\n",
        "note,omega,time,note,vx\na,0.1,0,b,0.5\n,-0.1,1,,0.5\n",
    ],
    ids=[
        "as written",
        "crlf",
        "semicolons",
        "tabs",
        "quoted",
        "bom",
        "savetxt",
        "blank lines",
        "other columns",
    ],
)
def test_csv_dialects(tmp_path: Path, text: str) -> None:
    time, twists = read(write(tmp_path / "c.csv", text))
    np.testing.assert_array_equal(time, [0, 1])
    np.testing.assert_array_equal(twists, [[0.5, 0, 0.1], [0.5, 0, -0.1]])


def test_a_header_in_capitals_and_an_ending_in_capitals(tmp_path: Path) -> None:
    time, _ = read(write(tmp_path / "C.CSV", "TIME,VX,OMEGA\n0,1,0\n"))
    assert time == [0]


@pytest.mark.parametrize("ending", [".csv", ".parquet"])
def test_nanoseconds_keep_every_digit(tmp_path: Path, ending: str) -> None:
    stamps = 1_700_000_000_123_456_789 + np.arange(5)
    path = tmp_path / f"c{ending}"
    if ending == ".csv":
        rows = "".join(f"{stamp},0.5,0.1\n" for stamp in stamps)
        write(path, "stamp_ns,vx,omega\n" + rows)
    else:
        parquet.write_table(pa.table({"stamp_ns": stamps, "vx": [0.5] * 5, "omega": [0.1] * 5}), path)
    time, _ = read(path, chunk_rows=2)
    assert time.dtype == np.int64
    np.testing.assert_array_equal(time, stamps)


@pytest.mark.parametrize(
    ("column", "symbol", "first"),
    [
        (pa.array([0.5, 1.5]), "s", 0.5),
        (pa.array([1, 2], pa.int32()), "s", 1),
        (pa.array([1, 2], pa.uint64()), "s", 1),
        (pa.array([0.5, 1.5], pa.float32()), "s", 0.5),
        (pa.array([10**18, 10**18 + 1], pa.timestamp("ns")), "ns", 10**18),
        (pa.array([10**15, 10**15 + 1], pa.timestamp("us", "UTC")), "us", 10**15),
        (pa.array([5, 6], pa.duration("ms")), "ms", 5),
    ],
    ids=lambda value: str(getattr(value, "type", value)),
)
def test_parquet_time_types(tmp_path: Path, column: "pa.Array", symbol: str, first: float) -> None:
    path = tmp_path / "c.parquet"
    parquet.write_table(
        pa.table({"time": column, "vx": pa.array([1, 2], pa.int8()), "omega": [0.0, 0.0]}), path
    )
    with CommandTable(path) as table:
        assert table.time_unit.symbol == symbol
    time, twists = read(path)
    assert time[0] == first
    np.testing.assert_array_equal(twists[:, 0], [1, 2])


@given(rows=st.integers(1, 40), chunk_rows=st.integers(1, 50))
def test_chunks_are_never_larger_and_leave_nothing_out(
    tmp_path_factory: pytest.TempPathFactory, rows: int, chunk_rows: int
) -> None:
    folder = tmp_path_factory.mktemp("chunks")
    numbers = np.arange(3.0 * rows).reshape(rows, 3)
    lines = "".join(",".join(map(repr, row)) + "\n" for row in numbers.tolist())
    csv_file = write(folder / "c.csv", "time,vx,omega\n" + lines)
    parquet.write_table(
        pa.table(dict(zip(("time", "vx", "omega"), numbers.T, strict=True))), folder / "c.parquet"
    )
    for path in (csv_file, folder / "c.parquet"):
        with CommandTable(path) as table:
            chunks: list[Chunk] = list(table.chunks(chunk_rows))
            assert table.position == table.size
        assert max(len(chunk.stamps) for chunk in chunks) <= chunk_rows
        np.testing.assert_array_equal(np.concatenate([chunk.stamps for chunk in chunks]), numbers[:, 0])
        twists = np.concatenate([chunk.twists for chunk in chunks])
        np.testing.assert_array_equal(twists[:, [0, 2]], numbers[:, 1:])


# --- what is wrong ---------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("rows", "words"),
    [
        ("0,1,0\n1,nan,0\n", 'row 2 (line 3): vx must be finite, got nan in column "vx"'),
        ("0,1,0\n1,1,inf\n", 'row 2 (line 3): omega must be finite, got inf in column "omega"'),
        ("0,1,0\n1,1,1e400\n", "row 2 (line 3): omega must be finite, got inf"),
        ("0,1,0\nnan,1,0\n", "row 2 (line 3): time must be finite, got nan"),
        ("0,1,0\n1,,0\n", 'row 2 (line 3): vx must be a number, got an empty cell in column "vx"'),
        ("0,1,0\n1,fast,0\n", 'row 2 (line 3): vx must be a number, got "fast" in column "vx"'),
        ("0,1,0\n1,1_0,0\n", 'got "1_0"'),
        ("0,1,0\n1,0x1,0\n", 'got "0x1"'),
        ("0,1,0\n1,N/A,0\n", 'got "N/A"'),
        ("0,1,0\n\n\n1,fast,0\n", "row 2 (line 5): vx must be a number"),
        ("0,1,0\n\n1,nan,0\n", "row 2 (line 4): vx must be finite"),
        ("1,1,0\n1,1,0\n", "row 2 (line 3): time must increase, got 1.0 after 1.0"),
        ("1,1,0\n2,1,0\n1.5,1,0\n", "row 3 (line 4): time must increase, got 1.5 after 2.0"),
        (
            "0,1,0\n1,1\n",
            "row 2 (line 3): a row must have 3 cells as the header has, got 2; is the file cut off?",
        ),
        ("0,1,0\n1,1,0,5\n", "row 2 (line 3): a row must have 3 cells as the header has, got 4"),
        ("", "the table must have at least one row under its header, got none"),
        (
            "1700000000123456789,1,0\n",
            'time must be in seconds unless its header states a unit, such as "time_ns"',
        ),
    ],
)
@pytest.mark.parametrize("chunk_rows", [1, 1000])
def test_bad_rows_name_row_line_rule_and_value(
    tmp_path: Path, rows: str, words: str, chunk_rows: int
) -> None:
    assert words in error(write(tmp_path / "c.csv", "time,vx,omega\n" + rows), chunk_rows)


def test_a_bad_row_far_into_a_file_has_its_own_line(tmp_path: Path) -> None:
    rows = [f"{k},0.5,0.1" for k in range(50_000)]
    rows[43_210] = "43210,0.5,oops"
    path = write(tmp_path / "c.csv", "time,vx,omega\n" + "\n".join(rows) + "\n")
    assert error(path, 5000).startswith('row 43211 (line 43212): omega must be a number, got "oops"')
    rows[43_210] = "0,0.5,0.1"
    write(path, "time,vx,omega\n" + "\n".join(rows) + "\n")
    assert error(path, 5000) == "row 43211 (line 43212): time must increase, got 0.0 after 43209.0"


def test_the_first_bad_row_is_named_whatever_its_column(tmp_path: Path) -> None:
    path = write(tmp_path / "c.csv", "time,vx,omega\n0,1,0\n1,1,nan\nnan,1,1\n")
    assert error(path).startswith("row 2 (line 3): omega")


def test_nanoseconds_must_stay_whole(tmp_path: Path) -> None:
    path = write(tmp_path / "c.csv", "time_ns,vx,omega\n1700000000123456789,1,0\n1700000000123456790.5,1,0\n")
    assert "row 2 (line 3): time must be a whole number of nanoseconds, got" in error(path)


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"", "got an empty file"),
        (b"\n\n", "the header must be a line of text, got none"),
        (b"\xff\xfet\x00i\x00m\x00e\x00", "no column for vx"),
        (b"\x00\x01\x02\x03\n", "the header must be a line of text"),
    ],
)
def test_files_that_are_no_csv(tmp_path: Path, content: bytes, words: str) -> None:
    assert words in error(write(tmp_path / "c.csv", content))


@given(content=st.binary(max_size=200))
def test_any_bytes_are_read_or_refused_in_one_line(
    tmp_path_factory: pytest.TempPathFactory, content: bytes
) -> None:
    folder = tmp_path_factory.mktemp("bytes")
    for path in (folder / "c.csv", folder / "c.parquet"):
        error(write(path, content))


@given(
    cells=st.lists(
        st.sampled_from(["0", "1", "2.5", "", "nan", "x", '"', ",", "\n", " ", "-1e3"]), max_size=25
    )
)
def test_any_rows_are_read_or_refused_in_one_line(
    tmp_path_factory: pytest.TempPathFactory, cells: list[str]
) -> None:
    path = write(tmp_path_factory.mktemp("rows") / "c.csv", "t,v,w\n" + "".join(cells))
    try:
        time, twists = read(path, 2)
    except TableError:
        error(path, 2)  # in one line
    else:
        assert np.isfinite(twists).all()
        assert (np.diff(time) > 0).all()


def test_a_file_without_a_last_line_end_is_read_with_a_warning(tmp_path: Path) -> None:
    with CommandTable(write(tmp_path / "c.csv", "time,vx,omega\n0,1,0\n1,1,0.")) as table:
        assert "is the file complete?" in table.warnings[0]
    with CommandTable(write(tmp_path / "c.csv", "time,vx,omega\n0,1,0\n1,1,0.\n")) as table:
        assert table.warnings == []


def test_parquet_errors(tmp_path: Path) -> None:
    path = tmp_path / "c.parquet"
    good = {"time": [0.0, 1.0, 2.0], "vx": [1.0, 1.0, 1.0], "omega": [0.0, 0.0, 0.0]}
    parquet.write_table(pa.table(good), path)
    write(path, path.read_bytes()[:-20])
    assert "not a readable Parquet file" in error(path)
    parquet.write_table(pa.table({**good, "vx": ["a", "b", "c"]}), path)
    assert error(path) == 'vx must be numbers, got string in column "vx"'
    parquet.write_table(pa.table({**good, "vx": [1.0, None, 1.0]}), path)
    assert error(path).startswith("row 2: vx must be a number, got an empty cell")
    parquet.write_table(pa.table({**good, "time": [0.0, 2.0, 1.0]}), path)
    assert error(path) == "row 3: time must increase, got 1.0 after 2.0"
    parquet.write_table(pa.table({**good, "vx": [1.0, 1.0, np.inf]}), path)
    assert error(path).startswith("row 3: vx must be finite, got inf")
    parquet.write_table(pa.table(good).slice(0, 0), path)
    assert "at least one row" in error(path)
    parquet.write_table(pa.table({"time": [0.0]}), path)
    assert "no column for vx" in error(path)


def test_paths_that_are_no_tables(tmp_path: Path) -> None:  # long headers took a quarter of an hour
    assert error(tmp_path / "none.csv") == "no such file"
    (tmp_path / "folder.csv").mkdir()
    assert error(tmp_path / "folder.csv") == "not a file"
    assert error(write(tmp_path / "c.xlsx", "x")) == 'the ending must be .csv or .parquet, got ".xlsx"'
    assert table_format(Path("a.b.PARQUET")) == "parquet"
    for text in (9999 * " [", f"a [{' ' * 60_000}x", f"x [rad{' ' * 60_000}y"):
        assert error(write(tmp_path / "c.csv", text)).startswith("no column for time among")


def test_row_errors_count_from_one() -> None:
    assert str(RowError(17, "time must increase")) == "row 17: time must increase"


def test_a_header_with_commas_in_quotes(tmp_path: Path) -> None:
    path = tmp_path / "c.csv"
    with path.open("w", newline="") as file:
        csv.writer(file).writerows([["note, long", "time", "vx", "omega"], ["a, b", 0, 1, 0]])
    time, twists = read(path)
    assert time == [0]
    np.testing.assert_array_equal(twists, [[1, 0, 0]])


def test_an_endless_line_is_refused(tmp_path: Path) -> None:
    path = write(tmp_path / "c.csv", "time,vx,omega\n" + "0,1,0\n1,1,0\n2,1,0" + "0" * 300_000)
    assert error(path, 10) == "row 3 (line 4): a line must be shorter than 65536 bytes"


@pytest.mark.parametrize("ending", ["\n", "\r\n"])
def test_blocks_of_a_long_table_meet_without_a_seam(tmp_path: Path, ending: str) -> None:
    # lines of many lengths
    numbers = np.cumsum(np.random.default_rng(2).uniform(0.1, 9.0, (20_000, 3)), axis=0)
    lines = ["time,vx,omega", *(",".join(map(repr, row)) for row in numbers.tolist())]
    path = write(tmp_path / "c.csv", ending.join(lines))
    positions = []
    with CommandTable(path) as table:
        for chunk in table.chunks(500):
            np.testing.assert_array_equal(
                chunk.stamps, numbers[chunk.first_row - 1 :, 0][: len(chunk.stamps)]
            )
            positions.append(table.position)
    assert positions == sorted(positions)
    assert positions[0] < table.size / 10  # progress says what has been driven, not what has been read ahead
    time, twists = read(path, 500)
    np.testing.assert_array_equal(time, numbers[:, 0])
    np.testing.assert_array_equal(twists[:, [0, 2]], numbers[:, 1:])
