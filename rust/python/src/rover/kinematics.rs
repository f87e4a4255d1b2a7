//! `Rover.inverse` and `Rover.forward`.

use pyo3::prelude::*;
use six_wheel_kinematics::estimate::Unseen;
use six_wheel_kinematics::geometry::Twist;
use six_wheel_kinematics::table::{InputTables, Log, Source, Table};
use six_wheel_kinematics::{batch, units};
use six_wheel_numerics::threads::workers::Workers;

use super::Rover;
use crate::convert::{
    AnyArray, Blocks, Out, Output, Precision, Rows, compute_rows, joined, one_twist, refuse, together,
};
use crate::unit_warnings::warn_units;
use crate::workers::workers;

/// Twists of points of the body, read as those of its origin.
struct ReferencePoint<'a> {
    twists: Table<'a>,
    /// One per twist, or one for all.
    centres: &'a [[f64; 2]],
}

impl Source for ReferencePoint<'_> {
    fn read(&self, first: usize, target: &mut [f64]) {
        match self.twists {
            Table::Flat(twists) => target.copy_from_slice(&twists[first..first + target.len()]),
            Table::Read(source) => source.read(first, target),
        }
        let twists = target.as_chunks_mut::<3>().0;
        let about = |twist: &mut [f64; 3], centre| *twist = Twist::from(*twist).about(centre).into();
        match self.centres {
            [centre] => twists.iter_mut().for_each(|twist| about(twist, *centre)),
            centres => {
                for (twist, centre) in twists.iter_mut().zip(&centres[first / 3..]) {
                    about(twist, *centre);
                }
            }
        }
    }
}

/// The columns of a log over common leading axes.
pub struct Columns<T> {
    steering: Option<T>,
    pub speeds: T,
    rates: Option<T>,
    leading: Vec<usize>,
}

/// Those in the memory of the caller, and those that lie row after row.
type Tables<'py> = Columns<Blocks<'py>>;
type Readings<'py> = Columns<Rows<'py>>;

impl<'py> Tables<'py> {
    /// All of it, for the batches.
    fn tables(&self) -> batch::Readings<Table<'_>> {
        batch::Readings {
            steering: self.steering.as_ref().map_or(Table::Flat(&[]), Blocks::table),
            speeds: self.speeds.table(),
            steering_rates: self.rates.as_ref().map(Blocks::table),
        }
    }

    /// The same, row after row.
    pub fn flat(self) -> PyResult<Readings<'py>> {
        Ok(Readings {
            steering: self.steering.map(Blocks::flat).transpose()?,
            speeds: self.speeds.flat()?,
            rates: self.rates.map(Blocks::flat).transpose()?,
            leading: self.leading,
        })
    }
}

impl Readings<'_> {
    /// All of it, as the core takes it.
    pub fn log(&self) -> Log<'_> {
        Log {
            steering: self.steering.as_ref().map_or(&[], Rows::flat),
            speeds: self.speeds.flat(),
            steering_rates: self.rates.as_ref().map(Rows::flat),
        }
    }
}

/// The treatment of motions that no reading sees.
pub fn unseen(allow_underdetermined: bool) -> Unseen {
    if allow_underdetermined { Unseen::Zero } else { Unseen::Refuse }
}

impl Rover {
    /// Reads steering angles, speeds and steering rates, and repeats what is there over their common leading axes.
    pub fn read_log<'py>(
        &self,
        steering: &Bound<'py, PyAny>,
        speeds: &Bound<'py, PyAny>,
        steering_rates: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Tables<'py>> {
        let py = speeds.py();
        let mut speeds = Blocks::read("wheel_speeds", speeds, self.count())?;
        let steering = (!steering.is_none()).then_some(steering);
        let mut angles = Blocks::read_optional("steering", steering, self.joints())?;
        if angles.is_none() && self.joints() > 0 {
            return Err(refuse("steering", "hold the angles of the steered wheels", "None"));
        }
        let mut rates = Blocks::read_optional("steering_rates", steering_rates, self.joints())?;
        let leading = together([&mut speeds, &mut angles, &mut rates])?;
        if let Some(angles) = &angles {
            let asked = units::angles(&self.core, angles.table(), angles.count());
            warn_units(py, asked)?;
        }
        Ok(Tables { steering: angles, speeds, rates, leading })
    }
}

methods! { Rover:
    /// Steering angles and wheel speeds with which the body moves with a twist.
    ///
    /// Exact at every turning radius: straight, on the spot, with the centre of rotation between the wheels
    /// or under one of them. Of the equivalent angles of a wheel, half a turn apart, the one nearest to
    /// `previous` is taken; a wheel whose pivot rests holds `previous`.
    #[doc = section!(Parameters)]
    /// twist : array_like, shape (..., 3)
    ///     ``[vx, vy, omega]`` in body axes [m/s, m/s, rad/s]. Three floats in a tuple or list are fastest.
    /// previous : array_like, shape (..., steered wheels), optional
    ///     Present steering angles [rad], default 0. One outside the range counts as its nearest end.
    #[doc = parameters!(steering_rates)]
    /// centre : array_like, shape (2,) or (..., 2), optional
    ///     The point ``[x, y]`` whose velocity `twist` is [m], and about which the rover turns if that is
    ///     zero; default the origin.
    /// previous_wheel_speeds : array_like, shape (..., wheels), optional
    ///     Present wheel speeds [rad/s]. A wheel that would have to turn by about 90 degrees either way goes
    ///     with the others of its kind: the way they roll already, otherwise the shorter one for all.
    /// out : (ndarray, ndarray), optional
    ///     Arrays for steering, shape (..., steered wheels), and wheel speeds, shape (..., wheels); they may be `previous` and `previous_wheel_speeds` themselves.
    #[doc = parameters!(dtype, threads)]
    /// level : str, optional
    ///     One of `simd_levels()`, default the best: they agree to 5 ulp or 1e-14.
    #[doc = returns!("steering : ndarray, shape (..., steered wheels)")]
    ///     Steering angles [rad].
    /// wheel_speeds : ndarray, shape (..., wheels)
    ///     Wheel speeds [rad/s].
    #[doc = raises!(InfeasibleMotionError)]
    ///     If a wheel would slide sideways or steer past its range; the first bad row is named and nothing
    ///     is written. `project` finds a twist the rover can make.
    /// ValueError
    ///     If a value is not finite or a shape does not fit.
    ///
    /// Source: R. Siegwart, I. Nourbakhsh, D. Scaramuzza, Introduction to Autonomous Mobile Robots, 2nd ed., ch. 3.
    pub fn inverse[&self, py: Python<'py>](twist, *more, previous=None, steering_rates=None, centre=None,
        previous_wheel_speeds=None, out=None, dtype=None, threads: Option<i64> = None, level: Option<&str> = None)
    as "($self, twist, *, previous=None, steering_rates=None, centre=None, previous_wheel_speeds=None, out=None, dtype=None, threads=None, level=None)"
    -> PyResult<(AnyArray<'py>, AnyArray<'py>)> {
        one_twist("Rover.inverse((vx, vy, omega))", 1, more)?;
        let precision = Precision::read(py, dtype, out)?;
        let mut twists = Blocks::read("twist", twist, 3)?;
        let mut centres = Rows::read_optional("centre", centre, 2)?;
        let mut previous = Blocks::read_optional("previous", previous, self.joints())?;
        let mut rates = Blocks::read_optional("steering_rates", steering_rates, self.joints())?;
        let mut rolling = Blocks::read_optional("previous_wheel_speeds", previous_wheel_speeds, self.count())?;
        let one = centres.take_if(|centres| centres.is_single()); // for all rows
        let leading = together([&mut twists, &mut centres, &mut previous, &mut rates, &mut rolling])?;
        let centres = one.or(centres).map(Rows::finite).transpose()?;
        let about = centres.as_ref().map(|centres| ReferencePoint { twists: twists.table(), centres: centres.pairs() });
        let out = Out::read_all(out, ["out[0]", "out[1]"], "be a pair of arrays (steering, wheel_speeds)")?;
        for (k, input) in [&mut previous, &mut rolling].into_iter().enumerate() {
            if let (Some(input), Some(array)) = (input, out.array(k)) {
                input.release_if(array)?;
            }
        }
        let shapes = [self.joints(), self.count()].map(|width| joined(&leading, width));
        let mut results = out.results(py, shapes, precision, false)?;
        let rows = match &about {
            Some(about) => Table::Read(about),
            None => twists.table(),
        };
        let beside = InputTables {
            previous: previous.as_ref().map(Blocks::table),
            previous_speeds: rolling.as_ref().map(Blocks::table),
            steering_rates: rates.as_ref().map(Blocks::table),
        };
        let workers = Workers { fresh: results.are_unseen(), ..workers(threads, level)? };
        let [angles, rotations] = results.flat();
        compute_rows(py, twists.count(), &leading, || {
            batch::inverse(&self.core, rows, beside, angles, rotations, workers)
        })?;
        results.finish_any().map(<(_, _)>::from)
    }

    /// The twist that angles and speeds of all wheels report, by least squares.
    #[doc = section!(Parameters: wheel_readings, steering_rates)]
    /// allow_underdetermined : bool
    ///     Take a motion that no wheel sees to be zero instead of raising.
    #[doc = parameters!(out "(..., 3)", dtype, threads)]
    /// level : str, optional
    ///     One of `simd_levels()`, default the best: they agree to 5 ulp or 1e-14, times the condition number of the
    ///     wheels' rows: the largest singular value over `TwistFit.sigma_min`.
    #[doc = returns!("ndarray, shape (..., 3)": "``[vx, vy, omega]`` in body axes [m/s, m/s, rad/s].")]
    #[doc = raises!(
        UnderdeterminedError: "If the wheels do not determine the twist.",
        ValueError: "If a value is not finite or a shape does not fit."
    )]
    fn forward[&self, py: Python<'py>](steering, wheel_speeds, *, steering_rates=None, allow_underdetermined: bool = false,
        out=None, dtype=None, threads: Option<i64> = None, level: Option<&str> = None) -> PyResult<AnyArray<'py>> {
        let readings = self.read_log(steering, wheel_speeds, steering_rates)?;
        let leading = readings.leading.as_slice();
        let mut twists = Output::asked(py, (out, dtype), &joined(leading, 3))?;
        let fresh = twists.is_unseen();
        let (tables, target) = (readings.tables(), twists.triples());
        let unseen = unseen(allow_underdetermined);
        let workers = Workers { fresh, ..workers(threads, level)? };
        compute_rows(py, target.len(), leading, || batch::forward(&self.core, tables, unseen, target, workers))?;
        twists.finish_any()
    }
}
