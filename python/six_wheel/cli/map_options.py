"""Options for what a map leaves open, the same for every command that reads one."""

from collections.abc import Collection
from typing import TYPE_CHECKING, Annotated, Any, NamedTuple

import typer

if TYPE_CHECKING:
    from six_wheel._core import Terrain
    from six_wheel.maps.files import Options


RULES = {
    "--nodata": "be a number, or several with commas between them",
    "--origin": "be two numbers, x,y",
    "--spacing": "be one number or two, dx,dy",
}


class MapReading(NamedTuple):
    """Answers to what a map leaves open: see `Terrain.read`."""

    band: Annotated[
        str | None, typer.Option(metavar="BAND", help="Number or name of the map's band of heights.")
    ] = None
    topic: Annotated[
        str | None, typer.Option(metavar="TOPIC", help="Topic of a bag; default the only one with maps.")
    ] = None
    layer: Annotated[
        str | None,
        typer.Option(metavar="LAYER", help="Layer of a grid map; default elevation, or the only one."),
    ] = None
    nodata: Annotated[
        str | None,
        typer.Option(
            metavar="N or N,N",
            help="Numbers that stand for unknown heights; nan if every number is a height.",
        ),
    ] = None
    unit: Annotated[
        str | None,
        typer.Option(metavar="UNIT", help="Of the heights: m, cm, mm, km, ft, us-ft, in, or its length [m]."),
    ] = None
    north_up: Annotated[
        bool | None,
        typer.Option(
            "--north-up/--south-up", help="First row of a map without a place; default as its form has it."
        ),
    ] = None
    spacing: Annotated[
        str | None,
        typer.Option(metavar="D or DX,DY", help="Between heights of a map without a place [m]."),
    ] = None
    origin: Annotated[
        str | None,
        typer.Option(metavar="X,Y", help="South-western cell's middle of a map without a place [m]."),
    ] = None

    def options(self) -> "Options":
        """The same as those of `Terrain.read`."""
        from six_wheel.maps.files import Options

        nodata = None if self.nodata is None else _numbers("--nodata", self.nodata, range(1, 9))
        origin = None if self.origin is None else _numbers("--origin", self.origin, (2,))
        spacing = None if self.spacing is None else _numbers("--spacing", self.spacing, (1, 2))
        return Options(
            topic=self.topic,
            layer=self.layer,
            band=self.band,
            nodata=nodata,
            unit=self.unit,
            north_up=self.north_up,
            spacing=spacing if spacing is None or len(spacing) == 2 else spacing[0],
            origin=origin,  # type: ignore[arg-type]
        )

    def ground(self, name: str | None) -> "Terrain | str | None":
        """The ground that `name` stands for: a map by these options; the name itself where none is given."""
        if not self.given():
            return name
        if name in (None, "yard", "flat"):
            options = ", ".join(f"--{option.replace('_', '-')}" for option in self.given())
            raise ValueError(f"{options} must come with a map as --ground, got {name or 'none'}")
        from six_wheel.maps.reading import read_with

        return read_with(str(name), self.options())

    def given(self) -> dict[str, Any]:
        """Those that are given, by name."""
        return {name: value for name, value in self.options()._asdict().items() if value is not None}


def _numbers(name: str, text: str, counts: Collection[int]) -> tuple[float, ...]:
    try:
        numbers = tuple(float(part) for part in text.split(","))
    except ValueError:
        numbers = ()
    if len(numbers) not in counts:
        rule = RULES[name]
        raise ValueError(f'{name} must {rule}, got "{text}"')
    return numbers
