"""ROS 2 bags, written here with rosbags itself: joints in any order and message, poses, commands out."""

import re
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from rosbags.highlevel import AnyReader
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

import six_wheel as sw
from six_wheel.kinematics.errors import TableError
from six_wheel.logs import JointLog, read_truth
from six_wheel.logs.bags.joint_bag import JOINT_STATE
from six_wheel.logs.bags.messages import POSES
from six_wheel.robot_description.parameters import dump
from six_wheel.simulation.drive import drive
from tests.logs.bag_messages import START, motion
from tests.rovers import CART
from tests.rovers import SIX_WHEELS as ROVER
from tests.strategies import at_most

STORE = get_typestore(Stores.ROS2_HUMBLE)
TYPES = STORE.types
STORAGES = {"sqlite3": StoragePlugin.SQLITE3, "mcap": StoragePlugin.MCAP}


def header(stamp: int) -> Any:
    time = TYPES["builtin_interfaces/msg/Time"](*divmod(stamp, 10**9)) if stamp else None
    return TYPES["std_msgs/msg/Header"](time or TYPES["builtin_interfaces/msg/Time"](0, 0), "base_link")


def joints(
    stamp: int, names: Sequence[str], positions: Sequence[float] = (), velocities: Sequence[float] = ()
) -> Any:
    arrays = (np.array(values, dtype=float) for values in (positions, velocities, ()))
    return TYPES[JOINT_STATE](header(stamp), list(names), *arrays)


def pose_of(kind: str, stamp: int, x: float, y: float, yaw: float) -> Any:
    point, vector = TYPES["geometry_msgs/msg/Point"](x, y, 0.1), TYPES["geometry_msgs/msg/Vector3"](x, y, 0.1)
    turned = TYPES["geometry_msgs/msg/Quaternion"](0.0, 0.0, np.sin(yaw / 2), np.cos(yaw / 2))
    pose = TYPES["geometry_msgs/msg/Pose"](point, turned)
    with_covariance = TYPES["geometry_msgs/msg/PoseWithCovariance"](pose, np.zeros(36))
    zero = TYPES["geometry_msgs/msg/Vector3"](0.0, 0.0, 0.0)
    twist = TYPES["geometry_msgs/msg/TwistWithCovariance"](
        TYPES["geometry_msgs/msg/Twist"](zero, zero), np.zeros(36)
    )
    transform = TYPES["geometry_msgs/msg/Transform"](vector, turned)
    fields = {
        "nav_msgs/msg/Odometry": ("base_link", with_covariance, twist),
        "geometry_msgs/msg/PoseStamped": (pose,),
        "geometry_msgs/msg/PoseWithCovarianceStamped": (with_covariance,),
        "geometry_msgs/msg/TransformStamped": ("base_link", transform),
    }
    return TYPES[kind](header(stamp), *fields[kind])


Message = tuple[str, int, Any]  # topic, when it was received [ns], content


def write(path: Path, messages: Sequence[Message], storage: str = "mcap") -> Path:
    """A bag; the messages in the order in which they came."""
    with Writer(path, version=9, storage_plugin=STORAGES[storage]) as writer:
        connections: dict[str, Any] = {}
        for topic, received, message in messages:
            kind = message.__msgtype__
            if topic not in connections:
                connections[topic] = writer.add_connection(topic, kind, typestore=STORE)
            writer.write(connections[topic], received, STORE.serialize_cdr(message, kind))
    return path


def states(messages: Sequence[Any], topic: str = "/joint_states") -> list[Message]:
    return [(topic, START + 1000 * k, message) for k, message in enumerate(messages)]


def read(path: Path, rover: sw.Rover, chunk_rows: int = 1000, **options: Any) -> tuple[np.ndarray, ...]:
    with JointLog(path, rover, **options) as log:
        parts = list(log.chunks(chunk_rows))
    joined = [np.concatenate([getattr(p, n) for p in parts]) for n in ("rows", "stamps", "wheel_angles")]
    return *joined, None if parts[0].steering is None else np.concatenate([p.steering for p in parts])


# --- joints ----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("storage", STORAGES)
@pytest.mark.parametrize("chunk_rows", [1, 7, 1000])
def test_joints_in_any_order(tmp_path: Path, storage: str, chunk_rows: int) -> None:
    stamps, steering, wheels = motion(40)
    names = [*ROVER.steering_joints, "mast_pan_joint", *ROVER.traction_joints]
    values = np.hstack([steering, np.full((40, 1), np.nan), wheels])
    generator = np.random.default_rng(1)
    messages = []
    for stamp, row in zip(stamps.tolist(), values, strict=True):
        order = generator.permutation(len(names))
        messages.append(joints(stamp, [names[k] for k in order], row[order]))
    bag = write(tmp_path / "bag", states(messages), storage)
    for path in (bag, next(bag.glob("*.mcap" if storage == "mcap" else "*.db3"))):
        rows, seconds, angles, steered = read(path, ROVER, chunk_rows)
        np.testing.assert_array_equal(rows, np.arange(1, 41))
        np.testing.assert_array_equal(seconds, (stamps - START) / 1e9)
        np.testing.assert_array_equal(angles, wheels)
        np.testing.assert_array_equal(steered, steering)


@at_most(30)
@given(order=st.randoms(use_true_random=False), chunk_rows=st.integers(1, 30), topics=st.booleans())
def test_joints_in_messages_of_their_own(
    tmp_path_factory: pytest.TempPathFactory, order: Any, chunk_rows: int, topics: bool
) -> None:
    # Even growth is interpolated exactly; every joint has its own rate and phase.
    rate, messages = 2.0, []
    phases = dict(
        zip([*ROVER.traction_joints, *ROVER.steering_joints], order.sample(range(50), 10), strict=True)
    )
    for k, (joint, phase) in enumerate(phases.items()):
        every = 50 + 5 * k  # [ms]
        for time in range(phase, 2000, every):
            value = 0.1 * rate * time / 1e3 if joint in ROVER.steering_joints else (k + 1) * rate * time / 1e3
            topic = "/steering/joint_states" if topics and joint in ROVER.steering_joints else "/joint_states"
            messages.append((topic, START + time * 10**6, joints(START + time * 10**6, [joint], [value])))
    messages.sort(key=lambda message: message[1])
    path = write(tmp_path_factory.mktemp("bag") / "bag", messages)
    _, seconds, angles, steered = read(path, ROVER, chunk_rows)
    # From the first message of the slowest joint to the last one of it, at the rate of the first.
    assert 36 <= len(seconds) <= 40
    np.testing.assert_allclose(np.diff(seconds), 0.05, atol=1e-9)
    np.testing.assert_allclose(angles, seconds[:, None] * rate * np.arange(1, 7), rtol=1e-12)
    np.testing.assert_allclose(steered, 0.1 * rate * np.tile(seconds[:, None], 4), rtol=1e-12)


@pytest.mark.parametrize(("value", "warned"), [(100.0, False), (0.25, True)])
def test_radians_that_are_taken_for_counts_are_warned_of(tmp_path: Path, value: float, warned: bool) -> None:
    """A file with a resolution made 3 mm of 17 m without a word: messages have no units."""
    names = list(CART.traction_joints)
    messages = [joints(START + k * 100_000_000, names, [k * value, 2 * k * value]) for k in range(11)]
    with JointLog(write(tmp_path / "bag", states(messages)), CART, wheel_encoders=sw.Encoder(1000)) as log:
        log.read()
        said = [one for one in log.warnings if "no whole numbers: leave it out if they are in radians" in one]
    assert len(said) == warned


def test_velocities_alone_and_both(tmp_path: Path) -> None:
    names = list(CART.traction_joints)
    stamps = [START + k * 100_000_000 for k in range(11)]
    speeds = write(tmp_path / "speeds", states([joints(s, names, velocities=[1, -2]) for s in stamps]))
    both = write(tmp_path / "both", states([joints(s, names, [5, 6], [1, -2]) for s in stamps]))
    for path, options in ((speeds, {}), (both, {"readings": "speeds"})):
        _, _, angles, steering = read(path, CART, 3, **options)
        assert steering is None
        np.testing.assert_allclose(angles[-1], [1, -2], rtol=1e-14)
    np.testing.assert_array_equal(read(both, CART)[2], np.tile([5, 6], (11, 1)))
    with pytest.raises(TableError, match="wheels must be read in one way, all as angles, got wheel left"):
        JointLog(speeds, CART, readings="angles")


def test_a_message_without_a_stamp_has_the_time_it_came(tmp_path: Path) -> None:
    messages = [joints(0, ["left", "right"], [k, k]) for k in range(3)]
    _, seconds, angles, _ = read(write(tmp_path / "bag", states(messages)), CART)
    np.testing.assert_allclose(seconds, [0, 1e-6, 2e-6], rtol=1e-15)
    assert angles.shape == (3, 2)


# --- what cannot be used ---------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("stamp", "value", "words"),
    [
        (2, np.nan, "row 4: every joint must have a finite value, got nan"),
        (2, 3.0, "row 4: stamps must increase, got"),
        (1, 3.0, "row 4: stamps must increase, got"),
        (3600, 3.0, "row 4: stamps must not run ahead, got"),
    ],
)
@pytest.mark.parametrize("chunk_rows", [1, 2, 1000])
def test_a_bad_message_costs_that_message(
    tmp_path: Path, stamp: int, value: float, words: str, chunk_rows: int
) -> None:
    times = [0, 1, 2, stamp, 4, 5]
    messages = [
        joints(START + t * 10**8, ["left", "right"], [value if k == 3 else k, k]) for k, t in enumerate(times)
    ]
    with JointLog(write(tmp_path / "bag", states(messages)), CART) as log:
        kept = np.concatenate([part.rows for part in log.chunks(chunk_rows)])
        assert kept.tolist() == [1, 2, 3, 5, 6]
        assert [str(each).startswith(f"{tmp_path / 'bag'}: {words}") for each in log.findings.listed] == [
            True
        ]


@pytest.mark.parametrize("chunk_rows", [5, 1000])
def test_nothing_is_invented_where_a_joint_is_silent(tmp_path: Path, chunk_rows: int) -> None:
    messages = [
        joints(
            START + k * 10**8, ["left"] if 30 < k < 60 else ["left", "right"], [k] if 30 < k < 60 else [k, k]
        )
        for k in range(100)
    ]
    with JointLog(write(tmp_path / "bag", states(messages)), CART) as log:
        parts = list(log.chunks(chunk_rows))
        kept = np.concatenate([part.rows for part in parts])
        assert kept.tolist() == [*range(1, 32), *range(61, 101)]
        assert log.findings.rows == 29
        assert str(log.findings.listed[0]).endswith(
            "rows 32 to 60: wheel right must be a finite number, got nan"
        )


def test_joints_that_are_missing_are_named(tmp_path: Path) -> None:
    cart = write(tmp_path / "cart", states([joints(START, ["left", "arm"], [1, 2])]))
    with pytest.raises(TableError, match="no position of joint front_left_steering_joint among left, arm"):
        JointLog(cart, ROVER)
    arm = write(tmp_path / "arm", states([joints(START, ["arm"], [1])]))
    with pytest.raises(TableError, match=r"no joint of any wheel \(left_wheel_joint.* among arm"):
        JointLog(arm, CART)
    with JointLog(cart, CART) as log:
        assert log.warnings == [f"{cart}: no readings of right: taken as without encoder"]
        (rows,) = log.chunks()
        np.testing.assert_array_equal(rows.wheel_angles, [[1, np.nan]])


def test_topics_are_chosen_or_named(tmp_path: Path) -> None:
    both = [
        *states([joints(START, ["left"], [1])], "/left"),
        *states([joints(START, ["right"], [2])], "/right"),
    ]
    bag = write(tmp_path / "bag", both)
    with pytest.raises(
        TableError, match=r"the topic must be one of /left, /right \(JointState\), got no choice"
    ):
        JointLog(bag, CART)
    with pytest.raises(TableError, match="got /middle"):
        JointLog(bag, CART, topics=["/left", "/middle"])
    np.testing.assert_array_equal(read(bag, CART, topics=["/left", "/right"])[2], [[1, 2]])
    with pytest.raises(TableError, match="no topic has messages of the type Odometry"):
        read_truth(bag)


@pytest.mark.parametrize("storage", STORAGES)
def test_bags_that_are_none(tmp_path: Path, storage: str) -> None:
    with pytest.raises(TableError, match="no such file"):
        JointLog(tmp_path / "none.mcap", CART)
    (tmp_path / "empty").mkdir()
    with pytest.raises(TableError, match=r"empty: the folder must hold metadata.yaml or .mcap or .db3 files"):
        JointLog(tmp_path / "empty", CART)
    messages = [joints(START + k, ["left"], [k]) for k in range(1000)]
    bag = write(tmp_path / "bag", states(messages), storage)
    (file,) = [path for path in bag.iterdir() if path.suffix != ".yaml"]
    whole = file.read_bytes()
    for part in (0, 100, len(whole) // 2, len(whole) - 50):
        file.write_bytes(whole[:part])
        message = f"{bag}"
        try:
            with JointLog(bag, CART) as log:
                rows = sum(len(each.rows) for each in log.chunks())
                # sqlite may not notice until it gets there; what is before is kept and the rest reported.
                assert rows == 1000 or log.findings.rows
        except TableError as error:
            message = str(error)
        assert message.startswith(f"{bag}")
        assert "\n" not in message


LONG = 30_000  # messages, in blocks of 2^20 bytes


@pytest.fixture(scope="module")
def long_recording(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    messages = [joints(START + k * 10**6, ["left", "right"], [k, -k]) for k in range(LONG)]
    (file,) = write(tmp_path_factory.mktemp("long") / "bag", states(messages)).glob("*.mcap")
    return file.read_bytes()


@pytest.mark.parametrize("share", [0.4, 0.7, 0.999])
def test_a_recorder_that_lost_power_leaves_what_is_whole(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, long_recording: bytes, share: float
) -> None:
    (tmp_path / "temporary").mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path / "temporary"))
    bag = tmp_path / "bag"
    bag.mkdir()
    (bag / "bag_0.mcap").write_bytes(long_recording[: int(share * len(long_recording))])
    for path in (bag, bag / "bag_0.mcap"):
        with JointLog(path, CART, plausibility=False) as log:
            rows = np.concatenate([part.rows for part in log.chunks(1000)])
            flaws = [str(each) for each in log.findings.listed]
        np.testing.assert_array_equal(rows, np.arange(1, len(rows) + 1))
        # All but the block that was cut, of 2^20 bytes and an index of 16 bytes a message.
        assert share * LONG - 1.3 * 2**20 / len(long_recording) * LONG < len(rows) <= LONG
        assert flaws == [f"{path}: row {len(rows) + 1}: the recording was cut off here"]
        assert list((tmp_path / "temporary").iterdir()) == []


# --- truth -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("kind", POSES)
@pytest.mark.parametrize("storage", STORAGES)
def test_poses_beside_the_joints(tmp_path: Path, kind: str, storage: str) -> None:
    poses = np.array([[0, 0, 0], [1, 0.5, 3.1], [2, 1.5, -3.0]])
    messages = states([joints(START + k * 10**9, ["left", "right"], [k, k]) for k in range(3)])
    messages += [
        ("/mocap", START + k * 10**9 + 7, pose_of(kind, START + k * 10**9 + 5 * 10**8, *pose))
        for k, pose in enumerate(poses)
    ]
    bag = write(tmp_path / "bag", messages, storage)
    with JointLog(bag, CART, plausibility=False) as joint_log:
        log = joint_log.read(truth=bag, truth_topic="/mocap")
    np.testing.assert_array_equal(log.truth.stamps, [0.5, 1.5, 2.5])
    np.testing.assert_allclose(log.truth.poses, poses, rtol=0, atol=1e-15)
    assert log.stamps.tolist() == [0, 1, 2]


def test_the_page_on_logs_shows_what_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    page = (Path(__file__).parents[2] / "docs" / "howto" / "logs.md").read_text(encoding="utf-8")
    (code,) = re.findall(r"```python\n(.*?)```", page, re.S)
    messages = states([joints(START + k * 10**9, ["left", "right"], [k, k]) for k in range(3)])
    poses = [(START + k, pose_of("geometry_msgs/msg/PoseStamped", START + k, k, 0, 0)) for k in range(2)]
    write(tmp_path / "drive_3", [*messages, *(("/mocap/pose", *pose) for pose in poses)])
    (tmp_path / "rover.yaml").write_text(dump(CART), encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    names: dict[str, Any] = {}
    exec(code, names)
    assert (len(names["log"]), len(names["log"].truth)) == (3, 2)


# --- commands --------------------------------------------------------------------------------------------


@pytest.mark.parametrize("unit", ["s", "ns"])
def test_commands_of_a_drive(tmp_path: Path, unit: str) -> None:
    stamps = [START + k * 100_000_000 + k for k in range(100)]
    times = stamps if unit == "ns" else [k / 10 for k in range(100)]
    lines = [f"{t},0.5,{0.3 * np.sin(k / 20)}\n" for k, t in enumerate(times)]
    (tmp_path / "c.csv").write_text(f"time_{unit},vx,omega\n" + "".join(lines))
    drive(ROVER, tmp_path / "c.csv", tmp_path / "run.mcap", chunk_rows=30)
    drive(ROVER, tmp_path / "c.csv", tmp_path / "run.csv")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["c.csv", "run.csv", "run.mcap"]
    table = np.genfromtxt(tmp_path / "run.csv", delimiter=",", names=True)
    with AnyReader([tmp_path / "run.mcap"]) as reader:
        commands = [c for c in reader.connections if c.topic == "/joint_commands"]
        seen = [(s, reader.deserialize(data, c.msgtype)) for c, s, data in reader.messages(commands)]
    assert [s for s, _ in seen] == (stamps if unit == "ns" else [k * 10**8 for k in range(100)])
    for (stamp, message), row in zip(seen, table, strict=True):
        assert message.header.stamp.sec * 10**9 + message.header.stamp.nanosec == stamp
        assert message.name == [*ROVER.steering_joints, *ROVER.traction_joints]
        expected = np.array([row[name] for name in message.name])
        np.testing.assert_allclose(message.position, [*expected[:4], *[np.nan] * 6], rtol=1e-15)
        np.testing.assert_allclose(message.velocity, [*[np.nan] * 4, *expected[4:]], rtol=1e-15)
    # And it is a log: what was commanded, as if it had been measured.
    _, _, angles, steering = read(tmp_path / "run.mcap", ROVER)
    np.testing.assert_allclose(steering[:, 0], table["front_left_steering_joint"], rtol=1e-15)
    assert angles.shape == (100, 6)
