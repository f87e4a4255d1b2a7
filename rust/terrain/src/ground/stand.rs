//! Settled poses as numbers.

use std::mem::offset_of;

use nalgebra::Vector3;

use super::settler::Status;
use crate::suspension::{Chain, MAX_FREE, MAX_STATE, MAX_WHEELS, Placed, PlanPose, State};
use crate::terrain::Terrain;
use six_wheel_kinematics::geometry::Direction;
use six_wheel_numerics::error::Error;

/// A settled pose, without the chain.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)] // see `numbers`
pub struct Stand {
    /// Outcome of settling.
    pub status: Status,
    /// Stops of the joints: -1 at the lower, 1 at the upper, 0 at none.
    pub stops: [i8; MAX_FREE],
    /// Bits of the wheels in the air.
    pub hanging: u8,
    /// z [m], roll, pitch and the free angles [rad]; NaN without a settled pose.
    pub state: State,
    /// Contact of every wheel.
    pub wheels: [Contact; MAX_WHEELS],
}

/// Contact of a wheel with the ground.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)] // see `Stand::numbers`
pub struct Contact {
    /// Least vertical distance of the rim over the ground [m].
    pub gap: f64,
    /// Contact angle: 0 straight below, positive to the front.
    pub at: Direction,
    /// Derivatives of the ground's height by x and y there; on a crease the weighted mean of both sides that is
    /// orthogonal to the rim.
    pub gradient: [f64; 2],
    /// Contact angle of the next best contact [rad]; NaN unless its gap is the same to 1e-7 m.
    pub next: f64,
}

/// Number of numbers of a contact.
pub const CONTACT: usize = 6;
/// Number of numbers of a settled pose: its state and its contacts.
pub const NUMBERS: usize = MAX_STATE + CONTACT * MAX_WHEELS;

impl Contact {
    /// No contact.
    pub const NONE: Self =
        Self { gap: f64::NAN, at: Direction { sin: f64::NAN, cos: f64::NAN }, gradient: [f64::NAN; 2], next: f64::NAN };

    /// A contact with no other as near, at a place of the grid with these derivatives of the height by columns and rows [m].
    pub(crate) fn new(ground: &Terrain, gap: f64, at: Direction, [along, across]: [f64; 2]) -> Self {
        let [dx, dy] = ground.placement().spacing();
        Self { gap, at, gradient: ground.placement().world_axes([along / dx, across / dy]), next: f64::NAN }
    }

    /// The vector whose product with the velocity of the contact point is the rate of the gap.
    #[inline]
    pub fn upwards(&self) -> Vector3<f64> {
        Vector3::new(-self.gradient[0], -self.gradient[1], 1.0)
    }

    /// Contact angle [rad].
    #[inline]
    pub fn angle(&self) -> f64 {
        self.at.sin.atan2(self.at.cos)
    }
}

impl Stand {
    /// The result of a failure.
    pub const fn nothing(status: Status) -> Self {
        Self {
            status,
            stops: [0; MAX_FREE],
            hanging: 0,
            state: [f64::NAN; MAX_STATE],
            wheels: [Contact::NONE; MAX_WHEELS],
        }
    }

    /// The settled pose of this code of a status, these stops, bits of wheels in the air, and [`Self::numbers`]. Fails if
    /// there is no such status, or not as many numbers.
    pub fn from_parts(status: u8, stops: [i8; MAX_FREE], hanging: u8, numbers: &[f64]) -> Result<Self, Error> {
        let known = Status::ALL.into_iter().chain([Status::TipsOver]).find(|known| *known as u8 == status);
        let status = known.ok_or_else(|| Error::value("status", "be a code of a status", status.to_string()))?;
        let Ok(&numbers) = <&[f64; NUMBERS]>::try_from(numbers) else {
            return Err(Error::value("numbers", format!("be {NUMBERS}"), numbers.len().to_string()));
        };
        let mut stand = Self { status, stops, hanging, ..Self::nothing(status) };
        let (state, contacts) = numbers.split_at(MAX_STATE);
        stand.state.copy_from_slice(state);
        for (contact, &[gap, sin, cos, by_x, by_y, next]) in stand.wheels.iter_mut().zip(contacts.as_chunks().0) {
            *contact = Contact { gap, at: Direction { sin, cos }, gradient: [by_x, by_y], next };
        }
        Ok(stand)
    }

    /// The state, then of every wheel gap, sine and cosine of the contact angle, gradient and next angle.
    #[inline]
    pub fn numbers(&self) -> &[f64; NUMBERS] {
        const {
            assert!(offset_of!(Self, wheels) == offset_of!(Self, state) + size_of::<State>());
            assert!(size_of::<Contact>() == CONTACT * size_of::<f64>());
        }
        let stand: *const Self = self;
        // SAFETY: from the state on there are only numbers, without a gap between them: a contact is as large as its own.
        unsafe { &*stand.byte_add(offset_of!(Self, state)).cast() }
    }

    /// True if a wheel touches the ground.
    #[inline]
    pub fn touches(&self, wheel: usize) -> bool {
        self.hanging >> wheel & 1 == 0
    }

    /// The chain at its settled pose, relative to node (0, 0) of the ground; None without a settled pose.
    pub fn place<'a>(
        &self,
        chain: &'a Chain,
        ground: &Terrain,
        pose: PlanPose,
        steering: &[f64],
    ) -> Option<Placed<'a>> {
        if !self.status.stands() {
            return None;
        }
        chain.place(pose.relative_to(ground.placement().origin()), &self.state, steering)
    }

    /// Contact point of a wheel, on its rim, in the coordinates of `placed` [m].
    #[inline]
    pub fn point(&self, chain: &Chain, placed: &Placed<'_>, wheel: usize) -> Vector3<f64> {
        rim_point(chain, placed, wheel, self.wheels[wheel].at)
    }
}

/// A point of a wheel's rim at a contact angle, in the coordinates of `placed` [m].
pub fn rim_point(chain: &Chain, placed: &Placed<'_>, wheel: usize, at: Direction) -> Vector3<f64> {
    let frame = placed.wheel(wheel);
    frame.centre + frame.spoke(at) * chain.wheels()[wheel].radius
}

/// Derivatives of a wheel's gap by x, y and yaw, and by z, roll, pitch and the free angles, at constant steering
/// angles. The gap is stationary in the contact angle, so that the derivatives of that do not enter.
pub(crate) fn gap_slopes(
    placed: &Placed<'_>,
    wheel: usize,
    point: Vector3<f64>,
    contact: &Contact,
) -> ([f64; 3], [f64; MAX_STATE]) {
    let slopes = placed.point_slopes(wheel, point);
    let [x, y, yaw, state @ ..] = slopes.map(|slope| contact.upwards().dot(&slope));
    ([x, y, yaw], state)
}
