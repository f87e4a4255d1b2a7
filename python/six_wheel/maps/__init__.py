"""Ground from files and from nothing: `Terrain.read` and `Terrain.yard`.

`reading` opens whatever it is given and finds out what it is; `rasters` are GeoTIFF and PDS images through
rasterio (extra ``[terrain]``), read by windows, in their own frame; `grids` are text: ESRI ASCII and lists of
heights; `bags` are ``grid_map_msgs/GridMap`` in ROS bags (extra ``[bags]``); `yards` makes fractal ground
with rocks by seed.
"""

from six_wheel.terrain.reading import TerrainFileError, read
from six_wheel.terrain.yards import yard

__all__ = ["TerrainFileError", "read", "yard"]
