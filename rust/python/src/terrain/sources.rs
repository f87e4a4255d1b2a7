//! `Terrain.read` and `Terrain.yard`: ground from files and from a seed.

use pyo3::prelude::*;

use super::Terrain;

methods! { Terrain:
    /// The map of a file.
    ///
    /// GeoTIFF, PDS, NetCDF and whatever else GDAL reads (extra ``[terrain]``), ESRI ASCII grids, tables of x, y and z,
    /// matrices and lists of extents and heights as text, these in .zip and .gz, ``.npy``, ``.npz``,
    /// ``grid_map_msgs/GridMap`` in ROS bags (extra ``[bags]``), and YAML with ``map:``, the file's name, and these
    /// options. Coordinates stay those of the map's own frame. What a file leaves open (units, places, marks of unknown
    /// heights) is refused with the option that settles it.
    #[doc = section!(Parameters)]
    /// path : path
    ///     The file, or the folder of a bag.
    /// window : (float, float, float, float), optional
    ///     x_min, y_min, x_max, y_max in the frame of the map [m]: only this part is read.
    /// topic : str, optional
    ///     Topic of a bag, default the only one with maps.
    /// layer : str, optional
    ///     Layer of a grid map, default ``elevation`` or the only one.
    /// band : int or str, optional
    ///     Number, from 1, or name of the band or variable that holds heights; default the only one, or the only one
    ///     that is called so.
    /// nodata : float or sequence of float, optional
    ///     Numbers that stand for an unknown height, beside the file's own; NaN if every number is a height.
    /// unit : str or float, optional
    ///     Of the heights: ``m``, ``cm``, ``mm``, ``km``, ``ft``, ``us-ft``, ``in``, or its length [m]; default the
    ///     file's own.
    /// north_up : bool, optional
    ///     True if the first row of a file without a place is the northern one; default as its form has it.
    /// spacing : float or (float, float), optional
    ///     Between columns and between rows of a file without a place [m].
    /// origin : (float, float), optional
    ///     Middle of the south-western cell of a file without a place [m]; default (0, 0).
    #[doc = returns!("Terrain": "NaN where the map has no height.")]
    #[doc = raises!(
        FileNotFoundError: "If there is no such file.",
        ImportError: "If the library that reads such files is not installed.",
        TerrainFileError: "If it is no map, its coordinates are degrees, the window is off it, or it leaves something open."
    )]
    #[staticmethod]
    fn read[](path, *, window=None, topic=None, layer=None, band=None, nodata=None, unit=None, north_up=None,
        spacing=None, origin=None, **)
    as "(path, *, window=None, topic=None, layer=None, band=None, nodata=None, unit=None, north_up=None, spacing=None, origin=None)"
    -> PyResult<Bound<'py, PyAny>> {
        let options = dict!(path.py(), window, topic, layer, band, nodata, unit, north_up, spacing, origin);
        let module = path.py().import("six_wheel.maps")?;
        module.call_method("read", (path,), Some(&options))
    }

    /// Ground made by seed: fractal (Hurst 0.7), with rocks as on Mars.
    #[doc = section!(Parameters)]
    /// size : float or (float, float)
    ///     Along x and along y [m].
    /// spacing : float, default 0.05
    ///     Between heights [m].
    /// cover : float, default 0.1
    ///     Share of the ground that rocks cover, 0 to 0.5. Those of diameter D [m] and more cover
    ///     ``cover exp(-q D)`` with ``q = 1.79 + 0.152 / cover``; they are half as high, from 0.05 to 3 m large, and
    ///     where they overlap the higher one is seen.
    /// seed : int
    ///     The same seed makes the same ground on every platform.
    /// roughness : float, default 0.1
    ///     Root mean square of the fractal heights over 40 m [m].
    #[doc = returns!("Terrain": "Its origin at (0, 0), heights rounded to 0.1 mm.")]
    #[doc = raises!("If a number is not finite or out of its range.")]
    ///
    /// Source: M. Golombek, D. Rapp, Size-frequency distributions of rocks on Mars and Earth analog sites, Journal of
    /// Geophysical Research 102, 1997.
    #[staticmethod]
    fn yard[py: Python<'py>](size=None, spacing: f64 = 0.05, cover: f64 = 0.1, seed=None, *, roughness: f64 = 0.1, **)
    as "(size=None, spacing=0.05, cover=0.1, seed=None, *, roughness=0.1)"
    -> PyResult<Bound<'py, PyAny>> {
        let options = dict!(py, spacing, cover, roughness);
        for (name, value) in [("size", size), ("seed", seed)] {
            if let Some(value) = value {
                options.set_item(name, value)?;
            }
        }
        py.import("six_wheel.maps")?.call_method("yard", (), Some(&options))
    }
}
