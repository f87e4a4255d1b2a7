"""The wheels of a rover, by number and by name."""

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from six_wheel.kinematics.keywords import did_you_mean

if TYPE_CHECKING:
    from six_wheel._core import Wheel


class Wheels(tuple["Wheel", ...]):
    """The wheels of a rover in the order of every array: ``wheels[0]``, ``wheels["front_left"]``."""

    __slots__ = ()

    def __getitem__(self, place: Any) -> Any:
        if not isinstance(place, str):
            return super().__getitem__(place)
        for wheel in self:
            if wheel.name == place:
                return wheel
        names = list(self.keys())
        raise KeyError(f"no wheel {place!r}{did_you_mean(place, names)} The wheels are {', '.join(names)}")

    def keys(self) -> Iterator[str]:
        """Names of the wheels, in their order."""
        return (wheel.name for wheel in self)
