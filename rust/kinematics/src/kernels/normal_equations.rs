//! Normal equations of the twists of a register of readings, and their solution. Forward kinematics, fits and
//! sensitivities use them, for one row as for many.
//!
//! The rows of a steered wheel determine together the velocity of its contact, whichever way it points. Without scrub and
//! trail the contact is the pivot, and the normal equations and their solution are constants of the rover.

use nalgebra::Matrix3;

use super::wheel_lanes::{Eight, GROUP, level};
use super::wheel_rows::{Offset, RowKind, WheelRows};
use crate::rover_data::RoverData;
use crate::table::Log;
use six_wheel_numerics::columns::Column;
use six_wheel_numerics::simd::lanes::{Lanes, Mask};
use six_wheel_numerics::simd::level::Level;
use six_wheel_numerics::simd::polynomials::{LARGEST_ANGLE, sin_cos};
use six_wheel_numerics::simd::vector::Vector;

/// Speeds up to this give a finite twist [rad/s].
pub(crate) const LARGEST_SPEED: f64 = 1e100;

/// Largest [`RoverData::reading_bound`] of rovers whose readings up to [`LARGEST_SPEED`] give a finite twist.
pub const LARGEST_ROVER: f64 = 1e100;

/// Minors solve normal equations without loss of digits if every pivot is above this share of their trace.
const DETERMINED: f64 = 1e-10;

/// Constants of a rover for the kernels of readings.
#[derive(Clone, Debug)]
pub struct ForwardConstants {
    pub(crate) wheels: Vec<WheelRows>,
    pub(crate) joints: usize,
    /// Level of one row.
    pub(crate) level: Level,
    /// Directions of the steered wheels at steering angle 0 [rad].
    pub(crate) headings: Vec<Eight>,
    /// False where every row is one of [`RoverData::forward_rarely`]: the twist is never determined, or sizes are extreme.
    pub(crate) is_regular: bool,
    /// The part of the normal equations that does not depend on the steering angles, `00 01 02 11 12 22`.
    normal: [f64; 6],
    /// Matrix from the right-hand side to the unknowns, if no part of the normal equations depends on them.
    pub(crate) solution: Option<[[f64; 3]; 3]>,
    /// Mean of the pivots [m], and one over their root mean square distance from it [1/m].
    centre: [f64; 2],
    per_size: f64,
}

impl ForwardConstants {
    /// Constants with weight 1 for every wheel.
    pub fn new(rover: &RoverData) -> Self {
        Self::weighted(rover, rover.solution, |_| 1.0)
    }

    /// Constants with weights of 1 or 0, and with the solution of the normal equations, if it is a constant.
    pub fn weighted(rover: &RoverData, solution: Option<Matrix3<f64>>, weight: impl Fn(usize) -> f64) -> Self {
        let wheels: Vec<_> = (0..rover.wheels().len()).map(|i| WheelRows::new(rover, i, weight(i) != 0.0)).collect();
        let mut normal = [0.0; 6];
        for wheel in &wheels {
            for (sum, part) in normal.iter_mut().zip(wheel.normal()) {
                *sum += part;
            }
        }
        let joints = rover.steered().len();
        let mut headings = vec![[0.0; GROUP]; joints.div_ceil(GROUP)];
        for (heading, &i) in headings.as_flattened_mut().iter_mut().zip(rover.steered()) {
            *heading = rover.wheels()[i].heading;
        }
        let has_offset = |i: &usize| !rover.wheels()[*i].is_centred();
        let is_determined = solution.is_some() || rover.steered().iter().any(has_offset);
        Self {
            wheels,
            joints,
            level: level(),
            headings,
            is_regular: is_determined && rover.reading_bound <= LARGEST_ROVER,
            normal,
            solution: solution.map(|solution| [0, 1, 2].map(|k| solution.row(k).transpose().into())),
            centre: rover.centre.into(),
            per_size: 1.0 / rover.size,
        }
    }

    /// Number of columns of steering rates: 0 if none are given or they do not change the twist.
    #[inline]
    pub fn rates(&self, log: Log<'_>) -> usize {
        match (self.solution, log.steering_rates) {
            (None, Some(_)) => self.joints,
            _ => 0,
        }
    }
}

/// Readings in lanes: a row in every lane, or one row.
pub(crate) trait ReadingLanes<'a, S: Vector>: Copy {
    /// Memory of one number per lane.
    type Cell: 'a;

    /// Speeds of the wheels [rad/s].
    fn speeds(self) -> &'a [Self::Cell];

    /// The lanes of a cell.
    fn load(self, simd: S, cell: &Self::Cell) -> Lanes<S>;

    /// Writes the lanes of a cell.
    fn store(self, cell: &mut Self::Cell, lanes: Lanes<S>);

    /// Angle of a steering joint [rad].
    fn angle(self, simd: S, joint: usize) -> Lanes<S>;

    /// Sine and cosine of the direction of its wheel, with this angle and direction at angle 0.
    fn direction(self, simd: S, joint: usize, angle: Lanes<S>, heading: f64) -> [Lanes<S>; 2];

    /// Rate of a steering joint [rad/s], if rates are given and change the twist.
    fn rate(self, simd: S, joint: usize) -> Option<Lanes<S>>;
}

/// Normal equations of a register of readings.
pub(crate) struct Sums<S: Vector> {
    pub normal: [Lanes<S>; 6],
    pub right: [Lanes<S>; 3],
    /// Sum of squares of the rim speeds [m²/s²].
    pub rolling: Lanes<S>,
    /// True where all readings are of a size whose squares neither overflow nor lose digits, none NaN.
    pub is_safe: Mask<S>,
}

#[inline_always]
impl ForwardConstants {
    /// Sums over the wheels. `KEEP`: the readings of each wheel along its rows are written to `kept`, for fits.
    /// `CENTRED`: no steered wheel has scrub or trail; a constant, so that the loop has no branch on it.
    pub(crate) fn sum<'a, S: Vector, R: ReadingLanes<'a, S>, const KEEP: bool, const CENTRED: bool>(
        &self,
        simd: S,
        readings: R,
        kept: &mut [[R::Cell; 2]],
    ) -> Sums<S> {
        let splat = |number| Lanes::splat(simd, number);
        let zero = splat(0.0);
        let [mut x, mut y, mut z] = [zero; 3];
        // Sums of squares: above the bound if one reading is, and NaN if one is.
        let [mut angles, mut rates, mut rolling] = [zero; 3];
        let mut normal = [zero; 6];
        if !CENTRED {
            for (sum, constant) in normal.iter_mut().zip(self.normal) {
                *sum = splat(constant);
            }
        }
        let mut joint = 0;
        for (i, (wheel, speed)) in self.wheels.iter().zip(readings.speeds()).enumerate() {
            let speed = readings.load(simd, speed);
            rates = speed.mul_add(speed, rates);
            let rolled = speed * splat(wheel.radius);
            let mut along_rows = [rolled, zero];
            match wheel.kind {
                RowKind::Fixed if KEEP && !wheel.counts => {}
                RowKind::Fixed => {
                    let [along, _] = &wheel.rows.0;
                    x = rolled.mul_add(splat(along[0]), x);
                    y = rolled.mul_add(splat(along[1]), y);
                    z = rolled.mul_add(splat(along[2]), z);
                }
                RowKind::Steered => {
                    let angle = readings.angle(simd, joint);
                    angles = angle.mul_add(angle, angles);
                    let direction = readings.direction(simd, joint, angle, wheel.heading);
                    let [sin, cos] = direction;
                    let (mut u, mut v) = (rolled * cos, rolled * sin);
                    let mut arm = wheel.arm(simd);
                    if let Some(offset) = wheel.offset
                        && !CENTRED
                    {
                        arm = Offset::offset_point(arm, offset.shares, direction);
                        add_moments(&mut normal, arm);
                        if let Some(rate) = readings.rate(simd, joint) {
                            rates = rate.mul_add(rate, rates);
                            // The steering rate moves the contact about the steering axis: `u + y phi', v - x phi'`.
                            let [x, y] = Offset::offset_point([zero; 2], offset.lengths, direction);
                            (u, v) = (u + y * rate, v - x * rate);
                        }
                    }
                    joint += 1;
                    if !KEEP || wheel.counts {
                        x = x + u;
                        y = y + v;
                        z = v.mul_add(arm[0], z);
                        z = u.mul_add(-arm[1], z);
                    }
                    along_rows = [u, v];
                }
                RowKind::Castor => along_rows = [zero; 2],
            }
            if KEEP {
                let [u, v] = along_rows;
                rolling = u.mul_add(u, v.mul_add(v, rolling));
                readings.store(&mut kept[i][0], u);
                readings.store(&mut kept[i][1], v);
            }
        }
        let [largest_angle, largest_speed] = [LARGEST_ANGLE / 2.0, LARGEST_SPEED].map(|bound| splat(bound * bound));
        let is_safe = rates.le(largest_speed) & angles.le(largest_angle);
        Sums { normal, right: [x, y, z], rolling, is_safe }
    }

    /// The unknowns about the centre of the pivots, and the lanes in which they are determined and all readings safe.
    pub(crate) fn solve<S: Vector, const CENTRED: bool>(&self, simd: S, sums: &Sums<S>) -> ([Lanes<S>; 3], Mask<S>) {
        let splat = |number| Lanes::splat(simd, number);
        if let Some(rows) = &self.solution
            && CENTRED
        {
            let [x, y, z] = sums.right;
            let mut unknowns = [splat(0.0); 3];
            for (unknown, [a, b, c]) in unknowns.iter_mut().zip(rows) {
                let sum = y.mul_add(splat(*b), x * splat(*a));
                *unknown = z.mul_add(splat(*c), sum);
            }
            return (unknowns, sums.is_safe);
        }
        let (unknowns, is_determined) = solve(simd, sums.normal, sums.right);
        (unknowns, sums.is_safe & is_determined)
    }

    /// The normal equations of a register of angles.
    pub fn normal<S: Vector>(&self, simd: S, steering: &[Column], k: usize) -> [Lanes<S>; 6] {
        let splat = |number| Lanes::splat(simd, number);
        let mut normal = [splat(0.0); 6];
        for (sum, constant) in normal.iter_mut().zip(self.normal) {
            *sum = splat(constant);
        }
        let mut joint = 0;
        for wheel in &self.wheels {
            if wheel.kind != RowKind::Steered {
                continue;
            }
            if let Some(offset) = wheel.offset {
                let angle = steering[joint].load(simd, k) + splat(wheel.heading);
                let (sin, cos) = sin_cos(simd, angle);
                add_moments(&mut normal, Offset::offset_point(wheel.arm(simd), offset.shares, [sin, cos]));
            }
            joint += 1;
        }
        normal
    }

    /// The twist of these unknowns about the centre of the pivots.
    pub fn twist_at_origin<S: Vector>(&self, [x, y, z]: [Lanes<S>; 3]) -> [Lanes<S>; 3] {
        let omega = z * self.per_size;
        [x + omega * self.centre[1], y - omega * self.centre[0], omega]
    }
}

/// Adds the moments of a contact at this arm, a share of the rover's size, to the normal equations.
#[inline(always)]
fn add_moments<S: Vector>(normal: &mut [Lanes<S>; 6], [x, y]: [Lanes<S>; 2]) {
    normal[2] = normal[2] - y;
    normal[4] = normal[4] + x;
    normal[5] = x.mul_add(x, y.mul_add(y, normal[5]));
}

/// The solution of normal equations `00 01 02 11 12 22` by minors, and the lanes in which all pivots exceed
/// [`DETERMINED`].
#[inline(always)]
pub(crate) fn solve<S: Vector>(
    simd: S,
    [a, b, c, d, e, f]: [Lanes<S>; 6],
    [x, y, z]: [Lanes<S>; 3],
) -> ([Lanes<S>; 3], Mask<S>) {
    let least = (a + d + f) * DETERMINED;
    // By minors, so that there is one division.
    let (xx, xy, xz) = (d * f - e * e, c * e - b * f, b * e - c * d);
    let (yy, yz, zz) = (a * f - c * c, b * c - a * e, a * d - b * b);
    let whole = a * xx + b * xy + c * xz;
    let share = Lanes::splat(simd, 1.0) / whole;
    let unknowns =
        [(xx * x + xy * y + xz * z) * share, (xy * x + yy * y + yz * z) * share, (xz * x + yz * y + zz * z) * share];
    // Leading minors: each is the product of the pivots up to its own.
    (unknowns, least.lt(a) & (least * a).lt(zz) & (least * zz).lt(whole))
}
