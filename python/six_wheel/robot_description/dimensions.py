"""The numbers of a rover: names, what each does to the wheels, how far it may be off.

A parameter of the rover is a linear change of what its wheels hold (place, heading, radius, scrub, trail)
or of what their readings mean. So any vehicle can be calibrated: nothing here knows one from another.
"""

from __future__ import annotations  # so that help shows the names of types, not what they stand for

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray

from six_wheel._core import Rover
from six_wheel.kinematics.keywords import checked, did_you_mean
from six_wheel.kinematics.poses import Floats

# Off by this share of itself, a length or a gain is a mistake in the drawing, not something to calibrate.
PLAUSIBLE_SHARE = 0.2
# Wheels drawn alike are alike to a tenth of that: what moulds, wear and load make of one kind of wheel.
PLAUSIBLE_APART = 0.02
PLAUSIBLE_ANGLE = 0.1  # [rad]
PLAUSIBLE_DELAY = 0.1  # [s]

# A mount that is not asked for was measured: it is off by this share of what one may be that is asked for.
MEASURED = 0.1

# Sides and angles smaller than this share are rounding.
LEVEL = 1e-9

WHEEL_QUANTITIES = ("radius", "x", "y", "heading", "scrub", "trail", "roller_angle")  # in the core's order
# Columns of these among the numbers of a wheel that may be off; TURNED and STEERED are shares of its turns.
PLACE, HEADING, TURNED, STEERED, NUMBERS = slice(1, 3), 3, 7, 8, 9
FRAME = ("x", "y", "yaw")


@dataclass(frozen=True, eq=False)
class Parameter:
    """One number to find.

    `value` is the nominal one, `plausible` how far the true one may be from it. `wheels` holds by how much
    the quantities of every wheel change with it, arrays of shape (wheels,); `gain` the steered wheels whose
    angles it multiplies, shape (steered,).
    """

    name: str
    unit: str
    value: float
    plausible: float
    wheels: Mapping[str, Floats] = field(default_factory=dict)
    gain: Floats | None = None
    positive: bool = False
    kind: str = ""  # numbers of one kind are nearly the same share off


def mounts(rover: Rover, sessions: Iterable[str], axes: Iterable[str]) -> list[Parameter]:
    """Pose of the ground-truth sensor in each session: parameters of the session, not of the rover."""
    reach = size(rover)
    plausible = {"x": MEASURED * reach, "y": MEASURED * reach, "yaw": MEASURED * PLAUSIBLE_ANGLE}
    units = {"x": "m", "y": "m", "yaw": "rad"}
    return [
        Parameter(f"mount_{axis}[{session}]", units[axis], 0.0, plausible[axis])
        for session in sessions
        for axis in axes
    ]


def prior(parameters: Sequence[Parameter]) -> Floats:
    """Prior correlation of the parameters, shape (p, p): covariance in units of `plausible`."""
    alike = PLAUSIBLE_SHARE**2 / (PLAUSIBLE_SHARE**2 + PLAUSIBLE_APART**2)
    kinds = [parameter.kind for parameter in parameters]
    together = np.array([[alike if one and one == other else 0.0 for other in kinds] for one in kinds])
    together = together.reshape(len(kinds), len(kinds))
    np.fill_diagonal(together, 1.0)
    return together


def size(rover: Rover) -> float:
    """The farthest pivot from the body's origin [m], or the largest wheel: what turning moves things by."""
    return max(max(math.hypot(wheel.x, wheel.y), wheel.radius) for wheel in rover.wheels)


class Catalogue:
    """The parameters a rover has, by name; the names of groups stand for all their members."""

    def __init__(self, rover: Rover, encoders: Sequence[bool]) -> None:
        self._rover = rover
        self._encoders = np.array(encoders, dtype=bool)
        self._values = {
            name: np.array([getattr(wheel, name) or 0.0 for wheel in rover.wheels])
            for name in WHEEL_QUANTITIES
        }
        x, y, each = self._values["x"], self._values["y"], np.eye(len(self._encoders))
        steered = [place for place, wheel in enumerate(rover.wheels) if wheel.steered]
        names = [rover.wheel_names[place] for place in steered]
        centres = {name: self._icr(name, side) for name, side in (("icr_left", 1.0), ("icr_right", -1.0))}
        forward = self._icr_forward() if all(centres.values()) else []
        self._groups: Mapping[str, list[Parameter]] = {
            "wheel_radius": self._radius("wheel_radius", np.ones(len(each), dtype=bool)),
            "wheel_radii": [
                one
                for name, chosen in zip(rover.wheel_names, each, strict=True)
                for one in self._radius(f"wheel_radius[{name}]", chosen > 0.0)
            ],
            "side_radii": self._side_radii(),
            "track_width": self._scaled("track_width", float(np.ptp(y)), y=y),
            "wheelbase": self._scaled("wheelbase", float(np.ptp(x)), x=x),
            "arm_length": self._scaled("arm_length", float(np.hypot(x, y).mean()), x=x, y=y),
            "steering_offset": [
                Parameter(f"steering_offset[{name}]", "rad", 0.0, PLAUSIBLE_ANGLE, {"heading": each[place]})
                for name, place in zip(names, steered, strict=True)
            ],
            "steering_gain": [
                Parameter(f"steering_gain[{name}]", "", 1.0, PLAUSIBLE_SHARE, gain=gain, positive=True)
                for name, gain in zip(names, np.eye(len(steered)), strict=True)
            ],
            "roller_angle": self._roller_angle(),
            "encoder_scale": [Parameter("encoder_scale", "", 1.0, PLAUSIBLE_SHARE, positive=True)],
            **centres,
            "icr_forward": forward,
            "skid": [*centres["icr_left"], *centres["icr_right"], *forward],
            "time_offset": [Parameter("time_offset", "s", 0.0, PLAUSIBLE_DELAY)],
            "sensor": self._frame("sensor"),
            "origin": self._frame("origin"),
        }
        self._singles = {member.name: member for group in self._groups.values() for member in group}

    @property
    def has_rollers(self) -> bool:
        """True if a wheel has rollers; then its distance from the origin counts, not x or y alone."""
        return any(wheel.roller_angle is not None for wheel in self._rover.wheels)

    @property
    def names(self) -> list[str]:
        """Every name `find` knows for this rover."""
        return list(dict.fromkeys([*(name for name, group in self._groups.items() if group), *self._singles]))

    def find(self, names: Iterable[str]) -> list[Parameter]:
        """The parameters of these names, each once. Raises `ValueError` if the rover has no such
        parameter."""
        found: dict[str, Parameter] = {}
        for name in names:
            single = [self._singles[name]] if name in self._singles else []
            if not (members := self._groups.get(name, single)):
                known = ", ".join(self.names)
                near = did_you_mean(str(name), self.names)
                raise ValueError(f"parameters must be some of {known} for this rover, got {name!r}{near}")
            found |= {member.name: member for member in members}
        return list(found.values())

    # --- each of them ------------------------------------------------------------------------------------

    def _length(self, name: str, value: float, wheels: dict[str, Floats], kind: str = "") -> Parameter:
        return Parameter(name, "m", value, PLAUSIBLE_SHARE * abs(value), wheels, positive=True, kind=kind)

    def _radius(self, name: str, chosen: NDArray[np.bool_]) -> list[Parameter]:
        """One number for the radii of some wheels, which keep their ratio; of those with an encoder."""
        chosen = chosen & self._encoders
        if not chosen.any():
            return []
        radii = self._values["radius"]
        value = float(radii[chosen].mean())
        return [self._length(name, value, {"radius": np.where(chosen, radii / value, 0.0)}, "radius")]

    def _side_radii(self) -> list[Parameter]:
        y = self._values["y"]
        if (self._encoders & (np.abs(y) <= LEVEL * size(self._rover))).any():
            return []
        left, right = self._radius("wheel_radius_left", y > 0.0), self._radius("wheel_radius_right", y < 0.0)
        return left + right if left and right else []

    def _scaled(self, name: str, value: float, **places: Floats) -> list[Parameter]:
        """A length with which the places of all wheels grow; none where it is 0."""
        return [self._length(name, value, {a: p / value for a, p in places.items()})] if value > 0.0 else []

    def _roller_angle(self) -> list[Parameter]:
        """One number for the rollers of all wheels: where they give way they act as if at another angle."""
        angles = self._values["roller_angle"]
        if not (np.abs(np.sin(2.0 * angles)) > LEVEL).any():
            return []  # rollers straight across give way the same however they stand
        value = float(np.abs(angles[angles != 0.0]).mean())
        return [Parameter("roller_angle", "rad", value, PLAUSIBLE_ANGLE, {"roller_angle": angles / value})]

    def _icr(self, name: str, side: float) -> list[Parameter]:
        """Lateral place of the centres of rotation of one side: where its wheels act, not where they are."""
        straight = np.array(
            [
                wheel.heading == 0.0 and not (wheel.steered or wheel.castor) and wheel.roller_angle is None
                for wheel in self._rover.wheels
            ]
        )
        chosen = straight & (side * self._values["y"] > 0.0)
        if not straight.all() or not chosen.any():
            return []
        value = float((self._values["y"] + self._values["scrub"])[chosen].mean())
        range_ = 2.5 * PLAUSIBLE_SHARE * abs(value)  # tracks skid by half their distance and more
        return [Parameter(name, "m", value, range_, {"scrub": chosen.astype(np.float64)})]

    def _icr_forward(self) -> list[Parameter]:
        value = float((self._values["x"] - self._values["trail"]).mean())
        every = -np.ones(len(self._encoders))
        return [Parameter("icr_forward", "m", value, 0.5 * size(self._rover), {"trail": every})]

    def _frame(self, kind: str) -> list[Parameter]:
        reach = size(self._rover)
        return [
            Parameter(f"{kind}_x", "m", 0.0, reach),
            Parameter(f"{kind}_y", "m", 0.0, reach),
            Parameter(f"{kind}_yaw", "rad", 0.0, PLAUSIBLE_ANGLE),
        ]


@checked()
def deviations(rover: Rover, parameters: Sequence[str], covariance: ArrayLike) -> Floats:
    """Covariance of the dimensions of a rover, as `Odometry` takes it for `dimensions`.

    Parameters
    ----------
    rover : Rover
        With the dimensions that are known by so much.
    parameters : sequence of str
        Names of single numbers, as `Calibration.names`; ``sensor_x`` and ``time_offset`` are no numbers of
        the rover and move nothing.
    covariance : array_like, shape (p, p)
        Of their values; of factors (``encoder_scale``, ``steering_gain``) as shares of themselves, of the
        origin in the axes of this rover.

    Returns
    -------
    ndarray, shape (k, wheels, 9)
        Independent errors of one standard deviation.

    Raises
    ------
    ValueError
        If the rover has no such parameter, or the covariance is none.
    """
    names = list(parameters)
    known = np.asarray(covariance, dtype=np.float64)
    square = known.shape == (len(names), len(names))
    if not square or not np.isfinite(known).all() or (np.diagonal(known) < 0.0).any():
        rule = f"must be a finite covariance of {len(names)} values"
        raise ValueError(f"covariance {rule}, got shape {known.shape}")
    found = Catalogue(rover, with_encoders(rover, names)).find(names)
    if len(found) != len(names):
        raise ValueError(f"parameters must be single ones, got {', '.join(names)}")
    return apart([moves(rover, one) for one in found], known)


def with_encoders(rover: Rover, names: Iterable[str] = ()) -> list[bool]:
    """True for wheels taken to have an encoder if no log tells: driven, or with a radius in `names`."""
    return [wheel.driven or f"wheel_radius[{wheel.name}]" in names for wheel in rover.wheels]


def moves(rover: Rover, parameter: Parameter, value: float = 1.0) -> Floats:
    """Derivatives of the numbers of every wheel by a parameter, shape (wheels, 9).

    `value` is that of a factor of readings.
    """
    moved = np.zeros((len(rover.wheels), NUMBERS))
    for number, quantity in enumerate(WHEEL_QUANTITIES):
        moved[:, number] = parameter.wheels.get(quantity, 0.0)
    match parameter.name:
        case "encoder_scale":
            moved[:, TURNED] = 1.0 / value
        case "origin_x":
            moved[:, PLACE.start] = -1.0
        case "origin_y":
            moved[:, PLACE.start + 1] = -1.0
        case "origin_yaw":
            moved[:, PLACE] = [(wheel.y, -wheel.x) for wheel in rover.wheels]
            moved[:, HEADING] = -1.0
    if parameter.gain is not None:
        moved[[wheel.steered for wheel in rover.wheels], STEERED] = parameter.gain / value
    return moved


def apart(moved: Sequence[Floats], covariance: Floats) -> Floats:
    """Errors that are independent (k, wheels, 9), from moves (p, wheels, 9) whose sizes have a covariance."""
    if not len(moved):
        return np.empty((0, 1, NUMBERS))
    variances = np.diagonal(covariance)
    usual = np.sqrt(np.where(variances > 0.0, variances, 1.0))  # so that units do not count
    sizes, directions = np.linalg.eigh(covariance / np.outer(usual, usual))
    shares = usual[:, None] * directions * np.sqrt(np.maximum(sizes, 0.0))
    errors = np.einsum("pk,pwn->kwn", shares, np.array(moved))
    some: Floats = errors[errors.any(axis=(1, 2))]
    return some
