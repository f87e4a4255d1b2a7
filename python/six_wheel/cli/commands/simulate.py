"""`six-wheel simulate`: a rover over a map, by a table of commands."""

import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from six_wheel.cli.shared import choose_suspension, grid, new_console

ROWS = 200_000  # of a table in memory at a time

if TYPE_CHECKING:
    from six_wheel._core import Terrain
    from six_wheel.simulation.ground import GroundSimulation


def simulate(
    rover: Annotated[str, typer.Argument(metavar="ROVER", help="Name of a preset with a suspension.")],
    commands: Annotated[
        Path, typer.Argument(metavar="COMMANDS", help="Table with time, vx, vy, omega: .csv or .parquet.")
    ],
    ground: Annotated[
        Path, typer.Option(metavar="MAP", help="Heights in metres: GeoTIFF, PDS, ESRI ASCII, bag.")
    ],
    output: Annotated[
        Path | None, typer.Option("-o", "--output", help="Where the results go: .csv, .parquet or .mcap.")
    ] = None,
    start: Annotated[
        str | None,
        typer.Option(
            metavar="X,Y,YAW", help="First pose [m, m, rad]; default the middle of the map, along x."
        ),
    ] = None,
    rate: Annotated[float, typer.Option(metavar="HZ", help="Samples per second.")] = 10.0,
    seed: Annotated[int, typer.Option(help="Of all that is random.")] = 0,
    plot: Annotated[
        Path | None,
        typer.Option(help="Picture of the drive in three dimensions, with a film strip: .png, .svg or .pdf."),
    ] = None,
    speeds: Annotated[
        Path | None,
        typer.Option(help="Picture of the wheels' speeds against those on level ground: .png, .svg or .pdf."),
    ] = None,
) -> None:
    arm = choose_suspension(rover)
    if plot is not None or speeds is not None:
        from six_wheel.plot.saving import picture_path

        for path in filter(None, (plot, speeds)):
            picture_path(path)
    import numpy as np

    from six_wheel._core import Terrain
    from six_wheel.logs.tables import CommandTable, table_format
    from six_wheel.simulation.ground import GroundSimulation
    from six_wheel.simulation.ground_writing import ENDINGS, write_ground
    from six_wheel.simulation.running import simulate as run

    if output is not None and output.suffix.lower() not in ENDINGS:
        table_format(output, ENDINGS)
    land = Terrain.read(ground)
    with CommandTable(commands) as table:
        chunks = list(table.chunks(ROWS))
        scale = table.time_unit.scale
    times = np.concatenate([chunk.time for chunk in chunks])
    way: Any = (times - times[0]) * scale, np.concatenate([chunk.twists for chunk in chunks])
    first = _start(start) if start is not None else (*_middle(land), 0.0)
    done = run(arm, way, ground=land, start=first, rate=rate, seed=seed)
    assert isinstance(done, GroundSimulation)
    if output is not None:
        write_ground(done, arm, output)
    if plot is not None or speeds is not None:
        from six_wheel.plot.ground.run import ground_figure, speeds_figure
        from six_wheel.plot.saving import save

        title = f"{rover} over {ground.name}"
        if plot is not None:
            save(ground_figure(done, arm, land, title=title), plot)
        if speeds is not None:
            save(speeds_figure(done, arm, title=title), speeds)
    rows = _summary(done)
    new_console().print(grid([*rows, ("results", output), ("picture", plot), ("speeds", speeds)]))


def _middle(land: "Terrain") -> tuple[float, float]:
    """Of a map [m]."""
    (rows, columns), (dx, dy), (x, y) = land.shape, land.spacing, land.origin
    ahead, aside = dx * (columns - 1) / 2, dy * (rows - 1) / 2
    cos, sin = math.cos(land.orientation), math.sin(land.orientation)
    return x + cos * ahead - sin * aside, y + sin * ahead + cos * aside


def _summary(run: "GroundSimulation") -> list[tuple[str, object]]:
    """What a drive came to, as rows for `grid`."""
    import numpy as np

    stand, speeds, flat, slip = run.stand, run.speeds, run.flat_speeds, run.slip
    assert stand is not None
    assert speeds is not None
    assert flat is not None
    assert slip is not None
    statuses = np.asarray(stand.status).astype(str).tolist()
    tilt = np.degrees(np.arccos(np.cos(stand.roll) * np.cos(stand.pitch)))
    driving = np.abs(flat) > 1e-9
    off = np.abs(speeds - flat)[driving] / np.abs(flat)[driving]
    counted = ", ".join(f"{status} {statuses.count(status):,}" for status in dict.fromkeys(statuses))
    return [
        ("samples", f"{len(run.stamps):,}, {counted}"),
        ("duration", f"{run.stamps[-1] - run.stamps[0]:.6g} s"),
        ("largest tilt", f"{np.nanmax(tilt):.3g} deg"),
        ("largest joint angle", f"{np.degrees(np.nanmax(np.abs(stand.joints))):.3g} deg"),
        ("largest slip angle", f"{np.degrees(np.nanmax(np.abs(slip.angle))):.3g} deg"),
        ("wheel speeds", f"off those on level ground by {np.median(off):.1%}, at most {off.max():.1%}")
        if off.size
        else ("wheel speeds", "all 0"),
    ]


def _start(text: str) -> tuple[float, float, float]:
    try:
        x, y, yaw = (float(number) for number in text.split(","))
    except ValueError:
        raise ValueError(f'--start must be three numbers, x,y,yaw, got "{text}"') from None
    return x, y, yaw
