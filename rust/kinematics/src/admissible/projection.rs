//! The nearest twist that a rover can make, in every lane.

use super::cone::{AdmissibleCone, Rates};
use crate::admissible::Keep;
use crate::admissible::check::infeasible;
use crate::admissible::faces::{AGREED, Face, Faces, VANISHED, components};
use crate::geometry::Twist;
use crate::kernels::safe_range::{MIN_SQUARABLE, SCALE};
use six_wheel_numerics::error::{Error, ErrorKind};
use six_wheel_numerics::simd::lanes::{Lanes, Mask};
use six_wheel_numerics::simd::level::{Kernel, Level};
use six_wheel_numerics::simd::vec3::row_times as dot;
use six_wheel_numerics::simd::vector::Vector;

/// A twist in every lane.
type TwistLanes<S> = [Lanes<S>; 3];

/// Constants of a rover for projections.
#[derive(Clone, Copy)]
pub(crate) struct Projection<'a> {
    pub cone: &'a AdmissibleCone,
    pub faces: &'a Faces,
    pub keep: Keep,
    /// Root mean square distance of the pivots from their centre [m].
    pub size: f64,
}

/// Nearest twists of the admissible set.
struct NearestPoint<S: Vector> {
    twist: TwistLanes<S>,
    /// True where there is one.
    is_found: Mask<S>,
}

impl Projection<'_> {
    /// The admissible twist nearest to a twist; an admissible one is unchanged.
    pub fn of(&self, twist: Twist) -> Result<Twist, Error> {
        match Level::Scalar.run_any(ProjectOne { projection: *self, twist: twist.into() }) {
            Some(found) => Ok(found.into()),
            None => Err(self.error(twist)),
        }
    }

    /// The failure of a twist that has no projection.
    #[cold]
    fn error(&self, twist: Twist) -> Error {
        if let Err(error) = self.cone.check_speeds(twist) {
            return error;
        }
        let kept = if self.keep == Keep::Speed { "speed" } else { "yaw rate" };
        let one = ProjectOne { projection: *self, twist: twist.into() };
        if Level::Scalar.run_any(HasPoint(one)) {
            // Squares of very large twists are not finite.
            let rule = "be small enough for a possible twist beside it";
            return infeasible(rule, twist).of_kind(ErrorKind::Value);
        }
        infeasible(format!("have a possible twist of the same {kept} beside it"), twist)
    }

    /// The projection of every lane, and the lanes that have one that is finite.
    #[inline(always)]
    pub fn lanes<S: Vector>(&self, simd: S, desired: TwistLanes<S>) -> (TwistLanes<S>, Mask<S>) {
        let admissibility = self.cone.admissibility(simd, desired, Rates::Row(&[]));
        let is_open = admissibility.is_valid & !admissibility.is_possible;
        if !is_open.any() {
            return (desired, admissibility.is_possible);
        }
        let NearestPoint { twist, is_found } = self.beyond(simd, desired, is_open);
        let largest = Lanes::splat(simd, f64::MAX);
        let mut is_finite = is_found;
        for part in twist {
            is_finite = is_finite & part.abs().le(largest);
        }
        let projected = [0, 1, 2].map(|k: usize| admissibility.is_possible.select(desired[k], twist[k]));
        (projected, admissibility.is_possible | is_finite)
    }

    /// The nearest points of lanes that are not admissible themselves.
    #[inline(always)]
    fn beyond<S: Vector>(&self, simd: S, desired: TwistLanes<S>, is_open: Mask<S>) -> NearestPoint<S> {
        // The projection is in proportion to the twist: tiny twists are scaled, so that their squares keep their
        // digits.
        let [vx, vy, omega] = desired.map(Lanes::abs);
        let is_tiny = (vx + vy + omega).lt(Lanes::splat(simd, MIN_SQUARABLE));
        if !is_tiny.any() {
            return self.nearest_scaled(simd, desired, is_open);
        }
        let factor = |number| is_tiny.select(Lanes::splat(simd, number), Lanes::splat(simd, 1.0));
        let (scale, unscale) = (factor(SCALE[0]), factor(SCALE[1]));
        let NearestPoint { twist, is_found } = self.nearest_scaled(simd, desired.map(|part| part * scale), is_open);
        NearestPoint { twist: twist.map(|part| part * unscale), is_found }
    }

    /// The nearest points of lanes that are not admissible themselves and not tiny.
    #[inline(always)]
    fn nearest_scaled<S: Vector>(&self, simd: S, desired: TwistLanes<S>, is_open: Mask<S>) -> NearestPoint<S> {
        let mut found = self.nearest(simd, self.keep, desired, is_open);
        let rest = is_open & !found.is_found;
        if self.keep != Keep::Curvature || !rest.any() {
            return found;
        }
        // Scaled so that neither the forward speed nor the yaw rate exceeds the desired one.
        let nearest = self.nearest(simd, Keep::Nearest, desired, rest);
        let share = |k: usize| {
            let (found, desired) = (nearest.twist[k].abs(), desired[k].abs());
            let one = Lanes::splat(simd, 1.0);
            found.le(desired).select(one, desired / found)
        };
        let scale = share(0).min(share(2));
        for (part, nearest) in found.twist.iter_mut().zip(nearest.twist) {
            *part = found.is_found.select(*part, nearest * scale);
        }
        found.is_found = found.is_found | nearest.is_found;
        found
    }

    /// The nearest points of the admissible set with the components kept by `keep`, in the lanes of `is_open`.
    #[inline(always)]
    fn nearest<S: Vector>(&self, simd: S, keep: Keep, desired: TwistLanes<S>, is_open: Mask<S>) -> NearestPoint<S> {
        let splat = |number| Lanes::splat(simd, number);
        let zero = splat(0.0);
        let [mut size, mut still] = [zero; 2];
        for row in &self.faces.size {
            let part = dot(simd, row, desired);
            size = size.max(part.abs());
            still = still + part * part;
        }
        // The zero twist is admissible. It counts where the kept components are 0, and as nearest if its distance is
        // finite.
        let mut may_stand = is_open;
        for &k in components(keep) {
            may_stand = may_stand & desired[k].abs().le(zero);
        }
        let (mut best, mut is_found) = (still, may_stand & still.le(splat(f64::MAX)));
        let mut found = [zero; 3];
        for face in self.faces.of(keep) {
            let mut distance = zero;
            for row in &face.distance_rows {
                let part = dot(simd, row, desired);
                distance = distance + part * part;
            }
            let is_nearer = is_open & (!is_found | distance.lt(best));
            if !is_nearer.any() {
                continue;
            }
            let (point, is_admissible) = self.point(simd, face, keep, desired, size);
            let is_nearer = is_nearer & is_admissible;
            best = is_nearer.select(distance, best);
            is_found = is_found | is_nearer;
            for (found, point) in found.iter_mut().zip(point) {
                *found = is_nearer.select(point, *found);
            }
        }
        let mut vanishes = Mask::splat(simd, true);
        for (part, length) in found.iter().zip(self.lengths(simd)) {
            vanishes = vanishes & (part.abs() * length).le(size * splat(VANISHED));
        }
        found = found.map(|part| vanishes.select(zero, part));
        for &k in components(keep) {
            found[k] = desired[k];
        }
        NearestPoint { twist: found, is_found: is_found | may_stand }
    }

    /// The nearest point of a face, and the lanes in which it is admissible and has the kept components.
    #[inline(always)]
    fn point<S: Vector>(
        &self,
        simd: S,
        face: &Face,
        keep: Keep,
        desired: TwistLanes<S>,
        size: Lanes<S>,
    ) -> (TwistLanes<S>, Mask<S>) {
        let zero = Lanes::splat(simd, 0.0);
        let mut point = [zero; 3];
        for [direction, row] in &face.span {
            let share = dot(simd, row, desired);
            for (part, along) in point.iter_mut().zip(direction) {
                *part = *part + share * Lanes::splat(simd, *along);
            }
        }
        let mut is_admissible = Mask::splat(simd, true);
        if face.restricts_kept {
            for &k in components(keep) {
                let off = (point[k] - desired[k]).abs();
                is_admissible = is_admissible & off.le(size * Lanes::splat(simd, AGREED));
            }
        }
        if !face.unchecked_joints.is_empty() {
            // Components that are rounding are 0, so that they do not give the twist a direction.
            for (part, length) in point.iter_mut().zip(self.lengths(simd)) {
                let vanishes = (part.abs() * length).le(size * Lanes::splat(simd, VANISHED));
                *part = vanishes.select(zero, *part);
            }
            is_admissible = is_admissible & self.cone.admissibility_of_joints(simd, point, &face.unchecked_joints);
        }
        (point, is_admissible)
    }

    /// Factors that convert the parts of a twist to speeds [1, 1, m].
    #[inline(always)]
    fn lengths<S: Vector>(&self, simd: S) -> TwistLanes<S> {
        [Lanes::splat(simd, 1.0), Lanes::splat(simd, 1.0), Lanes::splat(simd, self.size)]
    }
}

/// One twist, in every lane.
struct ProjectOne<'a> {
    projection: Projection<'a>,
    twist: [f64; 3],
}

impl Kernel for ProjectOne<'_> {
    type Output = Option<[f64; 3]>;

    #[inline(always)]
    fn run<S: Vector>(self, simd: S) -> Self::Output {
        let desired = self.twist.map(|part| Lanes::splat(simd, part));
        let (found, is_found) = self.projection.lanes(simd, desired);
        is_found.any().then(|| found.map(|part| part.last(simd)))
    }
}

/// True if there is a projection, finite or not.
struct HasPoint<'a>(ProjectOne<'a>);

impl Kernel for HasPoint<'_> {
    type Output = bool;

    #[inline(always)]
    fn run<S: Vector>(self, simd: S) -> bool {
        let desired = self.0.twist.map(|part| Lanes::splat(simd, part));
        self.0.projection.beyond(simd, desired, Mask::splat(simd, true)).is_found.any()
    }
}
