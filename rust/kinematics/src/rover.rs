//! A rover: its data, and the constants that the kernels of its questions have made of it.

use std::ops::Deref;
use std::sync::OnceLock;

use crate::admissible::Keep;
use crate::admissible::faces::Faces;
use crate::estimate::gradients::Gradients;
use crate::estimate::sensitivity::Quantity;
use crate::geometry::Twist;
use crate::kernels::cone::Cone;
use crate::one_row::{forward, inverse};
pub use crate::rover_data::{Bank, Inputs, MAX_WHEELS, Mount, RoverData};
use crate::units;
use crate::wheels::Wheel;
use six_wheel_numerics::error::Error;

/// A wheeled vehicle: its wheels, and what follows from them once and for all.
///
/// Immutable, without state: every method may be called from any number of threads. It dereferences to its
/// [`RoverData`], whose methods are its own.
#[derive(Clone, Debug)]
pub struct Rover {
    data: RoverData,
    /// An angle up to here is no question of units, whichever wheel's it is [rad].
    plain_angle: f64,
    /// Constants of the kernels that answer one call, where there are such kernels.
    pub(crate) inverse_constants: Option<inverse::InverseConstants>,
    pub(crate) forward_constants: Option<forward::ForwardConstants>,
    min_radius: f64,
    spin_radius: f64,
    /// The admissible twists as registers judge them, where they do.
    pub cone: Option<Cone>,
    /// Made when they are first asked for: many rovers are never asked to project.
    faces: OnceLock<Faces>,
    /// Likewise, for derivatives of the twist.
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
        let (min_radius, spin_radius) = data.turning_limits();
        Ok(Self {
            plain_angle: units::plain_angle(&data),
            inverse_constants: inverse::InverseConstants::new(&data),
            forward_constants: forward::ForwardConstants::new(&data),
            min_radius,
            spin_radius,
            cone: Cone::new(&data),
            faces: OnceLock::new(),
            gradients: Default::default(),
            data,
        })
    }

    /// The admissible twists as registers judge them, where these say it all.
    pub(crate) fn whole_cone(&self) -> Option<&Cone> {
        self.cone.as_ref().filter(|cone| cone.is_whole)
    }

    /// True if no angle raises a question of units ([`units::angles`]): a comparison each.
    pub fn are_plain(&self, steering: &[f64]) -> bool {
        steering.iter().all(|angle| angle.abs() <= self.plain_angle)
    }

    /// Gradients from which derivatives of the twist by a quantity are computed.
    pub(crate) fn gradients(&self, quantity: Quantity) -> &Gradients {
        self.gradients[quantity as usize].get_or_init(|| Gradients::new(&self.data, quantity))
    }

    /// The faces of the admissible set.
    pub(crate) fn faces(&self) -> &Faces {
        self.faces.get_or_init(|| Faces::new(&self.data))
    }

    /// Every turning radius of at least this size is possible [m]; 0 if all are, infinite if none is.
    ///
    /// The centre of rotation lies on the line of the fixed wheels, or abreast of the body's origin if
    /// there are none; the radius counts from the foot of the origin on that line.
    pub fn min_radius(&self) -> f64 {
        self.min_radius
    }

    /// Every turning radius of at most this size is possible [m]; 0 if the rover cannot spin at all.
    pub fn spin_radius(&self) -> f64 {
        self.spin_radius
    }

    /// The wheel equation solved for the wheels: steering angles [rad] and wheel speeds [rad/s].
    ///
    /// Nothing is written unless [`RoverData::check`] passes.
    pub fn inverse(
        &self,
        twist: Twist,
        inputs: Inputs<'_>,
        steering: &mut [f64],
        speeds: &mut [f64],
    ) -> Result<(), Error> {
        inputs.check()?;
        self.check(twist, inputs.steering_rates)?;
        self.solve(twist, inputs, steering, speeds);
        Ok(())
    }

    /// The nearest twist the rover can make, preserving what `keep` says; an admissible one is unchanged.
    #[inline]
    pub fn project(&self, twist: Twist, keep: Keep) -> Result<Twist, Error> {
        self.project_by(|| self.faces(), twist, keep)
    }
}
