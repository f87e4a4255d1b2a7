"""Coordinate reference systems as well-known text: units, degrees, ellipsoids, the command that projects."""

import math
import re
import shlex
from pathlib import Path
from typing import NamedTuple

from six_wheel.maps.files import TerrainFileError, length

EARTH = 6.3e6, 6.4e6  # [m]
GEOGRAPHIC = ("GEOGCS", "GEOGCRS", "GEODCRS", "GEOGRAPHICCRS")
PLANE = ("PROJCS", "PROJCRS", "PROJECTEDCRS", "LOCAL_CS", "ENGCRS", "ENGINEERINGCRS")
LENGTH = re.compile(r'(?:LENGTHUNIT|UNIT)\["([^"]*)"\s*,\s*([-+0-9.eE]+)')
ELLIPSOID = re.compile(r'(?:SPHEROID|ELLIPSOID)\["[^"]*"\s*,\s*([0-9.eE+]+)\s*,\s*([0-9.eE+]+)')

# The third form is that of ESRI.
DOWN = re.compile(r'\bDOWN\b|"Direction"\s*,\s*-1', re.IGNORECASE)


class Reference(NamedTuple):
    """Meaning of coordinates and heights, as far as a text says."""

    degrees: bool = False
    plane: float = 1.0  # of the horizontal coordinates [m]
    height: float | None = None
    """Of the heights, if there is a vertical system; negative where it counts depths [m]."""
    radius: float = 6378137.0  # equatorial radius of the ellipsoid [m]
    flattening: float = 0.0
    geographic: str | None = None  # the geographic system below a projected one


UNKNOWN = Reference()


def node(text: str, *names: str) -> str | None:
    """The first node with one of these names, brackets and all."""
    found = re.search(rf"(?<![A-Z_])(?:{'|'.join(names)})\s*\[", text, re.IGNORECASE)
    if found is None:
        return None
    depth = 0
    for place in range(found.end() - 1, len(text)):
        depth += (text[place] == "[") - (text[place] == "]")
        if depth == 0:
            return text[found.start() : place + 1]
    return None


def read_reference(text: str) -> Reference:
    """Reads well-known text of either version."""
    text = text.replace("(", "[").replace(")", "]") if "[" not in text else text
    vertical = node(text, "VERT_CS", "VERTCS", "VERTCRS", "VERTICALCRS")
    height = None
    if vertical is not None:
        units = LENGTH.findall(vertical)
        height = float(units[-1][1]) if units else 1.0
        if DOWN.search(vertical):
            height = -height
    ellipsoid = ELLIPSOID.search(text)
    radius, inverse = (float(part) for part in ellipsoid.groups()) if ellipsoid else (6378137.0, 0.0)
    projected = node(text, *PLANE)
    geographic = node(text, *GEOGRAPHIC, "BASEGEOGCRS", "BASEGEODCRS")
    plane = 1.0
    if projected is not None:
        inner = node(projected, *GEOGRAPHIC, "BASEGEOGCRS", "BASEGEODCRS", "CONVERSION")
        units = LENGTH.findall(projected.replace(inner, "") if inner else projected)
        if (
            height is None
            and re.search(r"\bCS\[Cartesian\s*,\s*3\b", projected, re.IGNORECASE)
            and len(units) > 2
        ):
            height = float(units.pop()[1])  # the third axis
        plane = float(units[-1][1]) if units else 1.0
    return Reference(
        projected is None and geographic is not None,
        plane,
        height,
        radius,
        1.0 / inverse if inverse else 0.0,
        geographic,
    )


def image_unit(label: str) -> str:
    """The unit of an image by its label of PDS 3; nothing without one (PDS Standards Reference, IMAGE)."""
    image = re.search(r"OBJECT\s*=\s*IMAGE\s(.*?)END_OBJECT", label, re.DOTALL)
    found = image and re.search(r'^\s*UNIT\s*=\s*"?([^"\r\n]*)', image[1], re.MULTILINE)
    return found[1].strip() if found else ""


def read_projection(text: str) -> Reference | None:
    """Reads a ``.prj`` file: well-known text, or lines of a name and a value, as ARC/INFO had them.

    None for anything else.
    """
    if node(text, *PLANE, *GEOGRAPHIC):
        return read_reference(text)
    lines = [line.lower().split() for line in text.splitlines()]
    values = {words[0]: words[1] for words in lines if len(words) > 1}
    if "projection" not in values:
        return None
    if values["projection"] == "geographic" or values.get("units") in ("dd", "ds", "dm"):
        return Reference(degrees=True)
    try:
        heights = values.get("zunits", "no")
        return Reference(
            plane=_length(values.get("units", "m")), height=None if heights == "no" else _length(heights)
        )
    except ValueError:
        return None


def _length(unit: str) -> float:
    """Length of a unit [m]; a number counts units of a metre, as in ARC/INFO."""
    return 1.0 / float(unit) if unit.isdecimal() and int(unit) > 0 else length(unit, "units")


def in_degrees(path: Path, at: tuple[float, float], reference: Reference) -> TerrainFileError:
    """The error of a map in degrees around a place: with no reference system it only looks like one."""
    told = "look like degrees" if reference == UNKNOWN else "are degrees"
    command = projection_command(
        path, *at, reference.radius, "-s_srs EPSG:4326 " if reference == UNKNOWN else ""
    )
    return TerrainFileError(f"{path} must be in metres, its coordinates {told}: project it first: {command}")


def shell_names(path: Path, ending: str) -> str:
    """A map and a file made of it beside it, as a command names them."""
    return f"{shlex.quote(str(path))} {shlex.quote(str(path.with_name(path.stem + ending)))}"


def projection_command(path: Path, longitude: float, latitude: float, radius: float, source: str = "") -> str:
    """The command that projects a map around a place [degrees] to metres; `source` states its system."""
    names = shell_names(path, "_metres.tif")
    if EARTH[0] < radius < EARTH[1]:
        zone = min(int((longitude + 180.0) % 360.0 // 6.0) + 1, 60)
        system = f"EPSG:{32600 + zone if latitude >= 0 else 32700 + zone}"
        return f"gdalwarp {source}-t_srs {system} {names}"
    place = f"+lat_ts={latitude:.4g} +lon_0={longitude:.4g} +R={radius:.10g}"
    return f'gdalwarp {source}-t_srs "+proj=eqc {place} +units=m" {names}'


def scale_factors(
    reference: Reference,
    places: list[tuple[float, float]],
    degrees: list[tuple[float, float]],
) -> tuple[float, float]:
    """Length on the map over length on the ground, along x and along y.

    `places` are a point, one beside it in x and one in y [m]; `degrees` their longitudes and latitudes.
    Distances on the ground are by the radii of curvature of the ellipsoid.
    """
    square = reference.flattening * (2.0 - reference.flattening)
    longitude, latitude = degrees[0]
    shrink = 1.0 - square * math.sin(math.radians(latitude)) ** 2
    across = reference.radius / math.sqrt(shrink) * math.cos(math.radians(latitude))
    along = reference.radius * (1.0 - square) / shrink**1.5
    factors = []
    for place, (east, north) in zip(places[1:], degrees[1:], strict=True):
        turn = math.remainder(east - longitude, 360.0)
        ground = math.hypot(across * math.radians(turn), along * math.radians(north - latitude))
        factors.append(math.hypot(place[0] - places[0][0], place[1] - places[0][1]) / ground)
    return factors[0], factors[1]
