"""Parameters of the node as teams set them: slips, frames, `ros2 param dump`; lines of its log."""

import math
import textwrap

import pytest
import yaml
from rcl_interfaces.srv import GetParameters, ListParameters
from rclpy.parameter import parameter_value_to_python
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import String

import six_wheel as sw
from six_wheel.control_loop import Settings
from six_wheel.robot_description.parameters import ParameterFileError, read_parameters
from six_wheel.robot_description.urdf import rover_urdf
from tests.control_loop.ros2.peers import PATIENCE, call, driving

NODE = "/mars/rover_controller"
ALL = [
    *("-p", "base_frame_id:=base_footprint", "-p", "tf_frame_prefix:=~", "-r", "__ns:=/mars"),
    *("-p", "limits.sped:=1.0", "-p", "cmd_vel_timeout:=0.25", "-p", "limits.jerk:=2.0"),
    *("-r", "joint_states:=/joint_states", "-r", "cmd_vel:=/cmd_vel"),
    *("-r", "joint_commands:=/joint_commands", "-r", "odom:=/odom"),
]


def dumped(peer):
    """The text that `ros2 param dump` writes."""
    names = call(peer, ListParameters, f"{NODE}/list_parameters", ListParameters.Request()).result.names
    tree: dict = {}
    for name, value in zip(names, values_of(peer, *names), strict=True):
        *groups, key = name.split(".")
        inside = tree
        for group in groups:
            inside = inside.setdefault(group, {})
        inside[key] = value
    return yaml.safe_dump({NODE: {"ros__parameters": tree}})


def values_of(peer, *names, node=NODE):
    request = GetParameters.Request(names=names)
    values = call(peer, GetParameters, f"{node}/get_parameters", request).values
    return [parameter_value_to_python(value) for value in values]


def test_what_the_file_says_of_the_node_counts(start, peer, rover_file):
    """It was ignored in silence; what is given beside the file comes first."""
    lines = "publish_rate: 10.0\ncommand_interface: group\nautostart: false\ncmd_vel_timeout: 0.25\n"
    rover_file.write_text(rover_file.read_text() + textwrap.indent(lines, "    "))
    start("node", str(rover_file), "--ros-args", "-p", "publish_rate:=20.0")
    names = "publish_rate", "command_interface", "autostart", "cmd_vel_timeout"
    assert values_of(peer, *names, node="/rover_controller") == [20.0, "group", False, 0.25]


def test_names_of_ros2_controllers(start, peer, rover_file):
    diagonal = "pose_covariance_diagonal:=[0.1,0.1,0.1,0.1,0.1,0.1]"
    given = ["-p", "reference_timeout:=0.3", "-p", diagonal, "-r", "__ns:=/mars"]
    process = start("node", str(rover_file), "--ros-args", *given)
    names = "reference_timeout", "cmd_vel_timeout", "pose_covariance_diagonal", "twist_covariance_diagonal"
    assert values_of(peer, *names) == [0.3, 0.3, [0.1] * 6, [0.0] * 6]
    assert "unknown parameter" not in process.said
    unused = "pose_covariance_diagonal is not used: covariances are computed from the noise and the readings"
    assert process.said.count(unused) == 1
    assert "twist_covariance_diagonal" not in process.said
    process.end()
    peer.clients.clear()  # whom they know is gone
    # Both names: that of the parameter that can be set while it drives.
    start("node", str(rover_file), "--ros-args", *given, "-p", "cmd_vel_timeout:=0.2")
    assert values_of(peer, "cmd_vel_timeout") == [0.2]


def test_slips_frames_and_a_dump(start, peer, rover_file, tmp_path):
    text = rover_file.read_text()
    rover_file.write_text(f"{text}    control: {{align: hold, following_error: 0.3}}\n")
    process = start("node", str(rover_file), "--ros-args", *ALL)
    peer.until(lambda: peer.odometry)
    message = peer.odometry[-1]
    assert (message.header.frame_id, message.child_frame_id) == ("mars/odom", "mars/base_footprint")
    assert process.said.count("unknown parameter") == 1
    assert "unknown parameter limits.sped is ignored; did you mean limits.speed?" in process.said
    file = tmp_path / "dump.yaml"
    file.write_text(dumped(peer))
    again, before = read_parameters(file), read_parameters(rover_file)
    assert not again.warnings
    assert again.rover == before.rover
    assert again.base_frame_id == "base_footprint"
    assert again.limits == before.limits.replace(jerk=2.0)
    assert again.control == before.control | {"timeout": 0.25, "following_time": 0.5}
    # Started from it, the loop is the same one.
    settings = Settings.of_parameters(again)
    assert (
        settings.controller().limits
        == Settings.of_parameters(before).changed({"limits.jerk": 2.0}).controller().limits
    )
    assert process.end() == 0


def test_a_value_that_cannot_be_is_one_line(start, rover_file):
    for given, line in (
        ("update_rate:=0.0", "update_rate must lie between 1 and 1000, got 0"),
        ("limits.speed:=-1.0", "limits.speed must lie between 0 and 1e+06, got -1"),
        ("imu_timeout:=.nan", "imu_timeout must lie between 0.001 and 1, got nan"),
        ("limits.speed:=1", "limits.speed must be a number with a decimal point, got 1"),
        ("autostart:=1", "autostart must be true or false, got 1"),
        (
            "pose_covariance_diagonal:=0.1",
            "pose_covariance_diagonal must be a list of the type in the file or by default, got 0.1",
        ),
    ):
        process = start("node", str(rover_file), "--ros-args", "-p", given)
        process.process.wait(PATIENCE)
        assert (process.process.returncode, process.said) == (2, f"six-wheel: {line}\n")


def test_a_stop_is_a_line_of_the_log_and_its_end_another(start, peer, rover_file):
    start("node", str(rover_file))
    driving(peer)

    def said(text):
        return sum(text in line for line in peer.log)

    begin = "joints: the rover stops, joint states are missing: joint fl_steer must be in the joint states"
    peer.alter = lambda state: None
    peer.until(lambda: said(begin))
    peer.spin(2.2)  # two reports more
    assert said("joint states are missing") == 1
    peer.alter = lambda state: state
    peer.until(lambda: said("joints: over: joint fl_steer must be in the joint states"))
    peer.wanted = None
    peer.until(lambda: said("commands: commands must keep coming"))
    driving(peer)
    peer.until(lambda: said("commands: over: commands must keep coming"))
    assert said("joint states are missing") == 1


def test_zero_is_no_limit_only_beside_parameters_of_the_node(tmp_path):
    path = tmp_path / "rover.yaml"
    text = "kind: differential\ntrack_width: 0.5\nwheel_radius: 0.1\n"
    text += "limits: {speed: 1.0, jerk: 0.0, acceleration: 1.0e+6}\n"
    path.write_text(f"{text}record: ''\n")
    assert read_parameters(path).limits == sw.Limits(speed=1.0, acceleration=math.inf)
    path.write_text(text)
    with pytest.raises(ParameterFileError, match="limits.jerk must be finite and positive"):
        read_parameters(path)


def test_the_rover_comes_by_a_topic_or_a_parameter(start, peer, rover_file):
    """As robot_state_publisher has it; told to end while it waits, the node ends."""
    waiting = start("node", "--ros-args", "-r", "robot_description:=another")
    peer.until(lambda: "waiting for /another" in waiting.said)
    assert waiting.end() == 0
    latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    publisher = peer.node.create_publisher(String, "robot_description", latched)
    publisher.publish(String(data=rover_urdf(peer.rover, name="rover")))
    process = start("node", "--ros-args", "-p", "limits.speed:=0.2")
    driving(peer, (0.2, 0.0, 0.0))
    assert peer.odometry[-1].child_frame_id == "base_link"
    assert process.end() == 0
    start("node", "--ros-args", "-p", f"rover:={rover_file}", "-r", "odom:=odom_of_the_other")
    peer.until(lambda: ("rover_controller", "/") in peer.node.get_node_names_and_namespaces())
