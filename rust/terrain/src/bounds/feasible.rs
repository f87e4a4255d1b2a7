//! Feasibility of poses: by bounds if they are sufficient, otherwise by settling.

use super::belly::Belly;
use super::boxes::TiltLimits;
use super::kernel::{Ground, Margins, bounds};
use super::plan::{BoundStatus, BoundsConstants, COUNT};
use super::stability::{tilt, wheel_drop};
use crate::ground::{Settler, Stand, Status, settle_part};
use crate::suspension::{Dimensions, MAX_WHEELS};
use six_wheel_numerics::error::{Error, number};
use six_wheel_numerics::simd::level::Level;
use six_wheel_numerics::threads::workers::Workers;

/// Limits of an admissible pose: largest absolute angles [rad], least clearance and largest drop of a wheel [m].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Allowed {
    /// Largest roll.
    pub roll: f64,
    /// Largest pitch.
    pub pitch: f64,
    /// Largest tilt.
    pub tilt: f64,
    /// Largest angle of a rocker.
    pub rocker: f64,
    /// Largest angle of a bogie.
    pub bogie: f64,
    /// Least clearance of the belly [m].
    pub clearance: f64,
    /// Largest drop of a wheel [m].
    pub wheel_drop: f64,
}

impl Allowed {
    /// Fails unless angles and the drop are positive, and nothing is NaN.
    pub fn check(&self) -> Result<(), Error> {
        let positive = [
            ("roll", self.roll),
            ("pitch", self.pitch),
            ("tilt", self.tilt),
            ("rocker", self.rocker),
            ("bogie", self.bogie),
            ("wheel_drop", self.wheel_drop),
        ];
        for (name, value) in positive {
            if value.is_nan() || value <= 0.0 {
                return Err(Error::value(name, "be positive", number(value)));
            }
        }
        if !self.clearance.is_finite() {
            return Err(Error::value("clearance", "be finite", number(self.clearance)));
        }
        Ok(())
    }

    /// Angles at which the boxes of the bounds have to hold the wheels.
    fn within(&self) -> TiltLimits {
        let TiltLimits { attitude, rocker, bogie } = TiltLimits::wide();
        TiltLimits {
            attitude: attitude.min(self.roll.max(self.pitch).min(self.tilt)),
            rocker: rocker.min(self.rocker),
            bogie: bogie.min(self.bogie),
        }
    }
}

/// Reason for which a pose is not admissible.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Reason {
    /// The pose is admissible.
    Ok = 0,
    /// Roll exceeds its limit and has the smallest margin; see [`Verdict::margin`].
    Roll = 1,
    /// The same for pitch.
    Pitch = 2,
    /// The same for the tilt.
    Tilt = 3,
    /// The same for the clearance of the belly.
    Clearance = 4,
    /// The same for the angle of a rocker.
    Rocker = 5,
    /// The same for the angle of a bogie.
    Bogie = 6,
    /// The same for the drop of a wheel.
    WheelDrop = 7,
    /// A rim or the belly may leave the map.
    OffMap = 8,
    /// A rim or the belly may be over unknown ground.
    UnknownCells = 9,
    /// The rover does not settle.
    NotSettled = 10,
}

/// The feasibility of a pose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Verdict {
    /// Reason for a refusal, or [`Reason::Ok`].
    pub reason: Reason,
    /// Smallest margin over all limits: as a share of the limit for angles and the drop, in wheel radii for clearances.
    /// By bounds it is a lower bound for an admissible pose, an upper bound for another one; NaN where it is unknown.
    pub margin: f64,
    /// Tilt [rad]; by bounds, the largest one.
    pub tilt: f64,
    /// Clearance [m]; by bounds, the least one.
    pub clearance: f64,
    /// True if the rover was settled.
    pub exact: bool,
}

impl Verdict {
    /// A pose of unknown feasibility.
    pub const UNKNOWN: Self =
        Self { reason: Reason::NotSettled, margin: f64::NAN, tilt: f64::NAN, clearance: f64::NAN, exact: false };

    /// A pose without a margin, for this reason.
    fn refused(reason: Reason) -> Self {
        Self { reason, ..Self::UNKNOWN }
    }
}

/// Poses that are bounded, or settled, at a time.
const BLOCK: usize = 1024;

/// Rover, map and limits against which poses are checked.
#[derive(Clone, Debug)]
pub struct Judge<'a> {
    settler: Settler<'a>,
    plan: BoundsConstants,
    belly: Belly,
    allowed: Allowed,
    radius: f64,
    level: [f64; MAX_WHEELS],
    error: f64,
}

impl<'a> Judge<'a> {
    /// For a rover with this belly on a map with heights exact to `error` [m]; `settler` has its chain.
    pub fn new(
        settler: Settler<'a>,
        dimensions: &Dimensions,
        belly: Belly,
        allowed: Allowed,
        error: f64,
    ) -> Result<Self, Error> {
        allowed.check()?;
        Ok(Self {
            settler,
            plan: BoundsConstants::new(dimensions, belly, allowed.within())?,
            belly,
            allowed,
            radius: dimensions.wheel_radius,
            level: std::array::from_fn(|wheel| dimensions.level_place(wheel / 2)[2]),
            error,
        })
    }

    /// Limit with the smallest margin, and that margin, for these sizes of roll, pitch and tilt, clearance, sizes of
    /// rocker and bogie, and drop.
    fn worst_margin(&self, [roll, pitch, tilt, clearance, rocker, bogie, drop]: [f64; 7]) -> (Reason, f64) {
        let allowed = &self.allowed;
        let share = |size: f64, limit: f64| {
            if limit.is_finite() { 1.0 - size / limit } else { 1.0 }
        };
        let all = [
            (Reason::Roll, share(roll, allowed.roll)),
            (Reason::Pitch, share(pitch, allowed.pitch)),
            (Reason::Tilt, share(tilt, allowed.tilt)),
            (Reason::Clearance, (clearance - allowed.clearance) / self.radius),
            (Reason::Rocker, share(rocker, allowed.rocker)),
            (Reason::Bogie, share(bogie, allowed.bogie)),
            (Reason::WheelDrop, share(drop, allowed.wheel_drop)),
        ];
        all.into_iter().fold((Reason::Ok, f64::INFINITY), |least, one| if one.1 < least.1 { one } else { least })
    }

    /// The feasibility by the bounds of a pose; None if they are not sufficient.
    fn by_bounds(&self, bound: &[[f64; 2]; COUNT]) -> Option<Verdict> {
        let [_, roll, pitch, tilt, clearance, rocker, left, right, drop] = *bound;
        let most = |[low, high]: [f64; 2]| low.abs().max(high.abs());
        let least = |[low, high]: [f64; 2]| low.max(-high).max(0.0);
        let worst =
            [most(roll), most(pitch), tilt[1], clearance[0], most(rocker), most(left).max(most(right)), drop[1]];
        let verdict = |reason, margin| Verdict { reason, margin, tilt: tilt[1], clearance: clearance[0], exact: false };
        let (_, margin) = self.worst_margin(worst);
        if margin >= 0.0 {
            return Some(verdict(Reason::Ok, margin));
        }
        let best =
            [least(roll), least(pitch), tilt[0], clearance[1], least(rocker), least(left).max(least(right)), drop[0]];
        let (reason, margin) = self.worst_margin(best);
        (margin < 0.0).then(|| verdict(reason, margin))
    }

    /// The feasibility by the settled pose.
    fn by_settling(&self, pose: [f64; 3], stand: &Stand) -> Verdict {
        let chain = self.settler.chain;
        let Some(placed) = stand.place(chain, self.settler.ground, pose.into(), &[]) else {
            return Verdict::refused(match stand.status {
                Status::OffMap => Reason::OffMap,
                Status::UnknownCells => Reason::UnknownCells,
                _ => Reason::NotSettled,
            });
        };
        let tilt = tilt(&placed);
        let belly = self.belly.above(self.settler.ground, &placed);
        let Some(clearance) = belly else {
            return Verdict::refused(Reason::UnknownCells);
        };
        // The ground under the wheels may be lower by `error`, and that under the belly higher.
        let clearance = clearance - 2.0 * self.error;
        let [_, roll, pitch, rocker, left, right] = stand.state;
        let (reason, margin) = self.worst_margin([
            roll.abs(),
            pitch.abs(),
            tilt,
            clearance,
            rocker.abs(),
            left.abs().max(right.abs()),
            wheel_drop(chain, &placed, &self.level),
        ]);
        Verdict { reason: if margin >= 0.0 { Reason::Ok } else { reason }, margin, tilt, clearance, exact: true }
    }

    /// Computes the feasibility of every pose, all of finite numbers. Fails if there is no memory for the pyramid.
    pub fn judge(&self, poses: &[[f64; 3]], verdicts: &mut [Verdict], workers: Workers) -> Result<(), Error> {
        let ground = Ground { pyramid: self.settler.ground.pyramid(workers.is_interrupted)?, error: self.error };
        let share = poses.len().div_ceil(workers.threads.max(1)).clamp(64, 2048);
        let parts = poses.chunks(share).zip(verdicts.chunks_mut(share));
        workers.for_each(parts, |(poses, verdicts)| self.check_range(ground, poses, verdicts, workers.level))
    }

    fn check_range(
        &self,
        ground: Ground<'_>,
        poses: &[[f64; 3]],
        verdicts: &mut [Verdict],
        level: Level,
    ) -> Result<(), Error> {
        let workers = Workers { level, ..Workers::PLAIN };
        let mut table = Box::new([[[0.0; 2]; BLOCK]; COUNT]);
        let mut statuses = [BoundStatus::Beyond; BLOCK];
        let margins = Margins { yaw: &[0.0], position: &[0.0] };
        let mut open = Vec::with_capacity(2 * BLOCK);
        for first in (0..poses.len()).step_by(BLOCK) {
            let some = &poses[first..poses.len().min(first + BLOCK)];
            let targets = table.each_mut().map(|block| &mut block[..some.len()]);
            let statuses = &mut statuses[..some.len()];
            let plan = std::slice::from_ref(&self.plan);
            bounds(plan, ground, some, margins, targets, statuses, workers)?;
            for (k, status) in statuses.iter().enumerate() {
                let by_bounds = || self.by_bounds(&table.each_ref().map(|block| block[k]));
                // A pose over unknown ground is refused: settling does not decide it either.
                let decided = match status {
                    BoundStatus::OffMap => Some(Verdict::refused(Reason::OffMap)),
                    BoundStatus::UnknownCells => Some(Verdict::refused(Reason::UnknownCells)),
                    BoundStatus::Bounded => by_bounds(),
                    _ => None,
                };
                match decided {
                    Some(decided) => verdicts[first + k] = decided,
                    None => open.push(first + k),
                }
            }
            if open.len() >= BLOCK {
                self.settled(&open, poses, verdicts);
                open.clear();
            }
        }
        self.settled(&open, poses, verdicts);
        Ok(())
    }

    /// Settles the poses that bounds do not decide.
    fn settled(&self, open: &[usize], poses: &[[f64; 3]], verdicts: &mut [Verdict]) {
        let some: Vec<[f64; 3]> = open.iter().map(|row| poses[*row]).collect();
        let mut stands = vec![Stand::nothing(Status::NotConverged); some.len()];
        settle_part(&self.settler, &some, &|_| &[], &mut stands);
        for ((row, pose), stand) in open.iter().zip(some).zip(&stands) {
            verdicts[*row] = self.by_settling(pose, stand);
        }
    }
}
