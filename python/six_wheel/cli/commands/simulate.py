"""`six-wheel simulate`: a rover on a plane or over a map, by a table of commands."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, NamedTuple

import typer

from six_wheel.cli.map_options import MapReading
from six_wheel.cli.shared import (
    Reading,
    ResultsOption,
    choose,
    choose_suspension,
    grid,
    new_console,
)
from six_wheel.robot_description.named_rover import NamedRover

ROWS = 200_000  # of a table in memory at a time

if TYPE_CHECKING:
    from six_wheel._core import RockerBogie, Terrain
    from six_wheel.simulation.controlled import Controlled
    from six_wheel.simulation.planar import Simulation
    from six_wheel.simulation.sticking import Stick


class Run(NamedTuple):
    """Options of the drive."""

    start: Annotated[
        tuple[float, float, float] | None,
        typer.Option(
            metavar="X Y YAW",
            help="First pose [m, m, rad]; default that of a path, the middle of a map or the origin.",
        ),
    ] = None
    speed: Annotated[float, typer.Option(metavar="V", help="Along a path [m/s].")] = 0.5
    rate: Annotated[float, typer.Option(metavar="HZ", help="Samples per second.")] = 10.0
    seed: Annotated[int, typer.Option(help="Of all that is random.")] = 0
    stick: Annotated[
        str | None,
        typer.Option(
            metavar="JOINT@T",
            help="A steering joint that sticks so many seconds after the first command: the rover is driven "
            "through the controller, with the limits of the parameter file.",
        ),
    ] = None


class Pictures(NamedTuple):
    """Pictures of the drive."""

    plot: Annotated[
        Path | None,
        typer.Option(help="Picture of the drive, over a map in three dimensions: .png, .svg or .pdf."),
    ] = None
    plot_speeds: Annotated[
        Path | None,
        typer.Option(help="Picture of the wheels' speeds against those on level ground: .png, .svg or .pdf."),
    ] = None


def simulate(
    rover: Annotated[
        str,
        typer.Argument(
            metavar="ROVER", help="Parameter file, URDF or preset; over a map one with a suspension."
        ),
    ],
    commands: Annotated[
        Path,
        typer.Argument(
            metavar="COMMANDS",
            help="Table with time, vx, vy, omega, or a path: time, x, y, yaw; .csv, .parquet.",
        ),
    ],
    ground: Annotated[
        Path | None,
        typer.Option(
            metavar="MAP",
            help="GeoTIFF, PDS, NetCDF, text, bag or YAML of one and its options; default a plane.",
        ),
    ] = None,
    output: ResultsOption = None,
    *,
    run: Run,
    pictures: Pictures,
    map_reading: MapReading,
    reading: Reading,
) -> None:
    if ground is None and pictures.plot_speeds is not None:
        rule = "--plot-speeds must come with --ground: level ground is all there is"
        raise ValueError(f"{rule}, got {pictures.plot_speeds}")
    if ground is None and map_reading.given():
        map_reading.ground(None)
    if ground is not None and run.stick is not None:
        raise ValueError(f"--stick must be left out with --ground, got {run.stick}")
    chosen = choose(rover, reading) if ground is None else None
    suspended = choose_suspension(rover, reading) if ground is not None else None
    if any(pictures):
        from six_wheel.plotting.saving import picture_path

        for path in filter(None, pictures):
            picture_path(path)
    if output is not None:
        from six_wheel.logs.tables import table_format
        from six_wheel.simulation.ground_writing import ENDINGS

        if output.suffix.lower() not in ENDINGS:
            table_format(output, ENDINGS)
    way = _way(commands, run.start, run.speed)
    if chosen is not None:
        rows = _on_a_plane(chosen, way, run, output, pictures.plot)
    else:
        assert suspended is not None
        assert ground is not None
        from six_wheel.maps.reading import read_with

        land = read_with(ground, map_reading.options())
        rows = _over_ground(*suspended, (land, ground.name), way, run, output, pictures)
    files = [("results", output), ("picture", pictures.plot), ("speeds", pictures.plot_speeds)]
    new_console().print(grid([*rows, *files]))


class Way(NamedTuple):
    """Stamps [s] and twists, or poses and the speed along them; where it begins, if that is known."""

    path: Any
    start: tuple[float, float, float] | None
    speed: float


def _way(commands: Path, start: tuple[float, float, float] | None, speed: float) -> Way:
    import numpy as np

    from six_wheel.kinematics.errors import TableError
    from six_wheel.logs.ground_truth import read_truth
    from six_wheel.logs.tables import CommandTable

    try:
        with CommandTable(commands) as table:
            chunks = list(table.chunks(ROWS))
            scale = table.time_unit.scale
    except TableError as no_commands:
        try:
            _, poses, _ = read_truth(commands)
        except (TableError, ValueError):
            raise no_commands from None
        poses = poses[:, [0, 1, -1]]
        return Way(poses, start or tuple(poses[0].tolist()), speed)
    times = np.concatenate([chunk.stamps for chunk in chunks])
    twists = np.concatenate([chunk.twists for chunk in chunks])
    return Way(((times - times[0]) * scale, twists), start, speed)


def _on_a_plane(
    chosen: NamedRover,
    way: Way,
    run: Run,
    output: Path | None,
    plot: Path | None,
) -> list[tuple[str, object]]:
    """Readings err and count as the parameter file says; without one they are exact."""
    import numpy as np

    from six_wheel._core import Encoder, Noise
    from six_wheel.log_odometry.evaluation.relative import path_distance
    from six_wheel.robot_description.gyroscope_errors import with_readings_apart
    from six_wheel.simulation.run_simulation import simulate as simulated
    from six_wheel.simulation.writing import write_log

    said = chosen.parameters
    noise = Noise(**said.noise) if said is not None and said.noise else None
    encoders: dict[str, Any] = {}
    for name in ("wheel_encoders", "steering_encoders"):
        given: dict[str, Any] = getattr(said, name, {})
        keys = ("ticks_per_turn", "gear_ratio", "wraps_at")
        counts = {key: given[key] for key in keys if given.get(key) is not None}
        if "ticks_per_turn" in counts:
            encoders[name] = Encoder(**counts)
    gyroscope = None
    if said is not None and (known := said.known_gyroscope) is not None:
        gyroscope = with_readings_apart(known, said.gyroscope.get("period"), 1.0 / run.rate)
    done = simulated(
        chosen.rover,
        way.path,
        noise=noise,
        gyroscope=gyroscope,
        rate=run.rate,
        start=way.start,
        speed=way.speed,
        seed=run.seed,
        stick=None if run.stick is None else _stick(run.stick),
        limits=chosen.limits,
        control=said.control if said is not None else None,
        **encoders,
    )
    if output is not None:
        write_log(done, chosen.rover, output)
    if plot is not None:
        _draw(chosen, done, plot)
    poses = done.truth.poses
    x, y, yaw = poses[-1]
    return [
        ("samples", f"{len(done.stamps):,}"),
        ("duration", f"{done.stamps[-1] - done.stamps[0]:.6g} s"),
        ("distance", f"{path_distance(poses)[-1]:.4g} m"),
        ("ends at", f"{x:.4g} m, {y:.4g} m, {np.degrees(yaw):.4g} deg"),
        ("noise", f"{noise}, seed {run.seed}" if noise else "none: the parameter file has no noise"),
        *_stuck(done.controlled),
    ]


def _draw(chosen: NamedRover, done: "Simulation", plot: Path) -> None:
    """The path; and what the controller did, where there was one."""
    from six_wheel.plotting import path_figure, save
    from six_wheel.plotting.drive import drive_figure
    from six_wheel.simulation.drive.min_max_thinning import Course

    assert done.motion is not None
    there, ran = done.motion.at(done.stamps), done.controlled
    path = (there.poses, there.steering)
    if ran is None:
        save(path_figure(chosen.rover, *path, title=chosen.name), plot)
        return
    panels = Course(ran.values.shape[1])
    panels.add(ran.times, ran.values, ran.reasons)
    figure = drive_figure(
        chosen.rover, panels, *path, limits=ran.limits, shares=ran.shares, title=chosen.name
    )
    save(figure, plot)


def _stuck(ran: "Controlled | None") -> list[tuple[str, object]]:
    """Response of the controller to a joint that sticks, as rows for `grid`."""
    if ran is None:
        return []
    found: object = "no joint"
    if ran.found is not None:
        found = f"{ran.joint} at {ran.found:.4g} s, {ran.error:.3g} rad off its command: halted"
    reasons = sorted(ran.shares.items(), key=lambda item: -item[1])
    return [
        ("found stuck", found),
        ("limited by", ", ".join(f"{name} {share:.1%}" for name, share in reasons) or "nothing"),
    ]


def _stick(text: str) -> "Stick":
    from six_wheel.simulation.sticking import Stick

    joint, _, start = text.rpartition("@")
    try:
        return Stick(joint, float(start))
    except ValueError:
        raise ValueError(f'--stick must be JOINT@T with T in seconds, got "{text}"') from None


def _over_ground(
    suspension: "RockerBogie",
    name: str,
    ground: "tuple[Terrain, str]",
    way: Way,
    run: Run,
    output: Path | None,
    pictures: Pictures,
) -> list[tuple[str, object]]:
    from six_wheel.cli.report.ground import ground_facts
    from six_wheel.simulation.ground_writing import write_ground
    from six_wheel.simulation.on_terrain import GroundSimulation, middle
    from six_wheel.simulation.run_simulation import simulate as simulated

    land, map_name = ground
    start = way.start or (*middle(land), 0.0)
    done = simulated(
        suspension, way.path, ground=land, start=start, rate=run.rate, speed=way.speed, seed=run.seed
    )
    assert isinstance(done, GroundSimulation)
    if output is not None:
        write_ground(done, suspension, output)
    if any(pictures):
        from six_wheel.plotting import ground_figure, save, speeds_figure

        title = f"{name} over {map_name}"
        if pictures.plot is not None:
            save(ground_figure(done, suspension, land, title=title), pictures.plot)
        if pictures.plot_speeds is not None:
            save(speeds_figure(done, suspension, title=title), pictures.plot_speeds)
    return [*ground_facts(done)]
