//! The readings of one instant: the lanes of a register are the wheels.

use crate::estimate::Measured;
use crate::geometry::Twist;
use crate::kernels::readings::{LARGEST_ROVER, LARGEST_SPEED};
use crate::kernels::wheel_lanes::{Eight, GROUP, level, order, padded};
use crate::rover_data::{Mount, RoverData};
use crate::wheels::Wheel;
use six_wheel_numerics::simd::lanes::Lanes;
use six_wheel_numerics::simd::level::{Kernel, Level};
use six_wheel_numerics::simd::polynomials::{LARGEST_ANGLE, sin_cos};
use six_wheel_numerics::simd::vector::Vector;

/// Constants of a rover for the forward kernel.
#[derive(Clone, Debug)]
pub(crate) struct ForwardConstants {
    level: Level,
    groups: Vec<Group>,
    order: Vec<usize>,
    /// From the right-hand side of the normal equations to the twist.
    solution: [[f64; 3]; 3],
}

/// Contribution of eight wheels to the right-hand side of the normal equations.
#[derive(Clone, Debug, Default)]
struct Group {
    /// Number of steered wheels among them.
    steered: usize,
    heading: Eight,
    /// Radius and place of a steered wheel, as a lever about the centre of the pivots; 0 for another.
    radius: Eight,
    arm: [Eight; 2],
    /// The row of a wheel that is not steered, to be multiplied by its speed.
    row: [Eight; 3],
}

impl ForwardConstants {
    /// Nothing where the solution depends on the readings, or the machine has no kernel.
    pub fn new(rover: &RoverData) -> Option<Self> {
        let level = level()?;
        let solution = rover.solution?;
        let turned = |wheel: &Wheel| wheel.heading.abs() > LARGEST_ANGLE / 2.0;
        if rover.reading_bound > LARGEST_ROVER || rover.wheels().iter().any(turned) {
            return None;
        }
        let (size, centre, order) = (rover.size, rover.centre, order(rover));
        let mut groups = vec![Group::default(); order.len().div_ceil(GROUP)];
        for (k, &i) in order.iter().enumerate() {
            let (wheel, group, lane) = (&rover.wheels()[i], &mut groups[k / GROUP], k % GROUP);
            match rover.mounts[i] {
                Mount::Castor(_) => {}
                Mount::Fixed(rows) => {
                    let row = rover.shifted(&rows.rolling) * wheel.radius;
                    for (place, number) in group.row.iter_mut().zip(<[f64; 3]>::from(row)) {
                        place[lane] = number;
                    }
                }
                Mount::Steered(..) => {
                    group.steered += 1;
                    group.heading[lane] = wheel.heading;
                    group.radius[lane] = wheel.radius;
                    group.arm[0][lane] = (wheel.x - centre.x) / size;
                    group.arm[1][lane] = (wheel.y - centre.y) / size;
                }
            }
        }
        let omega = solution.row(2) / size;
        let rows = [solution.row(0) + omega * centre.y, solution.row(1) - omega * centre.x, omega];
        Some(Self { level, groups, order, solution: rows.map(|row| [row.x, row.y, row.z]) })
    }

    /// The twist of one instant; nothing where the plain core has to find it.
    #[inline]
    pub fn solve(&self, measured: Measured<'_>) -> Option<Twist> {
        match measured.steering_rates {
            None => self.level.run(Row { plan: self, measured })?,
            Some(_) => None,
        }
    }
}

/// One row. The answer is nothing where a reading is not of a usual size.
struct Row<'a> {
    plan: &'a ForwardConstants,
    measured: Measured<'a>,
}

impl Kernel for Row<'_> {
    type Output = Option<Twist>;

    #[inline(always)]
    fn run<S: Vector>(self, simd: S) -> Option<Twist> {
        let (plan, measured) = (self.plan, self.measured);
        let zero = Lanes::splat(simd, 0.0);
        let largest_angle = Lanes::splat(simd, LARGEST_ANGLE / 2.0);
        let largest_speed = Lanes::splat(simd, LARGEST_SPEED);
        let mut usual = zero.le(zero);
        let [mut x, mut y, mut z] = [zero; 3];
        let mut steering = measured.steering.chunks(S::F64_LANES);
        let mut order = plan.order.chunks(S::F64_LANES);
        for group in &plan.groups {
            for k in 0..GROUP / S::F64_LANES {
                let Some(wheels) = order.next() else { break };
                let load = |numbers: &Eight| Lanes::load(simd, S::as_simd_f64s(numbers).0, k);
                let mut room = [0.0; GROUP];
                for (place, &i) in room.iter_mut().zip(wheels) {
                    *place = measured.speeds.get(i).copied().unwrap_or(f64::NAN);
                }
                let speed = Lanes::load(simd, S::as_simd_f64s(&room).0, 0);
                usual = usual & speed.abs().le(largest_speed);
                let [along, across, moment] = &group.row;
                x = speed.mul_add(load(along), x);
                y = speed.mul_add(load(across), y);
                z = speed.mul_add(load(moment), z);
                if k * S::F64_LANES < group.steered {
                    let angle = padded(simd, steering.next().unwrap_or_default());
                    usual = usual & angle.abs().le(largest_angle);
                    let (sin, cos) = sin_cos(simd, angle + load(&group.heading));
                    let rim_speed = speed * load(&group.radius);
                    let (u, v) = (rim_speed * cos, rim_speed * sin);
                    x = x + u;
                    y = y + v;
                    z = v.mul_add(load(&group.arm[0]), z);
                    z = u.mul_add(-load(&group.arm[1]), z);
                }
            }
        }
        if (!usual).any() {
            return None;
        }
        let [x, y, z] = [x.sum(), y.sum(), z.sum()];
        let twist = plan.solution.map(|[a, b, c]| z.mul_add(c, y.mul_add(b, x * a)));
        Some(Twist::from(twist))
    }
}
