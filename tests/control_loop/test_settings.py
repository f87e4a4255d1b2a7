"""Options of the loop and of a node that stand in the parameter file."""

import pytest

from six_wheel.control_loop import Options, Settings
from six_wheel.robot_description.parameters import ParameterFileError, read_parameters

OWN = "kind: differential\ntrack_width: 0.5\nwheel_radius: 0.1\n"
OF_CONTROLLERS = """\
diff_drive_controller:
  ros__parameters:
    left_wheel_names: [left_joint]
    right_wheel_names: [right_joint]
    wheel_separation: 0.5
    wheel_radius: 0.1
"""


@pytest.fixture
def read(tmp_path):
    def read(text):
        path = tmp_path / "rover.yaml"
        path.write_text(text)
        return Settings.of_parameters(read_parameters(path))

    return read


def test_options_of_a_file_count(read):
    """They were ignored in silence: what a node was started with made no difference."""
    settings = read(f"{OWN}publish_rate: 10\njoint_state_timeout: 1.0\ncommand_interface: group\n")
    assert settings.options == Options(publish_rate=10.0, joint_state_timeout=1.0)
    assert settings.node_options["command_interface"] == "group"
    assert "joint_state_timeout" not in settings.text  # options are apart in a record
    with pytest.raises(ValueError, match="publish_rate must lie between 0 and 1000, got -1"):
        read(f"{OWN}publish_rate: -1.0\n")


def test_of_a_controllers_file_those_count_that_mean_the_same(read):
    more = "    open_loop: true\n    update_rate: 0\n    command_interface: velocity\n"
    settings = read(f"{OF_CONTROLLERS}{more}    reference_timeout: 2\n    tf_frame_prefix: mars\n")
    assert settings.options == Options(open_loop=True)
    shared = {"open_loop": True, "reference_timeout": 2, "tf_frame_prefix": "mars"}
    assert settings.node_options == shared
    assert settings.parameters.control == {"timeout": 2.0}
    disabled = read(f"{OF_CONTROLLERS}    tf_frame_prefix: mars\n    tf_frame_prefix_enable: false\n")
    assert disabled.node_options == {}


@pytest.mark.parametrize(
    ("line", "timeout"),
    [
        ("cmd_vel_timeout: 0.25", 0.25),
        ("reference_timeout: 0.25", 0.25),
        ("cmd_vel_timeout: 0.0", None),
        ("cmd_vel_timeout: 0.25\ncontrol: {timeout: 0.3}", 0.3),
    ],
)
def test_the_timeout_of_commands_by_the_names_of_ros(read, line, timeout):
    """In a file with this package's keys they were ignored in silence."""
    assert read(f"{OWN}{line}\n").parameters.control == {"timeout": timeout}


@pytest.mark.parametrize("value", ["-1.0", "soon", ".nan", ".inf", "true"])
def test_a_timeout_that_is_none_is_refused(read, value):
    with pytest.raises(ParameterFileError, match="cmd_vel_timeout must be a time in seconds, got"):
        read(f"{OWN}cmd_vel_timeout: {value}\n")
