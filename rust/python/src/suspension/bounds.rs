//! `RockerBogie.bounds`.

use std::borrow::Cow;

use pyo3::prelude::*;
use pyo3::types::PyFloat;
use six_wheel_numerics::error::{Error, bounded, not_negative};
use six_wheel_terrain::bounds::{self as core, Belly, BoundStatus, BoundsConstants, Ground, Margins, TiltLimits};

use super::rocker_bogie::RockerBogie;
use crate::convert::{OrRaise, Out, Rows, compute_rows, joined, memory, refuse, scalar_or_array, together};
use crate::terrain::Terrain;
use crate::workers::workers;

result_class! {
    /// Intervals in which a rover stands, without settling it: see `RockerBogie.bounds`.
    ///
    /// Every interval holds its lower and its upper end in the last axis; NaN unless `status` is ``bounded``.
    pub struct PoseBounds {
        /// Height of the origin of the rover's frame, shape (..., 2) [m].
        z: Py<PyAny>,
        /// Roll, shape (..., 2) [rad].
        roll: Py<PyAny>,
        /// Pitch, shape (..., 2) [rad].
        pitch: Py<PyAny>,
        /// Angle between the rover's z axis and the vertical, shape (..., 2) [rad].
        tilt: Py<PyAny>,
        /// Least vertical distance from the ground to the belly, shape (..., 2) [m].
        clearance: Py<PyAny>,
        /// Angle of the left rocker, shape (..., 2) [rad].
        rocker: Py<PyAny>,
        /// Angles of the left and the right bogie, shape (..., 2, 2) [rad].
        bogies: Py<PyAny>,
        /// Drop of the lowest wheel below its place on level ground, in the rover's frame, shape (..., 2) [m].
        wheel_drop: Py<PyAny>,
    }
    hidden {
        codes: Vec<u8>,
        leading: Vec<usize>,
    }
    repr { z roll pitch tilt clearance rocker bogies wheel_drop status }
}

getters! { PoseBounds, self, py:
    /// Validity of the intervals, shape (...): `six_wheel.BoundsStatus`.
    status: PyResult<Bound<'py, PyAny>> = {
        let codes = scalar_or_array(py, memory::gathered(self.codes.iter().copied())?, &self.leading)?;
        py.import("six_wheel.kinematics.statuses")?.call_method1("bound_statuses", (codes,))
    };
}

/// Fails unless a size is finite and not negative; the message has `NaN` as Rust writes it.
fn check_size(argument: &'static str, size: f64) -> PyResult<()> {
    let refused = |_| refuse(argument, "be finite and not negative", format!("{size:?}"));
    not_negative(argument, size).map_err(refused)
}

/// Reads sizes, one or one per pose, default 0.
fn sizes<'py>(py: Python<'py>, argument: &'static str, value: Option<&Bound<'py, PyAny>>) -> PyResult<Rows<'py>> {
    let none = PyFloat::new(py, 0.0);
    let sizes = Rows::read_numbers(argument, value.unwrap_or(none.as_any()))?;
    sizes.flat().iter().try_for_each(|size| check_size(argument, *size))?;
    Ok(sizes)
}

/// The arrays of `out=`, in this order.
const RESULTS: [&str; 8] = ["z", "roll", "pitch", "tilt", "clearance", "rocker", "bogies", "wheel_drop"];

/// The intervals of an array.
fn pairs(values: &mut [f64]) -> &mut [[f64; 2]] {
    values.as_chunks_mut().0
}

/// A belly as it is given: rear and front edge, half width and height [m].
pub type Plate = (f64, f64, f64, f64);

/// The belly of these numbers.
pub fn read_belly((rear, front, half_width, z): Plate) -> Result<Belly, Error> {
    Belly::new([rear, front], half_width, z)
}

/// Fails unless the error of a map is a size.
pub fn check_map_error(map_error: f64) -> PyResult<()> {
    check_size("map_error", map_error)?;
    bounded("map_error", &[map_error]).or_raise(&[])
}

impl RockerBogie {
    /// The constants of the bounds for a belly and the largest angles.
    pub fn bounds_constants(
        &self,
        belly: Option<Plate>,
        within: Option<(f64, f64, f64)>,
    ) -> Result<Cow<'_, [BoundsConstants]>, Error> {
        match (belly, within) {
            (None, None) => self.usual_plans().map(Cow::Borrowed),
            (_, Some((attitude, rocker, bogie))) => {
                let within = TiltLimits { attitude, rocker, bogie };
                self.plan(belly, within).map(|plan| Cow::Owned(vec![plan]))
            }
            (_, None) => self.plans(belly).map(|plans| Cow::Owned(plans.into())),
        }
    }

    fn plan(&self, belly: Option<Plate>, within: TiltLimits) -> Result<BoundsConstants, Error> {
        BoundsConstants::new(self.0.dimensions(), self.belly(belly)?, within)
    }

    fn plans(&self, belly: Option<Plate>) -> Result<[BoundsConstants; 2], Error> {
        let narrow = self.plan(belly, TiltLimits::default())?;
        Ok([narrow, self.plan(belly, TiltLimits::wide())?])
    }

    /// Those of calls that say nothing else, made once.
    fn usual_plans(&self) -> Result<&[BoundsConstants], Error> {
        if self.1.get().is_none() {
            let plans = self.plans(None)?;
            let _ = self.1.set(plans); // or somebody else has
        }
        Ok(self.1.get().map_or(&[], |plans| plans))
    }

    /// The belly that is given, or the default one.
    pub fn belly(&self, belly: Option<Plate>) -> Result<Belly, Error> {
        belly.map_or_else(|| Ok(Belly::between_wheels(self.0.dimensions())), read_belly)
    }
}

methods! { RockerBogie:
    /// Conservative intervals of how the rover stands, without settling it.
    ///
    /// Per wheel the lowest and highest ground in a box that covers it, and closed-form kinematics of the extremes:
    /// a fraction of the time of `settle`, and a statement about every place and yaw within margins. The rover
    /// without steering, its joints away from their stops, is inside wherever `status` is ``bounded``.
    #[doc = section!(Parameters)]
    /// ground : Terrain
    ///     The map. At the first call it makes a pyramid of its extremes: 48 bytes per cell.
    #[doc = parameters!(poses)]
    /// yaw_margin : float or array_like, shape (...)
    ///     Holds for every yaw up to so much to either side [rad].
    /// position_margin : float or array_like, shape (...)
    ///     Holds for every place up to so far away [m].
    /// map_error : float, default 0.0
    ///     Holds for every map whose heights differ by up to so much [m].
    /// belly : (float, float, float, float), optional
    ///     Rear edge, front edge, half width and height of the underside of the body in the rover's frame [m].
    ///     Default: between the wheels, as wide as three quarters of the way to the rockers, a quarter of a wheel's
    ///     radius below the lower of the rockers' and the bogies' axes.
    /// within : (float, float, float), optional
    ///     Largest roll or pitch, rocker and bogie angle for which the boxes cover the wheels [rad]; bounds beyond
    ///     them are not known. Default 15, 7 and 17 degrees, and where that is too narrow 25, 20 and 38.
    /// out : tuple of ndarray, optional
    ///     Arrays for z, roll, pitch, tilt, clearance, rocker, bogies and wheel drop, in this order, of the shapes of
    ///     the result; what is left out, or None, is fresh. Nothing is written by a call that fails.
    #[doc = parameters!(threads)]
    /// level : str, optional
    ///     Instructions; the result is the same with any, to the bit.
    #[doc = returns!("PoseBounds")]
    ///     `z`, `roll`, `pitch`, `tilt`, `clearance`, `rocker`, `wheel_drop` (..., 2), `bogies` (..., 2, 2),
    ///     `status` (...).
    #[doc = raises!("If a number is not finite, a margin negative or a shape does not fit.")]
    ///
    /// Source: K. Otsu, G. Matheron, S. Ghosh, O. Toupet, M. Ono, Fast approximate clearance evaluation for rovers with
    /// articulated suspension systems, Journal of Field Robotics 37(5), 2020, with another closed form
    /// (`docs/explanation/bounds.md`).
    fn bounds[&self, py: Python<'py>](ground: Bound<'py, Terrain>, poses, yaw_margin=None, *, position_margin=None,
        map_error: f64 = 0.0, belly: Option<(f64, f64, f64, f64)> = None, within: Option<(f64, f64, f64)> = None,
        out=None, threads: Option<i64> = None, level: Option<&str> = None) -> PyResult<PoseBounds> {
        check_map_error(map_error)?;
        let plans = self.bounds_constants(belly, within).or_raise(&[])?;
        let mut poses = Rows::read("poses", poses, 3)?.finite()?;
        let mut yaw = sizes(py, "yaw_margin", yaw_margin)?;
        let mut position = sizes(py, "position_margin", position_margin)?;
        together([&mut poses, &mut yaw, &mut position])?;
        let leading = poses.leading.as_slice();
        let (yaw, position) = (yaw.flat(), position.flat());
        let workers = workers(threads, level)?;
        let (rows, ground) = (poses.triples(), &*ground.get().0);
        let count = rows.len();
        let mut shapes = [(); 8].map(|()| joined(leading, 2));
        shapes[6].push(2); // the bogies
        let mut results = Out::read(out, RESULTS)?.results(py, shapes, None, false)?;
        let mut sides = [memory::filled([0.0; 2], count)?, memory::filled([0.0; 2], count)?];
        let mut status = memory::filled(BoundStatus::Bounded, count)?;
        let [z, roll, pitch, tilt, clearance, rocker, bogies, drop] = results.flat();
        let [z, roll, pitch, tilt] = [z, roll, pitch, tilt].map(pairs);
        let [clearance, rocker, drop] = [clearance, rocker, drop].map(pairs);
        let bogies = bogies.as_chunks_mut::<4>().0;
        compute_rows(py, count.max(ground.heights().len() / 1000), &[], || {
            let map = Ground { pyramid: ground.pyramid(workers.is_interrupted)?, error: map_error };
            let margins = Margins { yaw, position };
            let [left, right] = sides.each_mut().map(Vec::as_mut_slice);
            let blocks = [z, roll, pitch, tilt, clearance, rocker, &mut *left, &mut *right, drop];
            core::bounds(&plans, map, rows, margins, blocks, &mut status, workers)?;
            for ((pair, left), right) in bogies.iter_mut().zip(&*left).zip(&*right) {
                *pair = [left[0], left[1], right[0], right[1]];
            }
            Ok(())
        })?;
        let [z, roll, pitch, tilt, clearance, rocker, bogies, wheel_drop] = results.finish()?;
        let leading = leading.to_vec();
        let codes = memory::gathered(status.iter().map(|status| *status as u8))?;
        Ok(PoseBounds { z, roll, pitch, tilt, clearance, rocker, bogies, wheel_drop, codes, leading })
    }
}
