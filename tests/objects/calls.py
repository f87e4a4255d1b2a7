"""Every public call that numbers go into, with ordinary arguments: made of signature and docstring."""

import copy
import inspect
import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

import six_wheel as sw
from tests.objects.samples import DRIVE, ROVER, samples, terrain
from tests.rovers import PAIR

COUNTS = {"n": 3, "m": 1, "k": 2, "t": 4, "n + 1": 4, "axes": 2}  # lengths of axes in docstrings
NAMES = {"wheels": "wheel_names", "steered wheels": "steered_wheel_names", "joints": "free_joints"}
VARIABLE = (inspect.Parameter.VAR_POSITIONAL, inspect.Parameter.VAR_KEYWORD)
ORDINARY = 0.05  # of numbers nothing is known of
BEGIN = 3.0  # [s] stamps: after those of the samples
# Arguments that have to go together, or that no docstring says. Other calls take files, tables and mappings,
# or work on what another call made.
GIVEN: dict[str, dict[str, Any]] = {
    "body_slip": {"covariance": 1e-4 * np.eye(3)},
    "umbmark": {"rover": PAIR},
    "Rover": {"wheels": PAIR.wheels},
    "Rover.swerve": {"positions": [(0.3, 0.2), (-0.3, -0.2)]},
    "Mppi.step": {"goal": (1.0, 0.0, 0.0)},
    "Odometry.correct": {"std": (0.1, 0.1, 0.1)},
    "Odometry3.correct": {"std": (0.1,) * 6, "stamp": 1.2},
    "Preintegrated.split": {"stamp": 1.0},
    "BodySlip.compensate": {"wanted": np.full(2, ORDINARY)},
    "BodyTransition.between": {"duration": 2.0},
    "FourAxle.simulate": {"sequence": [samples()["FourAxleStep"]]},
    "FourAxle.forward": {"wheel_speeds": (ORDINARY,) * 4},
    "GroundTruth.at": {"stamps": np.full(3, BEGIN)},
    "GroundTruth.at_in_space": {"stamps": np.full(3, BEGIN)},
    "Pose.between": {"other": (ORDINARY,) * 3},
    "Pose.to_body": {"twist": (ORDINARY,) * 3},
    "RockerBogie": {
        name: value for name, value in samples()["RockerBogie"].dimensions.items() if value is not None
    },
    "Twist.to_body": {"yaw": ORDINARY},
    "Twist.to_world": {"yaw": ORDINARY},
    "Rover.desaturate": {"wheel_speeds": np.full(6, ORDINARY)},
    "Rover.preset": {"name": "perseverance"},
    "FourAxleStep": {
        "action": "turn",
        "front_brake": "free",
        "rear_brake": "locked",
        "wheel_speeds": (1.0, 1.0, 1.0, 1.0),
    },
    "ModuleTransition.between": {
        "start": ROVER.inverse((0.05, 0.0, 0.0)),
        "end": ROVER.inverse((0.05, 0.0, 0.02)),
        "duration": 2.0,
    },
    "Suspension.forward": {"steering": np.full(2, ORDINARY)},
    "RockerBogie.preset": {"name": "rocky7"},
    "Suspension.preset": {"name": "zoe"},
    "Wheel": {"name": "one"},
    "Terrain": {"heights": np.full((3, 3), ORDINARY), "spacing": 0.1},
    "Costmap": {"values": np.full((3, 3), ORDINARY)},
    "simulate": {"rover": PAIR, "path": np.asarray(DRIVE)},
    "Preintegrated.add": {
        "wheel_angles": np.zeros((1, 6)),
        "stamp": np.full(1, BEGIN),
        "steering": np.zeros((1, 4)),
    },
}


@dataclass(frozen=True)
class Call:
    """A function, or a method of a sample: arguments by name, and others that may be given."""

    name: str
    function: Callable[..., Any]
    arguments: dict[str, Any]
    optional: dict[str, Any]
    positional: tuple[str, ...]

    def __call__(self, **changed: Any) -> Any:
        """The answer, of a copy of the object where it has a state."""
        given = self.arguments | changed
        first = [given.pop(name) for name in self.positional]
        function = self.function
        one = getattr(function, "__self__", None)
        if type(one).__name__ in samples():
            function = getattr(copy.copy(one), self.name.rpartition(".")[2])
        return function(*first, **given)


def functions() -> Iterator[tuple[str, Any, Callable[..., Any]]]:
    """Public functions, constructors and methods: name, the object of a method, and what is called."""
    for name in sw.__all__:
        thing = getattr(sw, name)
        if inspect.isroutine(thing) and not inspect.isclass(thing):
            yield name, None, thing
    for name, one in samples().items():
        if documented(type(one)):
            yield name, None, type(one)
        for part in dir(type(one)):
            member = inspect.getattr_static(type(one), part)
            if not (part.startswith("_") or inspect.isdatadescriptor(member) or hasattr(tuple, part)):
                bound = getattr(one, part)
                if callable(bound) and not inspect.isclass(bound):
                    yield f"{name}.{part}", one, bound


def documented(function: Callable[..., Any]) -> dict[str, str]:
    """Types of the arguments, as the docstring has them."""
    text = inspect.getdoc(function) or ""
    found: dict[str, str] = {}
    part = re.split(r"\n(?:Returns|Raises)\n-", text.partition("Parameters\n")[2])[0]
    for names, kind in re.findall(r"^([\w, *]+) : (.*)$", part, re.MULTILINE):
        found |= dict.fromkeys((name.strip(" *") for name in names.split(",")), kind)
    return found


def length(axis: str, one: Any) -> int | None:
    """Length of a named axis for a method of this object."""
    if axis.isdigit():
        return int(axis)
    for each in (one, getattr(one, "rover", None), getattr(one, "suspension", None)):
        if (counted := getattr(each, NAMES.get(axis, ""), None)) is not None:
            return len(counted)
        if axis == "steered wheels" and hasattr(each, "planar"):
            return len(each.planar().steered_wheel_names)
    return COUNTS.get(axis)


def ordinary(name: str, kind: str, one: Any) -> Any:
    """An ordinary value of an argument; None if none can be made."""
    if shape := re.search(r"shape \(([^)]*)\)", kind):
        axes = [length(axis.strip(), one) for axis in shape[1].split(",") if axis.strip() not in ("", "...")]
        if None in axes:
            return None
        value = np.full([each for each in axes if each is not None], ORDINARY)
        if "stamps" in name:
            return BEGIN + 0.1 * np.arange(len(value)) if value.ndim else BEGIN
        if value.shape[-1:] == (3,) and ("twist" in name or name == "controls"):
            value[..., 1] = 0.0  # wheels that do not steer let it roll straight ahead
        return value
    if numbers := re.match(r"\((float(?:, float)*)\)", kind):
        return (ORDINARY,) * len(numbers[1].split(","))
    if kind.startswith("float"):
        return BEGIN if name == "stamp" else 0.1
    if kind.startswith("int"):
        return 2
    if kind.startswith("SettledPose"):
        return one.settle(terrain(), (0.2, 0.1, 0.3))
    if words := re.match(r"\{'(\w+)'", kind):
        return words[1]
    return next((samples()[each] for each in re.findall(r"\w+", kind) if each in samples()), None)


def calls() -> Iterator[Call]:
    """Calls all of whose needed arguments can be made."""
    for name, one, function in functions():
        parameters = [
            each for each in inspect.signature(function).parameters.values() if each.kind not in VARIABLE
        ]
        kinds = documented(function)
        needed = [each for each in parameters if each.default is each.empty]
        given = {each.name: ordinary(each.name, kinds.get(each.name, ""), one) for each in needed}
        given |= GIVEN.get(name, {})
        optional = {
            each.name: ordinary(each.name, kinds[each.name], one)
            for each in parameters
            if each.name not in given and re.match(r"float|array|\(float", kinds.get(each.name, ""))
        }
        if all(value is not None for value in given.values()):
            first = tuple(each.name for each in needed if each.kind != each.KEYWORD_ONLY)
            yield Call(name, function, given, optional, first)
