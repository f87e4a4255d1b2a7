"""Ground from files and from a seed, and where on it a rover can stand.

`reading` opens whatever it is given and finds out what it is, or refuses it with what to give: `rasters` are
images through rasterio (extra ``[terrain]``), read by windows, in their own frame, by the `reference` system
they state; `grids` are text: ESRI ASCII, tables of points, lists of heights; `bags` are
``grid_map_msgs/GridMap`` in ROS bags (extra ``[bags]``). `arrays` are those with coordinates or masks.
`files` holds the options that all of them take, `doubts` what heights are refused for.
`synthetic` makes fractal
ground with rocks by seed. `traversability` judges every cell of a map, at several headings: it cuts the map
into `tiles`, spreads them over processes or a cluster, goes on where a run was stopped, and writes the layers
as a GeoTIFF in the map's own frame.
"""

from typing import TYPE_CHECKING

from six_wheel.kinematics.lazy import attach

if TYPE_CHECKING:
    from six_wheel.maps.readers.placement import TerrainFileWarning
    from six_wheel.maps.reading import TerrainFileError, read
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
