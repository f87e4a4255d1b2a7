"""Lengths that cannot be a rover's in metres: a question, with the unit that is likely."""

from six_wheel._core import Rover
from six_wheel.parameters.nodes import Section
from six_wheel.parameters.syntax import Report

__all__ = ["question_lengths"]

LARGEST = {"wheel_radius": 2.0, "distance": 50.0}  # [m] of what drives; the largest tyres of trucks have 2 m
MILLIMETRES = 20.0  # [m] a radius from here on would be none in centimetres either


def question_lengths(section: Section, rover: Rover, warning: Report) -> None:
    """Warn where the wheels are too large, or too far apart, to be a rover's."""
    radius = max(wheel.radius for wheel in rover.wheels)
    reach = max(max(abs(wheel.x), abs(wheel.y)) for wheel in rover.wheels)
    if radius <= LARGEST["wheel_radius"] and reach <= LARGEST["distance"]:
        return
    unit, metres = ("millimetres", 1e-3) if radius >= MILLIMETRES else ("centimetres", 1e-2)
    key = next((key for key in section.data if "radius" in key and "multiplier" not in key), "")
    at = (key,)
    message = f"a wheel has a radius of {radius:g} m, and is {reach:g} m from the origin"
    remedy = f"lengths are in metres; in {unit} they would be {radius * metres:g} m and {reach * metres:g} m"
    warning(section.line_of(at) if key else section.line, at, message, remedy)
