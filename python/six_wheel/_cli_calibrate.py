"""`six-wheel calibrate`: a rover's true dimensions from its logs."""

from six_wheel._cli_shared import RoverArgument


def calibrate(rover: RoverArgument) -> None:
    raise ValueError("x")
