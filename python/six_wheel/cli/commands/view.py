"""`six-wheel view`: a rover or a record in the browser."""

import os
import signal
from pathlib import Path
from typing import Annotated, NamedTuple

import typer

from six_wheel.cli.map_options import MapReading
from six_wheel.cli.shared import Reading

Three = tuple[float, float, float]


class Scene(NamedTuple):
    """Options of what is shown at first."""

    ground: Annotated[
        str | None,
        typer.Option(
            metavar="MAP|yard|flat",
            help="What a suspension stands on: a map, rocks by seed (the default), or a plane.",
        ),
    ] = None
    rover: Annotated[
        str | None, typer.Option(metavar="ROVER", help="Whose record it is, where it does not say so itself.")
    ] = None
    at: Annotated[
        Three | None,
        typer.Option(metavar="X Y YAW", help="First pose [m, m, rad]. Default: the middle of the map."),
    ] = None
    twist: Annotated[
        Three | None,
        typer.Option(metavar="VX VY OMEGA", help="First motion [m/s, m/s, rad/s]. Default: a left turn."),
    ] = None
    steering_limit: Annotated[
        float | None, typer.Option(metavar="DEG", help="Largest steering angle at first [degrees].")
    ] = None
    wheel_speed: Annotated[
        float | None, typer.Option(metavar="RAD/S", help="Limit of the wheels at first [rad/s].")
    ] = None
    speed: Annotated[float | None, typer.Option(metavar="M/S", help="Limit of the speed at first [m/s].")] = (
        None
    )
    tilt: Annotated[float | None, typer.Option(metavar="DEG", help="Largest tilt at first [degrees].")] = None
    joints: Annotated[
        Three | None,
        typer.Option(
            metavar="ROCKER BOGIE BOGIE",
            help="Angles of a suspension without ground, left bogie first [degrees].",
        ),
    ] = None
    scrub: Annotated[
        list[str] | None,
        typer.Option(metavar="WHEEL=M", help="Scrub of a wheel at first, without ground [m]; once each."),
    ] = None
    beside: Annotated[
        str | None,
        typer.Option("--with", metavar="RECORD", help="A second record, its rover paler; both begin at 0 s."),
    ] = None
    time: Annotated[
        float | None, typer.Option(metavar="S", help="Time in a record at first, since its first row [s].")
    ] = None


class Page(NamedTuple):
    """Options of the page."""

    port: Annotated[int, typer.Option(help="Port on this machine; 0 takes a free one.")] = 0
    no_browser: Annotated[bool, typer.Option("--no-browser", help="Only print the address.")] = False
    export: Annotated[
        Path | None,
        typer.Option(metavar="PAGE.html", help="Write the page, which then needs no server, and end."),
    ] = None
    theme: Annotated[str, typer.Option(metavar="dark|light", help="Of the page.")] = "dark"


def view(
    what: Annotated[
        str,
        typer.Argument(
            metavar="[WHAT]",
            help="Name of a preset; parameter file, URDF or xacro file; record: .mcap, .csv, .parquet, "
            "folder of a bag.",
        ),
    ] = "perseverance",
    *,
    scene: Scene,
    page: Page,
    map_reading: MapReading,
    reading: Reading,
) -> None:
    import math

    from six_wheel.view.opening import browse
    from six_wheel.view.server import free_port, require

    require()
    port = page.port if page.export is None else None
    if port is not None:
        free_port(port)
    from six_wheel.view.subject import find_subject

    ground, other = map_reading.ground(scene.ground), scene.beside
    subject = find_subject(what, ground, rover=scene.rover, at=scene.at, other=other, **reading._asdict())
    from six_wheel.view.commands import scrub_of, start_state
    from six_wheel.view.viewing import View

    def radians(degrees: float | None) -> float | None:
        return None if degrees is None else math.radians(degrees)

    state = start_state(
        subject,
        twist=scene.twist,
        steering_limit=radians(scene.steering_limit),
        wheel_speed=scene.wheel_speed,
        speed=scene.speed,
        tilt=radians(scene.tilt),
        joints=None if scene.joints is None else tuple(map(math.radians, scene.joints)),
        scrub=scrub_of(scene.scrub or ()),
    )
    shown = View(subject, state, port=port, theme=page.theme)
    with shown:
        if scene.time is not None:
            shown.time = scene.time
        if page.export is not None:
            print(shown.save(page.export).resolve())
            return
        caught: list[int] = []
        # An exception could be raised within a callback of a library, which loses it.
        signal.signal(signal.SIGINT, lambda number, _frame: caught.append(number))
        print(f"{shown.url}  (Ctrl-C ends)", flush=True)
        if not page.no_browser:
            browse(shown.url)
        while not caught and not shown.wait(0.1):
            pass
        shown.close()
        os._exit(0)  # threads of a server with a browser on it would be waited for
