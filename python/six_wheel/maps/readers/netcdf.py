"""NetCDF beyond what GDAL tells: names, units and order of coordinates; files of the classic form cut off."""

import contextlib
import struct
import warnings
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from six_wheel.maps.files import TerrainFileError, length
from six_wheel.maps.readers.points import EAST, NORTH
from six_wheel.maps.readers.sources import Source

HEADER = 1 << 20  # bytes that hold every header
SIZES = (0, 1, 1, 2, 4, 4, 8, 1, 2, 4, 8, 8)  # bytes of a number, by its type
PADDING = 3  # bytes that may lack at the end


def axes_of(dataset: Any) -> dict[str, str]:
    """Names of the coordinates x and y of a variable by ``standard_name``, ``axis``, or the names."""
    tags = dataset.tags()
    names = {key.partition("#")[0] for key in tags if "#" in key}
    found = dict[str, str]()
    for axis, words in (("x", EAST), ("y", NORTH)):
        by_attribute = [
            name
            for name in sorted(names)
            if tags.get(f"{name}#standard_name") == f"projection_{axis}_coordinate"
            or tags.get(f"{name}#axis", "").lower() == axis
        ]
        by_name = [name for name in sorted(names) if name.lower() in words]
        for name in (by_attribute or by_name)[:1]:
            found[axis] = name
    return found


def unit_of_axes(dataset: Any, path: Path, axes: dict[str, str]) -> float:
    """Unit of the coordinates x and y [m], of which GDAL takes no notice without a system."""
    units = {dataset.tags().get(f"{name}#units", "m") for name in axes.values()}
    try:
        (size,) = {length(unit, "units") for unit in units}
    except ValueError:
        listed = ", ".join(sorted(units))
        told = f"has coordinates in {listed}: give them units of length, m or km, the same for both"
        raise TerrainFileError(f"{path} {told}") from None
    return size


def is_transposed(
    path: Path, places: tuple[float, float], shape: tuple[int, int], names: Sequence[str]
) -> bool:
    """True where rows of a variable run along x: GDAL takes any last dimension for x.

    `places` are what GDAL takes for x of the first and last column, `names` those the coordinate x may have.
    """
    from rasterio import open as open_dataset
    from rasterio.errors import NotGeoreferencedWarning, RasterioIOError

    rows, columns = shape
    values = None
    for name in names:
        with contextlib.suppress(RasterioIOError), warnings.catch_warnings():
            warnings.simplefilter("ignore", NotGeoreferencedWarning)
            with open_dataset(f"NETCDF:{path}:{name}") as axis:
                values = axis.read(1).ravel()
            break
    if values is None:
        return False
    ends = {round(float(value), 6) for value in (values[0], values[-1])}
    along_columns = len(values) == columns and ends == {round(place, 6) for place in places}
    return len(values) == rows and not along_columns


def check_length(source: Source) -> None:
    """Fails where a file of the classic form is shorter than its header says: its rest would be zeros."""
    if source.packing or source.path.is_dir() or source.read(3) != b"CDF":
        return
    try:
        needed = _Header(source.read(HEADER)).end
    except (struct.error, IndexError):
        return  # GDAL has more to say about a header that is none
    size = source.path.stat().st_size
    if size < needed - PADDING:
        told = f"it has {size} bytes, its header says {needed}"
        raise TerrainFileError(f"{source.path} is damaged or cut off, {told}: fetch it again")


class _Header:
    """The header of a classic NetCDF file (NetCDF users guide, file format specifications)."""

    def __init__(self, data: bytes) -> None:
        self._data, self._at, version = data, 4, data[3]
        self._count = ">q" if version == 5 else ">i"
        self._begin = ">i" if version == 1 else ">q"
        records = self._number(self._count)
        dimensions = []
        for _ in range(self._items()):
            self._name()
            dimensions.append(self._number(self._count))
        self._skip_attributes()
        self.end = 0
        """Bytes of the whole file."""
        first, record = 0, 0
        for _ in range(self._items()):
            self._name()
            shape = [dimensions[self._number(self._count)] for _ in range(self._number(self._count))]
            self._skip_attributes()
            size = SIZES[self._number(">i")]
            self._number(self._count)  # its own size, which is wrong from 4 GB on
            begin = self._number(self._begin)
            for count in shape:
                size *= count or 1
            size = -(-size // 4) * 4
            if shape and shape[0] == 0:  # the dimension of records
                first, record = first or begin, record + size
            else:
                self.end = max(self.end, begin + size)
        if record and records > 0:
            self.end = max(self.end, first + records * record)

    def _number(self, form: str) -> int:
        (value,) = struct.unpack_from(form, self._data, self._at)
        self._at += struct.calcsize(form)
        return int(value)

    def _skip(self, size: int) -> None:
        self._at += -(-size // 4) * 4

    def _items(self) -> int:
        self._number(">i")  # kind of the list
        return self._number(self._count)

    def _name(self) -> None:
        self._skip(self._number(self._count))

    def _skip_attributes(self) -> None:
        for _ in range(self._items()):
            self._name()
            size = SIZES[self._number(">i")]
            self._skip(self._number(self._count) * size)
