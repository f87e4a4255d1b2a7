//! Admissibility of twists for whole registers of them, and the nearest twist that a rover can make.
//!
//! A steered wheel whose range is narrower than half a turn is within it if its pivot moves along the middle of the range,
//! forwards or backwards, or at an angle to that of half the range at most. With the velocity of the pivot along the
//! middle and across it, and the half range `h`, the wheel slides at the nearer end at `|across| cos h - |along| sin h`:
//! no angle is needed. What is neither surely below the tolerance nor surely above it is left to the plain core.

use nalgebra::Vector3;
use pulp::Simd;

use super::usual::{is_usual, pivots_apart, usual};
use crate::admissible::faces::{AGREED, Face, Faces, VANISHED, components};
use crate::admissible::{Keep, SLIP_TOLERANCE};
use crate::rover_data::{Mount, RoverData};
use crate::wheels::Direction;
use six_wheel_numerics::simd::lanes::{Lanes, Mask};
pub use six_wheel_numerics::simd::vec3::row_times as dot;

/// Shares of the tolerance up to which a wheel surely does not slide, and from which on it surely does.
const SURE: [f64; 2] = [0.5, 2.0];

/// The admissible twists of a rover, as numbers.
#[derive(Clone, Debug)]
pub struct Cone {
    /// Rows whose products with the twist are the speeds at which unsteered wheels slide.
    banks: Vec<[f64; 3]>,
    /// One for each steered wheel with a range narrower than half a turn.
    wedges: Vec<Wedge>,
    /// Two pivots far apart: the faster one is a lower bound of the fastest.
    pivots: [[f64; 2]; 2],
    /// The longest way from the body's origin to a contact, along the axes [m].
    pub arm: f64,
    /// Root mean square distance of the pivots from their centre [m].
    size: f64,
    /// True if that is all: no steered wheel has trail, whose steering angle depends on more than its pivot's velocity.
    pub is_whole: bool,
}

/// The twists for which one steered wheel is within its range.
#[derive(Clone, Debug)]
struct Wedge {
    joint: usize,
    /// Rows of the pivot's velocity along the middle of the range and across it.
    along: [f64; 3],
    across: [f64; 3],
    /// Of half the range.
    half: Direction,
}

/// Verdict on each lane. Neither holds where the plain core has to decide.
#[derive(Clone, Copy)]
pub struct Verdict<S: Simd> {
    /// Lanes with a twist that is surely possible.
    pub yes: Mask<S>,
    /// Lanes with a twist that is surely impossible.
    pub no: Mask<S>,
}

impl Cone {
    /// Nothing where a size is extreme.
    pub fn new(rover: &RoverData) -> Option<Self> {
        let mut wedges = Vec::new();
        let mut arm: f64 = 0.0;
        let mut is_whole = true;
        for (i, (wheel, mount)) in rover.wheels().iter().zip(&rover.mounts).enumerate() {
            if !is_usual(wheel) {
                return None;
            }
            let offset = wheel.scrub.abs() + wheel.trail.abs();
            arm = arm.max(wheel.x.abs() + wheel.y.abs() + offset);
            let Mount::Steered(range, _) = *mount else {
                continue;
            };
            is_whole &= wheel.trail == 0.0;
            if range.is_full() || wheel.trail != 0.0 {
                continue;
            }
            let middle = f64::midpoint(range.lower, range.upper);
            let Direction { sin, cos } = Direction::from(wheel.heading + middle);
            let row = |a: f64, b: f64| Vector3::new(a, b, wheel.x * b - wheel.y * a).into();
            wedges.push(Wedge {
                joint: rover.steered().iter().position(|&k| k == i)?,
                along: row(cos, sin),
                across: row(-sin, cos),
                half: Direction::from((range.upper - range.lower) / 2.0),
            });
        }
        Some(Self {
            banks: rover.banks.iter().map(|bank| bank.row.into()).collect(),
            wedges,
            pivots: pivots_apart(rover.wheels()),
            arm,
            size: rover.size,
            is_whole,
        })
    }

    /// Slips that are surely none, and surely one [m/s].
    #[inline(always)]
    fn bounds<S: Simd>(&self, simd: S, [vx, vy, omega]: [Lanes<S>; 3]) -> [Lanes<S>; 2] {
        let splat = |number| Lanes::splat(simd, number);
        let mut least = splat(0.0);
        for [x, y] in self.pivots {
            let (ux, uy) = (vx - omega * splat(y), vy + omega * splat(x));
            least = least.max(ux.abs() + uy.abs());
        }
        let most = vx.abs() + vy.abs() + omega.abs() * splat(self.arm);
        [least * splat(SURE[0] * SLIP_TOLERANCE), most * splat(SURE[1] * SLIP_TOLERANCE)]
    }

    /// Verdict on the twist of each lane.
    #[inline(always)]
    pub fn judge<S: Simd>(&self, simd: S, twist: [Lanes<S>; 3]) -> Verdict<S> {
        let usual = usual(simd, twist);
        let zero = Lanes::splat(simd, 0.0);
        let mut verdict = Verdict { yes: usual, no: zero.below(zero) };
        if self.banks.is_empty() && self.wedges.is_empty() {
            return verdict;
        }
        let bounds = self.bounds(simd, twist);
        for row in &self.banks {
            verdict.note(dot(simd, row, twist).abs(), bounds);
        }
        for wedge in &self.wedges {
            verdict.note(wedge.overshoot(simd, twist), bounds);
        }
        verdict.no = verdict.no & usual;
        verdict
    }

    /// Verdict on the ranges of the given joints: yes if all are within.
    #[inline(always)]
    fn within<S: Simd>(&self, simd: S, twist: [Lanes<S>; 3], joints: &[usize]) -> Verdict<S> {
        let zero = Lanes::splat(simd, 0.0);
        let mut verdict = Verdict { yes: zero.at_most(zero), no: zero.below(zero) };
        let bounds = self.bounds(simd, twist);
        for wedge in &self.wedges {
            if joints.contains(&wedge.joint) {
                verdict.note(wedge.overshoot(simd, twist), bounds);
            }
        }
        verdict
    }

    /// [`Rover::project`] of twists of which `done` are possible already, and where that is sure.
    #[inline(always)]
    pub fn project<S: Simd>(
        &self,
        simd: S,
        faces: &Faces,
        keep: Keep,
        wanted: [Lanes<S>; 3],
    ) -> ([Lanes<S>; 3], Mask<S>) {
        let Verdict { yes, no } = self.judge(simd, wanted);
        if !no.any() {
            return (wanted, yes);
        }
        let (mut found, mut any, mut sure) = self.nearest(simd, faces, keep, wanted, no);
        if keep == Keep::Curvature {
            let rest = no & !any;
            if rest.any() {
                let (nearest, near, safe) = self.nearest(simd, faces, Keep::Nearest, wanted, rest);
                let share = |k: usize| {
                    let (found, wanted) = (nearest[k].abs(), wanted[k].abs());
                    let one = Lanes::splat(simd, 1.0);
                    found.at_most(wanted).select(one, wanted.quotient(found))
                };
                let scale = share(0).min(share(2));
                for k in 0..3 {
                    found[k] = any.select(found[k], nearest[k] * scale);
                }
                sure = sure & (any | safe);
                any = any | near;
            }
        }
        let result = [0, 1, 2].map(|k| yes.select(wanted[k], found[k]));
        (result, yes | (no & any & sure))
    }

    /// The nearest points, where there are any, and where that is sure.
    #[inline(always)]
    fn nearest<S: Simd>(
        &self,
        simd: S,
        faces: &Faces,
        keep: Keep,
        wanted: [Lanes<S>; 3],
        asked: Mask<S>,
    ) -> ([Lanes<S>; 3], Mask<S>, Mask<S>) {
        let splat = |number| Lanes::splat(simd, number);
        let zero = splat(0.0);
        let mut size = zero;
        let mut best = zero;
        for row in &faces.size {
            let part = dot(simd, row, wanted);
            size = size.max(part.abs());
            best = best + part * part;
        }
        let lengths = [splat(1.0), splat(1.0), splat(self.size)];
        let rounding = size * splat(VANISHED);
        // To stand still keeps what is zero.
        let mut any = asked;
        for &k in components(keep) {
            any = any & wanted[k].abs().at_most(zero);
        }
        best = any.select(best, splat(f64::INFINITY));
        let mut found = [zero; 3];
        let mut sure = zero.at_most(zero);
        for face in faces.of(keep) {
            let mut distance = zero;
            for row in &face.miss {
                let part = dot(simd, row, wanted);
                distance = distance + part * part;
            }
            let mut nearer = distance.below(best) & asked;
            if !nearer.any() {
                continue;
            }
            let mut point = point(simd, face, wanted);
            if face.bound {
                for &k in components(keep) {
                    let off = (point[k] - wanted[k]).abs();
                    nearer = nearer & off.at_most(size * splat(AGREED));
                }
            }
            if !face.open.is_empty() {
                for (part, length) in point.iter_mut().zip(lengths) {
                    *part = (part.abs() * length).at_most(rounding).select(zero, *part);
                }
                let Verdict { yes, no } = self.within(simd, point, &face.open);
                sure = sure & (!nearer | yes | no);
                nearer = nearer & yes;
            }
            best = nearer.select(distance, best);
            any = any | nearer;
            for (found, point) in found.iter_mut().zip(point) {
                *found = nearer.select(point, *found);
            }
        }
        let mut vanishes = zero.at_most(zero);
        for (part, length) in found.iter().zip(lengths) {
            vanishes = vanishes & (part.abs() * length).at_most(rounding);
        }
        found = found.map(|part| vanishes.select(zero, part));
        for &k in components(keep) {
            found[k] = wanted[k];
        }
        (found, any, sure)
    }
}

impl<S: Simd> Verdict<S> {
    /// That something slides.
    #[inline(always)]
    fn note(&mut self, slip: Lanes<S>, [none, some]: [Lanes<S>; 2]) {
        self.yes = self.yes & slip.at_most(none);
        self.no = self.no | some.below(slip);
    }
}

impl Wedge {
    /// Side slip of the wheel at the nearer end of its range; negative inside it [m/s].
    #[inline(always)]
    fn overshoot<S: Simd>(&self, simd: S, twist: [Lanes<S>; 3]) -> Lanes<S> {
        let along = dot(simd, &self.along, twist).abs();
        let across = dot(simd, &self.across, twist).abs();
        across * Lanes::splat(simd, self.half.cos) - along * Lanes::splat(simd, self.half.sin)
    }
}

#[inline(always)]
fn point<S: Simd>(simd: S, face: &Face, wanted: [Lanes<S>; 3]) -> [Lanes<S>; 3] {
    let mut point = [Lanes::splat(simd, 0.0); 3];
    for [direction, row] in &face.span {
        let share = dot(simd, row, wanted);
        for (part, along) in point.iter_mut().zip(direction) {
            *part = *part + share * Lanes::splat(simd, *along);
        }
    }
    point
}
