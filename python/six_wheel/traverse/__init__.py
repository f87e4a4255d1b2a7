"""Where on a map a rover can stand: every cell, several headings, in tiles.

`tiles` judges one tile, anywhere; `maps` cuts a map into tiles, spreads them over processes or a cluster,
goes on where a run was stopped, and writes the layers as a GeoTIFF in the map's own frame.
"""

from six_wheel.traverse.maps import Layers, Traversed, traverse
from six_wheel.traverse.tiles import Tile, judge

__all__ = ["Layers", "Tile", "Traversed", "judge", "traverse"]
