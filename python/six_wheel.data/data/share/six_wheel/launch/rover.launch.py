"""Drive a rover: ``ros2 launch six_wheel rover.launch.py rover:=rover.yaml``."""

from launch import LaunchContext, LaunchDescription
from launch.actions import DeclareLaunchArgument, OpaqueFunction
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node

ARGUMENTS = {
    "rover": "parameter file, URDF or name of a preset; without it the topic robot_description says it",
    "namespace": "before every relative topic, service and the node's name",
    "use_sim_time": "true: times are those of /clock",
    "record": "an .mcap file of all that comes in and goes out",
}
DEFAULTS = {"rover": "", "namespace": "", "use_sim_time": "false", "record": ""}


def node(context: LaunchContext) -> list[Node]:
    """The node with those arguments that were given."""
    given = {name: LaunchConfiguration(name).perform(context) for name in ARGUMENTS}
    parameters: dict[str, bool | str] = {"use_sim_time": given["use_sim_time"].lower() in ("true", "1")}
    if given["record"]:
        parameters["record"] = given["record"]
    return [
        Node(
            package="six_wheel",
            executable="node",
            namespace=given["namespace"],
            arguments=[given["rover"]] if given["rover"] else [],
            parameters=[parameters],
            output="screen",
        )
    ]


def generate_launch_description() -> LaunchDescription:
    """Declare the arguments and start the node."""
    declared = [
        DeclareLaunchArgument(name, description=text, default_value=DEFAULTS[name])
        for name, text in ARGUMENTS.items()
    ]
    return LaunchDescription([*declared, OpaqueFunction(function=node)])
