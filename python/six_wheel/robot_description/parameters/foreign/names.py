"""Names of joints in controllers: those of another controller, those of their states, names with a sign."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from six_wheel.robot_description.parameters.foreign.limits import is_number, with_limits
from six_wheel.robot_description.parameters.ros_node_parameters import Section
from six_wheel.robot_description.parameters.schema import Values

__all__ = ["reversed_by_sign", "with_states"]


def reversed_by_sign(
    factors: Mapping[str, Sequence[str]], complete: Callable[..., Values] = with_limits
) -> Callable[[Section, Values], Values]:
    """A `Form.complete` by which negative factors reverse the joints of some keys."""

    def completed(section: Section, values: Values) -> Values:
        turned = [
            joint
            for factor, keys in factors.items()
            if is_number(values.get(factor)) and values[factor] < 0
            for key in keys
            for joint in _listed(values.get(key, ()))
        ]
        # Two factors that are negative reverse a joint twice.
        once = [joint for joint in dict.fromkeys(turned) if turned.count(joint) % 2]
        more = {"reversed_joints": once} if once and "reversed_joints" not in values else {}
        return complete(section, values | more)

    return completed


def _listed(value: Any) -> Sequence[str]:
    return [value] if isinstance(value, str) else list(value)


def _own_joint(name: str) -> str:
    """The joint behind a chained controller: ``pid_controller/left_joint`` commands ``left_joint``."""
    return name.rpartition("/")[2] or name


def with_states(
    keys: Mapping[str, str], complete: Callable[..., Values]
) -> Callable[[Section, Values], Values]:
    """A `Form.complete` by which joints go by the names under which their states come, as bags have them.

    `keys` has the key of the states for each of those of the commands.
    """

    def completed(section: Section, values: Values) -> Values:
        named: Values = {}
        for key, states in keys.items():
            given, said = values.get(key), section.data.get(states)
            if isinstance(given, str):
                named[key] = said if isinstance(said, str) and said else _own_joint(given)
            elif isinstance(given, list):
                same = (
                    isinstance(said, list)
                    and len(said) == len(given)
                    and all(isinstance(n, str) for n in said)
                )
                named[key] = said if same else [_own_joint(name) for name in given]
        return complete(section, values | named)

    return completed
