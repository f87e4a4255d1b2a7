"""A gyroscope in logs on disk: columns and messages, how it sits, its own stamps, gaps, what commands do."""

import itertools
import math
import platform
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from rosbags.rosbag1 import Writer as Writer1
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import get_types_from_msg

from six_wheel.logs import JointLog, TableError, read_log
from six_wheel.logs.gyroscope.rates import Passing, Turning, edges_of, upward
from six_wheel.logs.headers.rate_columns import rate_columns
from six_wheel.logs.log_options import LogOptions
from six_wheel.simulation import write_log
from tests.logs.gyroscope_logs import STORE, STORE_1, header, make, simulated
from tests.rovers import CART

for kind in ("tf2_msgs/msg/TFMessage", "tf/msg/tfMessage"):  # which came before
    STORE_1.register(get_types_from_msg("geometry_msgs/TransformStamped[] transforms", kind))


# --- what a row gets -----------------------------------------------------------------------------------


def test_no_turn_is_lost_between_two_rates() -> None:
    """The trapezium over rows sums to what was integrated between the first row and the last."""
    random = np.random.default_rng(1)
    stamps = np.sort(random.uniform(0.0, 10.0, 1000))
    rates = np.sin(stamps) + random.normal(0.0, 0.1, 1000)
    rows = np.linspace(0.5, 9.5, 91) + random.uniform(-0.02, 0.02, 91)
    whole = Turning(iter([(stamps, rates)])).rates(edges_of(rows, None, None))
    turned = float(((whole[1:] + whole[:-1]) / 2.0 * np.diff(rows)).sum())
    (mean,) = Turning(iter([(stamps, rates)])).rates(rows[[0, -1]])
    assert turned == pytest.approx(mean * (rows[-1] - rows[0]), rel=1e-12)
    # In pieces of any length it is the same to the rounding of sums that begin elsewhere.
    pieces = Turning((stamps[k : k + 7], rates[k : k + 7]) for k in range(0, 1000, 7))
    cuts = [0, 1, 2, 30, 31, 91]
    found = []
    for first, last in itertools.pairwise(cuts):
        before = rows[first - 1] if first else None
        found.append(pieces.rates(edges_of(rows[first:last], before, rows[last] if last < 91 else None)))
    np.testing.assert_allclose(np.concatenate(found), whole, atol=1e-11)


def test_readings_at_the_rows_stay_what_they_are() -> None:
    stamps, rates = np.cumsum(np.full(50, 0.02)), np.random.default_rng(2).normal(size=50)
    found = Turning(iter([(stamps, rates)])).rates(edges_of(stamps, None, None))
    np.testing.assert_allclose(found, rates, rtol=1e-10, atol=1e-12)


def test_nothing_is_made_up_across_a_gap_and_beyond_the_ends() -> None:
    stamps = np.concatenate((np.arange(1.0, 3.0, 0.01), np.arange(3.6, 5.0, 0.01)))
    rows = np.arange(0.0, 6.0, 0.1)
    found = Turning(iter([(stamps, np.ones_like(stamps))])).rates(edges_of(rows, None, None))
    known = (rows > 1.04) & (rows < 4.95) & ~((rows > 2.93) & (rows < 3.66))
    np.testing.assert_array_equal(np.isfinite(found), known)
    np.testing.assert_allclose(found[known], 1.0)
    short = np.concatenate((np.arange(1.0, 3.0, 0.01), np.arange(3.4, 5.0, 0.01)))  # less than half a second
    found = Turning(iter([(short, np.ones_like(short))])).rates(edges_of(rows[15:45], None, None))
    assert np.isfinite(found).all()
    assert np.isnan(Turning(iter([])).rates(np.array([0.0, 1.0]))).all()


@given(
    steps=st.lists(st.integers(1, 700), min_size=2, max_size=60),
    apart=st.lists(st.integers(1, 900), min_size=1, max_size=12),
    begin=st.integers(-400, 400),
    seed=st.integers(0, 1000),
)
def test_reading_by_reading_it_is_the_same_to_the_bit(
    steps: list[int], apart: list[int], begin: int, seed: int
) -> None:
    """A joint message took a node ten times as long with a gyroscope as without, in arrays of two numbers."""
    # Whole milliseconds: so rows meet readings, and both sides of a gap.
    stamps = np.cumsum(steps) / 1000
    rates = np.random.default_rng(seed).normal(size=len(stamps))
    rows = (stamps[0] * 1000 + begin + np.cumsum([0, *apart])) / 1000
    arrays, passing, given_so_far = Turning(iter(())), Passing(), 0
    for start, end in itertools.pairwise(rows):
        so_far = int(np.searchsorted(stamps, end + 0.1))
        arrays.add(stamps[given_so_far:so_far], rates[given_so_far:so_far])
        for k in range(given_so_far, so_far):
            passing.add(float(stamps[k]), float(rates[k]))
        given_so_far = so_far
        found = passing.rate(float(start), float(end))
        (expected,) = arrays.rates(np.array([start, end]))
        # NumPy may fuse a product and a sum where the processor always can: not on x86.
        fused = platform.machine() not in ("x86_64", "AMD64")
        np.testing.assert_allclose(found, expected, rtol=0.0, atol=1e-12 if fused else 0.0)


def test_how_it_sits_is_that_of_a_rotation() -> None:
    roll, pitch = 0.3, -0.4
    about_x = np.array([[1, 0, 0], [0, math.cos(roll), -math.sin(roll)], [0, math.sin(roll), math.cos(roll)]])
    about_y = np.array(
        [[math.cos(pitch), 0, math.sin(pitch)], [0, 1, 0], [-math.sin(pitch), 0, math.cos(pitch)]]
    )
    np.testing.assert_allclose(upward(roll, pitch), (about_y @ about_x)[2], atol=1e-15)


# --- tables --------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("headers", "found"),
    [
        (["time", "yaw_rate"], {"rate": (1, "rad/s")}),
        (["time", "yaw rate [deg/s]", "angular_velocity_z"], {"rate": (1, "deg/s")}),
        (["imu/angular_velocity/z"], {"rate z": (0, "rad/s")}),
        (["gyro_x", "gyro_z"], {"rate x": (0, "rad/s"), "rate z": (1, "rad/s")}),
        (["omega", "wz", "gyro_x"], {}),  # a command's, an odometry's, or none about z
    ],
)  # fmt: skip
def test_which_columns_are_a_gyroscope(headers: list[str], found: dict[str, tuple[int, str]]) -> None:
    columns = rate_columns(headers)
    assert {name: (column.index, column.unit.symbol) for name, column in columns.items()} == found
    assert rate_columns(["yaw_rate"], {0: "deg/s"})["rate"].unit.symbol == "deg/s"


@pytest.mark.parametrize("ending", [".csv", ".parquet", ".mcap"])
def test_what_was_written_is_read(tmp_path: Path, ending: str) -> None:
    log, path = simulated(), tmp_path / f"log{ending}"
    write_log(log, CART, path)
    back, reader = read_log(path, CART)
    assert reader.warnings == []
    # A bag has stamps in whole nanoseconds, and a row is a mean over a twentieth of a second of them.
    np.testing.assert_allclose(back.yaw_rate, log.yaw_rate, rtol=1e-6, atol=1e-8)
    with JointLog(path, CART) as opened:
        parts = np.concatenate([part.yaw_rate for part in opened.chunks(37)])
    np.testing.assert_allclose(parts, back.yaw_rate, atol=1e-10)


def test_a_clock_of_its_own_a_scale_and_a_tilt_are_taken_off(tmp_path: Path) -> None:
    stamps = np.arange(0.0, 20.0, 0.02)
    turned = np.stack((stamps, stamps), axis=-1)

    def rate(times: np.ndarray) -> np.ndarray:
        return np.sin(times)

    up = upward(0.3, -0.4)
    axes = rate(stamps - 0.1)[:, None] * up / 1.02
    columns = np.column_stack((stamps, turned, axes))
    header = "time,left [rad],right [rad],gyro_x,gyro_y,gyro_z"
    np.savetxt(tmp_path / "log.csv", columns, delimiter=",", header=header, comments="", fmt="%.12g")
    keys = {"roll": 0.3, "pitch": -0.4, "scale": 1.02, "time_offset": 0.1}
    log, _ = read_log(tmp_path / "log.csv", CART, LogOptions(gyroscope=keys))
    there = np.isfinite(log.yaw_rate)
    assert (log.stamps[~there] > 19.8).all()
    # Means over 0.02 s of what bends by its second derivative: 0.02² / 24, and rounding of columns.
    np.testing.assert_allclose(log.yaw_rate[there][1:], rate(log.stamps[there][1:]), atol=1e-4)
    np.savetxt(tmp_path / "z.csv", columns[:, [0, 1, 2, 5]], delimiter=",", comments="",
               header="time,left [rad],right [rad],gyro_z")  # fmt: skip
    with pytest.raises(TableError, match=r"gyroscope.roll and gyroscope.pitch need the rates about all axes"):
        read_log(tmp_path / "z.csv", CART, LogOptions(gyroscope={"roll": 0.3}))


def test_a_reading_that_lacks_costs_no_row(tmp_path: Path) -> None:
    rows = [
        "time,left [rad],right [rad],yaw_rate [deg/s]",
        "0,0,0,90",
        "0.1,1,1,",
        "0.2,2,2,nan",
        "0.3,3,3,45",
    ]
    (tmp_path / "log.csv").write_text("\n".join(rows) + "\n")
    log, reader = read_log(tmp_path / "log.csv", CART)
    np.testing.assert_allclose(log.yaw_rate, (np.pi / 2, np.nan, np.nan, np.pi / 4))
    assert not reader.findings.rows


# --- bags ----------------------------------------------------------------------------------------------


def quaternion(turn: tuple[float, ...] = (0.0, 0.0, 0.0, 1.0)) -> Any:
    return make("geometry_msgs/msg/Quaternion", **dict(zip("xyzw", turn, strict=True)))


def vector(numbers: Any) -> Any:
    x, y, z = map(float, numbers)
    return make("geometry_msgs/msg/Vector3", x=x, y=y, z=z)


def imu(stamp: float, rates: Any, frame: str = "imu_link", known: bool = True) -> Any:
    none = np.zeros(9)
    none[0] = -1.0
    return make(
        "sensor_msgs/msg/Imu", header=header(stamp, frame), orientation=quaternion(),
        orientation_covariance=none, angular_velocity=vector(rates),
        angular_velocity_covariance=np.zeros(9) if known else none,
        linear_acceleration=vector((0, 0, 9.8)), linear_acceleration_covariance=np.zeros(9),
    )  # fmt: skip


def chain(*links: tuple[str, str, tuple[float, ...]]) -> Any:
    """Transforms that stay: child, parent and quaternion."""
    stamped = [
        make(
            "geometry_msgs/msg/TransformStamped", header=header(0.0, parent), child_frame_id=child,
            transform=make("geometry_msgs/msg/Transform", translation=vector((0.1, 0, 0.2)),
                           rotation=quaternion(turn)),
        )
        for child, parent, turn in links
    ]  # fmt: skip
    return make("tf2_msgs/msg/TFMessage", transforms=stamped)


def of_ros_1(message: Any) -> Any:
    """The same message there: its header counts, and frames began with a slash for long."""
    if hasattr(message, "transforms"):
        return replace(message, transforms=[of_ros_1(each) for each in message.transforms])
    kind, top = STORE_1.types["std_msgs/msg/Header"], message.header
    return replace(message, header=kind(0, top.stamp, f"/{top.frame_id}"))


def bag(path: Path, *more: tuple[str, float, Any], storage: str = "mcap") -> Path:
    """Joint states of two wheels at 20 Hz for 10 s, and other messages."""
    nothing = np.empty(0)
    messages: list[tuple[str, float, Any]] = [
        ("/joint_states", t, make("sensor_msgs/msg/JointState", header=header(t, ""),
                                  name=["left_wheel_joint", "right_wheel_joint"],
                                  position=np.array([t, t]), velocity=nothing, effort=nothing))
        for t in np.arange(0.0, 10.0, 0.05).tolist()
    ]  # fmt: skip
    first = storage == "ros 1"
    path = path.with_suffix(".bag") if first else path
    plugin = StoragePlugin.SQLITE3 if storage == "sqlite3" else StoragePlugin.MCAP
    made: Any = Writer1(path) if first else Writer(path, version=9, storage_plugin=plugin)
    store = STORE_1 if first else STORE
    with made as writer:
        connections: dict[str, Any] = {}
        for topic, stamp, message in sorted([*messages, *more], key=lambda one: one[1]):
            kind = "tf/msg/tfMessage" if topic == "/tf" else message.__msgtype__
            if topic not in connections:
                connections[topic] = writer.add_connection(topic, kind, typestore=store)
            data = (
                STORE_1.serialize_ros1(of_ros_1(message), kind)
                if first
                else STORE.serialize_cdr(message, kind)
            )
            writer.write(connections[topic], round(stamp * 1e9), data)
    return path


TIMES = np.arange(0.0, 10.1, 0.005)
HALF = math.sqrt(0.5)


@pytest.mark.parametrize(
    ("storage", "topic"),
    [("mcap", "/tf_static"), ("sqlite3", "/tf_static"), ("ros 1", "/tf_static"), ("ros 1", "/tf")],
)
def test_a_sensor_that_hangs_is_turned_by_the_transforms(tmp_path: Path, storage: str, topic: str) -> None:
    """On its side, on a plate that lies upside down: its y is down, the rover's z is its -y."""
    links = chain(("plate", "base_link", (1.0, 0.0, 0.0, 0.0)), ("imu_link", "plate", (HALF, 0.0, 0.0, HALF)))
    rates = [("/imu/data", t, imu(t, (9.0, -math.sin(t), 9.0))) for t in TIMES.tolist()]
    path = bag(tmp_path / "bag", (topic, 0.0, links), *rates, storage=storage)
    log, reader = read_log(path, CART)
    assert reader.warnings == []
    np.testing.assert_allclose(log.yaw_rate[1:-1], np.sin(log.stamps[1:-1]), atol=1e-3)  # means of 0.05 s
    level = LogOptions(gyroscope={"roll": 0.0})  # which has the last word
    assert read_log(path, CART, level)[0].yaw_rate[50] == pytest.approx(9.0)


def test_what_is_not_known_of_how_it_sits_is_said(tmp_path: Path) -> None:
    rates = [("/imu", t, imu(t, (0.0, 0.0, 0.5))) for t in TIMES.tolist()]
    log, reader = read_log(bag(tmp_path / "bag", *rates), CART)
    np.testing.assert_allclose(log.yaw_rate, 0.5)
    (said,) = reader.warnings
    assert "no transform tells how imu_link of /imu sits in the rover: its z is taken for the rover's" in said
    assert read_log(tmp_path / "bag", CART, LogOptions(gyroscope={"roll": 0.0}))[1].warnings == []
    assert read_log(tmp_path / "bag", CART, LogOptions(frame="imu_link"))[1].warnings == []


@pytest.mark.parametrize("storage", ["mcap", "sqlite3", "ros 1"])
def test_which_of_several(tmp_path: Path, storage: str) -> None:
    without = [("/camera/accel", t, imu(t, (0, 0, 0), known=False)) for t in TIMES.tolist()]
    one = [("/one", t, imu(t, (0, 0, 0.1), "base_link")) for t in TIMES.tolist()]
    two = [("/two", t, imu(t, (0, 0, 0.2), "base_link")) for t in TIMES.tolist()]
    alone = bag(tmp_path / "bag", *without, *one, storage=storage)
    log, _ = read_log(alone, CART)  # an accelerometer has no angular velocity
    np.testing.assert_allclose(log.yaw_rate, 0.1)
    both = bag(tmp_path / "both", *one, *two, storage=storage)
    log, reader = read_log(both, CART)
    assert log.yaw_rate is None
    assert "2 topics have angular velocities, /one, /two: none is read" in reader.warnings[0]
    log, _ = read_log(both, CART, LogOptions(gyroscope={"topic": "/two"}))
    np.testing.assert_allclose(log.yaw_rate, 0.2)
    with pytest.raises(TableError, match=r"gyroscope.topic must be one of /one, /two \(Imu\), got /three"):
        read_log(both, CART, LogOptions(gyroscope={"topic": "/three"}))


def test_messages_that_lack_leave_rows_without(tmp_path: Path) -> None:
    kept = TIMES[(TIMES < 4.0) | (TIMES > 5.0)]
    rates = [("/imu", t, imu(t, (0, 0, 0.5), "base_link")) for t in kept.tolist()]
    log, _ = read_log(bag(tmp_path / "bag", *rates), CART)
    lost = (log.stamps > 3.95) & (log.stamps < 5.05)
    np.testing.assert_array_equal(np.isnan(log.yaw_rate), lost)


# --- what commands do with it ----------------------------------------------------------------------------
