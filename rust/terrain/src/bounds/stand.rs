//! Intervals of all quantities from the ground under the wheels: the closed form of `side` on both sides.
//!
//! Written without closures, which would be compiled as functions without the instructions of the level.

use pulp::Simd;

use super::plan::{BoundStatus, BoundsConstants, COUNT, VisibilityBox};
use super::side::{Lever, Side};
use crate::interval::{Interval, Turned, asin, both, complement, even, inside, minus, sum, times, widest};
use crate::suspension::lanes::all;
use six_wheel_numerics::simd::lanes::{Lanes, Mask};
use six_wheel_numerics::simd::polynomials::sin_cos;

/// Rounds of the contraction of tan(g); the fourth gained less than 1e-3 of the width.
const ROUNDS: usize = 3;

/// tan(30 degrees): the initial interval of the contraction of tan(g), to either side.
const STEEPEST: f64 = 0.577_350_269_189_625_8;

/// The ground under the body, less the mean of that under the wheels, and that mean [m].
#[derive(Clone, Copy)]
pub(super) struct Under<S: Simd> {
    pub mean: Lanes<S>,
    /// Highest under the belly, lowest under its middle.
    pub summit: Lanes<S>,
    pub floor: Lanes<S>,
}

/// Intervals of all quantities.
pub(super) type Intervals<S> = [Interval<S>; COUNT];

/// Intervals of one side: the height of its rocker axis and both its angles.
#[derive(Clone, Copy)]
struct Raised<S: Simd> {
    /// Height of D, less the share of lateral positions [m].
    axis: Interval<S>,
    /// Sines `sin(phi - t)` of the bogie and of the rocker.
    bogie: Interval<S>,
    rocker: Interval<S>,
    /// Heights of B at the least and the largest angle of the bogie [m].
    turned: Interval<S>,
    /// True if all extremes are at corners.
    solvable: Mask<S>,
}

impl Lever {
    /// Height of the axis under a support at this height, `sin` the sine of phi - t.
    #[inline(always)]
    fn below<S: Simd>(&self, support: Lanes<S>, sin: Lanes<S>) -> Lanes<S> {
        let simd = sin.simd();
        support - (all(simd, self.off) * complement(sin) + all(simd, self.along) * sin)
    }
}

#[inline_always]
impl Side {
    /// Sine of phi - t of the rocker, from the heights of its wheel and of the bogie's axis.
    fn tilt<S: Simd>(&self, wheel: Lanes<S>, joint: Lanes<S>) -> Lanes<S> {
        let rise = if self.in_front { joint - wheel } else { wheel - joint };
        rise * all(wheel.simd(), self.rocker.inverse_length)
    }

    /// From the reduced heights of the rocker's wheel and of the bogie's, ahead and behind.
    fn raise<S: Simd>(&self, [single, ahead, behind]: [Interval<S>; 3]) -> Raised<S> {
        let by_bogie = all(single[0].simd(), self.bogie.inverse_length);
        let bogie = [(ahead[0] - behind[1]) * by_bogie, (ahead[1] - behind[0]) * by_bogie];
        let joint = both!(k, self.bogie.below(ahead[k], (ahead[k] - behind[k]) * by_bogie));
        let opposed = both!(k, self.tilt(single[k], joint[1 - k]));
        let rocker = if self.in_front { [opposed[1], opposed[0]] } else { opposed };
        Raised {
            axis: both!(k, self.rocker.below(single[k], self.tilt(single[k], joint[k]))),
            bogie,
            rocker,
            turned: both!(k, self.bogie.below(ahead[1 - k], bogie[1 - k])),
            solvable: inside(bogie, self.bogie.range) & inside(rocker, self.rocker.range),
        }
    }

    /// Angles of the rocker against the plane, and of the bogie against the rocker.
    fn angles<S: Simd>(&self, raised: &Raised<S>, single: Interval<S>) -> [Interval<S>; 2] {
        let simd = single[0].simd();
        let (phi_bogie, phi_rocker) = (all(simd, self.bogie.phi), all(simd, self.rocker.phi));
        let rocker = both!(k, phi_rocker - asin(raised.rocker[1 - k]));
        let bogie = both!(k, phi_bogie - asin(raised.bogie[1 - k]));
        if !self.coupled {
            return [rocker, both!(k, bogie[k] - rocker[1 - k])];
        }
        // Least at the least angle of the bogie and the largest angle of the rocker by its wheel.
        let wheel = if self.in_front { [single[1], single[0]] } else { single };
        [rocker, both!(k, bogie[k] - (phi_rocker - asin(self.tilt(wheel[k], raised.turned[k]))))]
    }
}

#[inline_always]
impl BoundsConstants {
    /// Reduced heights of the wheels of a side at inclinations in an interval: the rocker's, and the bogie's ahead
    /// and behind.
    fn reduced<S: Simd>(
        &self,
        wheels: &[Interval<S>; 3],
        rise: Interval<S>,
        inverse_cos: Interval<S>,
    ) -> [Interval<S>; 3] {
        let simd = rise[0].simd();
        let mut reduced = [rise; 3];
        for (reduced, &pair) in reduced.iter_mut().zip(&self.roles) {
            let scaled = times(wheels[pair], inverse_cos);
            let (offset, radius) = (all(simd, self.offsets[pair]), all(simd, self.radius));
            *reduced = both!(k, rise[k].mul_add(offset, scaled[k] + radius));
        }
        reduced
    }

    /// Both sides at inclinations in an interval.
    fn sides<S: Simd>(&self, wheels: &[[Interval<S>; 3]; 2], tan: Interval<S>) -> [[Interval<S>; 3]; 2] {
        let one = all(tan[0].simd(), 1.0);
        let inverse_cos = even(tan, both!(k, tan[k].mul_add(tan[k], one).sqrt()), one);
        [self.reduced(&wheels[0], minus(tan), inverse_cos), self.reduced(&wheels[1], tan, inverse_cos)]
    }

    /// The interval of tan(g), by contraction of `tan(g) = (E_left - E_right) / (2 y)`, and the lanes in which it is
    /// proved.
    fn inclination<S: Simd>(&self, simd: S, wheels: &[[Interval<S>; 3]; 2]) -> (Interval<S>, Mask<S>) {
        let (zero, one) = (all(simd, 0.0), all(simd, 1.0));
        let mut tan = [all(simd, -STEEPEST), all(simd, STEEPEST)];
        let mut proved = zero.le(one);
        let per_width = all(simd, 0.5 / self.lateral);
        for _ in 0..ROUNDS {
            let [left, right] = self.sides(wheels, tan);
            let (left, right) = (self.side.raise(left), self.side.raise(right));
            let narrower = [
                tan[0].max((left.axis[0] - right.axis[1]) * per_width),
                tan[1].min((left.axis[1] - right.axis[0]) * per_width),
            ];
            let solvable = left.solvable & right.solvable;
            let held = narrower[0].le(narrower[1]);
            // If no inclination of up to 30 degrees has these heights, a steeper one may have them.
            proved = proved & (held | !solvable);
            let take = solvable & held;
            tan = both!(k, take.select(narrower[k], tan[k]));
        }
        (tan, proved)
    }

    /// Intervals of all quantities, and the conditions under which they are bounds.
    pub(super) fn stand<S: Simd>(
        &self,
        simd: S,
        wheels: &[[Interval<S>; 3]; 2],
        under: Under<S>,
    ) -> (Intervals<S>, [(Mask<S>, BoundStatus); 3]) {
        let (one, half) = (all(simd, 1.0), all(simd, 0.5));
        let (tan, mut proved) = self.inclination(simd, wheels);
        let [left, right] = self.sides(wheels, tan);
        let (raised_left, raised_right) = (self.side.raise(left), self.side.raise(right));
        proved = proved & raised_left.solvable & raised_right.solvable;
        let [left, bogie_left] = self.side.angles(&raised_left, left[0]);
        let [right, bogie_right] = self.side.angles(&raised_right, right[0]);

        let inverse = both!(k, one / tan[k].mul_add(tan[k], one).sqrt());
        let sin_side = both!(k, tan[k] * inverse[k]);
        let slack = all(simd, self.slack);
        let lean = [(left[0] + right[0]) * half - slack, (left[1] + right[1]) * half + slack];
        let rocker = [(left[0] - right[1]) * half - slack, (left[1] - right[0]) * half + slack];
        let (axes, ends) = (sum(raised_left.axis, raised_right.axis), both!(k, sin_cos(simd, lean[k])));
        let posture = Posture {
            axis: both!(k, axes[k] * half),
            sin_lean: both!(k, ends[k].0),
            cos_lean: even(lean, both!(k, ends[k].1), one),
            cos_side: even(tan, inverse, one),
        };
        let (sin_pitch, sin_roll, tilt) = posture.attitude(simd, sin_side);
        let z = sum(self.point(&posture, 0.0, 0.0), [under.mean; 2]);
        let clearance = self.clearance(&posture, widest(sin_side), under);
        let (roll, pitch) = (both!(k, asin(sin_roll[k])), both!(k, asin(sin_pitch[k])));
        let turned = self.turned(rocker, [bogie_left, bogie_right]);
        let drop = self.drop(&turned);
        let angle = [-self.within.attitude, self.within.attitude];
        let swing = [-self.within.bogie, self.within.bogie];
        let boxed = self.boxed(&turned, widest(sin_pitch), widest(sin_roll))
            | inside(roll, angle)
                & inside(pitch, angle)
                & inside(rocker, [-self.within.rocker, self.within.rocker])
                & inside(bogie_left, swing)
                & inside(bogie_right, swing);
        let free = inside(rocker, self.rocker_limit)
            & inside(bogie_left, self.bogie_limit)
            & inside(bogie_right, self.bogie_limit);
        (
            [z, roll, pitch, tilt, clearance, rocker, bogie_left, bogie_right, drop],
            [(proved, BoundStatus::Unsolved), (boxed, BoundStatus::Beyond), (free, BoundStatus::AtStop)],
        )
    }

    /// Height of a point of the middle plane of the body.
    fn point<S: Simd>(&self, posture: &Posture<S>, x: f64, z: f64) -> Interval<S> {
        let simd = posture.axis[0].simd();
        // From the axis of the rockers.
        let (behind, below) = (all(simd, self.pivot[0] - x), all(simd, self.pivot[2] - z));
        let swings = both!(k, posture.sin_lean[k] * behind);
        let drops = both!(k, posture.cos_lean[k] * below);
        let height = [
            posture.axis[0] + swings[0].min(swings[1]) - drops[0].max(drops[1]),
            posture.axis[1] + swings[0].max(swings[1]) - drops[0].min(drops[1]),
        ];
        times(height, posture.cos_side)
    }

    /// From the lowest corner of the belly to the highest ground under it, and from its middle, at its highest, to
    /// the lowest ground there.
    fn clearance<S: Simd>(&self, posture: &Posture<S>, sin_side: Lanes<S>, under: Under<S>) -> Interval<S> {
        let simd = sin_side.simd();
        let plate = self.plate;
        let rear = self.point(posture, plate.x[0], plate.z);
        let front = self.point(posture, plate.x[1], plate.z);
        let middle = self.point(posture, (plate.x[0] + plate.x[1]) / 2.0, plate.z);
        let lowest = rear[0].min(front[0]) - all(simd, plate.half_width) * sin_side;
        [lowest - under.summit, middle[1] - under.floor]
    }

    /// Sines and cosines of the ends of the rockers' and the bogies' angles in the body, left and right.
    fn turned<S: Simd>(&self, rocker: Interval<S>, bogies: [Interval<S>; 2]) -> [[Turned<S>; 2]; 2] {
        let simd = rocker[0].simd();
        let slack = all(simd, 2.0 * self.slack);
        let left = both!(k, sin_cos(simd, rocker[k]));
        // With a differential bar the right rocker does not turn back by exactly the angle of the left one: `slack`, which
        // matters for the bogie it carries only.
        let right = [(-left[1].0, left[1].1), (-left[0].0, left[0].1)];
        let loose = [-slack, slack];
        let on_left = sum(sum(rocker, bogies[0]), loose);
        let on_right = sum(sum(minus(rocker), bogies[1]), loose);
        [[left, both!(k, sin_cos(simd, on_left[k]))], [right, both!(k, sin_cos(simd, on_right[k]))]]
    }

    /// Decrease of the height of the end of a vector of `vectors` from the level position [m].
    fn fall<S: Simd>(&self, k: usize, ends: &Turned<S>) -> Interval<S> {
        let simd = ends[0].0.simd();
        let [x, _, z] = self.vectors[k];
        let (x, z, sag) = (all(simd, x), all(simd, z), all(simd, self.sag[k]));
        let falls = both!(k, z - (z * ends[k].1 - x * ends[k].0));
        [falls[0].min(falls[1]) - sag, falls[0].max(falls[1]) + sag]
    }

    /// Largest distance, in the body, of a wheel below its place on level ground [m].
    fn drop<S: Simd>(&self, turned: &[[Turned<S>; 2]; 2]) -> Interval<S> {
        let simd = turned[0][0][0].0.simd();
        let mut most = [all(simd, f64::NEG_INFINITY); 2];
        for [rocker, carried] in turned {
            let joint = self.fall(1, rocker);
            let falls = [self.fall(0, rocker), sum(joint, self.fall(2, carried)), sum(joint, self.fall(3, carried))];
            for fall in falls {
                most = [most[0].max(fall[0]), most[1].max(fall[1])];
            }
        }
        let loose = all(simd, self.looseness);
        [most[0] - loose, most[1] + loose]
    }

    /// Largest displacements of the end of a vector of `vectors`, along and across [m].
    fn displacement<S: Simd>(&self, k: usize, ends: &Turned<S>) -> Interval<S> {
        let simd = ends[0].0.simd();
        let [x, _, z] = self.vectors[k];
        let (x, z) = (all(simd, x.abs()), all(simd, z.abs()));
        let sin = ends[0].0.abs().max(ends[1].0.abs());
        let less = all(simd, 1.0) - ends[0].1.min(ends[1].1);
        [z * sin + x * less, x * sin + z * less]
    }

    /// True if every wheel and the belly, seen from above, are in the boxes of ground that were searched.
    ///
    /// As all heights increase from 0 to those of the map, the settled pose changes continuously from the level one, in
    /// which all wheels are in their boxes. The bounds hold while the wheels are in the boxes, and imply that they are
    /// strictly inside; so no wheel can leave its box.
    fn boxed<S: Simd>(&self, turned: &[[Turned<S>; 2]; 2], pitch: Lanes<S>, roll: Lanes<S>) -> Mask<S> {
        let simd = pitch.simd();
        let still = [all(simd, 0.0); 2];
        let mut fits = self.rooms[3].holds(still, pitch, roll);
        for [rocker, carried] in turned {
            let joint = self.displacement(1, rocker);
            let moved = [
                self.displacement(0, rocker),
                sum(joint, self.displacement(2, carried)),
                sum(joint, self.displacement(3, carried)),
            ];
            for (moved, &pair) in moved.into_iter().zip(&self.roles) {
                fits = fits & self.rooms[pair].holds(moved, pitch, roll);
            }
        }
        fits
    }
}

impl VisibilityBox {
    /// True if a part that is displaced by `moved` (forward, up) in the body is inside the box seen from above, at
    /// attitudes with up to these sines of pitch and roll.
    #[inline(always)]
    fn holds<S: Simd>(&self, moved: [Lanes<S>; 2], pitch: Lanes<S>, roll: Lanes<S>) -> Mask<S> {
        let simd = pitch.simd();
        let [x, y, z] = self.place;
        let (x, y, height) = (all(simd, x), all(simd, y), all(simd, z) + moved[1]);
        let one = all(simd, 1.0);
        let (sunk, leaned) = (one - complement(pitch), one - complement(roll));
        let ahead = moved[0] + x * sunk + pitch * (y * roll + height);
        let aside = y * leaned + (height + all(simd, self.radius)) * roll;
        ahead.le(all(simd, self.room[0])) & aside.le(all(simd, self.room[1]))
    }
}

/// Height of the rockers' axis and inclination of the body.
struct Posture<S: Simd> {
    /// Height of the axis of the rockers, in the plane [m].
    axis: Interval<S>,
    sin_lean: Interval<S>,
    cos_lean: Interval<S>,
    cos_side: Interval<S>,
}

impl<S: Simd> Posture<S> {
    /// Sines of pitch and roll, and the tilt [rad].
    #[inline(always)]
    fn attitude(&self, simd: S, sin_side: Interval<S>) -> (Interval<S>, Interval<S>, Interval<S>) {
        let (zero, one) = (all(simd, 0.0), all(simd, 1.0));
        let sin_pitch = times(self.sin_lean, self.cos_side);
        let secants = both!(k, one / complement(sin_pitch[k]).max(all(simd, 0.03)));
        let sin_roll = times(sin_side, even(sin_pitch, secants, one));
        let a = even(sin_side, both!(k, sin_side[k] * sin_side[k]), zero);
        let b = even(self.sin_lean, both!(k, self.sin_lean[k] * self.sin_lean[k]), zero);
        // 1 - cos(tilt)^2, cos(tilt) = cos(g) cos(lean).
        let tilt = both!(k, asin((one - a[k]).mul_add(b[k], a[k]).sqrt()));
        (sin_pitch, sin_roll, tilt)
    }
}
