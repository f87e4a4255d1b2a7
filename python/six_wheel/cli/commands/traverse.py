"""`six-wheel traverse`: where on a map a rover can stand."""

import math
import time
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from six_wheel.cli.map_options import MapReading
from six_wheel.cli.shared import SUSPENDED, choose_suspension, grid, new_console, progress_bar, several

if TYPE_CHECKING:
    from six_wheel.kinematics.statuses import FeasibilityLimits

ANGLES = ("roll", "pitch", "tilt", "rocker", "bogie")
UNITS = {"": 1.0, "rad": 1.0, "deg": math.radians(1.0)}

LayersOption = Annotated[
    Path,
    typer.Option(
        "-o", "--output", help="GeoTIFF: share of safe headings, worst tilt, clearance left, reason."
    ),
]
LimitOption = Annotated[
    list[str] | None,
    typer.Option(
        metavar="NAME=VALUE",
        help="Largest roll, pitch, tilt, rocker, bogie (15deg or 0.26rad), wheel_drop [m]; "
        "least clearance [m].",
    ),
]


def traverse(
    rover: Annotated[
        str,
        typer.Argument(
            metavar="ROVER",
            help=f"{', '.join(SUSPENDED)}, or a parameter file or URDF with a suspension.",
        ),
    ],
    map: Annotated[
        Path,
        typer.Argument(metavar="MAP", help="GeoTIFF, PDS, NetCDF, text, bag or YAML of one and its options."),
    ],
    output: LayersOption,
    headings: Annotated[int, typer.Option(help="How many, evenly spaced.")] = 16,
    limit: LimitOption = None,
    map_error: Annotated[float, typer.Option(help="How far the heights may be wrong [m].")] = 0.0,
    cluster: Annotated[
        str | None, typer.Option(metavar="ADDRESS", help="Dask scheduler, as tcp://10.0.0.7:8786.")
    ] = None,
    workers: Annotated[int | None, typer.Option(help="Processes; default one per core.")] = None,
    plot: Annotated[Path | None, typer.Option(help="Picture: .png, .svg or .pdf.")] = None,
    *,
    map_reading: MapReading,
) -> None:
    suspension, name = choose_suspension(rover)
    if plot is not None:
        from six_wheel.plotting.saving import picture_path

        picture_path(plot)
    from six_wheel.maps.traversability import traverse as run

    limits = _limits(several(limit, "="))
    begin = time.monotonic()
    with progress_bar("tiles") as update:
        done = run(
            map,
            suspension,
            output,
            headings=headings,
            limits=limits,
            map_error=map_error,
            cluster=cluster,
            workers=workers,
            progress=lambda done, total: update(done, total),
            **map_reading.given(),
        )
    if plot is not None:
        from six_wheel.plotting import save, traverse_figure

        layers = done.picture
        save(traverse_figure(layers.safe, layers.tilt, done.extent, f"{name} on {map.name}"), plot)
    rows = [
        ("cells", f"{done.cells} at {done.headings} headings, {time.monotonic() - begin:.1f} s"),
        ("safe", f"{100 * done.safe:.2f} % of all poses"),
        ("resumed", f"{done.resumed} of {done.tiles} tiles were done before" if done.resumed else None),
        ("layers", done.output),
        ("picture", plot),
    ]
    new_console().print(grid(rows))


def _limits(texts: list[str]) -> "FeasibilityLimits":
    from six_wheel.kinematics.statuses import FeasibilityLimits

    found = dict[str, float]()
    for text in texts:
        name, _, value = text.partition("=")
        if name not in FeasibilityLimits._fields:
            raise ValueError(f"limit must be one of {', '.join(FeasibilityLimits._fields)}, got {text!r}")
        number, unit = (value[:-3], value[-3:]) if name in ANGLES else (value, "")
        try:
            found[name] = float(number) * UNITS[unit]
        except (KeyError, ValueError):
            rule = "be an angle such as 15deg or 0.26rad" if name in ANGLES else "be a number"
            raise ValueError(f"limit {name} must {rule}, got {text!r}") from None
    return FeasibilityLimits.curiosity().replace(**found)
