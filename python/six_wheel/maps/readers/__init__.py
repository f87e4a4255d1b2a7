"""Readers of the forms of maps.

`sources` are files as they lie on disk, packed or not; `refusals` name those that are no maps. `rasters` are
images through rasterio (extra ``[terrain]``), read by windows, in their own frame, which `placement` finds
by the `reference` system they state. `grids` are text: ESRI ASCII, lists of heights, and tables of `points`.
`bags` are ``grid_map_msgs/GridMap`` in ROS bags (extra ``[bags]``).
"""
