"""Layouts show what a record has, and no empty panels."""

import json
from pathlib import Path

import pytest

pytest.importorskip("mcap", reason='needs pip install "six-wheel[bags]"')

from six_wheel.logs.mcap import Record, layouts

ROVER = "d1: 0.4\nd2: 0.5\nd3: 0.5\nd4: 0.45\nwheel_radius: 0.15\n"
COMMANDS = "time,vx,vy,omega\n" + "".join(f"{k / 4},0.3,0,{k % 3 / 10}\n" for k in range(9))


def made(run) -> dict[str, list[str]]:
    """Records by what makes them, and the panels of each."""
    Path("rover.yaml").write_text(ROVER)
    Path("commands.csv").write_text(COMMANDS)
    for arguments in (
        ("simulate", "rover.yaml", "commands.csv", "-o", "simulate.mcap"),
        ("odometry", "rover.yaml", "simulate.mcap", "-o", "odometry.mcap"),
        ("drive", "rover.yaml", "commands.csv", "--rate", "20", "-o", "drive.mcap"),
    ):
        code, _, err = run(*arguments)
        assert (code, err) == (0, "")
    return {
        "simulate": ["Plot!motion", "Plot!steering", "Plot!wheels"],
        "odometry": ["Plot!motion", "Plot!steering", "Plot!wheels", "Plot!slip"],
        "drive": ["Plot!motion", "Plot!steering", "Plot!wheels", "Plot!slip", "StateTransitions!reasons"],
    }


def test_every_path_of_a_layout_is_in_its_record(run) -> None:
    for name, panels in made(run).items():
        code, out, _ = run("convert", f"{name}.mcap", f"{name}.json")
        assert (code, Path(out.strip()).name) == (0, f"{name}.json")
        shown = json.loads(Path(f"{name}.json").read_text())["configById"]
        assert list(shown) == ["3D!rover", *panels]
        record = Record(Path(f"{name}.mcap"))
        there = {}
        for message in record.messages():
            there.setdefault(message.topic, record.parsed(message))
        for panel in shown.values():
            for path in panel.get("paths", []):
                topic, _, field = path["value"].partition(".")
                value = there[topic]
                for part in field.split("."):
                    key, _, index = part.partition("[")
                    value = getattr(value, key)
                    value = value[int(index[:-1])] if index else value
                assert value is not None
                if topic == "/joint_states":
                    assert path["label"] == there[topic].name[int(path["value"].split("[")[1][:-1])]


def test_rerun_takes_every_kind_of_record(run) -> None:
    pytest.importorskip("rerun", reason='needs pip install "six-wheel[viewer]"')
    for name in made(run):
        for ending in (".rbl", ".rrd"):
            code, _, err = run("convert", f"{name}.mcap", f"{name}{ending}")
            assert (code, err) == (0, "")
            assert Path(f"{name}{ending}").stat().st_size > 10_000


def test_a_layout_without_a_record_has_all_panels() -> None:
    import six_wheel as sw

    panels = layouts.foxglove(sw.Rover.preset("perseverance"))["configById"]
    assert len(panels) == 7
    assert all(panel.get("paths", True) for panel in panels.values())
