"""A URDF out of a rover: what `read` makes the same rover of, digit by digit, and viewers open."""

import math
from collections.abc import Iterable, Mapping
from xml.etree import ElementTree
from xml.etree.ElementTree import Element, SubElement

from six_wheel._core import RockerBogie, Rover, Wheel
from six_wheel.kinematics.keywords import checked
from six_wheel.robot_description.diagnostics import ParameterFileError
from six_wheel.robot_description.urdf.read import parse_urdf
from six_wheel.robot_description.urdf.wheel_geometry import NUMBERS, ROUNDING
from six_wheel.robot_description.wheels_of_rover import joints_by_wheel

WIDTH = 0.6  # of a wheel, in radii
ROLLERS = 8
EFFORT, VELOCITY = "1000.0", "1000.0"  # a hinge with limits must state it; so large it is read as none
DENSITY = 300.0  # [kg/m^3] of wheels, so that simulations have masses to start from
BEAM = 0.02  # [m] radius of what is drawn between hinges

Point = tuple[float, float, float]
ORIGIN: Point = (0.0, 0.0, 0.0)
Z: Point = (0.0, 0.0, 1.0)
Y: Point = (0.0, 1.0, 0.0)


@checked()
def rover_urdf(rover: Rover, name: str = "rover") -> str:
    """See `Rover.urdf`."""
    if rover.suspension is None:
        text = _text(_Description(name).flat(rover))
    else:
        text = _text(_Description(name).suspended(rover, rover.suspension))
    _refuse_others(rover, _read_back(text))
    return text


@checked()
def suspension_urdf(suspension: RockerBogie, name: str = "rover") -> str:
    """See `RockerBogie.urdf`. Raises `ValueError` if what is read back differs."""
    text = _text(_Description(name).suspended(suspension.planar(), suspension))
    if (found := _read_back(text).suspension) != suspension:
        got = f"{suspension!r}, which comes back as {found!r}"
        raise ValueError(f"a URDF must hold the suspension, got {got}")
    return text


def _read_back(text: str) -> Rover:
    try:
        return parse_urdf(text).rover
    except ParameterFileError as error:
        raise ValueError(
            f"a URDF must hold the rover, got one of which {error.findings[0].message}"
        ) from None


def _refuse_others(rover: Rover, found: Rover) -> None:
    """Fails unless the rover that a text is read as is the one it was written from."""
    for wheel, other in zip(rover.wheels, found.wheels, strict=False):
        if wheel != other:
            message = (
                f"a URDF must hold every wheel, got {wheel.name}, {wheel!r}, which comes back as {other!r}"
            )
            raise ValueError(message)
    for part in ("wheels", "traction_joints", "steering_joints", "reversed_joints", "suspension"):
        was, came = getattr(rover, part), getattr(found, part)
        if was != came:
            raise ValueError(
                f"a URDF must hold {part} of the rover, got {was!r}, which come back as {came!r}"
            )


def _centre(wheel: Wheel) -> tuple[float, float]:
    """Place of a wheel's centre with its steering at 0 [m]."""
    sin, cos = math.sin(wheel.heading), math.cos(wheel.heading)
    return (
        wheel.x - wheel.trail * cos - wheel.scrub * sin,
        wheel.y - wheel.trail * sin + wheel.scrub * cos,
    )


def _hinge_offsets(wheels: Mapping[str, Wheel], arm: RockerBogie) -> dict[str, tuple[float, float]]:
    """Offset in x and y of each wheel's hinge from its centre in the model [m]. The hinge is at the pivot
    of a steered wheel, else at the wheel's own centre."""
    offsets = {}
    for model in arm.planar().wheels:
        wheel = wheels[model.name]
        centre = _centre(wheel)
        offset = (centre[0] - model.x, centre[1] - model.y)
        if max(map(abs, offset)) < ROUNDING:
            offset = (0.0, 0.0)
        if wheel.steered or wheel.castor:
            offset = (offset[0] + (wheel.x - centre[0]), offset[1] + (wheel.y - centre[1]))
        offsets[wheel.name] = offset
    return offsets


def _text(robot: Element) -> str:
    ElementTree.indent(robot)
    return f'<?xml version="1.0"?>\n{ElementTree.tostring(robot, encoding="unicode")}\n'


def _numbers(values: Iterable[float]) -> str:
    return " ".join(repr(float(value) + 0.0) for value in values)


class _Description:
    """A robot under construction."""

    def __init__(self, name: str) -> None:
        if not name.strip() or not name.isprintable():
            raise ValueError(f"name must have visible characters and no others, got {name!r}")
        self.robot = Element("robot", name=name)
        for colour, rgba in {"body": "0.75 0.75 0.75 1.0", "wheel": "0.15 0.15 0.15 1.0"}.items():
            SubElement(SubElement(self.robot, "material", name=colour), "color", rgba=rgba)
        self.control = Element("ros2_control", name=name, type="system")
        hardware = SubElement(self.control, "hardware")
        SubElement(hardware, "plugin").text = "mock_components/GenericSystem"
        self._links: dict[str, Element] = {}

    def flat(self, rover: Rover) -> Element:
        """Every wheel on the body, whose frame lies on the ground."""
        self.link("base_link")
        reach = [max(abs(wheel.x) for wheel in rover.wheels), max(abs(wheel.y) for wheel in rover.wheels)]
        radius = max(wheel.radius for wheel in rover.wheels)
        size = (2.0 * max(reach[0], radius), 2.0 * max(reach[1] - radius, radius / 2.0), radius / 2.0)
        self.box("base_link", size, (0.0, 0.0, 1.5 * radius))
        for wheel in rover.wheels:
            x, y = (wheel.x, wheel.y) if wheel.steered or wheel.castor else _centre(wheel)
            self.wheel(rover, wheel, "base_link", (x, y, wheel.radius))
        return self.done()

    def suspended(self, rover: Rover, arm: RockerBogie) -> Element:
        """Rockers and bogies of a suspension, with the joints of a rover; the base is its frame R."""
        said = arm.dimensions
        alone = "rear" if "rocker_to_rear" in said else "front"
        carried = ("front", "middle") if alone == "rear" else ("middle", "rear")
        self.link("base_link")
        x, y, z = said["rocker_pivot"]
        self.box("base_link", (2.0 * max(abs(y), BEAM), 1.6 * abs(y), abs(y) / 2.0), (x, 0.0, z))
        wheels = {wheel.name: wheel for wheel in rover.wheels}
        offsets = _hinge_offsets(wheels, arm)
        # Where wheels are beside the model, whose vectors are the mean of both sides, a tree rounds these.
        uneven = any(map(any, offsets.values()))
        noted = {
            key: _numbers(value)
            for key, value in said.items()
            if isinstance(value, tuple) and len(value) == 3 and (uneven or key == "differential_bar")
        }
        for side, way in (("left", 1.0), ("right", -1.0)):

            def mirrored(key: str, way: float = way) -> Point:
                x, y, z = said[key]
                return (x, way * y, z)

            rocker, bogie = f"{side}_rocker", f"{side}_bogie"
            self.link(rocker)
            self.link(bogie)
            limit = _limit(said.get("rocker_limit"))
            if limit is not None and side == "right":
                limit = (-limit[1], -limit[0])
            hinge = self.hinge(f"{rocker}_joint", "base_link", rocker, mirrored("rocker_pivot"), Y, limit)
            if side == "right":
                # Of a bar that is nearly so; what it is exactly stands among the parameters of the left one.
                SubElement(hinge, "mimic", joint="left_rocker_joint", multiplier="-1.0", offset="0.0")
            elif noted:
                self.control_entry(f"{rocker}_joint", None, noted, ("position",))
            self.hinge(
                f"{bogie}_joint",
                rocker,
                bogie,
                mirrored("rocker_to_bogie"),
                Y,
                _limit(said.get("bogie_limit")),
            )
            self.beam(rocker, mirrored("rocker_to_bogie"))
            for holder, places in ((rocker, (alone,)), (bogie, carried)):
                for place in places:
                    key = f"{holder.partition('_')[2]}_to_{place}"
                    wheel = wheels[f"{place}_{side}"]
                    self.beam(holder, mirrored(key))
                    (x, y, z), (dx, dy) = mirrored(key), offsets[wheel.name]
                    self.wheel(rover, wheel, holder, (x + dx, y + dy, z))
        return self.done()

    def done(self) -> Element:
        """The whole, with what is commanded at its end."""
        self.robot.append(self.control)
        return self.robot

    def link(self, name: str, mass: float = 1.0, size: float = 0.1) -> Element:
        """A link with an inertia, which simulations ask for."""
        if name in self._links:
            raise ValueError(f"wheels and joints must not be called {name}, which a link is called already")
        if not name.isprintable():
            raise ValueError(f"wheels must be called by visible characters, got {name!r}")
        link = self._links[name] = SubElement(self.robot, "link", name=name)
        inertial = SubElement(link, "inertial")
        SubElement(inertial, "mass", value=_numbers([mass]))
        diagonal = repr(0.4 * mass * size * size)
        SubElement(
            inertial, "inertia", ixx=diagonal, iyy=diagonal, izz=diagonal, ixy="0.0", ixz="0.0", iyz="0.0"
        )
        return link

    def hinge(
        self, name: str, parent: str, child: str, origin: Point, axis: Point,
        limit: tuple[float, float] | None, yaw: float = 0.0,
    ) -> Element:  # fmt: skip
        """A joint about an axis; without a limit it turns endlessly."""
        kind = "continuous" if limit is None else "revolute"
        joint = SubElement(self.robot, "joint", name=name, type=kind)
        SubElement(joint, "origin", xyz=_numbers(origin), rpy=_numbers((0.0, 0.0, yaw)))
        SubElement(joint, "parent", link=parent)
        SubElement(joint, "child", link=child)
        SubElement(joint, "axis", xyz=_numbers(axis))
        if limit is not None:
            lower, upper = map(repr, limit)
            SubElement(joint, "limit", lower=lower, upper=upper, effort=EFFORT, velocity=VELOCITY)
        return joint

    def control_entry(
        self,
        joint: str,
        interface: str | None,
        parameters: Mapping[str, str],
        states: tuple[str, ...] = ("position", "velocity"),
    ) -> None:
        """An entry of ros2_control: what commands a joint, its states, and what is noted of what it turns."""
        entry = SubElement(self.control, "joint", name=joint)
        if interface is not None:
            SubElement(entry, "command_interface", name=interface)
        for state in states:
            SubElement(entry, "state_interface", name=state)
        for name, value in parameters.items():
            SubElement(entry, "param", name=name).text = value

    def wheel(self, rover: Rover, wheel: Wheel, holder: str, at: Point) -> None:
        """A wheel and what steers it; `at` is its pivot, or its centre where nothing turns it."""
        steers, drives = joints_by_wheel(rover)
        joint = drives.get(wheel.name, f"{wheel.name}_wheel_joint")
        way = -1.0 if joint in rover.reversed_joints else 1.0
        below, yaw = at, wheel.heading
        if wheel.steered or wheel.castor:
            steering = steers.get(wheel.name, f"{wheel.name}_swivel_joint")
            pillar = f"{wheel.name}_pillar"
            upright: Point = (0.0, 0.0, -1.0) if steering in rover.reversed_joints else Z
            limit = wheel.steering_range
            if limit is not None and math.isinf(limit[1]):
                limit = None
            if limit is not None and upright is not Z:
                limit = (-limit[1], -limit[0])
            self.link(pillar, mass=0.1)
            self.hinge(steering, holder, pillar, at, upright, limit, yaw)
            self.control_entry(steering, None if wheel.castor else "position", {})
            # The offset in the axes of the steered wheel, where nothing has been turned yet.
            holder, yaw = pillar, 0.0
            below = (-wheel.trail, wheel.scrub, 0.0)
        tyre = f"{wheel.name}_tyre"
        mass = DENSITY * math.pi * WIDTH * wheel.radius**3
        link = self.link(tyre, mass, wheel.radius)
        self.hinge(joint, holder, tyre, below, (0.0, way, 0.0), None, yaw)
        index = str(rover.wheel_names.index(wheel.name))
        numbers = {key: getattr(wheel, key) for key in NUMBERS}
        noted = {key: repr(value) for key, value in numbers.items() if value or key in ("x", "y")}
        noted = {"wheel": wheel.name, "index": index} | noted
        self.control_entry(joint, "velocity" if wheel.driven else None, noted)
        core = 0.6 * wheel.radius if wheel.roller_angle is not None else wheel.radius
        for part, radius in (("visual", core), ("collision", wheel.radius)):
            self.cylinder(link, part, radius, WIDTH * wheel.radius, (math.pi / 2.0, 0.0, 0.0))
        if wheel.roller_angle is not None:
            self.rollers(wheel, tyre)

    def rollers(self, wheel: Wheel, tyre: str) -> None:
        """Free rollers around a wheel; the first is the one on the ground."""
        angle = wheel.roller_angle or 0.0
        thickness = 0.2 * wheel.radius
        reach = wheel.radius - thickness
        across, along = math.cos(angle), math.sin(angle)
        for k in range(ROLLERS):
            turn = 2.0 * math.pi * k / ROLLERS
            sin, cos = math.sin(turn), math.cos(turn)
            # Turned about y from straight below.
            place = (-reach * sin, 0.0, -reach * cos)
            axis = (along * cos, across, -along * sin)
            name = f"{wheel.name}_roller_{k}"
            link = self.link(name, 0.01, thickness)
            self.hinge(f"{name}_joint", tyre, name, place, axis, None)
            tilt = math.atan2(math.hypot(axis[0], axis[1]), axis[2])
            self.cylinder(
                link, "visual", thickness, 3.0 * thickness, (0.0, tilt, math.atan2(axis[1], axis[0]))
            )

    def cylinder(
        self, link: Element, part: str, radius: float, length: float, rpy: Point, at: Point = ORIGIN,
        material: str = "wheel",
    ) -> None:  # fmt: skip
        shape = SubElement(link, part)
        SubElement(shape, "origin", xyz=_numbers(at), rpy=_numbers(rpy))
        SubElement(SubElement(shape, "geometry"), "cylinder", radius=repr(radius), length=repr(length))
        if part == "visual":
            SubElement(shape, "material", name=material)

    def beam(self, name: str, end: Point) -> None:
        """Adds a visual beam from the origin of a link to another of its hinges."""
        x, y, z = end
        length = math.sqrt(x * x + y * y + z * z)
        if length > 0.0:
            middle = (x / 2.0, y / 2.0, z / 2.0)
            rpy = (0.0, math.atan2(math.hypot(x, y), z), math.atan2(y, x))
            self.cylinder(self._links[name], "visual", BEAM, length, rpy, middle, "body")

    def box(self, name: str, size: Point, at: Point) -> None:
        """The body, as far as it is seen."""
        shape = SubElement(self._links[name], "visual")
        SubElement(shape, "origin", xyz=_numbers(at), rpy=_numbers(ORIGIN))
        SubElement(SubElement(shape, "geometry"), "box", size=_numbers(size))
        SubElement(shape, "material", name="body")


def _limit(value: object) -> tuple[float, float] | None:
    """A limit of a hinge that is one: at least one end is finite."""
    return value if isinstance(value, tuple) and any(map(math.isfinite, value)) else None
