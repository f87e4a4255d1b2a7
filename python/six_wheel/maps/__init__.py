"""Ground from files and from a seed, and where on it a rover can stand.

`reading` finds the form of a file and gives it to one of `readers`, or refuses it with what to give instead;
`arrays` are those with coordinates, masks or points. `files` holds the options that all of them take,
`plausibility` the checks of heights before anything is computed. `synthetic` makes fractal ground with rocks
by seed. `traversability` judges every cell of a map, at several headings: it cuts the map
into `tiles`, spreads them over processes or a cluster, goes on where a run was stopped, and writes the layers
as a GeoTIFF in the map's own frame.
"""

from typing import TYPE_CHECKING

from six_wheel.kinematics.lazy import attach

if TYPE_CHECKING:
    from six_wheel.maps.files import TerrainFileError
    from six_wheel.maps.readers.placement import TerrainFileWarning
    from six_wheel.maps.reading import read
    from six_wheel.maps.synthetic import yard
    from six_wheel.maps.tiles import Tile, judge
    from six_wheel.maps.traversability import Layers, Traversed, traverse

__all__ = [
    "Layers",
    "TerrainFileError",
    "TerrainFileWarning",
    "Tile",
    "Traversed",
    "judge",
    "read",
    "traverse",
    "yard",
]

__getattr__, __dir__ = attach(
    __name__,
    {
        "readers.placement": ("TerrainFileWarning",),
        "reading": ("TerrainFileError", "read"),
        "synthetic": ("yard",),
        "tiles": ("Tile", "judge"),
        "traversability": ("Layers", "Traversed", "traverse"),
    },
)
