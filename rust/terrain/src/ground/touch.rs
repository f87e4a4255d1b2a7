//! All wheels of a chain over the ground: gaps, contact points, and how the gaps change with the state.

use nalgebra::Vector3;

use crate::ground::rims::circles::{RIMS, WheelCircle};
use crate::ground::rims::contact::{Minimum, RimContact, RimSegment, find_contacts, upper_half_matters};
use crate::suspension::{Chain, MAX_STATE, MAX_WHEELS, Placed, PlanPose, State, WheelFrame};
use crate::terrain::Terrain;
use six_wheel_numerics::simd::level::Level;

/// A wheel over the ground.
#[derive(Clone, Copy, Debug)]
pub struct WheelContact {
    /// The wheel.
    pub frame: WheelFrame,
    /// Result of the search along its rim.
    pub rim: RimContact,
    /// Least vertical distance of the rim over the ground [m]; NaN where there is no known ground.
    pub gap: f64,
    /// Point of the rim with that distance [m].
    pub point: Vector3<f64>,
    /// Derivatives of the ground's height there by x and y; on a crease the mix of both sides that is square to
    /// the rim.
    pub gradient: [f64; 2],
}

/// All wheels of a chain over the ground.
#[derive(Clone, Debug)]
pub struct WheelContacts<'a> {
    /// The chain where it stands.
    pub placed: Placed<'a>,
    /// Its wheels; those it does not have repeat the first.
    pub wheels: [WheelContact; MAX_WHEELS],
}

/// Derivatives of a wheel's gap by x, y and yaw, and by z, roll, pitch and the free angles, steering held. The
/// contact angle is where the gap is least, so how it moves does not matter.
pub fn gap_slopes(
    placed: &Placed<'_>,
    wheel: usize,
    point: Vector3<f64>,
    gradient: [f64; 2],
) -> ([f64; 3], [f64; MAX_STATE]) {
    let upwards = Vector3::new(-gradient[0], -gradient[1], 1.0);
    let slopes = placed.point_slopes(wheel, point);
    let [x, y, yaw, state @ ..] = slopes.map(|slope| upwards.dot(&slope));
    ([x, y, yaw], state)
}

/// The rim of a wheel over the grid, its centre by its distances from node (0, 0).
fn circle(ground: &Terrain, frame: &WheelFrame, radius: f64) -> WheelCircle {
    let [x, y] = ground.grid_from_offset(frame.centre.x, frame.centre.y);
    let [dx, dy] = ground.spacing();
    let in_grid = |direction: Vector3<f64>| {
        let [u, v] = ground.grid_axes([direction.x * radius, direction.y * radius]);
        [u / dx, v / dy, direction.z * radius]
    };
    WheelCircle { centre: [x, y, frame.centre.z], forward: in_grid(frame.forward), up: in_grid(frame.up) }
}

impl WheelContact {
    fn of(ground: &Terrain, frame: WheelFrame, radius: f64, rim: RimContact) -> Self {
        let mut touch = Self { frame, rim, gap: f64::NAN, point: frame.centre, gradient: [f64::NAN; 2] };
        if let Some(least) = rim.least {
            touch.gap = least.gap;
            (touch.point, touch.gradient) = touch.contact(ground, radius, &least);
        }
        touch
    }

    /// Point and gradient of a minimum [m].
    #[inline]
    pub fn contact(&self, ground: &Terrain, radius: f64, minimum: &Minimum) -> (Vector3<f64>, [f64; 2]) {
        let WheelFrame { centre, forward, up, .. } = self.frame;
        let [dx, dy] = ground.spacing();
        let at = minimum.at;
        (
            centre + (forward * at.sin - up * at.cos) * radius,
            ground.world_axes([minimum.slope[0] / dx, minimum.slope[1] / dy]),
        )
    }
}

impl<'a> WheelContacts<'a> {
    /// Room for a chain over the ground.
    #[inline]
    pub fn nowhere(chain: &'a Chain) -> Self {
        let frame =
            WheelFrame { centre: Vector3::zeros(), forward: Vector3::x(), axle: Vector3::y(), up: Vector3::z() };
        let touch = WheelContact {
            frame,
            rim: RimContact::NOTHING,
            gap: f64::NAN,
            point: frame.centre,
            gradient: [f64::NAN; 2],
        };
        Self { placed: chain.nowhere(), wheels: [touch; MAX_WHEELS] }
    }

    /// Puts the chain at a pose, a state and steering angles over the ground. None, and nothing that makes sense, where a
    /// differential does not reach.
    #[allow(clippy::too_many_arguments)] // one caller, which names them
    pub fn put(
        &mut self,
        ground: &Terrain,
        chain: &Chain,
        pose: PlanPose,
        state: &State,
        steering: &[f64],
        part: RimSegment,
        level: Level,
    ) -> Option<()> {
        self.placed.put(pose, state, steering)?;
        self.find(ground, chain, [1.0, 0.0], part, level);
        Some(())
    }

    /// The same over ground whose heights are a share of what they are above a datum, the lower halves of the rims alone: `over`
    /// holds the share and the datum.
    pub(crate) fn over_part(
        ground: &Terrain,
        chain: &'a Chain,
        pose: PlanPose,
        state: &State,
        steering: &[f64],
        over: [f64; 2],
        level: Level,
    ) -> Option<Self> {
        let mut touches = Self::nowhere(chain);
        touches.placed.put(pose, state, steering)?;
        touches.find(ground, chain, over, RimSegment::Lower, level);
        Some(touches)
    }

    /// Finds the contacts of all wheels where they are, over heights of a share above a datum.
    fn find(&mut self, ground: &Terrain, chain: &Chain, [share, datum]: [f64; 2], part: RimSegment, level: Level) {
        let count = chain.wheels().len();
        // Lanes without a wheel repeat the first.
        let wheel = |k: usize| if k < count { k } else { 0 };
        let frames: [WheelFrame; RIMS] = std::array::from_fn(|k| self.placed.wheel(wheel(k)));
        let circles: [WheelCircle; RIMS] = std::array::from_fn(|k| {
            let mut circle = circle(ground, &frames[k], chain.wheels()[wheel(k)].radius);
            if share != 1.0 {
                // As much higher as the ground is lower.
                circle.centre[2] = datum + (circle.centre[2] - datum) / share;
                circle.forward[2] /= share;
                circle.up[2] /= share;
            }
            circle
        });
        let rims = find_contacts(level, ground, &circles, count, part);
        for (k, touch) in self.wheels.iter_mut().enumerate().take(count) {
            *touch = WheelContact::of(ground, frames[k], chain.wheels()[k].radius, rims[k]);
            touch.gap *= share;
            touch.gradient = touch.gradient.map(|slope| slope * share);
        }
        let first = self.wheels[0];
        self.wheels[count..].fill(first);
    }

    /// Searches the upper halves of the rims too where the ground may be that high, or is not known; whether there is such a
    /// rim.
    pub(crate) fn look_up(&mut self, ground: &Terrain, chain: &Chain, level: Level) -> bool {
        let matters = self.wheels.iter().zip(chain.wheels()).any(|(touch, wheel)| {
            let gap = touch.rim.least.map_or(f64::INFINITY, |least| least.gap);
            upper_half_matters(ground, &circle(ground, &touch.frame, wheel.radius), gap)
        });
        if matters {
            self.find(ground, chain, [1.0, 0.0], RimSegment::Whole, level);
        }
        matters
    }

    /// [`gap_slopes`] of a wheel.
    #[inline]
    pub fn slopes(&self, wheel: usize) -> ([f64; 3], [f64; MAX_STATE]) {
        let touch = &self.wheels[wheel];
        gap_slopes(&self.placed, wheel, touch.point, touch.gradient)
    }

    /// True if a rim lies over unknown cells, and if one leaves the map.
    pub(crate) fn blind(&self) -> [bool; 2] {
        let any = |seen: fn(&RimContact) -> bool| self.wheels.iter().any(|touch| seen(&touch.rim));
        [any(|rim| rim.unknown), any(|rim| rim.outside)]
    }
}
