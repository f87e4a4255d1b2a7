//! A chain in lanes, one pose in each: where its wheels are, how the gaps change with the state, Newton's step.
//!
//! What [`Chain::place`] and [`super::newton`] do for one pose, for chains whose parts turn about the axes of
//! their parents and which have as many wheels as numbers that the ground decides. Everything is in the axes of
//! the grid [m], so that its orientation is part of the yaw.

use crate::suspension::{Chain, Differential, MAX_FREE, MAX_PARTS, MAX_STATE, MAX_WHEELS, Turning};
use six_wheel_numerics::simd::lanes::{Lanes, Mask};
use six_wheel_numerics::simd::polynomials::direction;
pub(crate) use six_wheel_numerics::simd::vec3::{Vec3 as Vectors, dot};
use six_wheel_numerics::simd::vec3::{add as sum, cross, sub as less};
use six_wheel_numerics::simd::vector::Vector;

/// The angle that turns a part.
#[derive(Clone, Copy, Debug)]
enum Turn {
    /// A free angle, forwards or backwards.
    Free(usize, f64),
    /// A steering angle.
    Steering(usize),
}

/// A part that turns about the axis with this number of its parent.
#[derive(Clone, Copy, Debug)]
struct Link {
    parent: Option<usize>,
    origin: [f64; 3],
    axis: usize,
    turn: Turn,
}

/// A wheel on its part.
#[derive(Clone, Copy, Debug)]
struct Wheel {
    part: Option<usize>,
    centre: [f64; 3],
    radius: f64,
}

/// A joint that moves a wheel.
#[derive(Clone, Copy, Debug)]
struct Mover {
    part: usize,
    joint: usize,
    sign: f64,
}

/// Constants of a chain for lanes.
#[derive(Clone, Debug)]
pub(crate) struct ChainConstants {
    parts: Vec<Link>,
    wheels: Vec<Wheel>,
    /// Of every wheel.
    movers: Vec<Vec<Mover>>,
    /// The columns of the system in the order of elimination, each with the wheels it is not 0 for.
    columns: Vec<(usize, u32)>,
}

impl ChainConstants {
    /// None for chains that are not for lanes. Without steering, knuckles are part of what carries them.
    pub fn new(chain: &Chain, steered: bool) -> Option<Self> {
        if chain.wheels().len() != chain.state_count() {
            return None;
        }
        let mut plan = Self { parts: Vec::new(), wheels: Vec::new(), movers: Vec::new(), columns: Vec::new() };
        // Where a part went, and how far its origin lies from the origin of that.
        let mut places: Vec<(Option<usize>, [f64; 3])> = Vec::new();
        for part in chain.parts() {
            let (parent, offset) = part.parent.map_or((None, [0.0; 3]), |k| places[k]);
            let origin = std::array::from_fn(|k| offset[k] + part.origin[k]);
            let turn = match part.turning {
                Turning::Free(joint) => Turn::Free(joint, 1.0),
                Turning::Across(joint, Differential::Gear) => Turn::Free(joint, -1.0),
                Turning::Across(_, Differential::Bar { .. }) => return None,
                Turning::Steering(_) if !steered => {
                    places.push((parent, origin));
                    continue;
                }
                Turning::Steering(joint) => Turn::Steering(joint),
            };
            let unit = |axis: &usize| (0..3).all(|k| part.axis[k] == f64::from(k == *axis));
            let axis = (0..3).find(unit)?;
            places.push((Some(plan.parts.len()), [0.0; 3]));
            plan.parts.push(Link { parent, origin, axis, turn });
        }
        for wheel in chain.wheels() {
            let (part, offset) = wheel.part.map_or((None, [0.0; 3]), |k| places[k]);
            plan.wheels.push(Wheel {
                part,
                centre: std::array::from_fn(|k| offset[k] + wheel.centre[k]),
                radius: wheel.radius,
            });
            let carriers = std::iter::successors(part, |&part| plan.parts[part].parent);
            let movers = carriers.filter_map(|part| match plan.parts[part].turn {
                Turn::Free(joint, sign) => Some(Mover { part, joint, sign }),
                Turn::Steering(_) => None,
            });
            plan.movers.push(movers.collect());
        }
        let all = (1_u32 << plan.wheels.len()) - 1;
        plan.columns = (0..chain.state_count())
            .map(|k| {
                let moved = |wheel: usize| plan.movers[wheel].iter().any(|by| 3 + by.joint == k);
                let wheels = (0..plan.wheels.len()).filter(|&wheel| moved(wheel));
                let wheels = wheels.fold(0, |bits, wheel| bits | 1 << wheel);
                (k, if k < 3 { all } else { wheels })
            })
            .collect();
        plan.columns.sort_by_key(|(_, wheels)| wheels.count_ones());
        Some(plan)
    }

    #[inline]
    pub fn wheels(&self) -> usize {
        self.wheels.len()
    }

    #[inline]
    pub fn radius(&self, wheel: usize) -> f64 {
        self.wheels[wheel].radius
    }
}

/// Columns of a rotation, and a point that it carries [m], from the origin of the body.
#[derive(Clone, Copy)]
struct Frame<S: Vector> {
    columns: [Vectors<S>; 3],
    origin: Vectors<S>,
}

impl<S: Vector> Frame<S> {
    #[inline(always)]
    fn point(&self, simd: S, local: [f64; 3]) -> Vectors<S> {
        let mut point = self.origin;
        for (column, length) in self.columns.iter().zip(local) {
            let length = Lanes::splat(simd, length);
            for k in 0..3 {
                point[k] = column[k].mul_add(length, point[k]);
            }
        }
        point
    }
}

/// A wheel in lanes: its centre from the origin of the body [m], forward and upward axis.
#[derive(Clone, Copy)]
pub(crate) struct WheelAt<S: Vector> {
    pub centre: Vectors<S>,
    pub forward: Vectors<S>,
    pub up: Vectors<S>,
}

/// The chain in lanes.
pub(crate) struct Placing<'a, S: Vector> {
    plan: &'a ChainConstants,
    roll_axis: Vectors<S>,
    pitch_axis: Vectors<S>,
    /// Axes about which the parts turn.
    axes: [Vectors<S>; MAX_PARTS],
    origins: [Vectors<S>; MAX_PARTS],
    pub wheels: [WheelAt<S>; MAX_WHEELS],
}

/// Sine and cosine.
pub(crate) type Turned<S> = (Lanes<S>, Lanes<S>);

impl<'a, S: Vector> Placing<'a, S> {
    #[inline(always)]
    pub fn new(
        simd: S,
        plan: &'a ChainConstants,
        yaw: Turned<S>,
        state: &[Lanes<S>; MAX_STATE],
        steering: &[Turned<S>; MAX_WHEELS],
    ) -> Self {
        let zero = Lanes::splat(simd, 0.0);
        let (sy, cy) = yaw;
        let (sr, cr) = direction(simd, state[1]);
        let (sp, cp) = direction(simd, state[2]);
        let body = Frame {
            columns: [
                [cy * cp, sy * cp, -sp],
                [cy * sp * sr - sy * cr, sy * sp * sr + cy * cr, cp * sr],
                [cy * sp * cr + sy * sr, sy * sp * cr - cy * sr, cp * cr],
            ],
            origin: [zero; 3],
        };
        let mut free = [(zero, zero); MAX_FREE];
        for (joint, turned) in free.iter_mut().enumerate() {
            *turned = direction(simd, state[3 + joint]);
        }
        let mut frames = [body; MAX_PARTS];
        let mut axes = [[zero; 3]; MAX_PARTS];
        let mut origins = axes;
        for (k, part) in plan.parts.iter().enumerate().take(MAX_PARTS) {
            // Written where it stays: a frame is as large as twelve registers.
            let (before, rest) = frames.split_at_mut(k);
            let parent = match part.parent {
                Some(parent) => &before[parent],
                None => &body,
            };
            let frame = &mut rest[0];
            let (sin, cos) = match part.turn {
                Turn::Free(joint, sign) => (free[joint].0 * Lanes::splat(simd, sign), free[joint].1),
                Turn::Steering(joint) => steering[joint],
            };
            let (first, second) = ((part.axis + 1) % 3, (part.axis + 2) % 3);
            let (a, b) = (parent.columns[first], parent.columns[second]);
            frame.columns[part.axis] = parent.columns[part.axis];
            for i in 0..3 {
                frame.columns[first][i] = a[i] * cos + b[i] * sin;
                frame.columns[second][i] = b[i] * cos - a[i] * sin;
            }
            frame.origin = parent.point(simd, part.origin);
            axes[k] = parent.columns[part.axis];
            origins[k] = frame.origin;
        }
        let nowhere = WheelAt { centre: [zero; 3], forward: [zero; 3], up: [zero; 3] };
        let mut wheels = [nowhere; MAX_WHEELS];
        for (at, wheel) in wheels.iter_mut().zip(&plan.wheels) {
            let frame = wheel.part.map_or(&body, |part| &frames[part]);
            *at = WheelAt { centre: frame.point(simd, wheel.centre), forward: frame.columns[0], up: frame.columns[2] };
        }
        Self { plan, roll_axis: body.columns[0], pitch_axis: [-sy, cy, zero], axes, origins, wheels }
    }

    /// Derivatives of the gap of a wheel by the state, at a point of its rim over ground with this gradient.
    #[inline(always)]
    pub fn slopes(&self, simd: S, wheel: usize, point: Vectors<S>, gradient: [Lanes<S>; 2]) -> [Lanes<S>; MAX_STATE] {
        let (zero, unit) = (Lanes::splat(simd, 0.0), Lanes::splat(simd, 1.0));
        let upwards = [-gradient[0], -gradient[1], unit];
        let moment = cross(point, upwards);
        let mut slopes = [zero; MAX_STATE];
        slopes[0] = unit;
        slopes[1] = dot(self.roll_axis, moment);
        slopes[2] = dot(self.pitch_axis, moment);
        for mover in &self.plan.movers[wheel] {
            let arm = less(point, self.origins[mover.part]);
            let slope = dot(self.axes[mover.part], cross(arm, upwards));
            slopes[3 + mover.joint] = Lanes::splat(simd, mover.sign).mul_add(slope, slopes[3 + mover.joint]);
        }
        slopes
    }

    /// A point of a rim at this distance from its wheel's centre.
    #[inline(always)]
    pub fn rim(&self, wheel: usize, spoke: Vectors<S>) -> Vectors<S> {
        sum(self.wheels[wheel].centre, spoke)
    }
}

/// The system whose solution is Newton's step: a row of slopes for every wheel, and on its right what is missing.
pub(crate) type Rows<S> = [([Lanes<S>; MAX_STATE], Lanes<S>); MAX_WHEELS];

/// Solves by elimination with row exchanges, lane by lane. Where it is singular the numbers are not finite, or huge.
#[inline(always)]
pub(crate) fn solve<S: Vector>(simd: S, plan: &ChainConstants, rows: &mut Rows<S>) -> [Lanes<S>; MAX_STATE] {
    let mut left = (1_u32 << plan.wheels.len()) - 1;
    let mut pivots = [0; MAX_STATE];
    for (step, (column, wheels)) in plan.columns.iter().enumerate() {
        // Earlier columns are 0 or gone in all rows that are left; theirs filled no place that was 0 in this one
        // unless that is full anyway.
        let those = left & wheels;
        let pivot = those.trailing_zeros() as usize % MAX_WHEELS;
        pivots[step] = pivot;
        left &= !(1 << pivot);
        let rest = those & left;
        for row in (0..plan.wheels.len()).filter(|row| rest >> row & 1 == 1) {
            let larger = rows[pivot].0[*column].abs().below(rows[row].0[*column].abs());
            for k in 0..MAX_STATE {
                exchange(larger, rows, [pivot, row], |row| &mut row.0[k]);
            }
            exchange(larger, rows, [pivot, row], |row| &mut row.1);
        }
        let inverse = Lanes::splat(simd, 1.0).quotient(rows[pivot].0[*column]);
        for row in (0..plan.wheels.len()).filter(|row| rest >> row & 1 == 1) {
            let factor = -(rows[row].0[*column] * inverse);
            for (after, _) in &plan.columns[step + 1..] {
                rows[row].0[*after] = factor.mul_add(rows[pivot].0[*after], rows[row].0[*after]);
            }
            rows[row].1 = factor.mul_add(rows[pivot].1, rows[row].1);
        }
    }
    let mut solution = [Lanes::splat(simd, 0.0); MAX_STATE];
    for (step, (column, _)) in plan.columns.iter().enumerate().rev() {
        let (row, mut right) = rows[pivots[step]];
        for (after, _) in &plan.columns[step + 1..] {
            right = right - row[*after] * solution[*after];
        }
        solution[*column] = right.quotient(row[*column]);
    }
    solution
}

/// Swaps a number of two rows where the mask says.
#[inline(always)]
fn exchange<S: Vector>(
    mask: Mask<S>,
    rows: &mut Rows<S>,
    [a, b]: [usize; 2],
    number: impl Fn(&mut ([Lanes<S>; MAX_STATE], Lanes<S>)) -> &mut Lanes<S>,
) {
    let (first, second) = (*number(&mut rows[a]), *number(&mut rows[b]));
    *number(&mut rows[a]) = mask.select(second, first);
    *number(&mut rows[b]) = mask.select(first, second);
}
