"""Name of the command line and one line on each of its commands: no more than the overview needs."""

PROGRAM = "six-wheel"
PURPOSE = "Kinematics of wheeled rovers: what their wheels must do, and what they did."
INSTALL = 'pip install "six-wheel[cli]"'
COMMANDS = {
    "demo": "What it can do: two rovers along a real recording, one over rocks, with pictures.",
    "check": "Every mistake in a parameter file at once; then what the rover can do.",
    "drive": "Drive a table of commands, within limits: joint commands, odometry, reasons, pictures.",
    "simulate": "A log with its truth: a rover on a plane, or a suspension over a map with a picture in 3D.",
    "inspect": "What is in a log: columns or topics with rate, range, unit, and what to do next.",
    "odometry": "Dead-reckon a log: the path with its covariance, bad rows, slip, errors against the truth.",
    "calibrate": "The rover's true dimensions from its logs and where it really was.",
    "traverse": "Where on a map a rover can stand: every cell, every heading, as a GeoTIFF.",
    "show": "A rover from above: its wheels, their axes meeting in the centre of rotation.",
    "view": "A rover or a record in the browser, in 3D: drag its sliders, drive it over rocks, play a drive.",
    "convert": "A rover as .yaml or .urdf; a rover or a record as a layout of Foxglove or Rerun.",
    "example": "A parameter file, a table of commands, a log, a map to try the others on.",
    "node": "Drive a rover in ROS 2: commands and joint states in, joint commands and odometry out.",
    "filter": "Between a planner and a robot: commands of ROS 2 that it can follow, the curvature kept.",
    "replay": "Run a record of a node again: the same bits, or what other parameters would have made of it.",
    "bench": "How fast the compiled core is on this machine, beside the reference in plain NumPy.",
}


def help_text() -> str:
    """The overview: all commands, a line each."""
    lines = [f"Usage: {PROGRAM} COMMAND [OPTIONS] [ARGUMENTS]", "", PURPOSE, "", "Commands:"]
    lines += [f"  {name:<9} {summary}" for name, summary in COMMANDS.items()]
    return "\n".join(
        [*lines, "", f"{PROGRAM} COMMAND --help explains a command, {PROGRAM} --version says which this is."]
    )
