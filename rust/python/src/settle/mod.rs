//! `Suspension.settle` and `six_wheel.SettledPose`: chains on ground.

mod stability;
mod stand;

use pyo3::prelude::*;
use six_wheel_numerics::threads::workers::Workers;
use six_wheel_terrain::ground::{self, Settler, Status};

use crate::convert::{Rows, compute, memory, raise, read_point, together};
use crate::fastcall::{Answer, Arguments, three};
use crate::suspension::Suspension;
use crate::terrain::Terrain;
use crate::workers::workers;

pub use stability::{Feasibility, MarginJacobian, Stability};
pub use stand::Stand;

/// Steering angles beside poses, whose leading axes then go together: none, one row for all, or one per pose.
pub fn read_steering(value: Option<&Bound<'_, PyAny>>, joints: usize, poses: &mut Rows<'_>) -> PyResult<Vec<f64>> {
    let Some(value) = value else { return Ok(Vec::new()) };
    let mut rows = Rows::read("steering", value, joints)?;
    if !rows.is_single() {
        together([poses, &mut rows])?;
    }
    memory::gathered(rows.flat().iter().copied())
}

methods! { Suspension:
    /// Settles the rover on ground: heights, attitude and joint angles that put every wheel on it, exactly.
    ///
    /// A wheel is a circle; its gap is the least vertical distance of the circle over the bilinear surface.
    /// Settled means that every gap is 0. At the stop of a joint (`rocker_limit`, `bogie_limit`) a wheel hangs: one
    /// that the joint would lower if it could turn on. On a bogie that is the wheel ahead of its joint at the upper
    /// stop and the one behind at the lower. At the stop of the rockers several may: those hang without which
    /// no wheel has to be pulled down, with vertical loads and the weight in `centre_of_mass` but for one
    /// hundredth in the centre of every wheel, which turns a bogie that carries nothing. The same rule says which
    /// three of four wheels on a rigid body touch. Wheels may also touch where friction would have to hold a
    /// bogie from tipping over: this is geometry.
    #[doc = section!(Parameters)]
    /// ground : Terrain
    ///     The ground.
    #[doc = parameters!(poses)]
    /// steering : array_like, shape (steered,) or (..., steered), optional
    ///     Steering angles [rad], default 0. A pose whose angles are all NaN, as `inverse` gives them for a pose that does not
    ///     stand, has not converged.
    /// derivatives : bool
    ///     True to compute `by_pose` and `by_dimension`.
    /// centre_of_mass : (float, float, float), optional
    ///     In the body [m]; default the mean of the wheel centres, on a rocker-bogie at the height of the rocker axis.
    #[doc = parameters!(threads)]
    /// level : str, optional
    ///     One of `simd_levels()`; default the best. Results differ by rounding.
    #[doc = returns!("SettledPose": "With a status for every pose; numbers are NaN where it does not stand.")]
    #[doc = raises!("If a number is not finite or a shape does not fit.")]
    ///
    /// Source: M. Tarokh, G. McDermott, Kinematics modeling and analyses of articulated rovers, IEEE T-RO 21(4),
    /// 2005, for the kinematics; the contact of circle and grid is solved over every cell (`docs/explanation/settling.md`).
    fn settle[slf: &Bound<'py, Self>, py: Python<'py>](ground: Bound<'py, Terrain>, poses, steering=None, *,
        derivatives: bool = false, centre_of_mass=None, threads: Option<i64> = None, level: Option<&str> = None)
    -> PyResult<Stand> {
        let chain = &slf.get().chain;
        let mut poses = Rows::read("poses", poses, 3)?;
        let steering = read_steering(steering, chain.steering().len(), &mut poses)?;
        let mut settler = Settler::new(&ground.get().0, chain);
        if let Some(centre) = centre_of_mass {
            settler.balance = read_point("centre_of_mass", centre)?.into();
        }
        let workers = workers(threads, level)?;
        settler.level = workers.level;
        let rows = poses.triples();
        let nothing = ground::Stand::nothing(Status::NotConverged);
        let mut stands = memory::filled(nothing, rows.len())?;
        compute(py, rows.len(), || ground::settle(&settler, rows, &steering, workers, &mut stands)).map_err(
            |error| {
                let one = error.argument == "steering" && error.row.is_none();
                raise(error, if one { &[] } else { &poses.leading })
            },
        )?;
        Ok(Stand {
            suspension: slf.clone().unbind(),
            ground: ground.get().0.clone(),
            poses: memory::gathered(rows.iter().copied())?,
            steering,
            stands,
            leading: poses.leading.clone(),
            derivatives,
        })
    }
}

fast_methods! {
    SettleCall<2>: Suspension, c"settle", [c"ground", c"poses"], 2, settle;
}

#[inline(always)]
fn settle<'py>(this: Borrowed<'_, 'py, Suspension>, [ground, pose]: Arguments<'_, 'py, 2>) -> Answer<'py> {
    let (py, suspension) = (this.py(), this.get());
    let (ground, pose) = (&ground?.cast::<Terrain>().ok()?.get().0, three(pose?)?);
    let settler = Settler::new(ground, &suspension.chain);
    let mut stands = vec![ground::Stand::nothing(Status::NotConverged)];
    ground::settle(&settler, &[pose], &[], Workers::PLAIN, &mut stands).ok()?;
    let stand = Stand {
        suspension: this.to_owned().unbind(),
        ground: ground.clone(),
        poses: vec![pose],
        steering: Vec::new(),
        stands,
        leading: Vec::new(),
        derivatives: false,
    };
    Some(Bound::new(py, stand).ok()?.into_any())
}
