//! `Suspension.stability` and `RockerBogie.feasible`.

use pyo3::prelude::*;
use six_wheel_numerics::error::{bounded, positive};
use six_wheel_numerics::threads::workers::Workers;
use six_wheel_terrain::bounds::{
    self, Allowed, Belly, Judge, Verdict, joint_margins, loads, margins_by_dimension, margins_by_pose, tilt,
    tip_over_angle,
};
use six_wheel_terrain::ground::Settler;

use super::stand::Stand;
use crate::convert::{
    OrRaise, Out, Results, Rows, compute_rows, joined, memory, number, read_point, refuse, scalar_or_array,
};
use crate::suspension::{Plate, RockerBogie, Suspension, check_map_error, read_belly};
use crate::terrain::Terrain;
use crate::workers::{fill_rows, workers};

result_class! {
    /// Loads and margins of a settled rover: see `Suspension.stability`.
    pub struct Stability {
        /// Vertical load of every wheel, shape (..., wheels) [N]; a negative one would have to pull.
        loads: Py<PyAny>,
        /// Least angle by which the rover has to be turned about a line through two contacts to tip over, shape (...)
        /// [rad]; negative where it does.
        tip_over_angle: Py<PyAny>,
        /// Least vertical distance from the ground to the belly, shape (...) [m]; negative where the ground is in it.
        clearance: Py<PyAny>,
        /// Angle of every free joint to its nearer stop, shape (..., joints) [rad]; infinite without stops.
        joint_margins: Py<PyAny>,
        /// Angle between the rover's z axis and the vertical, shape (...) [rad].
        tilt: Py<PyAny>,
        /// Derivatives of these margins by x, y and yaw; None unless the stand was asked for `derivatives`.
        by_pose: Option<Py<MarginJacobian>>,
        /// Derivatives by the dimensions of a rocker-bogie; None for other chains, and unless the stand was asked for them.
        by_dimension: Option<Py<MarginJacobian>>,
    }
    repr { loads tip_over_angle clearance joint_margins tilt }
}

result_class! {
    /// Feasibility of poses: see `RockerBogie.feasible`.
    pub struct Feasibility {
        /// True if the rover may stand at the pose, shape (...).
        ok: Py<PyAny>,
        /// Numbers of the reasons in `six_wheel.FeasibilityReason`, shape (...), as in the layer of `six-wheel traverse`.
        reason_codes: Py<PyAny>,
        /// Least margin to any of the limits, shape (...): shares of angles and drops, clearances in wheel
        /// radii. NaN where nothing is known.
        margin: Py<PyAny>,
        /// Tilt, shape (...) [rad]; the largest possible where `exact` is false, NaN where nothing is known.
        tilt: Py<PyAny>,
        /// Clearance, shape (...) [m]; the least possible where `exact` is false, NaN where nothing is known.
        clearance: Py<PyAny>,
        /// True if the rover was settled at the pose, false if bounds decided, shape (...).
        exact: Py<PyAny>,
    }
    repr { ok reason margin tilt clearance exact }
}

getters! { Feasibility, self, py:
    /// Reason for a pose that is not feasible, shape (...): `six_wheel.FeasibilityReason`, ``ok`` where it may.
    reason: PyResult<Bound<'py, PyAny>> =
        py.import("six_wheel.kinematics.statuses")?.call_method1("feasible_reasons", (&self.reason_codes,));
}

result_class! {
    /// Derivatives of margins by x, y and yaw, or by the dimensions of a rocker-bogie in the order of `SettledPose.by_dimension`, with
    /// belly and centre of mass as they are. NaN where the rover does not stand, and of a tilt of 0.
    pub struct MarginJacobian {
        /// Of `Stability.tip_over_angle`, shape (..., 3) or (..., 16).
        tip_over_angle: Py<PyAny>,
        /// Of `Stability.clearance`, shape (..., 3) or (..., 16).
        clearance: Py<PyAny>,
        /// Of `Stability.joint_margins`, shape (..., joints, 3) or (..., joints, 16).
        joint_margins: Py<PyAny>,
        /// Of `Stability.tilt`, shape (..., 3) or (..., 16).
        tilt: Py<PyAny>,
    }
    repr { tip_over_angle clearance joint_margins tilt }
}

/// By `N` numbers, row after row; None for a row without.
pub fn slopes<const N: usize>(
    py: Python<'_>,
    stand: &Stand,
    workers: Workers,
    of: impl Fn(usize) -> Option<bounds::MarginSlopes<N>> + Sync + Send,
) -> PyResult<Py<MarginJacobian>> {
    let joints = stand.suspension.get().chain.joints().len();
    let one = joined(&stand.leading, N);
    let shapes = [one.clone(), one.clone(), joined(&joined(&stand.leading, joints), N), one];
    let mut results = Results::fresh(py, shapes)?;
    let [tipping, clear, turns, tilts] = results.flat();
    let count = stand.stands.len();
    let rows = [(tipping, N), (clear, N), (turns, joints * N), (tilts, N)];
    fill_rows(py, workers, count, &stand.leading, rows, |k, [tipping, clear, turns, tilts]| {
        let Some(found) = of(k) else {
            for row in [tipping, clear, turns, tilts] {
                row.fill(f64::NAN);
            }
            return Ok(());
        };
        tipping.copy_from_slice(&found.tip_over_angle);
        clear.copy_from_slice(&found.clearance);
        tilts.copy_from_slice(&found.tilt);
        for (row, joint) in turns.chunks_exact_mut(N).zip(&found.joints) {
            row.copy_from_slice(joint);
        }
        Ok(())
    })?;
    let [tip_over_angle, clearance, joint_margins, tilt] = results.finish_arrays()?;
    Py::new(py, MarginJacobian { tip_over_angle, clearance, joint_margins, tilt })
}

/// Reads the limits of an object that has them as attributes, or the default ones.
fn allowed(py: Python<'_>, limits: Option<&Bound<'_, PyAny>>) -> PyResult<Allowed> {
    let limits = match limits {
        Some(limits) => limits.clone(),
        None => py.import("six_wheel.kinematics.statuses")?.getattr("FeasibilityLimits")?.call_method0("curiosity")?,
    };
    let read = |name: &str| match limits.getattr(name) {
        Ok(value) => number(name, &value),
        Err(_) => Err(refuse("limits", "be a FeasibilityLimits", limits.get_type().name()?)),
    };
    let allowed = Allowed {
        roll: read("roll")?,
        pitch: read("pitch")?,
        tilt: read("tilt")?,
        rocker: read("rocker")?,
        bogie: read("bogie")?,
        clearance: read("clearance")?,
        wheel_drop: read("wheel_drop")?,
    };
    allowed.check().or_raise(&[])?;
    Ok(allowed)
}

methods! { RockerBogie:
    /// Tests if the rover may stand at poses: by `bounds` where they decide, by `settle` where they do not.
    #[doc = section!(Parameters)]
    /// ground : Terrain
    ///     The map.
    #[doc = parameters!(poses)]
    /// limits : FeasibilityLimits, optional
    ///     Limits of a feasible pose; default ``FeasibilityLimits.curiosity()``.
    /// map_error : float, default 0.0
    ///     Largest error of the heights of the map [m]: bounds hold for all of them, settled
    ///     clearances are less by twice as much.
    /// belly : (float, float, float, float), optional
    ///     Rear edge, front edge, half width and height of the underside of the body [m], as for `bounds`.
    /// out : tuple of ndarray, optional
    ///     Arrays for margin, tilt and clearance, in this order, each of shape (...); what is left out, or None, is
    ///     fresh. Nothing is written by a call that fails.
    #[doc = parameters!(threads)]
    #[doc = returns!("Feasibility": "`ok`, `reason`, `margin`, `tilt`, `clearance`, `exact`, each of shape (...).")]
    #[doc = raises!("If a number is not finite, a limit not positive or a shape does not fit.")]
    fn feasible[slf: &Bound<'py, Self>, py: Python<'py>](ground: Bound<'py, Terrain>, poses, limits=None, *,
        map_error: f64 = 0.0, belly: Option<(f64, f64, f64, f64)> = None, out=None, threads: Option<i64> = None)
    -> PyResult<Feasibility> {
        let this = slf.get();
        check_map_error(map_error)?;
        this.bounds_constants(belly, None).or_raise(&[])?; // as `bounds` fails with this belly
        let allowed = allowed(py, limits)?;
        let poses = Rows::read("poses", poses, 3)?.finite()?;
        let workers = workers(threads, None)?;
        let (rows, ground, leading) = (poses.triples(), &*ground.get().0, &poses.leading);
        let settler = Settler::new(ground, this.0.chain());
        let dimensions = this.0.dimensions();
        let judge = this.belly(belly).and_then(|belly| Judge::new(settler, dimensions, belly, allowed, map_error));
        let judge = judge.or_raise(&[])?;
        let mut verdicts = memory::filled(Verdict::UNKNOWN, rows.len())?;
        let shapes = [(); 3].map(|()| leading.clone());
        let mut results = Out::read(out, ["margin", "tilt", "clearance"])?.results(py, shapes, None, false)?;
        compute_rows(py, rows.len().max(ground.heights().len() / 1000), &[], || {
            judge.judge(rows, &mut verdicts, workers)
        })?;
        let truths =
            |value: fn(&Verdict) -> bool| scalar_or_array(py, memory::gathered(verdicts.iter().map(value))?, leading);
        let codes = verdicts.iter().map(|verdict| verdict.reason as u8);
        let reason_codes = scalar_or_array(py, memory::gathered(codes)?, leading)?;
        let (ok, exact) = (truths(|verdict| verdict.reason as u8 == 0)?, truths(|verdict| verdict.exact)?);
        let [margins, tilts, clear] = results.flat();
        let targets = margins.iter_mut().zip(tilts).zip(clear);
        for (verdict, ((margin, tilt), clearance)) in verdicts.iter().zip(targets) {
            (*margin, *tilt, *clearance) = (verdict.margin, verdict.tilt, verdict.clearance);
        }
        let [margin, tilt, clearance] = results.finish()?;
        Ok(Feasibility { ok, reason_codes, margin, tilt, clearance, exact })
    }
}

fn check_positive(argument: &'static str, value: f64) -> PyResult<()> {
    positive(argument, value).and_then(|()| bounded(argument, &[value])).or_raise(&[])
}

/// The belly that is given, or that of a rocker-bogie between its wheels.
fn belly_of(suspension: &Bound<'_, Suspension>, given: Option<Plate>) -> PyResult<Option<Belly>> {
    let default = suspension.cast::<RockerBogie>().ok().map(|rover| Belly::between_wheels(rover.get().0.dimensions()));
    given.map_or(Ok(default), |belly| read_belly(belly).map(Some)).or_raise(&[])
}

/// Derivatives of the margins by pose and by dimensions, where the stand was asked for them.
fn derivatives(
    suspension: &Bound<'_, Suspension>,
    stand: &Stand,
    workers: Workers,
    centre: [f64; 3],
    belly: Option<Belly>,
) -> PyResult<[Option<Py<MarginJacobian>>; 2]> {
    if !stand.derivatives {
        return Ok([None, None]);
    }
    let (py, chain) = (suspension.py(), &suspension.get().chain);
    let by_pose = slopes(py, stand, workers, |k| {
        let (one, placed) = (&stand.stands[k], stand.placed(k)?);
        margins_by_pose(&stand.ground, chain, one, &placed, centre, belly)
    })?;
    let by_dimension = |rover: &Bound<'_, RockerBogie>| {
        let of = (chain, rover.get().0.dimensions());
        slopes(py, stand, workers, |k| {
            let (one, placed) = (&stand.stands[k], stand.placed(k)?);
            margins_by_dimension(&stand.ground, of, one, &placed, centre, belly)
        })
    };
    Ok([Some(by_pose), suspension.cast::<RockerBogie>().ok().map(by_dimension).transpose()?])
}

methods! { Suspension:
    /// Loads of the wheels at settled poses, and the margins to tipping over, to the ground and to the joints' stops.
    ///
    /// Loads push straight up where wheels touch, wheels held by their links; all mass is in the body. They keep
    /// the body and every free joint in balance; a joint at its stop takes any moment.
    #[doc = section!(Parameters)]
    /// stand : SettledPose
    ///     From `settle` of this suspension.
    /// mass : float
    ///     Of the rover [kg].
    /// centre_of_mass : (float, float, float), optional
    ///     In the rover's frame [m]; default that of `settle`.
    /// gravity : float, default 9.80665
    ///     [m/s^2].
    /// belly : (float, float, float, float), optional
    ///     Rear edge, front edge, half width and height of the underside of the body [m], as for `RockerBogie.bounds`,
    ///     which has a default; without one `clearance` is NaN.
    /// out : tuple of ndarray, optional
    ///     Arrays for loads, tip-over angle, clearance, joint margins and tilt, in this order, of the shapes of the
    ///     result; what is left out, or None, is fresh. Nothing is written by a call that fails.
    #[doc = parameters!(threads)]
    #[doc = returns!("Stability")]
    ///     `loads` (..., wheels), `tip_over_angle` (...), `clearance` (...), `joint_margins` (..., joints),
    ///     `tilt` (...); NaN where the rover does not stand, or where forces are not determined. Of a stand with
    ///     `derivatives`, those of the margins: `by_pose`, `by_dimension`.
    #[doc = raises!("If mass or gravity are not finite and positive, or the stand is of another suspension.")]
    ///
    /// Source: E. Papadopoulos, D. Rey, A new measure of tipover stability margin for mobile manipulators,
    /// ICRA 1996.
    fn stability[slf: &Bound<'py, Self>, py: Python<'py>](stand: Bound<'py, Stand>, *, mass: f64, centre_of_mass=None,
        gravity: f64 = 9.80665, belly: Option<(f64, f64, f64, f64)> = None, out=None, threads: Option<i64> = None)
    -> PyResult<Stability> {
        let workers = workers(threads, None)?;
        check_positive("mass", mass)?;
        check_positive("gravity", gravity)?;
        let (chain, stand) = (&slf.get().chain, stand.get());
        if !stand.suspension.bind(py).is(slf) && stand.suspension.get().chain.wheels().len() != chain.wheels().len() {
            return Err(refuse("stand", "be one of this suspension", "one of another"));
        }
        let centre =
            centre_of_mass.map_or(Ok(chain.balance().into()), |centre| read_point("centre_of_mass", centre))?;
        let belly = belly_of(slf, belly)?;
        let (wheels, joints) = (chain.wheels().len(), chain.joints().len());
        let leading = stand.leading.as_slice();
        let [one, wheel, joint] = [leading.to_vec(), joined(leading, wheels), joined(leading, joints)];
        let shapes = [wheel, one.clone(), one.clone(), joint, one];
        let names = ["loads", "tip_over_angle", "clearance", "joint_margins", "tilt"];
        let mut results = Out::read(out, names)?.results(py, shapes, None, false)?;
        let [by_pose, by_dimension] = derivatives(slf, stand, workers, centre, belly)?;
        let [carried, tipping, clear, margins, tilts] = results.flat();
        let outputs = [(carried, wheels), (tipping, 1), (clear, 1), (margins, joints), (tilts, 1)];
        let fill = |k: usize, [carried, tipping, clear, margins, tilts]: [&mut [f64]; 5]| {
            for row in [&mut *carried, &mut *tipping, &mut *clear, &mut *margins, &mut *tilts] {
                row.fill(f64::NAN);
            }
            let one = &stand.stands[k];
            let Some(placed) = stand.placed(k) else { return Ok(()) };
            if let Some(shares) = loads(chain, one, &placed, centre) {
                for (load, share) in carried.iter_mut().zip(shares) {
                    *load = share * mass * gravity;
                }
            }
            for (margin, value) in margins.iter_mut().zip(joint_margins(chain, one)) {
                *margin = value;
            }
            let clearance = belly.and_then(|belly| belly.above(&stand.ground, &placed));
            tipping[0] = tip_over_angle(chain, one, &placed, centre).unwrap_or(f64::NAN);
            clear[0] = clearance.unwrap_or(f64::NAN);
            tilts[0] = tilt(&placed);
            Ok(())
        };
        fill_rows(py, workers, stand.stands.len(), leading, outputs, fill)?;
        let [loads, tip_over_angle, clearance, joint_margins, tilt] = results.finish()?;
        Ok(Stability { loads, tip_over_angle, clearance, joint_margins, tilt, by_pose, by_dimension })
    }
}
