"""Maps as images: GeoTIFF, PDS and whatever else GDAL reads, by windows, in their own frame."""

import math
import warnings
from typing import Any

import numpy as np
from numpy.typing import NDArray

from six_wheel._core import Terrain
from six_wheel.kinematics.errors import needed, one_line
from six_wheel.kinematics.objects.closing import Closing
from six_wheel.maps import doubts
from six_wheel.maps.files import Grid, Options, TerrainFileError, Window, bracketed_unit, length, unit_in_name
from six_wheel.maps.plausibility import find_fill, find_unit, is_fill, is_in_degrees
from six_wheel.maps.readers.netcdf import check_length
from six_wheel.maps.readers.placement import Placement, apply, place
from six_wheel.maps.readers.points import OTHERS, is_height
from six_wheel.maps.readers.reference import UNKNOWN, image_unit, read_reference
from six_wheel.maps.readers.sources import Source

SAMPLE = (256, 256)  # rows and columns of a part that stands for the image
GLANCE = (8, 256)  # the same where only a window is read: few strips, which are as wide as the image
UNIT_TAGS = (
    "z_units", "z_unit", "zunits", "vertical_units", "vertical_unit", "elevation_units", "height_units",
)  # fmt: skip
OF_HEIGHTS = (*UNIT_TAGS, "positive")  # tags of a whole image that say something about its heights
NO_UNIT = ("", "none", "unknown", "undefined", "unspecified", "unitless", "n/a")
LABEL = 1 << 16  # bytes at the begin of a file in which a label is looked for
COARSEST = 0.3  # cells in degrees of maps [deg]


def rasterio() -> Any:
    """The library, or what to install."""
    with needed("six-wheel[terrain]", "maps as images need"):
        import rasterio
    return rasterio


class Raster(Closing):
    """An open image of heights: one band, in metres, pixel (0, 0) first.

    `options` are facts known beside the file, checked.

    Raises `ImportError` if rasterio is not installed. Raises `TerrainFileError` if it is no image, its
    coordinates are degrees, its axes are sheared, or its heights are of no known unit, or none at all.
    """

    def __init__(self, source: Source, options: Options) -> None:
        library = rasterio()
        self.path, self.options = source.path, options
        # Whatever the image lacks is said here in one line, not as a warning. NetCDF: axes are known by their
        # names too (GDAL, netCDF driver).
        self._environment = library.Env(CPL_DEBUG=False, GDAL_NETCDF_IGNORE_XY_AXIS_NAME_CHECKS="YES")
        self._environment.__enter__()
        try:
            check_length(source)
            self.dataset = self._open(source.gdal)
        except BaseException:
            self._environment.__exit__(None, None, None)
            raise
        try:
            self.band = self._band()
            self._measure()
            self.crs = self.dataset.crs
            self.placement = place(self.dataset, self.path, self.options, self.reference)
            self.shape, self.spacing = self.placement.shape, self.placement.spacing
        except BaseException as error:
            self.close()
            if type(error).__module__.startswith("rasterio"):
                raise TerrainFileError(f"{self.path} is damaged or cut off: {_words(error)}") from None
            raise

    def _open(self, source: str) -> Any:
        """The dataset, or that of its only variable, or of the one that is asked for."""
        library = rasterio()
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", library.errors.NotGeoreferencedWarning)
            dataset = self._opened(source)
            parts = {name.rpartition(":")[2].strip('/"'): name for name in dataset.subdatasets}
            if dataset.count or not parts:
                return dataset
            dataset.close()
            named = [part for part in parts if is_height(part)]
            wanted = self.options.band
            name = named[0] if wanted is None and len(named) == 1 else str(wanted)
            if name not in parts:
                first = (named or list(parts))[0]
                raise self._doubt(doubts.several("variables", list(parts), "band", first))
            return self._opened(parts[name])

    def _opened(self, name: str) -> Any:
        try:
            return rasterio().open(name)
        except MemoryError:
            raise
        except Exception as error:  # those of GDAL have no class in common
            raise TerrainFileError(f"{self.path} must be a map: {_words(error)}") from None

    def _band(self) -> int:
        """The band of heights."""
        names, wanted = self.dataset.descriptions, self.options.band
        alphas = [k for k, kind in enumerate(self.dataset.colorinterp, 1) if kind.name == "alpha"]
        self.alpha = alphas[0] if alphas else None
        bands: list[int] = [k for k in self.dataset.indexes if k not in alphas]
        told = [f"{k} {names[k - 1]}" if names[k - 1] else str(k) for k in bands]
        if isinstance(wanted, str) and wanted.isdecimal():
            wanted = int(wanted)
        if isinstance(wanted, int) and not isinstance(wanted, bool):
            if wanted not in bands:
                raise self._doubt(doubts.no_name_of_that("band", wanted, told, "band", bands[-1]))
            return wanted
        if isinstance(wanted, str) and len(bands) > 1:
            if wanted not in names:
                raise self._doubt(doubts.no_name_of_that("band", wanted, told, "band", bands[-1]))
            return int(names.index(wanted)) + 1
        named = [k for k in bands if is_height(names[k - 1] or "")]
        if len(named) == 1 or (len(bands) == 1 and wanted is not None):
            return (named or bands)[0]
        kinds = {self.dataset.dtypes[k - 1] for k in bands}
        if all(kind.startswith("complex") for kind in kinds):
            raise TerrainFileError(f"{self.path} must hold real numbers, got {kinds.pop()}")
        if len(bands) in (3, 4) and kinds == {"uint8"}:
            raise self._doubt(doubts.picture_bands(self.dataset.count))
        if len(bands) == 1:
            word = (names[bands[0] - 1] or "").lower()
            if word in OTHERS:
                raise self._doubt(doubts.band_by_name("band", word, "band", 1))
            return bands[0]
        raise self._doubt(doubts.several("bands", told, "band", bands[-1]))

    def _doubt(self, words: doubts.Words) -> TerrainFileError:
        """The error of a doubt about this image."""
        return TerrainFileError(f"{self.path} ", *words)

    def _measure(self) -> None:
        """Units and sense of coordinates and heights. Fails for pictures, and where the file has none."""
        index, options, crs = self.band - 1, self.options, self.dataset.crs
        self.reference = read_reference(_well_known_text(crs)) if crs is not None else UNKNOWN
        dtype = self.dataset.dtypes[index]
        whole = {
            key.lower(): value for key, value in self.dataset.tags().items() if key.lower() in OF_HEIGHTS
        }
        tags = whole | {key.lower(): value for key, value in self.dataset.tags(self.band).items()}
        if dtype.startswith("complex"):
            raise TerrainFileError(f"{self.path} must hold real numbers, got {dtype}")
        # A mark in the metadata, where the format has no place for it.
        self.marks = [
            float(tags[name])
            for name in ("missing_value", "_fillvalue", "nodata", "nodata_value")
            if self.dataset.nodatavals[index] is None and _is_number(tags.get(name))
        ]
        self.scale, self.offset = self.dataset.scales[index], self.dataset.offsets[index]
        name = self.dataset.descriptions[index] or ""
        brackets = bracketed_unit(name), bracketed_unit(tags.get("long_name"))
        stated = [tags.get(key) for key in ("units", "unit", *UNIT_TAGS)]
        said = (self.dataset.units[index], *stated, *brackets, self._unit_of_label())
        unit = next((word.strip() for word in said if word and word.strip().lower() not in NO_UNIT), "")
        picture = dtype == "uint8" and (self.scale, self.offset) == (1.0, 0.0)
        if options.unit is None and not unit and picture:
            raise self._doubt(doubts.cells_of_bits())
        if options.unit is None and not unit and self.dataset.driver in ("PNG", "JPEG", "BMP"):
            raise self._doubt(doubts.counts_without_unit())
        vertical = self.reference.height
        if options.unit is None and not unit and vertical is None:
            for called in (name, self.path.stem):
                if word := unit_in_name(called):
                    raise self._doubt(doubts.named_unit(called, word))
        self.unit = 1.0
        if options.unit is not None:
            self.unit = length(options.unit, "unit")
        elif unit:
            try:
                self.unit = length(unit, "unit")
            except ValueError:
                raise self._doubt(doubts.unknown_unit(unit)) from None
        if vertical is not None and options.unit is None:
            if unit and abs(abs(vertical) - self.unit) > 1e-3 * self.unit:
                raise self._doubt(doubts.two_units(unit, abs(vertical)))
            self.unit = abs(vertical)
        # CF: a depth counts downwards.
        down = tags.get("positive", "down" if tags.get("standard_name") == "depth" else "").lower() == "down"
        if down or (vertical or 0.0) < 0.0:
            self.unit = -self.unit
        self.unit_known = bool(options.unit is not None or unit or vertical is not None)
        self.whole = np.issubdtype(np.dtype(dtype), np.integer) and self.scale == 1.0

    def _unit_of_label(self) -> str:
        """The keyword UNIT of the image in a label of PDS 3, which GDAL leaves out."""
        if self.dataset.driver != "PDS":
            return ""
        with self.path.open("rb") as file:
            return image_unit(file.read(LABEL).decode("latin-1"))

    def check_sample(self, sample: tuple[int, int] = SAMPLE) -> None:
        """Checks parts that stand for the whole image, before anything is computed from one of them."""
        for share in (0.5, 0.1, 0.9):
            parts = []
            for size, most in zip(self.shape, sample, strict=True):
                first = int(max(size - most, 0) * share)
                parts.append(slice(first, min(first + most, size)))
            self.check_plausibility(self.heights(*parts))
            if self.shape[0] <= sample[0] and self.shape[1] <= sample[1]:
                break

    def glance(self) -> None:
        """The same by less, before a window is read."""
        self.check_sample(GLANCE)

    def check_plausibility(self, heights: NDArray[np.floating]) -> None:
        """Fails if heights of this image are hardly in metres."""
        finding = None if self.unit_known else find_unit(heights, self.spacing, whole=self.whole)
        if finding is None:
            return
        if self.reference == UNKNOWN and is_in_degrees(
            self.placement.bounds[:2], self.spacing, self.shape, COARSEST
        ):
            finding += ("; or are its coordinates degrees (gdalwarp -s_srs EPSG:4326 projects it)?",)
        raise TerrainFileError(f"{self.path}: ", *finding)

    def heights(self, rows: slice, columns: slice) -> NDArray[np.floating]:
        """Pixels of a window as they lie in the image; NaN where there are none [m]."""
        window = ((rows.start, rows.stop), (columns.start, columns.stop))
        try:
            band = self.dataset.read(self.band, window=window, masked=True)
        except Exception as error:
            raise TerrainFileError(f"{self.path} is damaged or cut off: {_words(error)}") from None
        plain = (self.scale, self.offset, self.unit) == (1.0, 0.0, 1.0)
        single = band.dtype == np.float32 and plain
        options = self.options
        if options.every_number_counts:
            band = np.ma.getdata(band)
        heights: NDArray[np.floating] = np.ma.filled(
            band.astype(np.float32 if single else np.float64), np.nan
        )
        for mark in self.marks if options.nodata is None else options.marks:
            heights[is_fill(heights, mark)] = np.nan
        if self.alpha is not None:  # GDAL takes one of 8 or 16 bits for a mask, and no other
            heights[self.dataset.read(self.alpha, window=window) == 0] = np.nan
        # Some images mark what is not known by infinities beside their own mark.
        heights[np.isinf(heights)] = np.nan
        finding = None if options.every_number_counts else find_fill(heights, options.marks)
        if finding is not None:
            raise TerrainFileError(f"{self.path}: ", *finding)
        if not plain:
            heights = (heights * self.scale + self.offset) * self.unit
        return heights

    def grid(self, rows: slice, columns: slice) -> Grid:
        """The same as a grid whose rows go along +y of its own frame."""
        heights, placed = self.heights(rows, columns), self.placement
        if placed.flipped:
            return Grid(heights[::-1], self.spacing, placed.middle(rows.stop - 1, columns.start), placed.yaw)
        return Grid(heights, self.spacing, placed.middle(rows.start, columns.start), placed.yaw)

    def read(self, window: Window | None) -> Grid:
        """The pixels that cover a window of the frame of the map, or all."""
        rows, columns = self.shape
        if window is None:
            return self.grid(slice(0, rows), slice(0, columns))
        x0, y0, x1, y1 = (value / self.placement.metre for value in window)
        inverse = ~self.placement.transform
        corners = np.array([apply(inverse, x, y) for x in (x0, x1) for y in (y0, y1)]) - 0.5
        low, high = np.floor(corners.min(axis=0)), np.ceil(corners.max(axis=0))
        first = np.maximum(low, 0).astype(int)
        last = np.minimum(high, [columns - 1, rows - 1]).astype(int)
        if not (last > first).all():
            left, bottom, right, top = self.placement.bounds
            where = f"the map has x {left:g} to {right:g}, y {bottom:g} to {top:g}"
            raise TerrainFileError(f"{self.path}: window must overlap the map, got {window}; {where}")
        return self.grid(slice(first[1], last[1] + 1), slice(first[0], last[0] + 1))

    @property
    def description(self) -> list[tuple[str, str]]:
        """Form, unit, marks and system, and the source of each."""
        dataset, index = self.dataset, self.band - 1
        name = f" {dataset.descriptions[index]}" if dataset.descriptions[index] else ""
        form = f"{dataset.driver}, band {self.band}{name} of {dataset.count}, {dataset.dtypes[index]}"
        factor = self.scale * self.unit
        said = "as asked" if self.options.unit is not None else "as the file says"
        unit = (
            f"{factor:g} m, {said}"
            if self.unit_known
            else f"{factor:g} m, taken for granted: the file has none"
        )
        marks = [
            str(mark)
            for mark in (dataset.nodatavals[index], *self.options.marks, *self.marks)
            if mark is not None
        ]
        mask = "a band of opacity" if self.alpha is not None else ""
        system = "of no known system, taken for metres"
        if self.crs is not None:
            word = _well_known_text(self.crs).partition('"')[2].partition('"')[0]
            system = (
                self.crs.to_proj4().replace(" +no_defs=True", "")
                if word.lower() in ("", "unknown", "unnamed")
                else word
            )
        rows = [("form", form), ("unit", unit), ("nodata", ", ".join(filter(None, [*marks, mask])) or "none")]
        return [*rows, ("coordinates", system)]

    def close(self) -> None:
        """Let go of the file."""
        self.dataset.close()
        self._environment.__exit__(None, None, None)


class GridImage(Closing):
    """Ground that is in memory as an image whose first row is the northern one: what text and bags hold."""

    crs = None

    def __init__(self, ground: Terrain) -> None:
        (dx, dy), (x, y), self.shape = ground.spacing, ground.origin, ground.shape
        cos, sin, top = math.cos(ground.yaw), math.sin(ground.yaw), dy * (ground.shape[0] - 0.5)
        corner = (x - cos * dx / 2 - sin * top, y - sin * dx / 2 + cos * top)
        transform = rasterio().Affine(cos * dx, sin * dy, corner[0], sin * dx, -cos * dy, corner[1])
        self.placement, self.spacing = Placement(transform, 1.0, ground.shape), ground.spacing
        self._heights = ground.heights[::-1]

    def heights(self, rows: slice, columns: slice) -> NDArray[np.floating]:
        """Pixels of a window; NaN where there are none [m]."""
        return self._heights[rows, columns]


def _well_known_text(crs: Any) -> str:
    """Text of a system: that of the first version, unless only the second can say it."""
    try:
        return str(crs.to_wkt())
    except rasterio().errors.CRSError:
        return str(crs.to_wkt(version="WKT2_2019"))


def _is_number(text: str | None) -> bool:
    try:
        return text is not None and not math.isnan(float(text))
    except ValueError:
        return False


def _words(error: BaseException) -> str:
    """Reason of an error of GDAL in one line; rasterio keeps it in its causes."""
    while error.__cause__ is not None:
        error = error.__cause__
    return one_line(error)
