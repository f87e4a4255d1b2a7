"""Views of a record: a layout for Foxglove, a blueprint for Rerun. Both show the topics of `rover_record`.

Foxglove's is JSON, imported through its menu of layouts. Rerun's is written by its own library, because its
files hold for one version: a blueprint alone, or with the record in one file that ``rerun run.rrd`` opens.
"""

import json
from pathlib import Path
from typing import Any, NamedTuple

from six_wheel._core import Rover
from six_wheel.kinematics.errors import needed
from six_wheel.kinematics.objects.whole_files import replacing
from six_wheel.logs.mcap import rover_record as topics
from six_wheel.logs.mcap.reader import Record
from six_wheel.robot_description.wheels_of_rover import joints_as_given

ENDINGS = {
    ".json": "Foxglove's layout",
    ".rbl": "Rerun's blueprint",
    ".rrd": "a record with Rerun's blueprint",
}
APPLICATION = "six_wheel"
PATH = "/path"  # of the rover, as a line
COLOURS = ("#1f77b4", "#ff7f0e", "#2ca02c", "#d62728", "#9467bd", "#8c564b")

WANTED_AND_LIMITED = (("linear.x", "vx [m/s]"), ("linear.y", "vy [m/s]"), ("angular.z", "omega [rad/s]"))


class Seen(NamedTuple):
    """Content that a layout can show: topics, and the joints in the order of their states."""

    topics: frozenset[str]
    joints: tuple[str, ...] = ()

    @property
    def commands(self) -> list[tuple[str, str]]:
        """Topics of commands, each with its name in a plot."""
        every = ((topics.WANTED, "wanted"), (topics.LIMITED, "commanded"))
        return [each for each in every if each[0] in self.topics]


_OF_NODE = "WANTED LIMITED COMMANDS ODOMETRY REASONS SLIP DIAGNOSTICS"
ALL = Seen(frozenset(getattr(topics, name) for name in _OF_NODE.split()))  # the topics of a node


def _seen(record: Record) -> Seen:
    first = next(record.messages([topics.JOINTS]), None)
    return Seen(frozenset(record.topics()), () if first is None else tuple(record.parsed(first).name))


def write(path: Path, rover: Rover, record: Path | None = None) -> None:
    """Write the layout that the ending of a path asks for, or the record with it, see `ENDINGS`."""
    check(path, record)
    seen = ALL if record is None else _seen(Record(record))
    with replacing(path, [] if record is None else [record]) as temporary:
        if path.suffix == ".json":
            temporary.write_text(json.dumps(foxglove(rover, seen), indent=2) + "\n")
        elif path.suffix == ".rbl" or record is None:
            rerun(rover, seen).save(APPLICATION, temporary)
        else:
            _write_record(temporary, rerun(rover, seen), record)


def _write_record(temporary: Path, blueprint: Any, record: Path) -> None:
    """A record with its blueprint in one file."""
    import rerun as rr

    stream = rr.RecordingStream(APPLICATION)
    stream.save(temporary, default_blueprint=blueprint)
    stream.log_file_from_path(record)
    places, frame = _path(Record(record))
    if places:
        line = rr.LineStrips3D([places], radii=rr.Radius.ui_points(1.5))
        stream.log(PATH, line, rr.CoordinateFrame(frame), static=True)
    stream.flush()
    stream.disconnect()


def _path(record: Record) -> tuple[list[tuple[float, float, float]], str]:
    """Positions of odometry [m] and the name of their frame."""
    places, frame = [], ""
    for message in record.messages([topics.ODOMETRY]):
        said = record.parsed(message)
        at, frame = said.pose.pose.position, said.header.frame_id
        places.append((at.x, at.y, at.z))
    return places, frame


def check(path: Path, record: Path | None) -> None:
    """Fails unless the ending of a path is one of `ENDINGS`, and its record there if it takes one."""
    if path.suffix in ENDINGS and (path.suffix != ".rrd" or record is not None):
        return
    listed = ", ".join(f"{ending} ({what})" for ending, what in ENDINGS.items())
    got = "a rover without its record" if path.suffix == ".rrd" else f'"{path.suffix}"'
    raise ValueError(f"{path}: the ending of a layout must be one of {listed}, got {got}")


# Foxglove


def foxglove(rover: Rover, seen: Seen = ALL) -> dict[str, Any]:
    """The layout: the rover in 3D, plots of motion, joints and slip, reasons over time, diagnostics."""
    panels: dict[str, Any] = {
        "3D!rover": {
            "followMode": "follow-pose",
            "followTf": "map" if topics.TRUTH in seen.topics else "odom",
            "topics": {
                topics.ODOMETRY: {"visible": True, "type": "arrow"},
                topics.DESCRIPTION: {"visible": True},
            },
            "transforms": {},
            "layers": {"grid": {"layerId": "foxglove.Grid", "visible": True, "frameLocked": True}},
        }
    }
    plots = {
        "Plot!motion": _plot(*_motion_lines(seen)),
        "Plot!steering": _plot(*_joint_lines(rover, seen, steering=True)),
        "Plot!wheels": _plot(*_joint_lines(rover, seen, steering=False)),
    }
    if topics.SLIP in seen.topics:
        slip = [(f"{topics.SLIP}.data[{k}]", wheel) for k, wheel in enumerate(rover.wheel_names)]
        plots["Plot!slip"] = _plot("slip [m/s]", slip)
    panels |= {name: plot for name, plot in plots.items() if plot["paths"]}
    right = [name for name in panels if name != "3D!rover"]
    if topics.REASONS in seen.topics:
        path = {"value": f"{topics.REASONS}.data", "timestampMethod": "receiveTime", "label": "limited by"}
        panels["StateTransitions!reasons"] = {"paths": [path], "isSynced": True}
    left: Any = "3D!rover"
    if topics.DIAGNOSTICS in seen.topics:
        said = {"topicToRender": topics.DIAGNOSTICS, "minLevel": 0, "sortByLevel": True}
        panels["DiagnosticSummary!all"] = said
        left = _split("column", left, "DiagnosticSummary!all", 60)
    stack = _stack(right)
    if topics.REASONS in seen.topics:
        stack = _split("column", stack, "StateTransitions!reasons", 88)
    return {
        "configById": panels,
        "globalVariables": {},
        "userNodes": {},
        "playbackConfig": {"speed": 1},
        "layout": _split("row", left, stack, 40),
    }


def _motion_lines(seen: Seen) -> tuple[str, list[tuple[str, str]]]:
    """Title and lines of the motion plot: wanted and commanded motion; without commands the odometry's."""
    lines = [
        (f"{topic}.twist.{field}", f"{label}, {name}")
        for field, name in WANTED_AND_LIMITED
        for topic, label in seen.commands
    ]
    if lines:
        return "wanted and commanded motion", lines
    lines = [(f"{topics.ODOMETRY}.twist.twist.{field}", name) for field, name in WANTED_AND_LIMITED]
    return "motion by odometry", lines


def _joint_lines(rover: Rover, seen: Seen, *, steering: bool) -> tuple[str, list[tuple[str, str]]]:
    """Commands to the joints; of a record without commands the readings."""
    steered, driving = map(list, joints_as_given(rover))
    names = steered if steering else driving
    if topics.COMMANDS in seen.topics:
        field, first = ("position", 0) if steering else ("velocity", len(steered))
        lines = [(f"{topics.COMMANDS}.{field}[{k}]", joint) for k, joint in enumerate(names, first)]
        return "steering angles [rad]" if steering else "wheel speeds [rad/s]", lines
    read = [
        (f"{topics.JOINTS}.position[{k}]", joint) for k, joint in enumerate(seen.joints) if joint in names
    ]
    return ("steering angles [rad]" if steering else "wheel angles [rad]"), read


def _stack(panels: list[str]) -> Any:
    """Panels below each other, of one height."""
    first, *rest = panels
    return _split("column", first, _stack(rest), 100 / len(panels)) if rest else first


def _plot(title: str, paths: list[tuple[str, str]]) -> dict[str, Any]:
    lines = [
        {
            "value": value,
            "label": label,
            "enabled": True,
            "timestampMethod": "receiveTime",
            "color": COLOURS[k % len(COLOURS)],
        }
        for k, (value, label) in enumerate(paths)
    ]
    return {
        "foxglovePanelTitle": title,
        "paths": lines,
        "xAxisVal": "timestamp",
        "isSynced": True,
        "showLegend": True,
        "legendDisplay": "floating",
        "showXAxisLabels": True,
        "showYAxisLabels": True,
    }


def _split(direction: str, first: Any, second: Any, share: float) -> dict[str, Any]:
    return {"direction": direction, "first": first, "second": second, "splitPercentage": share}


# Rerun


def rerun(rover: Rover, seen: Seen = ALL) -> Any:
    """The blueprint: the path in 3D, plots of motion, joints and slip, the reasons. Raises
    `ModuleNotFoundError` if rerun-sdk is not installed."""
    with needed("six-wheel[viewer]", "a blueprint for Rerun needs"):
        import rerun as rr
        import rerun.blueprint as rrb

    def view(name: str, origin: str) -> Any:
        return rrb.TimeSeriesView(name=name, origin=origin)

    plots = [_motion(seen, "linear.x", "forward [m/s]"), _motion(seen, "angular.z", "turning [rad/s]")]
    if topics.COMMANDS in seen.topics:
        if rover.steering_joints:
            plots.append(view("joint commands: angles [rad]", f"{topics.COMMANDS}/position"))
        plots.append(view("joint commands: speeds [rad/s]", f"{topics.COMMANDS}/velocity"))
    else:
        plots.append(view("joint states: angles [rad]", f"{topics.JOINTS}/position"))
    if topics.SLIP in seen.topics:
        plots.append(view(f"slip [m/s]: {', '.join(rover.wheel_names)}", topics.SLIP))
    space = rrb.Spatial3DView(
        name="rover",
        origin="/",
        contents=[topics.TRANSFORMS, PATH],
        overrides={topics.TRANSFORMS: rr.TransformAxes3D(1.0)},
    )
    reasons = [rrb.TextDocumentView(name="limited by", origin=topics.REASONS)]
    shown = reasons if topics.REASONS in seen.topics else []
    return rrb.Blueprint(
        rrb.Horizontal(
            rrb.Vertical(space, *shown, row_shares=[4, 1][: 1 + len(shown)]),
            rrb.Vertical(*plots),
            column_shares=[2, 3],
        ),
        collapse_panels=True,
    )


def _motion(seen: Seen, field: str, name: str) -> Any:
    """A plot of one number of the twists: wanted and commanded, or else by odometry."""
    import rerun as rr
    import rerun.blueprint as rrb
    from rerun.blueprint.encodings import ComponentSourceKind, VisualizerComponentMapping

    told, kind, inner = seen.commands, "geometry_msgs.msg.TwistStamped", ".twist"
    if not told:
        told, kind, inner = [(topics.ODOMETRY, "by odometry")], "nav_msgs.msg.Odometry", ".twist.twist"
    overrides: Any = {}
    for topic, label in told:
        mapping = VisualizerComponentMapping(
            target="Scalars:scalars",
            source_kind=ComponentSourceKind.SourceComponent,
            source_component=f"{kind}:message",
            selector=f"{inner}.{field}",
        )
        overrides[topic] = [rr.SeriesLines(names=label).visualizer(mappings=[mapping])]
    return rrb.TimeSeriesView(name=name, origin="/", contents=list(overrides), overrides=overrides)
