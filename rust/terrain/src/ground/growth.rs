//! Settling where Newton's method does not converge: continuation from level ground to the ground of the map.
//!
//! All heights above a datum are multiplied by a factor `s`. At `s = 0` the ground is flat and the rover stands on it; at `s = 1`
//! it is the ground of the map. The states that close all gaps, as `s` changes, are a curve in (state, s), which may turn back
//! and go on; it is followed by its arc length. Where it reaches `s = 1`, at angles at which a rover can stand, the state there
//! is the answer. Where it leaves these angles and does not come back, the growing ground tips the rover or a bogie over.
//!
//! The gap of a rim over ground scaled by `s` is `s` times the gap of a rim at `1 / s` times the height over the map itself.
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

/// Factor of the heights at which the curve begins: so small that Newton's method converges.
const FIRST: f64 = 0.1;

/// A curve that returns to the factor `BACK`, or exceeds `FORTH`, is given up.
const BACK: f64 = 0.02;
const FORTH: f64 = 2.0;

/// Steps along the curve: the longest, the first, the shortest one, and their largest number.
const LONGEST: f64 = 0.1;
const FIRST_STEP: f64 = 0.02;
const SHORTEST: f64 = 2e-5;
const STEPS: usize = 1500;

/// A body tilted by more than this has tipped over for good [rad]; a joint has when it has turned by half a turn.
const UPRIGHT: f64 = 1.5;

/// Turns of Newton's method back to the curve, and the gap at which it is there [m].
const TURNS: usize = 8;
const THERE: f64 = 1e-9;

/// Cosine of how far the curve may turn in a step, but for steps shorter than this: at a corner it turns at once.
const BEND: f64 = 0.7;
const AROUND: f64 = 2e-3;

/// Gaps of the wheels, and their derivatives by the state and the share.
struct GapJacobian {
    gaps: SVector<f64, SIZE>,
    slopes: SMatrix<f64, SIZE, SIZE>,
}

/// The ground of a pose, of any share.
struct Homotopy<'a> {
    pose: OnePose<'a>,
    order: PivotOrder,
    /// Numbers of the state.
    count: usize,
    /// Heights are from here [m].
    datum: f64,
}

impl Settler<'_> {
    /// Settles the chain with no joint at a stop, by scaling the heights from flat ground to the map; or the status of
    /// a failure.
    pub(crate) fn grown(&self, pose: &OnePose<'_>) -> Result<NewtonResult, Status> {
        let at = pose.plan_pose();
        let Sample::Known { height: datum, .. } = self.ground.sample_offset(at.x, at.y, Interpolation::Bilinear) else {
            return Err(Status::NotConverged);
        };
        let order = PivotOrder::new(self.chain, &ActiveSet::NONE);
        Homotopy { pose: *pose, order, count: self.chain.state_count(), datum }.followed()
    }
}

impl Homotopy<'_> {
    /// Gaps and slopes at a point. None where the differential does not reach or no ground is known.
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
            // As high as the ground is there, less.
            jacobian.slopes[(wheel, MAX_STATE)] = (gap - (here.heights[wheel] - self.datum)) / share;
        }
        Some(jacobian)
    }

    /// Back to the curve, across a direction. None where Newton's method does not lead there.
    fn back(&self, mut point: Point, across: &Point) -> Option<(Point, GapJacobian)> {
        let mut worst = f64::INFINITY;
        for _ in 0..TURNS {
            let mut look = self.jacobian(&point)?;
            let gap = look.gaps.amax();
            if gap <= THERE {
                return Some((point, look));
            }
            if gap > worst {
                return None;
            }
            worst = gap;
            look.slopes.set_row(MAX_STATE, &across.transpose());
            point -= look.slopes.lu().solve(&look.gaps)?;
        }
        None
    }

    /// The direction of the curve: that in which state, share and gaps turn as they do where it begins.
    ///
    /// At a corner, where a wheel gets another contact or goes over a crease, the curve may turn back by more than a right angle,
    /// so that the way it came does not say which way it goes on. The determinant does: its sign is kept where a row of slopes
    /// is exchanged for that of the other contact, whose gap has to get smaller than that of the one before.
    fn along(look: &GapJacobian, turns: f64) -> Option<Point> {
        // Orthogonal to the slopes of all gaps.
        let q = look.slopes.transpose().qr().q();
        let mut direction: Point = q.column(MAX_STATE).into_owned();
        let mut slopes = look.slopes;
        slopes.set_row(MAX_STATE, &direction.transpose());
        let determinant = slopes.determinant();
        if determinant * turns < 0.0 {
            direction.neg_mut();
        }
        (determinant != 0.0 && direction.norm().is_finite()).then_some(direction)
    }

    /// The next point of the curve, so far away, and its direction there. A short step goes around a corner.
    fn next(&self, point: &Point, direction: &Point, step: f64, turns: f64) -> Option<[Point; 2]> {
        let reach = |direction: &Point| {
            let (next, look) = self.back(point + direction * step, direction)?;
            let turned = Self::along(&look, turns)?;
            let near = (next - point).norm() < 2.0 * step;
            let smooth = turned.dot(direction) > BEND;
            (near && (smooth || step < AROUND)).then_some([next, turned])
        };
        reach(direction).or_else(|| {
            let around = (step < AROUND).then(|| self.jacobian(&(point + direction * step)))??;
            reach(&Self::along(&around, turns)?)
        })
    }

    fn followed(&self) -> Result<NewtonResult, Status> {
        let mut lost = Status::NotConverged;
        let share_alone = Point::ith(MAX_STATE, 1.0);
        let (mut point, look) = self.begin(&share_alone).ok_or(lost)?;
        // The factor grows at first.
        let turns = look.slopes.determinant().signum();
        let mut direction = Self::along(&look, turns).ok_or(lost)?;
        let mut step = FIRST_STEP;
        for _ in 0..STEPS {
            let Some([next, turned]) = self.next(&point, &direction, step, turns) else {
                step *= 0.5;
                if step < SHORTEST {
                    return Err(lost);
                }
                continue;
            };
            let crosses = (point[MAX_STATE] < 1.0) != (next[MAX_STATE] < 1.0);
            if crosses && let Some(attempt) = self.arrived(&point, &next) {
                return Ok(attempt);
            }
            if (1..MAX_STATE).any(|k| next[k].abs() > LARGEST_ANGLE) {
                // Not the end: the curve may come back to angles at which a rover stands.
                lost = Status::TipsOver;
            }
            let over = (1..3).any(|k| next[k].abs() > UPRIGHT) || (3..MAX_STATE).any(|k| next[k].abs() > PI);
            if over || !(BACK..FORTH).contains(&next[MAX_STATE]) {
                return Err(lost);
            }
            (point, direction) = (next, turned);
            step = (1.5 * step).min(LONGEST);
        }
        Err(lost)
    }

    /// On nearly flat ground.
    fn begin(&self, share_alone: &Point) -> Option<(Point, GapJacobian)> {
        let mut point = Point::zeros();
        point[0] = self.datum;
        point[MAX_STATE] = FIRST;
        let look = self.jacobian(&point)?;
        let wheels = self.count as f64;
        point[0] -= look.gaps.sum() / wheels;
        self.back(point, share_alone)
    }

    /// The end of the curve, between two points of it.
    fn arrived(&self, before: &Point, after: &Point) -> Option<NewtonResult> {
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
