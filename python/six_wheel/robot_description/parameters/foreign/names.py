"""Names of joints in controllers: those of a robot, those of their states, names with a sign."""

from collections.abc import Mapping, Sequence
from typing import Any

from six_wheel._core import Rover
from six_wheel.robot_description.parameters.foreign.limits import is_number
from six_wheel.robot_description.parameters.joints import JointList
from six_wheel.robot_description.parameters.key_types import Values
from six_wheel.robot_description.parameters.ros_node_parameters import Section


def stated_joints(values: Values, rover: Rover) -> list[JointList]:
    """Lists of joints that the file or its robot states as wheel to joint."""
    lists = []
    for key, steers in (("traction_joints", False), ("steering_joints", True)):
        wheels = rover.steered_wheel_names if steers else tuple(w.name for w in rover.wheels if w.driven)
        if key in values:
            lists.append(JointList.of(rover, key, wheels, steers=steers))
    return lists


def reversed_by_sign(factors: Mapping[str, Sequence[str]], values: Values) -> Values:
    """`reversed_joints`: those of the keys of each factor that is negative."""
    turned = [
        joint
        for factor, keys in factors.items()
        if is_number(values.get(factor)) and values[factor] < 0
        for key in keys
        for joint in listed(values.get(key, ()))
    ]
    # Two factors that are negative reverse a joint twice.
    once = [joint for joint in dict.fromkeys(turned) if turned.count(joint) % 2]
    return {"reversed_joints": once} if once and "reversed_joints" not in values else {}


def listed(value: Any) -> list[str]:
    """The names in a key that holds one, several or none."""
    return [value] if isinstance(value, str) else list(value or ())


def _own_joint(name: str) -> str:
    """The joint behind a chained controller: ``pid_controller/left_joint`` commands ``left_joint``."""
    return name.rpartition("/")[2] or name


def by_states(keys: Mapping[str, str], section: Section, values: Values) -> Values:
    """Joints by the names under which their states come, as bags have them.

    `keys` has the key of the states for each of those of the commands.
    """
    named: Values = {}
    for key, states in keys.items():
        given, said = values.get(key), section.data.get(states)
        if isinstance(given, str):
            named[key] = said if isinstance(said, str) and said else _own_joint(given)
        elif isinstance(given, list):
            same = (
                isinstance(said, list) and len(said) == len(given) and all(isinstance(n, str) for n in said)
            )
            named[key] = said if same else [_own_joint(name) for name in given]
    return named
