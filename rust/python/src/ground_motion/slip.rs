//! `Suspension.slip` and `body_slip`.

use pyo3::prelude::*;
use six_wheel_ground_motion::{SlipInput, SlipTest, Slips, slip_rows};

use super::settled_pose_input::Stands;
use crate::convert::{OrRaise, Out, Output, Rows, compute_rows, joined, refuse, short_repr, together};
use crate::suspension::Suspension;
use crate::workers::workers;

result_class! {
    /// Slip ratio and slip angle of wheels.
    pub struct WheelSlip {
        /// ``1 - travelled / rolled``, shape (..., wheels): 0 rolls, 1 spins on the spot, negative brakes; NaN where a
        /// wheel does not turn or does not touch.
        ratio: Py<PyAny>,
        /// Of the way of the touching point against the wheel's heading, positive to the left, shape (..., wheels) [rad].
        angle: Py<PyAny>,
    }
    repr { ratio angle }
}

methods! { Suspension:
    /// Slip ratio and slip angle of every wheel at a known motion.
    #[doc = section!(Parameters)]
    /// stand : SettledPose
    ///     Result of `settle`, at the steering angles of the moment, shape (...).
    /// wheel_speeds : array_like, shape (..., wheels)
    ///     Measured speed of every wheel against the link that carries it [rad/s].
    /// twist : array_like, shape (..., 6)
    ///     ``vx, vy, vz, wx, wy, wz`` of the body's origin in its own axes, from elsewhere [m/s, rad/s].
    /// joint_rates : array_like, shape (..., joints)
    ///     Rates of the free angles [rad/s].
    /// out : tuple of ndarray, optional
    ///     Arrays for ratio and angle, in this order, each of shape (..., wheels); what is left out, or None, is
    ///     fresh. Nothing is written by a call that fails.
    #[doc = parameters!(threads)]
    #[doc = returns!("WheelSlip": "`ratio` and `angle` [rad].")]
    #[doc = raises!("If a number is not finite or a shape does not fit.")]
    fn slip[&self, py: Python<'py>](stand, wheel_speeds, twist, joint_rates, *, out=None, threads: Option<i64> = None)
    -> PyResult<WheelSlip> {
        let workers = workers(threads, None)?;
        let chain = &self.chain;
        let mut stands = Stands::read(chain, stand)?;
        let (wheels, joints) = (chain.wheels().len(), chain.joints().len());
        let mut speeds = Rows::read("wheel_speeds", wheel_speeds, wheels)?;
        let mut twists = Rows::read("twist", twist, 6)?;
        let mut rates = Rows::read("joint_rates", joint_rates, joints)?;
        let leading = together([&mut stands, &mut speeds, &mut twists, &mut rates])?;
        for rows in [&speeds, &twists, &rates] {
            stands.check_finite(rows)?;
        }
        let shapes = [(); 2].map(|()| joined(&leading, wheels));
        let mut results = Out::read(out, ["ratio", "angle"])?.results(py, shapes, None, false)?;
        let footings = stands.footings();
        let [ratios, angles] = results.flat();
        let slips = Slips { ratios, angles };
        let twists = twists.flat().as_chunks().0;
        let input = SlipInput { speeds: speeds.flat(), twists, joint_rates: rates.flat() };
        compute_rows(py, speeds.count(), &leading, || {
            slip_rows(chain, &self.motion, &footings, &input, slips, workers)
        })?;
        let [ratio, angle] = results.finish_arrays()?;
        Ok(WheelSlip { ratio, angle })
    }
}

result_class! {
    /// Slip of a whole rover, and the chi-squared test for it.
    pub struct BodySlip {
        /// The navigated motion less the kinematic one, shape (n,).
        slip: Py<PyAny>,
        /// Its squared length in the metric of the covariance: chi-squared, with n degrees of freedom, without slip.
        statistic: f64,
        /// Without slip the statistic is above this value only with the probability of a false alarm.
        threshold: f64,
        /// Probability of such a statistic, or a larger one, without slip.
        probability: f64,
        /// True if the statistic is above the threshold: the rover slips.
        slipping: bool,
    }
    repr { slip statistic threshold probability slipping }
}

methods! { BodySlip:
    /// The command for a wanted motion: less the slip where there is some, so that what comes of it is wanted.
    #[doc = section!(Parameters)]
    /// wanted : array_like, shape (n,)
    ///     A motion in the same components.
    #[doc = returns!("ndarray, shape (n,)": "Motion to command.")]
    #[doc = raises!("If a number is not finite or the shape does not fit.")]
    ///
    /// Source: D. Helmick, Y. Cheng, D. Clouse, L. Matthies, S. Roumeliotis, Path following using visual odometry
    /// for a Mars rover in high-slip environments, IEEE Aerospace 2004.
    fn compensate[&self, py: Python<'py>](wanted) -> PyResult<Py<PyAny>> {
        let slip = self.slip.bind(py);
        let slips = Rows::read("slip", slip, slip.len()?)?;
        let wanted = Rows::read("wanted", wanted, slip.len()?)?.over(&[])?.finite()?;
        let mut command = Output::fresh(py, &[slip.len()?])?;
        let share = if self.slipping { 1.0 } else { 0.0 };
        for (k, command) in command.flat().iter_mut().enumerate() {
            *command = wanted.flat()[k] - share * slips.flat()[k];
        }
        command.finish_object()
    }
}

functions! {
    /// Tests if a motion that was navigated differs from the one the wheels tell by more than noise.
    #[doc = section!(Parameters)]
    /// navigated, kinematic : array_like, shape (n,)
    ///     The same motion, one to six components of it, from elsewhere and from the wheels: twists or increments.
    /// covariance : array_like, shape (n, n)
    ///     Of their difference without slip: the sum of both covariances.
    /// false_alarm : float, default 0.01
    ///     Probability with which a rover that does not slip is said to slip.
    #[doc = returns!("BodySlip": "`slip`, `statistic`, `threshold`, `probability`, `slipping`, and `compensate`.")]
    #[doc = raises!("If a number is not finite, the covariance not positive definite, or a shape does not fit.")]
    ///
    /// Source: D. Helmick, Y. Cheng, D. Clouse, L. Matthies, S. Roumeliotis, Path following using visual odometry
    /// for a Mars rover in high-slip environments, IEEE Aerospace 2004.
    pub fn body_slip[py: Python<'py>](navigated, kinematic, covariance, *, false_alarm: f64 = 0.01, **)
    as "(navigated, kinematic, covariance, *, false_alarm=0.01)"
    -> PyResult<BodySlip> {
        let length = navigated.len().unwrap_or(0);
        if !(1..=6).contains(&length) {
            return Err(refuse("navigated", "hold one to six numbers", short_repr(navigated)));
        }
        let navigated = Rows::read("navigated", navigated, length)?.over(&[])?.finite()?;
        let kinematic = Rows::read("kinematic", kinematic, length)?.over(&[])?.finite()?;
        let covariance = Rows::read("covariance", covariance, length)?.over(&[length])?.finite()?;
        let mut slip = Output::fresh(py, &[length])?;
        for (k, slip) in slip.flat().iter_mut().enumerate() {
            *slip = navigated.flat()[k] - kinematic.flat()[k];
        }
        let test = SlipTest::new(slip.flat(), covariance.flat(), false_alarm).or_raise(&[])?;
        Ok(BodySlip {
            slip: slip.finish_object()?,
            statistic: test.statistic,
            threshold: test.threshold,
            probability: test.probability,
            slipping: test.slips(),
        })
    }
}
