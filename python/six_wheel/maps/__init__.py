"""Ground from files and from a seed, and where on it a rover can stand.

`reading` opens whatever it is given and finds out what it is: `rasters` are GeoTIFF and PDS images through
rasterio (extra ``[terrain]``), read by windows, in their own frame; `grids` are text: ESRI ASCII and lists of
heights; `bags` are ``grid_map_msgs/GridMap`` in ROS bags (extra ``[bags]``). `synthetic` makes fractal ground
with rocks by seed. `traversability` judges every cell of a map, at several headings: it cuts the map into
`tiles`, spreads them over processes or a cluster, goes on where a run was stopped, and writes the layers as a
GeoTIFF in the map's own frame.
"""

from typing import TYPE_CHECKING

from six_wheel.kinematics.lazy import attach

if TYPE_CHECKING:
    from six_wheel.maps.reading import TerrainFileError, read
    from six_wheel.maps.synthetic import yard
    from six_wheel.maps.tiles import Tile, judge
    from six_wheel.maps.traversability import Layers, Traversed, traverse

__all__ = ["Layers", "TerrainFileError", "Tile", "Traversed", "judge", "read", "traverse", "yard"]

__getattr__, __dir__ = attach(
    __name__,
    {
        "reading": ("TerrainFileError", "read"),
        "synthetic": ("yard",),
        "tiles": ("Tile", "judge"),
        "traversability": ("Layers", "Traversed", "traverse"),
    },
)
