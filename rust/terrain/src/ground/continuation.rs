//! Settling where Newton's method does not converge: continuation from level ground to the ground of the map.
//!
//! All heights above a datum are multiplied by a factor `s`. At `s = 0` the ground is flat and the rover stands on it;
//! at `s = 1` it is the ground of the map. The states that close all gaps, as `s` changes, are a curve in (state, s),
//! along which s may also decrease; it is followed by its arc length. The settled state is the point at `s = 1` at
//! angles at which a rover can stand. If the curve leaves these angles and does not return, the increasing heights tip
//! the rover or a bogie over.
//!
//! The gap of a rim over ground scaled by `s` is `s` times the gap of a rim at `1 / s` times the height over the map
//! itself.
//!
//! (E. Allgower, K. Georg, Introduction to Numerical Continuation Methods, SIAM 2003, ch. 2 and 6.)

use std::f64::consts::PI;

use nalgebra::{SMatrix, SVector};

use super::active_set::ActiveSet;
use super::newton::{LARGEST_ANGLE, NewtonResult, OnePose};
use super::pivots::PivotOrder;
use super::rims::contact::RimSegment;
use super::settler::{Settler, Status};
use crate::suspension::{MAX_STATE, State};
use crate::terrain::{Interpolation, Sample};

/// Numbers of a state, and the factor of the heights.
const SIZE: usize = MAX_STATE + 1;

type Point = SVector<f64, SIZE>;

/// Factor of the heights at the start of the curve: so small that Newton's method converges.
const FIRST: f64 = 0.1;

/// Range of the factor; a curve that leaves it is abandoned.
const MIN_FACTOR: f64 = 0.02;
const MAX_FACTOR: f64 = 2.0;

/// Steps along the curve: the longest, the first, the shortest one, and their largest number.
const LONGEST: f64 = 0.1;
const FIRST_STEP: f64 = 0.02;
const SHORTEST: f64 = 2e-5;
const STEPS: usize = 1500;

/// Roll or pitch beyond which the curve is abandoned [rad]; for a joint it is half a turn.
const UPRIGHT: f64 = 1.5;

/// Largest number of Newton steps of a correction to the curve, and the largest gap on it [m].
const CORRECTIONS: usize = 8;
const ON_CURVE: f64 = 1e-9;

/// Least cosine of the angle between the tangents of successive points, except for steps shorter than `CORNER_STEP`: at
/// a corner the tangent is discontinuous.
const MIN_COSINE: f64 = 0.7;
const CORNER_STEP: f64 = 2e-3;

/// Gaps of the wheels [m], and their derivatives by the state and the factor.
struct GapJacobian {
    gaps: SVector<f64, SIZE>,
    slopes: SMatrix<f64, SIZE, SIZE>,
}

/// The gaps of a pose over ground with any factor of its heights.
struct Homotopy<'a> {
    pose: OnePose<'a>,
    order: PivotOrder,
    /// Numbers of the state.
    count: usize,
    /// Datum of the heights [m].
    datum: f64,
}

impl Settler<'_> {
    /// Settles the chain with no joint at a stop, by scaling the heights from flat ground to the map; or the status of
    /// a failure.
    pub(crate) fn settle_by_continuation(&self, pose: &OnePose<'_>) -> Result<NewtonResult, Status> {
        let at = pose.plan_pose();
        let Sample::Known { height: datum, .. } = self.ground.sample_offset(at.x, at.y, Interpolation::Bilinear) else {
            return Err(Status::NotConverged);
        };
        let order = PivotOrder::new(self.chain, &ActiveSet::NONE);
        Homotopy { pose: *pose, order, count: self.chain.state_count(), datum }.follow_curve()
    }
}

impl Homotopy<'_> {
    /// Gaps and slopes at a point. None where the differential has no solution or no ground is known.
    fn jacobian(&self, point: &Point) -> Option<GapJacobian> {
        let share = point[MAX_STATE];
        let state: State = std::array::from_fn(|k| point[k]);
        let pose = self.pose.over([share, self.datum]);
        let here = pose.evaluate(state, &self.order, RimSegment::Lower)?;
        let mut jacobian = GapJacobian { gaps: SVector::zeros(), slopes: SMatrix::identity() };
        for wheel in 0..self.count {
            let gap = here.gaps[wheel];
            if gap.is_nan() {
                return None;
            }
            jacobian.gaps[wheel] = gap;
            for (k, slope) in here.slopes[wheel].into_iter().enumerate().take(self.count) {
                jacobian.slopes[(wheel, k)] = slope;
            }
            // d gap / d s = -(height of the ground above the datum), which is (height of the rim - gap - datum) / s.
            jacobian.slopes[(wheel, MAX_STATE)] = (gap - (here.heights[wheel] - self.datum)) / share;
        }
        Some(jacobian)
    }

    /// Corrects a point to the curve by Newton's method, orthogonally to a direction. None where that does not
    /// converge.
    fn correct(&self, mut point: Point, direction: &Point) -> Option<(Point, GapJacobian)> {
        let mut worst = f64::INFINITY;
        for _ in 0..CORRECTIONS {
            let mut jacobian = self.jacobian(&point)?;
            let gap = jacobian.gaps.amax();
            if gap <= ON_CURVE {
                return Some((point, jacobian));
            }
            if gap > worst {
                return None;
            }
            worst = gap;
            jacobian.slopes.set_row(MAX_STATE, &direction.transpose());
            point -= jacobian.slopes.lu().solve(&jacobian.gaps)?;
        }
        None
    }

    /// The unit tangent of the curve, oriented so that the determinant of the slopes with the tangent as last row has
    /// the sign `orientation`, that at the start.
    ///
    /// At a corner, where a wheel changes its contact or passes a crease, the tangent may change by more than a right
    /// angle, so that the last tangent does not give the orientation. The determinant does: its sign is the same after
    /// a row of slopes is replaced by that of the other contact, whose gap becomes the lesser one.
    fn tangent(jacobian: &GapJacobian, orientation: f64) -> Option<Point> {
        // Orthogonal to the slopes of all gaps.
        let q = jacobian.slopes.transpose().qr().q();
        let mut direction: Point = q.column(MAX_STATE).into_owned();
        let mut slopes = jacobian.slopes;
        slopes.set_row(MAX_STATE, &direction.transpose());
        let determinant = slopes.determinant();
        if determinant * orientation < 0.0 {
            direction.neg_mut();
        }
        (determinant != 0.0 && direction.norm().is_finite()).then_some(direction)
    }

    /// The next point of the curve after a step of this length, and the tangent there. A short step may pass a corner.
    fn next(&self, point: &Point, direction: &Point, step: f64, orientation: f64) -> Option<[Point; 2]> {
        let predict_and_correct = |direction: &Point| {
            let (next, jacobian) = self.correct(point + direction * step, direction)?;
            let tangent = Self::tangent(&jacobian, orientation)?;
            let near = (next - point).norm() < 2.0 * step;
            let smooth = tangent.dot(direction) > MIN_COSINE;
            (near && (smooth || step < CORNER_STEP)).then_some([next, tangent])
        };
        predict_and_correct(direction).or_else(|| {
            let beyond = (step < CORNER_STEP).then(|| self.jacobian(&(point + direction * step)))??;
            predict_and_correct(&Self::tangent(&beyond, orientation)?)
        })
    }

    /// Follows the curve from nearly flat ground to the ground of the map.
    fn follow_curve(&self) -> Result<NewtonResult, Status> {
        let mut failure = Status::NotConverged;
        let by_factor = Point::ith(MAX_STATE, 1.0);
        let (mut point, jacobian) = self.first_point(&by_factor).ok_or(failure)?;
        // The factor increases at first.
        let orientation = jacobian.slopes.determinant().signum();
        let mut direction = Self::tangent(&jacobian, orientation).ok_or(failure)?;
        let mut step = FIRST_STEP;
        for _ in 0..STEPS {
            let Some([next, tangent]) = self.next(&point, &direction, step, orientation) else {
                step *= 0.5;
                if step < SHORTEST {
                    return Err(failure);
                }
                continue;
            };
            let crosses = (point[MAX_STATE] < 1.0) != (next[MAX_STATE] < 1.0);
            if crosses && let Some(attempt) = self.settle_between(&point, &next) {
                return Ok(attempt);
            }
            if (1..MAX_STATE).any(|k| next[k].abs() > LARGEST_ANGLE) {
                // The curve may return to angles at which a rover can stand.
                failure = Status::TipsOver;
            }
            let over = (1..3).any(|k| next[k].abs() > UPRIGHT) || (3..MAX_STATE).any(|k| next[k].abs() > PI);
            if over || !(MIN_FACTOR..MAX_FACTOR).contains(&next[MAX_STATE]) {
                return Err(failure);
            }
            (point, direction) = (next, tangent);
            step = (1.5 * step).min(LONGEST);
        }
        Err(failure)
    }

    /// The first point of the curve, on nearly flat ground.
    fn first_point(&self, by_factor: &Point) -> Option<(Point, GapJacobian)> {
        let mut point = Point::zeros();
        point[0] = self.datum;
        point[MAX_STATE] = FIRST;
        let jacobian = self.jacobian(&point)?;
        let wheels = self.count as f64;
        point[0] -= jacobian.gaps.sum() / wheels;
        self.correct(point, by_factor)
    }

    /// Settles the pose on the ground of the map from two points of the curve with factors on both sides of 1.
    fn settle_between(&self, before: &Point, after: &Point) -> Option<NewtonResult> {
        let share = (1.0 - before[MAX_STATE]) / (after[MAX_STATE] - before[MAX_STATE]);
        let between = before.lerp(after, share);
        [between, *before, *after].iter().find_map(|point| {
            let state: State = std::array::from_fn(|k| point[k]);
            let attempt = self.pose.close(state, &ActiveSet::NONE);
            let upright = |state: &State| state[1..].iter().all(|angle| angle.abs() < LARGEST_ANGLE);
            attempt.filter(|attempt| attempt.closed && upright(&attempt.state))
        })
    }
}
