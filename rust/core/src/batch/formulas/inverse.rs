//! Inverse kinematics of whole registers of twists: fixed wheels, rollers, and wheels steered about their
//! contact. What the kernel does not decide itself, it leaves to the plain core, row by row.

use pulp::Simd;

use super::steered::{Reach, Steer, Steered, absolute, load};
use crate::admissible::SLIP_TOLERANCE;
use crate::batch::machine::lanes::{Lanes, Mask};
use crate::batch::machine::level::{Kernel, Level};
use crate::batch::machine::stream::{Output, fetch_ahead};
use crate::batch::machine::vector::Vector;
use crate::batch::machine::weave::{BLOCK, Column, unweave, weave, with_columns};
use crate::error::Error;
use crate::geometry::Twist;
use crate::rover::{Inputs, Mount, Rover};
use crate::wheels::{REST, Wheel};

/// Sizes of twists whose squares neither overflow nor lose digits. Beyond them, the plain core.
pub(in crate::batch) const SMALLEST: f64 = 1e-100;
pub(in crate::batch) const LARGEST: f64 = 1e100;

/// Sizes of rovers with which that holds at every pivot.
pub(in crate::batch) const SIZES: std::ops::RangeInclusive<f64> = 1e-20..=1e20;

#[derive(Clone, Copy, Debug)]
pub(crate) enum Part {
    Fixed([f64; 3]),
    Steered(Steered),
}

/// What the kernel needs to know of a rover.
pub(crate) struct Plan<'a> {
    rover: &'a Rover,
    /// Every wheel with one over its radius.
    pub parts: Vec<(Part, f64)>,
    joints: usize,
    pub banks: Vec<[f64; 3]>,
    /// Two pivots far apart: the faster one is a lower bound of the fastest.
    pivots: [[f64; 2]; 2],
    /// The longest way to a pivot, along the axes [m].
    arm: f64,
}

impl<'a> Plan<'a> {
    /// Nothing where a wheel is not one of those the kernel knows.
    pub fn new(rover: &'a Rover) -> Option<Self> {
        let usual = |length: f64| length == 0.0 || SIZES.contains(&length);
        let part = |(wheel, mount): (&Wheel, &Mount)| {
            let lengths = [wheel.radius, wheel.x.abs(), wheel.y.abs()];
            if !(lengths.into_iter().all(usual) && *SIZES.end() > wheel.scrub.abs()) {
                return None;
            }
            let part = match *mount {
                Mount::Fixed(rows) => Part::Fixed(rows.rolling.into()),
                Mount::Castor(_) => return None,
                Mount::Steered(range, heading) if wheel.is_centred() => Part::Steered(Steered {
                    x: wheel.x,
                    y: wheel.y,
                    heading: (wheel.heading != 0.0).then_some(heading),
                    range,
                    reach: Reach::new(range)?,
                }),
                Mount::Steered(..) => return None,
            };
            Some((part, 1.0 / wheel.radius))
        };
        let wheels = rover.wheels();
        let parts: Option<Vec<_>> = wheels.iter().zip(&rover.mounts).map(part).collect();
        Some(Self {
            rover,
            parts: parts?,
            joints: rover.steered().len(),
            banks: rover.banks.iter().map(|bank| bank.row.into()).collect(),
            pivots: pivots_apart(wheels),
            arm: wheels
                .iter()
                .map(|wheel| wheel.x.abs() + wheel.y.abs())
                .fold(0.0, f64::max),
        })
    }

    /// Fails at the first row that the rover cannot make; rows count from `first`.
    pub fn check(&self, level: Level, twists: &[[f64; 3]], first: usize) -> Result<(), Error> {
        let check = Check {
            plan: self,
            twists,
            first,
        };
        level
            .run(check)
            .unwrap_or_else(|| self.check_rows(twists, first))
    }

    /// Solves rows that have been checked; `past` the caches, if what is written does not fit in.
    pub fn solve(
        &self,
        level: Level,
        twists: &[[f64; 3]],
        steering: &mut [f64],
        speeds: &mut [f64],
        past: bool,
    ) {
        with_columns(self.joints + self.parts.len(), |columns| {
            level.run(Solve {
                plan: self,
                twists,
                steering,
                speeds,
                past,
                columns,
            })
        });
    }

    fn check_rows(&self, twists: &[[f64; 3]], first: usize) -> Result<(), Error> {
        for (k, twist) in twists.iter().enumerate() {
            let checked = self.rover.check(Twist::from(*twist), None);
            checked.map_err(|error| error.at_row(first + k))?;
        }
        Ok(())
    }

    /// Whether a twist is surely finite, and its squares are too.
    #[inline(always)]
    pub fn usual<S: Simd>(simd: S, twist: [Lanes<S>; 3]) -> Mask<S> {
        let [vx, vy, omega] = absolute(twist);
        let size = vx + vy + omega;
        let fits = size.at_most(Lanes::splat(simd, LARGEST));
        let zero = size.at_most(Lanes::splat(simd, 0.0));
        fits & (zero | Lanes::splat(simd, SMALLEST).at_most(size))
    }

    /// Whether the plain core would surely let a twist pass.
    #[inline(always)]
    fn passes<S: Simd>(&self, simd: S, twist: [Lanes<S>; 3]) -> Mask<S> {
        let mut passes = Self::usual(simd, twist);
        if !self.banks.is_empty() {
            let [vx, vy, omega] = twist;
            let mut fastest = Lanes::splat(simd, 0.0);
            for [x, y] in self.pivots {
                let ux = vx - omega * Lanes::splat(simd, y);
                let uy = vy + omega * Lanes::splat(simd, x);
                fastest = fastest.max(ux.abs() + uy.abs());
            }
            let tolerance = Lanes::splat(simd, SLIP_TOLERANCE) * fastest;
            for row in &self.banks {
                passes = passes & dot(simd, row, twist).abs().at_most(tolerance);
            }
        }
        for (part, _) in &self.parts {
            let Part::Steered(steered) = part else {
                continue;
            };
            if steered.reach.limited {
                passes = passes & steered.decides(simd, twist);
            }
        }
        passes
    }
}

/// Two pivots far apart.
pub(in crate::batch) fn pivots_apart(wheels: &[Wheel]) -> [[f64; 2]; 2] {
    let first = [wheels[0].x, wheels[0].y];
    let mut other = first;
    let distance = |[x, y]: [f64; 2]| (x - first[0]).abs() + (y - first[1]).abs();
    for wheel in wheels {
        if distance([wheel.x, wheel.y]) > distance(other) {
            other = [wheel.x, wheel.y];
        }
    }
    [first, other]
}

/// A row times a twist, by the same operations as the plain core.
#[inline(always)]
pub(crate) fn dot<S: Simd>(simd: S, row: &[f64; 3], [vx, vy, omega]: [Lanes<S>; 3]) -> Lanes<S> {
    let [a, b, c] = [row[0], row[1], row[2]];
    vx * Lanes::splat(simd, a) + vy * Lanes::splat(simd, b) + omega * Lanes::splat(simd, c)
}

struct Check<'a> {
    plan: &'a Plan<'a>,
    twists: &'a [[f64; 3]],
    first: usize,
}

impl Kernel for Check<'_> {
    type Output = Result<(), Error>;

    #[inline(always)]
    fn run<S: Vector>(self, simd: S) -> Self::Output {
        let mut columns = [Column::ZERO; 3];
        for (block, rows) in self.twists.chunks(BLOCK).enumerate() {
            unweave(simd, rows.as_flattened(), &mut columns);
            let mut pass = self.plan.passes(simd, load(simd, &columns, 0));
            for k in 1..BLOCK / S::F64_LANES {
                pass = pass & self.plan.passes(simd, load(simd, &columns, k));
            }
            if (!pass).any() {
                self.plan.check_rows(rows, self.first + block * BLOCK)?;
            }
        }
        Ok(())
    }
}

struct Solve<'a> {
    plan: &'a Plan<'a>,
    twists: &'a [[f64; 3]],
    steering: &'a mut [f64],
    speeds: &'a mut [f64],
    past: bool,
    /// One per steering angle and one per speed.
    columns: &'a mut [Column],
}

impl Kernel for Solve<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Vector>(self, simd: S) {
        let plan = self.plan;
        let (joints, wheels) = (plan.joints, plan.parts.len());
        let mut twists = [Column::ZERO; 3];
        let (steering, speeds) = self.columns.split_at_mut(joints);
        let output = |target, width| Output::new(simd, target, width * BLOCK, self.past);
        let mut all_steering = output(self.steering, joints);
        let mut all_speeds = output(self.speeds, wheels);
        for rows in self.twists.chunks(BLOCK) {
            fetch_ahead(simd, rows.as_flattened(), 0, 1);
            unweave(simd, rows.as_flattened(), &mut twists);
            let steering_rows = all_steering.next(rows.len() * joints);
            let speed_rows = all_speeds.next(rows.len() * wheels);
            let brisk = solve_block(simd, plan, &twists, steering, speeds);
            let doubtful = !brisk && hold_still(simd, plan, &twists, steering, speeds);
            weave(simd, steering, steering_rows);
            weave(simd, speeds, speed_rows);
            if doubtful {
                let mut doubts = Column::ZERO;
                find_doubts(simd, plan, &twists, &mut doubts);
                let doubtful = |(k, _): &(usize, _)| doubts.0[*k] != 0.0;
                for (k, twist) in rows.iter().enumerate().filter(doubtful) {
                    plan.rover.solve(
                        Twist::from(*twist),
                        Inputs::default(),
                        &mut steering_rows[k * joints..(k + 1) * joints],
                        &mut speed_rows[k * wheels..(k + 1) * wheels],
                    );
                }
            }
        }
    }
}

/// Solves a block. Whether that was all: every wheel moves, well inside its range.
#[inline(always)]
fn solve_block<S: Simd>(
    simd: S,
    plan: &Plan<'_>,
    twists: &[Column; 3],
    steering: &mut [Column],
    speeds: &mut [Column],
) -> bool {
    let zero = Lanes::splat(simd, 0.0);
    let mut sure = zero.at_most(zero);
    let mut margins = Column::ZERO;
    let margins = S::as_mut_simd_f64s(&mut margins.0).0;
    for k in 0..BLOCK / S::F64_LANES {
        let twist = load(simd, twists, k);
        sure = sure & Plan::usual(simd, twist);
        let [vx, vy, omega] = absolute(twist);
        let summed = vx + vy + omega * Lanes::splat(simd, plan.arm);
        (summed * Lanes::splat(simd, 2.0 * REST)).store(margins, k);
    }
    let mut joint = 0;
    for ((part, per_radius), speeds) in plan.parts.iter().zip(speeds) {
        let speeds = S::as_mut_simd_f64s(&mut speeds.0).0;
        let per_radius = Lanes::splat(simd, *per_radius);
        match part {
            Part::Fixed(row) => {
                for k in 0..BLOCK / S::F64_LANES {
                    let rim_speed = dot(simd, row, load(simd, twists, k));
                    (rim_speed * per_radius).store(speeds, k);
                }
            }
            Part::Steered(steered) => {
                let angles = S::as_mut_simd_f64s(&mut steering[joint].0).0;
                joint += 1;
                let steer = Steer {
                    twists,
                    margins,
                    per_radius,
                    angles,
                    speeds,
                };
                sure = sure
                    & match (steered.heading, steered.reach.symmetric) {
                        (None, true) => steer.run::<false, true>(simd, steered),
                        (None, false) => steer.run::<false, false>(simd, steered),
                        (Some(_), true) => steer.run::<true, true>(simd, steered),
                        (Some(_), false) => steer.run::<true, false>(simd, steered),
                    };
            }
        }
    }
    !(!sure).any()
}

/// Puts right the wheels of a block that rest. Whether there are rows in it that are for the plain core.
#[inline(always)]
fn hold_still<S: Simd>(
    simd: S,
    plan: &Plan<'_>,
    twists: &[Column; 3],
    steering: &mut [Column],
    speeds: &mut [Column],
) -> bool {
    let zero = Lanes::splat(simd, 0.0);
    let mut sure = zero.at_most(zero);
    for k in 0..BLOCK / S::F64_LANES {
        let twist = load(simd, twists, k);
        sure = sure & Plan::usual(simd, twist);
        let mut joint = 0;
        for ((part, _), speeds) in plan.parts.iter().zip(speeds.iter_mut()) {
            let Part::Steered(steered) = part else {
                continue;
            };
            sure = sure & steered.decides(simd, twist);
            let rests = steered.rests(simd, twist);
            for column in [&mut steering[joint], speeds] {
                let column = S::as_mut_simd_f64s(&mut column.0).0;
                let moving = Lanes::load(simd, column, k);
                rests.select(zero, moving).store(column, k);
            }
            joint += 1;
        }
    }
    (!sure).any()
}

/// Marks the rows of a block that are for the plain core.
#[inline(always)]
fn find_doubts<S: Simd>(simd: S, plan: &Plan<'_>, twists: &[Column; 3], doubts: &mut Column) {
    let (zero, one) = (Lanes::splat(simd, 0.0), Lanes::splat(simd, 1.0));
    let doubts = S::as_mut_simd_f64s(&mut doubts.0).0;
    for k in 0..BLOCK / S::F64_LANES {
        let twist = load(simd, twists, k);
        let mut sure = Plan::usual(simd, twist);
        for (part, _) in &plan.parts {
            if let Part::Steered(steered) = part {
                sure = sure & steered.decides(simd, twist);
            }
        }
        sure.select(zero, one).store(doubts, k);
    }
}
