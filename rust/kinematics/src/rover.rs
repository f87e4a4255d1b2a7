//! A rover: its data, and the constants of its kernels.

use std::ops::Deref;
use std::sync::OnceLock;

use crate::admissible::Keep;
use crate::admissible::cone::AdmissibleCone;
use crate::admissible::faces::Faces;
use crate::admissible::projection::Projection;
use crate::estimate::gradients::Gradients;
use crate::estimate::sensitivity::Quantity;
use crate::estimate::{Fit, Measured, Method, Unseen};
use crate::geometry::Twist;
use crate::inverse::constants::InverseConstants;
use crate::kernels::fit::{FitConstants, Fits};
use crate::kernels::normal_equations::ForwardConstants;
pub use crate::rover_data::{Bank, Inputs, MAX_WHEELS, Mount, RoverData};
use crate::units;
use crate::wheels::Wheel;
use six_wheel_numerics::error::Error;
use six_wheel_numerics::simd::level::Level;

/// A wheeled vehicle: its wheels, and the constants that follow from them.
///
/// Immutable, without state: every method may be called from any number of threads. It dereferences to its
/// [`RoverData`], whose methods are its own.
#[derive(Clone, Debug)]
pub struct Rover {
    data: RoverData,
    /// Angle up to which no steering angle is suspicious ([`units::angles`]), whichever wheel's it is [rad].
    plain_angle: f64,
    /// Constants of the inverse kinematics.
    pub inverse_constants: InverseConstants,
    /// Constants of the forward kinematics.
    pub(crate) forward_constants: ForwardConstants,
    min_radius: f64,
    spin_radius: f64,
    /// The admissible twists.
    pub cone: AdmissibleCone,
    /// The faces of the admissible set, made at the first projection.
    faces: OnceLock<Faces>,
    /// Constants of fits by each method with either treatment of undetermined motion, made at the first fit.
    fits: [OnceLock<FitConstants>; 6],
    /// Constants of derivatives of the twist by each quantity, made at the first call.
    gradients: [OnceLock<Gradients>; Quantity::ALL.len()],
}

impl Deref for Rover {
    type Target = RoverData;

    #[inline]
    fn deref(&self) -> &RoverData {
        &self.data
    }
}

impl PartialEq for Rover {
    fn eq(&self, other: &Self) -> bool {
        self.wheels() == other.wheels()
    }
}

impl Rover {
    /// A rover of any layout. Fails if a wheel is not well formed or two share a name.
    pub fn new(wheels: Vec<Wheel>) -> Result<Self, Error> {
        let mut data = RoverData::new(wheels)?;
        data.solution = data.constant_solution();
        let cone = AdmissibleCone::new(&data);
        let (min_radius, spin_radius) = data.turning_limits(&cone);
        Ok(Self {
            plain_angle: units::plain_angle(&data),
            inverse_constants: InverseConstants::new(&data),
            forward_constants: ForwardConstants::new(&data),
            min_radius,
            spin_radius,
            cone,
            faces: OnceLock::new(),
            fits: Default::default(),
            gradients: Default::default(),
            data,
        })
    }

    /// True if no angle can be suspicious ([`units::angles`]): one comparison per angle.
    pub fn are_plain(&self, steering: &[f64]) -> bool {
        steering.iter().all(|angle| angle.abs() <= self.plain_angle)
    }

    /// Gradients from which derivatives of the twist by a quantity are computed.
    pub(crate) fn gradients(&self, quantity: Quantity) -> &Gradients {
        self.gradients[quantity as usize].get_or_init(|| Gradients::new(&self.data, quantity))
    }

    /// Constants of fits.
    pub(crate) fn fit_constants(&self, method: Method, unseen: Unseen) -> &FitConstants {
        self.fits[2 * method as usize + unseen as usize].get_or_init(|| FitConstants::new(&self.data, method, unseen))
    }

    /// The faces of the admissible set.
    pub(crate) fn faces(&self) -> &Faces {
        self.faces.get_or_init(|| Faces::new(&self.data, &self.cone))
    }

    /// Every turning radius of at least this size is possible [m]; 0 if all are, infinite if none is.
    ///
    /// The centre of rotation lies on the line of the fixed wheels, or on the y axis if there are none; the radius
    /// counts from the foot of the origin on that line.
    pub fn min_radius(&self) -> f64 {
        self.min_radius
    }

    /// Every turning radius of at most this size is possible [m]; 0 if the rover cannot spin at all.
    pub fn spin_radius(&self) -> f64 {
        self.spin_radius
    }

    /// The wheel equation solved for the wheels: steering angles [rad] and wheel speeds [rad/s].
    ///
    /// Nothing is written unless [`Self::check`] passes.
    #[inline]
    pub fn inverse(
        &self,
        twist: Twist,
        inputs: Inputs<'_>,
        steering: &mut [f64],
        speeds: &mut [f64],
    ) -> Result<(), Error> {
        if self.solve_row(self.inverse_constants.level, twist, inputs, [&mut *steering, &mut *speeds], true) {
            return Ok(());
        }
        inputs.check()?;
        self.check(twist, inputs.steering_rates)?;
        self.solve(twist, inputs, steering, speeds);
        Ok(())
    }

    /// The inverse kinematics of a twist that need not be possible: steering angles outside a range are clipped to its
    /// nearer end.
    #[inline]
    pub fn solve(&self, twist: Twist, inputs: Inputs<'_>, steering: &mut [f64], speeds: &mut [f64]) {
        self.solve_row(self.inverse_constants.level, twist, inputs, [steering, speeds], false);
    }

    /// [`Self::solve`] at a level. If `is_checked`, returns false and writes nothing unless the twist is well inside
    /// the admissible ones.
    #[inline]
    pub(crate) fn solve_row(
        &self,
        level: Level,
        twist: Twist,
        inputs: Inputs<'_>,
        targets: [&mut [f64]; 2],
        is_checked: bool,
    ) -> bool {
        let cone = is_checked.then_some(&self.cone);
        self.inverse_constants.solve_row(level, twist.into(), inputs, targets, cone)
    }

    /// The twist that fits the readings of all wheels best, in the sense of least squares.
    #[inline]
    pub fn forward(&self, measured: Measured<'_>, unseen: Unseen) -> Result<Twist, Error> {
        self.forward_constants.solve_row(&self.data, measured, unseen)
    }

    /// The twist with residual [m/s] and weight of every wheel, rank and smallest singular value.
    pub fn fit(
        &self,
        measured: Measured<'_>,
        method: Method,
        unseen: Unseen,
        residual: &mut [f64],
        weights: &mut [f64],
    ) -> Result<Fit, Error> {
        let (mut twists, mut ranks, mut sigmas) = ([[0.0; 3]], [0], [0.0]);
        let mut fits = Fits { twists: &mut twists, ranks: &mut ranks, sigmas: &mut sigmas, residual, weights };
        let level = self.forward_constants.level;
        let constants = self.fit_constants(method, unseen);
        constants.fit(level, &self.data, measured, &mut fits).map_err(|error| Error { row: None, ..error })?;
        let ([twist], [rank], [sigma_min]) = (twists, ranks, sigmas);
        Ok(Fit { twist: twist.into(), rank: rank as usize, sigma_min })
    }

    /// Fails unless the rover can make the twist: finite, without side slip, inside the steering ranges.
    #[inline]
    pub fn check(&self, twist: Twist, steering_rates: Option<&[f64]>) -> Result<(), Error> {
        self.cone.check(&self.data, twist, steering_rates)
    }

    /// Fails unless the twist and every wheel speed are finite.
    #[inline]
    pub fn check_speeds(&self, twist: Twist) -> Result<(), Error> {
        self.cone.check_speeds(twist)
    }

    /// True if the rover can make a twist. Fails if it is not finite.
    #[inline]
    pub fn admissible(&self, twist: Twist) -> Result<bool, Error> {
        self.cone.admissible(twist)
    }

    /// The nearest admissible twist that preserves the components of `keep`; an admissible twist is unchanged.
    #[inline]
    pub fn project(&self, twist: Twist, keep: Keep) -> Result<Twist, Error> {
        // The faces are not made for an admissible twist.
        if self.faces.get().is_none() && self.admissible(twist).unwrap_or(false) {
            return Ok(twist);
        }
        self.projection(keep).of(twist)
    }

    /// Constants of projections that preserve the components of `keep`.
    pub(crate) fn projection(&self, keep: Keep) -> Projection<'_> {
        Projection { cone: &self.cone, faces: self.faces(), keep, size: self.size }
    }
}
