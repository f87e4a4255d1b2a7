"""Options of a loop beside its parameter file; names of ros2_controllers where they have one."""

from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from typing import Any

from six_wheel.kinematics.keywords import checked_class


@dataclass(frozen=True)
class Option:
    """One option.

    Attributes
    ----------
    name : str
    default : bool, float or str
    description : str
    min_value, max_value : float, optional
        Between which a number lies.
    choices : tuple of str
        Of a text.
    live : bool
        True if it can be changed while the rover drives.
    """

    name: str
    default: bool | float | str
    description: str
    min_value: float | None = None
    max_value: float | None = None
    choices: tuple[str, ...] = ()
    live: bool = False

    def check(self, given: Any) -> Any:
        """The value, if it may be one.

        Raises
        ------
        ValueError
            If its type, the number or the word is none of those of the option.
        """
        kind: type = type(self.default)
        value: Any = given
        if kind is float and isinstance(given, int) and not isinstance(given, bool):
            value = float(given)
        if type(value) is not kind:
            names = {bool: "true or false", float: "a number", str: "text"}
            raise ValueError(f"{self.name} must be {names[kind]}, got {value!r}")
        if self.choices and value not in self.choices:
            raise ValueError(f'{self.name} must be one of {", ".join(self.choices)}, got "{value}"')
        low, high = self.min_value, self.max_value
        if low is not None and high is not None and not low <= given <= high:
            raise ValueError(f"{self.name} must lie between {low:g} and {high:g}, got {value:g}")
        return value


def _option(default: Any, description: str, **others: Any) -> Any:
    return field(default=default, metadata={"description": description} | others)


@checked_class
@dataclass(frozen=True)
class Options:
    """The values of `OPTIONS`."""

    open_loop: bool = _option(False, "odometry from the commands, for a rover without joint states")
    position_feedback: bool = _option(True, "wheels report positions (running totals); false: velocities")
    joint_state_timeout: float = _option(
        0.5,
        "age of a joint's last reading at which the rover stops [s]",
        min_value=0.01,
        max_value=60.0,
        live=True,
    )
    imu_timeout: float = _option(
        0.1,
        "how long joint readings wait for those of the gyroscope; then odometry goes by the wheels [s]",
        min_value=0.001, max_value=1.0, live=True,
    )  # fmt: skip
    update_rate: float = _option(
        50.0, "steps per second while no joint states come [Hz]", min_value=1.0, max_value=1000.0
    )
    publish_rate: float = _option(
        50.0,
        "odometry messages per second, at most [Hz]; 0: one for every reading",
        min_value=0.0, max_value=1000.0, live=True,
    )  # fmt: skip
    reset_on_time_jump: bool = _option(
        False, "odometry starts over where time jumps back, as simulations do it"
    )

    @classmethod
    def of(cls, values: Mapping[str, Any]) -> "Options":
        """The options, checked; those left out have their defaults."""
        known = {option.name: option for option in OPTIONS}
        return cls(**{name: known[name].check(value) for name, value in values.items()})

    def values(self) -> dict[str, Any]:
        """By name."""
        return {each.name: getattr(self, each.name) for each in fields(self)}


OPTIONS = tuple(Option(each.name, getattr(Options, each.name), **each.metadata) for each in fields(Options))
