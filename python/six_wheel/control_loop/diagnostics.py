"""Diagnostics of a loop: one status for each thing that can be wrong."""

import math

from six_wheel.control_loop.faults import AREAS, ERROR, OK, STALE
from six_wheel.control_loop.loop import Loop
from six_wheel.kinematics.controller import Reason

Status = tuple[int, str, str, dict[str, str]]
LISTED = 3  # faults of an area in one line of the log


class FaultLines:
    """Lines for a log: one when faults of an area begin, one when they have ended."""

    def __init__(self) -> None:
        self._lasting: dict[tuple[str, str], int] = {}

    def lines(self, loop: Loop) -> list[tuple[int, str]]:
        """Level and text of what has changed since the last call; before `statuses`, which counts anew."""
        now = {(fault.area, fault.what): (fault.level, str(fault)) for fault in loop.faults if fault.new}
        if loop.stuck is not None or loop.halted:
            level, _, text, _ = _motion(loop, "")
            now["motion", "halted"] = level, text
        begun = {key: said for key, said in now.items() if key not in self._lasting}
        ended = {key: (OK, key[1]) for key in self._lasting if key not in now}
        self._lasting = {key: level for key, (level, _) in now.items()}
        listed = []
        for faults, is_over in ((begun, False), (ended, True)):
            for area in ("motion", *AREAS):
                found = [said for key, said in faults.items() if key[0] == area]
                if not found:
                    continue
                texts = [text for _, text in found]
                more = f"; and {len(texts) - LISTED} more" if len(texts) > LISTED else ""
                stops = area == "joints" and loop.stopping is not None and not is_over
                what = "over: " if is_over else f"the rover stops, {loop.stopping}: " if stops else ""
                listed.append(
                    (max(level for level, _ in found), f"{area}: {what}{'; '.join(texts[:LISTED])}{more}")
                )
        return listed


def statuses(loop: Loop, name: str) -> list[Status]:
    """Level, name, message and values of everything there is to say of a loop, in a node of this name, since
    the last report, which this is then."""
    listed: list[Status] = [_motion(loop, name)]
    for area in AREAS:
        found = loop.faults.of(area)
        new = [fault for fault in found if fault.new]
        level = max((fault.level for fault in new), default=OK)
        said = {fault.what: f"{fault.count} times, last: {fault.last or 'so'}" for fault in found}
        if area == "odometry":
            said = _odometry(loop) | said
        message = "; ".join(map(str, new)) or "good"
        listed.append((level, f"{name}: {area}", message, said))
    loop.faults.reported()
    loop.reasons.clear()
    return listed


def _motion(loop: Loop, name: str) -> Status:
    """Status of the controller: wanted and commanded motion, and the reasons for limiting it."""
    steps = sum(loop.reasons.values())
    shares = {
        str(each.name): sum(count for reasons, count in loop.reasons.items() if reasons & each) / steps
        for each in Reason
        if any(reasons & each for reasons in loop.reasons)
    }
    said = {
        "steps since the last report": str(steps),
        "wanted": _twist(loop.wanted),
        "commanded": _twist(loop.twist),
        "stopping distance [m]": f"{loop.stopping_distance:.4g}",
    }
    said |= {f"limited by {each}": f"{share:.1%} of the steps" for each, share in shares.items()}
    if loop.stuck is not None:
        joint, error = loop.stuck
        said |= {"stuck joint": joint, "error of the stuck joint [rad]": f"{error:.4g}"}
        text = (
            f"halted: joint {joint} does not follow, {error:.3g} rad off its command; ~/release tries again"
        )
        return ERROR, f"{name}: motion", text, said
    if loop.halted:
        return ERROR, f"{name}: motion", "halted; ~/release ends it", said
    if loop.stopping is not None:
        return ERROR, f"{name}: motion", f"stopped: {loop.stopping}", said
    if not loop.active:
        return OK, f"{name}: motion", "inactive", said
    if not steps:
        return STALE, f"{name}: motion", "waiting for joint states", said
    limited = ", ".join(shares)
    return OK, f"{name}: motion", f"limited by {limited}" if limited else "as wanted", said


def _odometry(loop: Loop) -> dict[str, str]:
    """Values of the odometry: pose, its standard deviation, health, bias of the gyroscope, slip."""
    state = loop.state
    x, y, yaw = state.pose.tolist()
    sigmas = [math.sqrt(max(state.covariance[k, k], 0.0)) for k in range(3)]
    said = {
        "pose": f"{x:.4f} m, {y:.4f} m, {yaw:.4f} rad",
        "standard deviation": "{:.2g} m, {:.2g} m, {:.2g} rad".format(*sigmas),
        "health": "|".join(str(each.name) for each in state.health) or "GOOD",
    }
    if (bias := loop.gyroscope_bias) is not None:
        said["bias of the gyroscope"] = "{:.4g} +- {:.2g} rad/s".format(*bias)
    slips = zip(loop.settings.rover.wheel_names, state.residuals.tolist(), strict=True)
    return said | {f"slip of {wheel} [m/s]": f"{slip:.4f}" for wheel, slip in slips}


def _twist(twist: tuple[float, float, float]) -> str:
    return "{:.4g} m/s, {:.4g} m/s, {:.4g} rad/s".format(*twist)
