"""Views of a record: a layout for Foxglove, a blueprint for Rerun. Both show the topics of `rover_record`.

Foxglove's is JSON, imported through its menu of layouts. Rerun's is written by its own library, because its
files hold for one version: a blueprint alone, or with the record in one file that ``rerun run.rrd`` opens.
"""

import json
from pathlib import Path
from typing import Any

from six_wheel._core import Rover
from six_wheel.rebuild import joints_as_given
from six_wheel.records import rover_record as topics
from six_wheel.records.reader import Record

__all__ = ["ENDINGS", "check", "foxglove", "rerun", "write"]

ENDINGS = {
    ".json": "Foxglove's layout",
    ".rbl": "Rerun's blueprint",
    ".rrd": "a record with Rerun's blueprint",
}
APPLICATION = "six_wheel"
PATH = "/path"  # of the rover, as a line
INSTALL = 'pip install "six-wheel[viewer]"'
COLOURS = ("#1f77b4", "#ff7f0e", "#2ca02c", "#d62728", "#9467bd", "#8c564b")

WANTED_AND_LIMITED = (("linear.x", "vx [m/s]"), ("linear.y", "vy [m/s]"), ("angular.z", "omega [rad/s]"))


def write(path: Path, rover: Rover, record: Path | None = None) -> None:
    """What the ending of a path says, see `ENDINGS`.

    Parameters
    ----------
    path : Path
        To be written; what is there is replaced.
    rover : Rover
        Whose joints are to be seen.
    record : Path, optional
        The record, for an .rrd.
    """
    check(path, record)
    if path.suffix == ".json":
        path.write_text(json.dumps(foxglove(rover), indent=2) + "\n")
    elif path.suffix == ".rbl":
        rerun(rover).save(APPLICATION, path)
    elif record is not None:
        blueprint = rerun(rover)
        import rerun as rr

        stream = rr.RecordingStream(APPLICATION)
        stream.save(path, default_blueprint=blueprint)
        stream.log_file_from_path(record)
        places, frame = _path(Record(record))
        if places:
            line = rr.LineStrips3D([places], radii=rr.Radius.ui_points(1.5))
            stream.log(PATH, line, rr.CoordinateFrame(frame), static=True)
        stream.flush()
        stream.disconnect()


def _path(record: Record) -> tuple[list[tuple[float, float, float]], str]:
    """Where odometry has been, and in which frame."""
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


def foxglove(rover: Rover) -> dict[str, Any]:
    """The layout: the rover in 3D, plots of motion, joints and slip, reasons over time, diagnostics."""
    steering, driving = joints_as_given(rover)
    joints = len(steering)
    motion = [
        (f"{topic}.twist.{field}", f"{label}, {name}")
        for field, name in WANTED_AND_LIMITED
        for topic, label in ((topics.WANTED, "wanted"), (topics.LIMITED, "commanded"))
    ]
    angles = [(f"{topics.COMMANDS}.position[{k}]", joint) for k, joint in enumerate(steering)]
    speeds = [(f"{topics.COMMANDS}.velocity[{joints + k}]", joint) for k, joint in enumerate(driving)]
    slip = [(f"{topics.SLIP}.data[{k}]", wheel) for k, wheel in enumerate(rover.wheel_names)]
    panels: dict[str, Any] = {
        "3D!rover": {
            "followMode": "follow-pose",
            "followTf": "odom",
            "topics": {
                topics.ODOMETRY: {"visible": True, "type": "arrow"},
                topics.DESCRIPTION: {"visible": True},
            },
            "transforms": {},
            "layers": {"grid": {"layerId": "foxglove.Grid", "visible": True, "frameLocked": True}},
        },
        "Plot!motion": _plot("wanted and commanded motion", motion),
        "Plot!wheels": _plot("wheel speeds [rad/s]", speeds),
        "Plot!slip": _plot("slip [m/s]", slip),
        "StateTransitions!reasons": {
            "paths": [
                {"value": f"{topics.REASONS}.data", "timestampMethod": "receiveTime", "label": "limited by"}
            ],
            "isSynced": True,
        },
        "DiagnosticSummary!all": {"topicToRender": topics.DIAGNOSTICS, "minLevel": 0, "sortByLevel": True},
    }
    left: Any = _split("column", "3D!rover", "DiagnosticSummary!all", 60)
    right: Any = _split("column", "Plot!wheels", "Plot!slip", 50)
    if steering:
        panels["Plot!steering"] = _plot("steering angles [rad]", angles)
        right = _split("column", "Plot!steering", right, 34)
    right = _split("column", "Plot!motion", right, 30)
    right = _split("column", right, "StateTransitions!reasons", 88)
    return {
        "configById": panels,
        "globalVariables": {},
        "userNodes": {},
        "playbackConfig": {"speed": 1},
        "layout": _split("row", left, right, 40),
    }


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


def rerun(rover: Rover) -> Any:
    """The blueprint: the path in 3D, plots of motion, joints and slip, the reasons.

    Raises
    ------
    ModuleNotFoundError
        If rerun-sdk is not installed.
    """
    try:
        import rerun as rr
        import rerun.blueprint as rrb
        from rerun.blueprint.encodings import ComponentSourceKind, VisualizerComponentMapping
    except ModuleNotFoundError as error:
        message = f"a blueprint for Rerun needs rerun-sdk: {INSTALL}"
        raise ModuleNotFoundError(message, name=error.name) from None

    def line(kind: str, selector: str, name: str) -> Any:
        """One number out of the messages of a topic."""
        mapping = VisualizerComponentMapping(
            target="Scalars:scalars",
            source_kind=ComponentSourceKind.SourceComponent,
            source_component=f"{kind}:message",
            selector=selector,
        )
        return rr.SeriesLines(names=name).visualizer(mappings=[mapping])

    def motion(field: str, name: str) -> Any:
        kind = "geometry_msgs.msg.TwistStamped"
        overrides: Any = {
            topic: [line(kind, f".twist.{field}", label)]
            for topic, label in ((topics.WANTED, "wanted"), (topics.LIMITED, "commanded"))
        }
        return rrb.TimeSeriesView(name=name, origin="/", contents=list(overrides), overrides=overrides)

    plots = [
        motion("linear.x", "forward [m/s]"),
        motion("angular.z", "turning [rad/s]"),
        rrb.TimeSeriesView(name="joint commands: speeds [rad/s]", origin=f"{topics.COMMANDS}/velocity"),
        rrb.TimeSeriesView(name=f"slip [m/s]: {', '.join(rover.wheel_names)}", origin=topics.SLIP),
    ]
    if rover.steering_joints:
        plots.insert(
            2, rrb.TimeSeriesView(name="joint commands: angles [rad]", origin=f"{topics.COMMANDS}/position")
        )
    return rrb.Blueprint(
        rrb.Horizontal(
            rrb.Vertical(
                rrb.Spatial3DView(
                    name="rover",
                    origin="/",
                    contents=[topics.TRANSFORMS, PATH],
                    overrides={topics.TRANSFORMS: rr.TransformAxes3D(1.0)},
                ),
                rrb.TextDocumentView(name="limited by", origin=topics.REASONS),
                row_shares=[4, 1],
            ),
            rrb.Vertical(*plots),
            column_shares=[2, 3],
        ),
        collapse_panels=True,
    )
