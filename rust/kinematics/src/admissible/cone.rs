//! Admissibility of twists in every lane: no side slip, and every steering angle inside its range.
//!
//! A steered wheel without trail whose range is narrower than half a turn is within it if its pivot moves along the
//! middle of the range, forwards or backwards, or at an angle to that of half the range at most. With the velocity of
//! the pivot along the middle and across it, and the half range `h`, the wheel slides at the nearer end at `|across|
//! cos h - |along| sin h`: no angle is needed. Twists whose slip is neither well below the tolerance nor well above it
//! are decided by the definition: the slip of every wheel at the angle that it would be steered to.

use nalgebra::Vector3;
use pulp::Simd;

use crate::geometry::Direction;
use crate::kernels::safe_range::{MIN_SQUARABLE, SCALE, distant_pivots, has_safe_lengths, is_in_safe_range};
use crate::kernels::steered::wheel::{SAFE_OVERSHOOT, SteeredConstants, WheelQuery};
use crate::rover_data::RoverData;
use six_wheel_numerics::columns::Column;
use six_wheel_numerics::simd::lanes::{Lanes, Mask};
use six_wheel_numerics::simd::level::{LevelKernel, run_rarely};
use six_wheel_numerics::simd::vec3::row_times as dot;
use six_wheel_numerics::simd::vector::Vector;

/// Side slip up to which a twist is admissible, as a share of the fastest pivot's speed: 1 nm per metre driven, above
/// rounding.
pub const SLIP_TOLERANCE: f64 = 1e-9;

/// Shares of the tolerance between which the definition decides.
const CLEAR: [f64; 2] = [0.5, 2.0];

/// Share of the pivot's speed along the wheel from which on the angle of a wheel with trail is exact to rounding.
const MIN_ALONG: f64 = 0.75;

/// The admissible twists of a rover, as numbers.
#[derive(Clone, Debug)]
pub struct AdmissibleCone {
    /// Rows whose products with the twist are the speeds at which unsteered wheels slide.
    pub(crate) banks: Vec<[f64; 3]>,
    /// Steered wheels whose ranges restrict the twist.
    pub(crate) limited: Vec<LimitedWheel>,
    /// Pivot and distance of the contact from it, of every wheel [m].
    contacts: Vec<[f64; 3]>,
    /// Smallest radius [m].
    min_radius: f64,
    /// Two pivots far apart [m]: the speed of the faster one is a lower bound of the fastest pivot's.
    pivots: [[f64; 2]; 2],
    /// Largest distance of a contact from the body's origin, as the sum of its parts along the axes [m].
    arm: f64,
    /// True if lengths are such that squares neither overflow nor lose digits.
    is_safe: bool,
}

/// A steered wheel whose range restricts the twist.
#[derive(Clone, Debug)]
pub(crate) struct LimitedWheel {
    /// Index among the steered wheels.
    pub joint: usize,
    /// Index among all wheels.
    pub wheel: usize,
    constants: SteeredConstants,
    /// Wedge of a wheel without trail; None with trail.
    wedge: Option<SteeringWedge>,
}

/// The twists for which one steered wheel is within its range.
#[derive(Clone, Debug)]
struct SteeringWedge {
    /// Row that gives the pivot's velocity along the middle of the range [m/s].
    along: [f64; 3],
    /// Row that gives the pivot's velocity across it [m/s].
    across: [f64; 3],
    /// Direction of half the range.
    half: Direction,
}

/// Rates of the steering joints [rad/s].
#[derive(Clone, Copy)]
pub(crate) enum Rates<'a> {
    /// Register `k` of one column per joint; none of no columns.
    Columns(&'a [Column], usize),
    /// The same in every lane.
    Row(&'a [f64]),
}

/// Decision on each lane.
#[derive(Clone, Copy)]
pub(crate) struct Admissibility<S: Simd> {
    /// True if the rover can make the twist.
    pub is_possible: Mask<S>,
    /// True if the twist and every wheel speed are finite.
    pub is_valid: Mask<S>,
}

impl AdmissibleCone {
    /// The admissible twists of a rover.
    pub fn new(rover: &RoverData) -> Self {
        let wheels = rover.wheels();
        let limited = rover.steered().iter().enumerate().filter_map(|(joint, &i)| {
            let wheel = &wheels[i];
            let range = wheel.steering()?;
            let wedge = (wheel.trail == 0.0).then(|| {
                let middle = f64::midpoint(range.lower, range.upper);
                let Direction { sin, cos } = Direction::from(wheel.heading + middle);
                let row = |a: f64, b: f64| Vector3::new(a, b, wheel.x * b - wheel.y * a).into();
                let half = Direction::from((range.upper - range.lower) / 2.0);
                SteeringWedge { along: row(cos, sin), across: row(-sin, cos), half }
            });
            let constants = SteeredConstants::new(wheel, rover.mounts[i])?;
            (wedge.is_none() || !range.is_full()).then_some(LimitedWheel { joint, wheel: i, constants, wedge })
        });
        let contacts: Vec<_> =
            wheels.iter().map(|wheel| [wheel.x, wheel.y, wheel.scrub.abs() + wheel.trail.abs()]).collect();
        Self {
            banks: rover.banks.iter().map(|bank| bank.row.into()).collect(),
            limited: limited.collect(),
            min_radius: wheels.iter().map(|wheel| wheel.radius).fold(f64::INFINITY, f64::min),
            pivots: distant_pivots(wheels),
            arm: contacts.iter().map(|[x, y, offset]| x.abs() + y.abs() + offset).fold(0.0, f64::max),
            is_safe: wheels.iter().all(has_safe_lengths),
            contacts,
        }
    }

    /// True if lengths are such that squares neither overflow nor lose digits.
    pub fn is_safe(&self) -> bool {
        self.is_safe
    }

    /// True if rates of the steering joints change the admissible twists: some wheel has scrub or trail.
    pub(crate) fn depends_on_rates(&self) -> bool {
        self.contacts.iter().any(|[.., offset]| *offset != 0.0)
    }

    /// Decides for each lane if the rover can make the twist.
    #[inline(always)]
    pub(crate) fn admissibility<S: Vector>(&self, simd: S, twist: [Lanes<S>; 3], rates: Rates<'_>) -> Admissibility<S> {
        let mut yes = self.safe_lanes(simd, twist);
        if !(self.banks.is_empty() && self.limited.is_empty()) {
            let none = self.clear_slips(simd, twist)[0];
            for bank in 0..self.banks.len() {
                yes = yes & self.bank_slip(simd, bank, twist).le(none);
            }
            for wheel in &self.limited {
                yes = yes & wheel.is_clearly_within(simd, twist, rates, none);
            }
        }
        if yes.all() {
            return Admissibility { is_possible: yes, is_valid: yes };
        }
        self.decided(simd, twist, rates, yes, None)
    }

    /// Decides for each lane if the rover can make the twist, where every condition but the ranges of the given joints
    /// holds.
    #[inline(always)]
    pub(crate) fn admissibility_of_joints<S: Vector>(
        &self,
        simd: S,
        twist: [Lanes<S>; 3],
        joints: &[usize],
    ) -> Mask<S> {
        let mut yes = self.safe_lanes(simd, twist);
        let none = self.clear_slips(simd, twist)[0];
        for wheel in self.limited.iter().filter(|wheel| joints.contains(&wheel.joint)) {
            yes = yes & wheel.is_clearly_within(simd, twist, Rates::Row(&[]), none);
        }
        if yes.all() {
            return yes;
        }
        self.decided(simd, twist, Rates::Row(&[]), yes, Some(joints)).is_possible
    }

    /// Lanes in which squares neither overflow nor lose digits.
    #[inline(always)]
    fn safe_lanes<S: Vector>(&self, simd: S, twist: [Lanes<S>; 3]) -> Mask<S> {
        if self.is_safe { is_in_safe_range(simd, twist) } else { Mask::splat(simd, false) }
    }

    /// The decision in lanes of which some are not `yes`: no where some slip is well above the tolerance, elsewhere by
    /// definition. Of the ranges, those of the given joints alone are tested against it.
    #[inline(always)]
    fn decided<S: Vector>(
        &self,
        simd: S,
        twist: [Lanes<S>; 3],
        rates: Rates<'_>,
        yes: Mask<S>,
        joints: Option<&[usize]>,
    ) -> Admissibility<S> {
        let mut no = Mask::splat(simd, false);
        // With rates contacts may be faster than the bound.
        if !rates.are_given() {
            let some = self.clear_slips(simd, twist)[1];
            for bank in 0..self.banks.len() {
                no = no | some.lt(self.bank_slip(simd, bank, twist));
            }
            for wheel in self.limited.iter().filter(|wheel| joints.is_none_or(|joints| joints.contains(&wheel.joint))) {
                no = no | wheel.is_clearly_outside(simd, twist, some);
            }
            no = no & self.safe_lanes(simd, twist) & !yes;
        }
        let is_clear = yes | no;
        if is_clear.all() {
            return Admissibility { is_possible: yes, is_valid: is_clear };
        }
        run_rarely(simd, ByDefinition { cone: self, twist, rates, yes, no })
    }

    /// True where a twist is finite and the unsteered wheels slide by well less than the tolerance.
    #[inline(always)]
    pub(crate) fn banks_roll<S: Vector>(&self, simd: S, twist: [Lanes<S>; 3]) -> Mask<S> {
        let mut roll = self.safe_lanes(simd, twist);
        if !self.banks.is_empty() {
            let none = self.clear_slips(simd, twist)[0];
            for bank in 0..self.banks.len() {
                roll = roll & self.bank_slip(simd, bank, twist).le(none);
            }
        }
        roll
    }

    /// Speed at which the unsteered wheels of a bank slide sideways [m/s].
    #[inline(always)]
    pub(crate) fn bank_slip<S: Simd>(&self, simd: S, bank: usize, twist: [Lanes<S>; 3]) -> Lanes<S> {
        dot(simd, &self.banks[bank], twist).abs()
    }

    /// Slips that are well inside the tolerance, and well outside it [m/s].
    #[inline(always)]
    fn clear_slips<S: Vector>(&self, simd: S, [vx, vy, omega]: [Lanes<S>; 3]) -> [Lanes<S>; 2] {
        let splat = |number| Lanes::splat(simd, number);
        let mut least = splat(0.0);
        for [x, y] in self.pivots {
            let (ux, uy) = (vx - omega * splat(y), vy + omega * splat(x));
            least = least.max(ux.abs() + uy.abs());
        }
        let most = vx.abs() + vy.abs() + omega.abs() * splat(self.arm);
        [least * splat(CLEAR[0] * SLIP_TOLERANCE), most * splat(CLEAR[1] * SLIP_TOLERANCE)]
    }

    /// Upper bound of the speed of every pivot and contact, within a factor of two [m/s], and the lanes in which the
    /// twist and all wheel speeds are finite.
    #[inline(always)]
    pub(crate) fn fastest<S: Vector>(
        &self,
        simd: S,
        [vx, vy, omega]: [Lanes<S>; 3],
        rates: Rates<'_>,
    ) -> (Lanes<S>, Mask<S>) {
        let splat = |number| Lanes::splat(simd, number);
        let turn_rate = omega.abs() + rates.largest(simd);
        let mut fastest = splat(0.0);
        for [x, y, offset] in &self.contacts {
            let (ux, uy) = (vx - omega * splat(*y), vy + omega * splat(*x));
            fastest = fastest.max(ux.abs() + uy.abs() + splat(*offset) * turn_rate);
        }
        let largest = splat(f64::MAX);
        let is_finite = vx.abs().le(largest) & vy.abs().le(largest) & omega.abs().le(largest);
        // Bound of every wheel speed, with a factor of two as a margin [rad/s].
        let speed = (fastest + fastest) / splat(self.min_radius);
        (fastest, is_finite & speed.le(largest))
    }
}

/// Decision by the slip of every wheel at the angle that it would be steered to, in the lanes that are neither `yes`
/// nor `no`.
struct ByDefinition<'a, S: Simd> {
    cone: &'a AdmissibleCone,
    twist: [Lanes<S>; 3],
    rates: Rates<'a>,
    yes: Mask<S>,
    no: Mask<S>,
}

impl<S: Vector> LevelKernel<S> for ByDefinition<'_, S> {
    type Output = Admissibility<S>;

    #[inline(always)]
    fn run_at_level(self, simd: S) -> Admissibility<S> {
        let Self { cone, twist: [vx, vy, omega], rates, yes, no } = self;
        let zero = Lanes::splat(simd, 0.0);
        // Slips and speeds are in proportion to the twist, where no joint turns: tiny twists are scaled to keep their
        // digits.
        let is_tiny = (vx.abs() + vy.abs() + omega.abs()).lt(Lanes::splat(simd, MIN_SQUARABLE));
        let is_tiny = is_tiny & rates.largest(simd).le(zero);
        let scale = is_tiny.select(Lanes::splat(simd, SCALE[0]), Lanes::splat(simd, 1.0));
        let twist = [vx * scale + zero, vy * scale, omega * scale];
        let (fastest, is_valid) = cone.fastest(simd, twist, rates);
        let tolerance = fastest * Lanes::splat(simd, SLIP_TOLERANCE);
        let mut is_possible = is_valid;
        for bank in 0..cone.banks.len() {
            is_possible = is_possible & cone.bank_slip(simd, bank, twist).le(tolerance);
        }
        for wheel in &cone.limited {
            is_possible = is_possible & wheel.slip(simd, twist, rates)[1].le(tolerance);
        }
        Admissibility { is_possible: yes | (!no & is_possible), is_valid: yes | no | is_valid }
    }
}

#[inline_always]
impl LimitedWheel {
    /// The angle that the wheel would be steered to from angle 0 [rad], and the side slip there [m/s]; 0 inside the
    /// range of a wheel without trail.
    pub fn slip<S: Vector>(&self, simd: S, twist: [Lanes<S>; 3], rates: Rates<'_>) -> [Lanes<S>; 2] {
        let wheel = self.constants.broadcast(simd);
        let rounding = Lanes::splat(simd, f64::INFINITY);
        let query = WheelQuery { twist, rounding, previous: None, rate: rates.of(simd, self.joint) };
        let first = wheel.first_solution(simd, &query);
        let angle = wheel.solve(simd, &query, &first, None).angle;
        let slip = wheel.side_slip(simd, &query, &first, angle).abs();
        let [lower, upper] = wheel.range;
        let is_at_end = angle.le(lower) | upper.le(angle);
        let slip = if self.wedge.is_none() { slip } else { is_at_end.select(slip, Lanes::splat(simd, 0.0)) };
        [angle, slip]
    }

    /// True where the wheel slides by at most `none` [m/s], well inside the tolerance.
    fn is_clearly_within<S: Vector>(&self, simd: S, twist: [Lanes<S>; 3], rates: Rates<'_>, none: Lanes<S>) -> Mask<S> {
        match &self.wedge {
            Some(wedge) => wedge.overshoot(simd, twist).le(none),
            None => self.has_solution_in_range(simd, twist, rates),
        }
    }

    /// True where the wheel slides by more than `some` [m/s], well outside the tolerance.
    fn is_clearly_outside<S: Vector>(&self, simd: S, twist: [Lanes<S>; 3], some: Lanes<S>) -> Mask<S> {
        match &self.wedge {
            Some(wedge) => some.lt(wedge.overshoot(simd, twist)),
            None => Mask::splat(simd, false),
        }
    }

    /// Lanes in which a wheel with trail has an angle without side slip in its range: the slips at the two ends have
    /// different signs, or one is far below the tolerance.
    fn has_solution_in_range<S: Vector>(&self, simd: S, twist: [Lanes<S>; 3], rates: Rates<'_>) -> Mask<S> {
        let splat = |number| Lanes::splat(simd, number);
        let wheel = self.constants.broadcast(simd);
        let [x, y] = wheel.velocity(twist);
        let square = x.mul_add(x, y * y);
        let turn_rate = rates.of(simd, self.joint).map_or(twist[2], |rate| twist[2] + rate);
        let side = wheel.trail * turn_rate;
        let along = (-side).mul_add(side, square);
        let none = along * splat(SAFE_OVERSHOOT * SAFE_OVERSHOOT);
        let slip = |end: Direction| (y * splat(end.cos) - x * splat(end.sin)) - side;
        let [first, last] = [slip(self.constants.ends[0]), slip(self.constants.ends[1])];
        let is_held = (first * last).lt(splat(0.0)) | (first * first).le(none) | (last * last).le(none);
        is_held & (splat(MIN_ALONG * MIN_ALONG) * square).le(along) & !wheel.is_at_rest(twist)
    }
}

impl Rates<'_> {
    fn are_given(self) -> bool {
        match self {
            Self::Columns(columns, _) => !columns.is_empty(),
            Self::Row(rates) => !rates.is_empty(),
        }
    }

    /// Rate of a joint, if there are any.
    #[inline(always)]
    fn of<S: Vector>(self, simd: S, joint: usize) -> Option<Lanes<S>> {
        match self {
            Self::Columns(columns, k) => columns.get(joint).map(|column| column.load(simd, k)),
            Self::Row(rates) => rates.get(joint).map(|rate| Lanes::splat(simd, *rate)),
        }
    }

    /// The largest absolute rate; 0 without any.
    #[inline(always)]
    fn largest<S: Vector>(self, simd: S) -> Lanes<S> {
        let mut largest = Lanes::splat(simd, 0.0);
        let mut joint = 0;
        while let Some(rate) = self.of(simd, joint) {
            largest = largest.max(rate.abs());
            joint += 1;
        }
        largest
    }
}

impl SteeringWedge {
    /// Side slip of the wheel at the nearer end of its range; negative inside it [m/s].
    #[inline(always)]
    fn overshoot<S: Simd>(&self, simd: S, twist: [Lanes<S>; 3]) -> Lanes<S> {
        let along = dot(simd, &self.along, twist).abs();
        let across = dot(simd, &self.across, twist).abs();
        across * Lanes::splat(simd, self.half.cos) - along * Lanes::splat(simd, self.half.sin)
    }
}
