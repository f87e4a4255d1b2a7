//! One row: the lanes of a register are the wheels.
//!
//! The formulas, and what is left to the plain core, are those of the kernels for whole batches. The steered
//! wheels come first, then the others, eight to a group.
//!
//! There are no branches by the kind of wheel; every lane goes through the same operations with numbers that make the
//! foreign ones harmless. A lane that is not steered has `x = y = arm = 0` and a whole turn without ends, so its angle is
//! never in doubt and thrown away, and its speed is its constant row times the twist. A steered lane has a row of zeros. A lane
//! without a wheel has both, and its results are not copied out. Where half turns lead to no other angle of the range,
//! `per_half_turn` is 0, so that the number of half turns comes out as 0.

use std::f64::consts::{FRAC_1_PI, PI};

use pulp::Simd;

use crate::admissible::SLIP_TOLERANCE;
use crate::geometry::Twist;
use crate::kernels::steered::{AT_AN_END, DECIDED, NEAR_AN_END, ONLY, Reach};
use crate::kernels::usual::{LARGEST, SMALLEST, is_usual, pivots_apart};
use crate::rover_data::{Inputs, MAX_WHEELS, Mount, RoverData};
use crate::steering::SteeringRange;
use crate::wheels::{REST, Wheel};
use six_wheel_numerics::simd::lanes::{Lanes, Mask};
use six_wheel_numerics::simd::level::{Kernel, Level};
use six_wheel_numerics::simd::polynomials::{ROUND, angle};
use six_wheel_numerics::simd::vector::Vector;

/// Wheels in a group: a whole number of registers on every level.
pub const GROUP: usize = 8;

/// Groups of the largest rover.
const GROUPS: usize = MAX_WHEELS / GROUP;

/// One number per wheel of a group.
pub type Eight = [f64; GROUP];

/// The level of one row. Registers of eight are no faster: steered wheels are mostly four, and a row of four
/// angles fills a register of four without masks.
#[inline]
pub fn level() -> Option<Level> {
    [Level::Avx2, Level::Neon].into_iter().find(|level| level.is_here())
}

/// The order of the lanes: wheels by index, the steered ones first.
#[inline]
pub fn order(rover: &RoverData) -> Vec<usize> {
    let others = (0..rover.wheels().len()).filter(|i| !rover.steered().contains(i));
    rover.steered().iter().copied().chain(others).collect()
}

/// Constants of a rover for the inverse kernel.
#[derive(Clone, Debug)]
pub(crate) struct InverseConstants {
    level: Level,
    groups: Vec<Group>,
    order: Vec<usize>,
    /// True if a steered wheel's angle 0 is not straight ahead.
    turned: bool,
    banks: Vec<[f64; 3]>,
    pivots: [[f64; 2]; 2],
}

/// Eight wheels.
#[derive(Clone, Debug, Default)]
struct Group {
    /// Number of steered wheels among them.
    steered: usize,
    /// 1 for a steered wheel, 0 for another.
    steers: Eight,
    x: Eight,
    y: Eight,
    arm: Eight,
    sin: Eight,
    cos: Eight,
    /// Ends of the range [rad], and of what lies inside it by more than [`NEAR_AN_END`]: beyond that the plain core, which
    /// knows the tolerances at an end, decides.
    range: [Eight; 2],
    inside: [Eight; 2],
    /// Tolerance beyond that, within which an angle counts as the end [rad]: where there is no other way of making the
    /// motion.
    slack: Eight,
    /// Turn from the present angle up to which a wheel need not agree with the others on a way round [rad]; infinite where
    /// the range leaves one way only.
    decided: Eight,
    /// `1 / pi` where half turns lead to other angles of the range, 0 elsewhere.
    per_half_turn: Eight,
    /// The rolling row of a wheel that is not steered.
    row: [Eight; 3],
    per_radius: Eight,
}

impl Group {
    /// Puts a wheel into a lane. Nothing if it is not one of those the kernel knows.
    fn fill(&mut self, lane: usize, wheel: &Wheel, mount: Mount) -> Option<()> {
        if !is_usual(wheel) {
            return None;
        }
        self.per_radius[lane] = 1.0 / wheel.radius;
        match mount {
            Mount::Castor(_) => return None,
            Mount::Fixed(rows) => {
                for (row, number) in self.row.iter_mut().zip(<[f64; 3]>::from(rows.rolling)) {
                    row[lane] = number;
                }
            }
            Mount::Steered(range, heading) => {
                if !(wheel.is_centred() && range.lower < 0.0 && range.upper > 0.0) {
                    return None;
                }
                let quarter = SteeringRange::default();
                self.steered += 1;
                self.steers[lane] = 1.0;
                (self.x[lane], self.y[lane]) = (wheel.x, wheel.y);
                self.arm[lane] = wheel.x.abs() + wheel.y.abs();
                (self.sin[lane], self.cos[lane]) = (heading.sin, heading.cos);
                self.set_range(lane, range);
                // Within a quarter turn to either side there is only one angle to each motion.
                if range.lower < quarter.lower || range.upper > quarter.upper {
                    self.decided[lane] = DECIDED;
                    self.per_half_turn[lane] = FRAC_1_PI;
                }
            }
        }
        Some(())
    }

    fn set_range(&mut self, lane: usize, range: SteeringRange) {
        self.range[0][lane] = range.lower;
        self.range[1][lane] = range.upper;
        let inner = Reach::new(range).is_some_and(|reach| reach.ways == ONLY);
        let margin = if inner { 0.0 } else { NEAR_AN_END };
        self.slack[lane] = if inner { AT_AN_END } else { 0.0 };
        self.inside[0][lane] = range.lower + margin;
        self.inside[1][lane] = range.upper - margin;
        self.decided[lane] = f64::INFINITY;
    }
}

impl InverseConstants {
    /// Nothing where a wheel is not one of those the kernel knows, or the machine has no kernel.
    pub fn new(rover: &RoverData) -> Option<Self> {
        let level = level()?;
        let order = order(rover);
        let mut groups = vec![Group::default(); order.len().div_ceil(GROUP)];
        for group in &mut groups {
            for lane in 0..GROUP {
                group.set_range(lane, SteeringRange::WHOLE_TURN);
                group.inside[0][lane] = f64::NEG_INFINITY;
                group.inside[1][lane] = f64::INFINITY;
            }
        }
        for (k, &i) in order.iter().enumerate() {
            groups[k / GROUP].fill(k % GROUP, &rover.wheels()[i], rover.mounts[i])?;
        }
        let turned = |&i: &usize| rover.wheels()[i].heading != 0.0;
        Some(Self {
            level,
            groups,
            turned: rover.steered().iter().any(turned),
            order,
            banks: rover.banks.iter().map(|bank| bank.row.into()).collect(),
            pivots: pivots_apart(rover.wheels()),
        })
    }

    /// Steering angles and wheel speeds of one twist. The answer is whether the kernel could do it; nothing is written
    /// otherwise.
    #[inline]
    pub fn solve(&self, twist: Twist, inputs: Inputs<'_>, steering: &mut [f64], speeds: &mut [f64]) -> bool {
        if inputs.previous_speeds.is_some() || inputs.steering_rates.is_some() {
            return false;
        }
        let row = Row { plan: self, twist: twist.into(), previous: inputs.previous, steering, speeds };
        self.level.run(row) == Some(true)
    }

    /// True if the plain core would surely let the twist pass, the steered wheels apart.
    #[inline(always)]
    fn passes(&self, [vx, vy, omega]: [f64; 3]) -> bool {
        let size = vx.abs() + vy.abs() + omega.abs();
        let usual = size <= LARGEST && (size >= SMALLEST || size == 0.0);
        usual
            && self.banks.iter().all(|[a, b, c]| {
                let slip = (a * vx + b * vy + c * omega).abs();
                let speed = |[x, y]: [f64; 2]| (vx - omega * y).abs() + (vy + omega * x).abs();
                slip == 0.0 || slip <= SLIP_TOLERANCE * speed(self.pivots[0]).max(speed(self.pivots[1]))
            })
    }
}

/// One row of the inverse. The answer is whether the kernel could decide it; nothing is written otherwise.
struct Row<'a> {
    plan: &'a InverseConstants,
    twist: [f64; 3],
    previous: Option<&'a [f64]>,
    steering: &'a mut [f64],
    speeds: &'a mut [f64],
}

impl Kernel for Row<'_> {
    type Output = bool;

    #[inline(always)]
    fn run<S: Vector>(self, simd: S) -> bool {
        if !self.plan.passes(self.twist) {
            return false;
        }
        // One group is the rule, and stays in registers.
        match self.plan.groups.len() {
            1 => self.solve::<S, 1>(simd),
            _ => self.solve::<S, GROUPS>(simd),
        }
    }
}

impl Row<'_> {
    #[inline(always)]
    fn solve<S: Vector, const N: usize>(self, simd: S) -> bool {
        let plan = self.plan;
        let mut angles = [[0.0; GROUP]; N];
        let mut rotations = [[0.0; GROUP]; N];
        let zero = Lanes::splat(simd, 0.0);
        let mut sure = zero.at_most(zero);
        let mut previous = self.previous.map(|previous| previous.chunks(S::F64_LANES));
        let groups = plan.groups.iter().zip(&mut angles).zip(&mut rotations);
        for ((group, angles), rotations) in groups {
            let angles = S::as_mut_simd_f64s(angles).0;
            let rotations = S::as_mut_simd_f64s(rotations).0;
            for k in 0..GROUP / S::F64_LANES {
                if k * S::F64_LANES < group.steered {
                    let next = previous.as_mut().map(Iterator::next);
                    let before = next.map(|row| padded(simd, row.unwrap_or_default()));
                    let wheels = Wheels { simd, group, k };
                    let solved = wheels.steer(self.twist, plan.turned, before);
                    sure = sure & solved.sure;
                    solved.angle.store(angles, k);
                    solved.speed.store(rotations, k);
                } else if k * S::F64_LANES < plan.order.len() {
                    Wheels { simd, group, k }.roll(self.twist).store(rotations, k);
                }
            }
        }
        if (!sure).any() {
            return false;
        }
        for (target, angle) in self.steering.iter_mut().zip(angles.as_flattened()) {
            *target = *angle;
        }
        for (&i, rotation) in plan.order.iter().zip(rotations.as_flattened()) {
            if let Some(target) = self.speeds.get_mut(i) {
                *target = *rotation;
            }
        }
        true
    }
}

/// A register of numbers, zero beyond their end.
#[inline(always)]
pub fn padded<S: Simd>(simd: S, numbers: &[f64]) -> Lanes<S> {
    if let [register, ..] = S::as_simd_f64s(numbers).0 {
        return Lanes::load(simd, std::slice::from_ref(register), 0);
    }
    let mut room = [0.0; GROUP];
    for (place, number) in room.iter_mut().zip(numbers) {
        *place = *number;
    }
    Lanes::load(simd, S::as_simd_f64s(&room).0, 0)
}

/// A register of a group's wheels.
#[derive(Clone, Copy)]
struct Wheels<'a, S> {
    simd: S,
    group: &'a Group,
    k: usize,
}

struct Solved<S: Simd> {
    angle: Lanes<S>,
    speed: Lanes<S>,
    /// True if the wheel rests, or there is no doubt about its rolling direction.
    sure: Mask<S>,
}

impl<S: Simd> Wheels<'_, S> {
    #[inline(always)]
    fn load(self, numbers: &Eight) -> Lanes<S> {
        Lanes::load(self.simd, S::as_simd_f64s(numbers).0, self.k)
    }

    #[inline(always)]
    fn splat(self, number: f64) -> Lanes<S> {
        Lanes::splat(self.simd, number)
    }

    /// Speeds of wheels that are not steered, by the same operations as the plain core.
    #[inline(always)]
    fn roll(self, [vx, vy, omega]: [f64; 3]) -> Lanes<S> {
        let [a, b, c] = &self.group.row;
        let along = self.splat(vx) * self.load(a) + self.splat(vy) * self.load(b);
        (along + self.splat(omega) * self.load(c)) * self.load(&self.group.per_radius)
    }

    /// Angles and speeds of a register with steered wheels in it.
    #[inline(always)]
    fn steer(self, twist: [f64; 3], turned: bool, before: Option<Lanes<S>>) -> Solved<S> {
        let (simd, group) = (self.simd, self.group);
        let zero = self.splat(0.0);
        let [vx, vy, omega] = twist.map(|part| self.splat(part));
        let mut x = vx - omega * self.load(&group.y);
        let mut y = vy + omega * self.load(&group.x);
        let summed = vx.abs() + vy.abs() + omega.abs() * self.load(&group.arm);
        let rests = x.abs().max(y.abs()).at_most(self.splat(REST) * summed);
        if turned {
            let (sin, cos) = (self.load(&group.sin), self.load(&group.cos));
            (x, y) = (cos * x + sin * y, cos * y - sin * x);
        }
        let near = angle(simd, x.abs(), y.abs()).flip(y.sign()).flip(x.sign());
        // Of the angles half a turn apart, the one nearest to the present one, if half a turn may matter.
        let mut finite = zero.at_most(zero);
        let before = before.map_or(zero, |before| {
            finite = before.abs().at_most(self.splat(f64::MAX));
            let [lower, upper] = &group.range;
            before.max(self.load(lower)).min(self.load(upper))
        });
        let round = self.splat(ROUND);
        let shifted = (before - near).mul_add(self.load(&group.per_half_turn), round);
        let angle = (shifted - round).mul_add(self.splat(PI), near);
        let back = shifted.has_bit(0).select(self.splat(-0.0), zero);
        let [lower, upper] = &group.inside;
        let decided = (angle - before).abs().at_most(self.load(&group.decided));
        let held = angle.max(self.load(lower)).min(self.load(upper));
        let inside = (angle - held).abs().at_most(self.load(&group.slack));
        let speed = x.mul_add(x, y * y).sqrt() * self.load(&group.per_radius);
        let speed = rests.select(zero, speed.flip(x.sign()).flip(back));
        let steers = zero.below(self.load(&group.steers));
        Solved {
            angle: rests.select(before, held),
            speed: steers.select(speed, self.roll(twist)),
            sure: finite & (rests | (inside & decided)),
        }
    }
}
