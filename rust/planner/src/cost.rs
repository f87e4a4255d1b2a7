//! Costs of a rollout by its poses: the map under the rover, the distance to the goal, the path.

use std::ops::Range;

use super::costmap::Costmap;
use crate::motion::drive::TRACK;
use crate::numbers::BLOCK;
use six_wheel_kinematics::geometry::Direction;
use six_wheel_numerics::simd::float::Float;
use six_wheel_numerics::simd::lanes::{Lanes, Mask};
use six_wheel_numerics::simd::vector::Vector;

/// Largest number of points of a path.
const POINTS: usize = 4096;

/// A path as points at equal distances: each with the direction to the next one.
#[derive(Clone, Debug, Default)]
pub(crate) struct Path {
    /// Points x, y [m] and unit directions.
    points: Vec<[f64; 4]>,
    /// Distance between points [m].
    spacing: f64,
    /// Length of the path [m].
    length: f64,
}

impl Path {
    /// Samples the polygon of these corners [m], at most half a metre and a thousandth of its length apart; segments of
    /// length 0 are left out.
    pub fn set_corners(&mut self, corners: &[[f64; 2]]) {
        self.points.clear();
        let span = |pair: &[[f64; 2]]| (pair[1][0] - pair[0][0]).hypot(pair[1][1] - pair[0][1]);
        self.length = corners.windows(2).map(span).sum();
        let least = corners.windows(2).map(span).filter(|span| *span > 0.0).fold(f64::INFINITY, f64::min);
        if self.length == 0.0 {
            return;
        }
        let pieces = (self.length / least.min(0.5)).ceil().clamp(1.0, (POINTS - 1) as f64);
        self.spacing = self.length / pieces;
        let (mut at, mut k) = (0.0, 0);
        for piece in 0..=pieces as usize {
            let along = piece as f64 * self.spacing;
            while k + 2 < corners.len() && at + span(&corners[k..k + 2]) < along {
                at += span(&corners[k..k + 2]);
                k += 1;
            }
            let (from, to) = (corners[k], corners[k + 1]);
            let length = span(&corners[k..k + 2]);
            let share = if length > 0.0 { ((along - at) / length).min(1.0) } else { 0.0 };
            self.points.push([from[0] + share * (to[0] - from[0]), from[1] + share * (to[1] - from[1]), 1.0, 0.0]);
        }
        for k in 0..self.points.len() {
            let (a, b) = if k + 1 < self.points.len() { (k, k + 1) } else { (k - 1, k) };
            let [dx, dy] = [self.points[b][0] - self.points[a][0], self.points[b][1] - self.points[a][1]];
            let length = dx.hypot(dy);
            let (dx, dy) = if length > 0.0 { (dx / length, dy / length) } else { (1.0, 0.0) };
            (self.points[k][2], self.points[k][3]) = (dx, dy);
        }
    }

    pub fn length(&self) -> f64 {
        self.length
    }

    pub fn is_empty(&self) -> bool {
        self.points.is_empty()
    }

    /// Arc length of the path's point nearest to a position, searched from `from` to `to` [m].
    pub fn nearest(&self, place: [f64; 2], from: f64, to: f64) -> f64 {
        let mut best = (f64::INFINITY, from.clamp(0.0, self.length));
        for (k, [x, y, tx, ty]) in self.points.iter().enumerate() {
            let begin = k as f64 * self.spacing;
            if begin + self.spacing < from || begin > to {
                continue;
            }
            let along = (place[0] - x) * tx + (place[1] - y) * ty;
            let along = along.clamp(0.0, self.spacing).min(self.length - begin);
            let distance = (place[0] - x - along * tx).hypot(place[1] - y - along * ty);
            if distance < best.0 {
                best = (distance, begin + along);
            }
        }
        best.1
    }
}

/// Weights of the costs, per second, and once at the end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Weights {
    /// Cost of the map under the rover [1/s].
    pub map: f64,
    /// Cost of a rollout that reaches a lethal position, once.
    pub collision: f64,
    /// Distance to the goal [1/(m s)], and at the end [1/m].
    pub goal: f64,
    /// See `goal`.
    pub terminal: f64,
    /// One less the cosine between the yaw at the end and that of the goal, shared by 1 + distance to the goal / 1 m; once.
    pub goal_yaw: f64,
    /// Distance from the path [1/(m s)].
    pub path: f64,
    /// Gain of arc length along the path, subtracted [1/m].
    pub progress: f64,
    /// Square of the sine between the rover's heading and the path [1/s].
    pub heading: f64,
    /// Mean square speed of the wheels' pivots [1/(m²/s)].
    pub effort: f64,
    /// Square of the speed at which fixed wheels slide [1/(m²/s)].
    pub scrub: f64,
}

impl Default for Weights {
    fn default() -> Self {
        Self {
            map: 1.0,
            collision: 1000.0,
            goal: 1.0,
            terminal: 10.0,
            goal_yaw: 10.0,
            path: 5.0,
            progress: 10.0,
            heading: 1.0,
            effort: 0.0,
            scrub: 1.0,
        }
    }
}

array_of_fields! { Weights: map, collision, goal, terminal, goal_yaw, path, progress, heading, effort, scrub }

/// The first `N` of x, y [m], cosine and sine of the heading, of some rollouts at a step of a track.
#[inline(always)]
fn quantities<S: Vector, R: Float, const N: usize>(simd: S, step: &[R], at: usize) -> [Lanes<S, R>; N] {
    let mut quantities = [Lanes::constant(simd, 0.0); N];
    for (k, quantity) in quantities.iter_mut().enumerate() {
        *quantity = Lanes::from_slice(simd, &step[k * BLOCK + at..]);
    }
    quantities
}

/// Terms of the costs of a cycle, positions counted from its start.
pub(crate) struct CostTerms<'a, R> {
    pub map: Option<&'a Costmap>,
    /// Points of the rover where the map is read, in the components' axes [m].
    pub points: &'a [[f64; 2]],
    /// Position of the rover at the start, from which positions are counted [m].
    pub start: [f64; 2],
    /// Position of the goal [m].
    pub goal: Option<[f64; 2]>,
    /// Cosine and sine of the heading to have at the goal.
    pub goal_heading: Option<[f64; 2]>,
    /// Points of the path with their directions, their spacing, its length, and the rover's arc length on it [m].
    pub path: &'a [[R; 4]],
    pub spacing: f64,
    pub length: f64,
    pub progress: f64,
    pub weights: Weights,
    pub dt: f64,
}

#[inline_always]
impl<R: Float> CostTerms<'_, R> {
    /// Adds the costs of the poses of some rollouts of a block to `costs`.
    pub fn add<S: Vector>(&self, simd: S, track: &[R], costs: &mut [R], rollouts: Range<usize>) {
        for at in rollouts.step_by(R::lanes::<S>()) {
            let mut sum = Lanes::<S, R>::from_slice(simd, &costs[at..]);
            if let Some(map) = self.map {
                sum = self.under(simd, map, track, at, sum);
            }
            if let Some(goal) = self.goal {
                sum = self.to_goal(simd, goal, track, at, sum);
            }
            if !self.path.is_empty() {
                sum = self.along(simd, track, at, sum);
            }
            sum.copy_to_slice(&mut costs[at..]);
        }
    }

    fn to_goal<S: Vector>(&self, simd: S, goal: [f64; 2], track: &[R], at: usize, mut sum: Lanes<S, R>) -> Lanes<S, R> {
        let number = |value: f64| Lanes::<S, R>::constant(simd, value);
        let (gx, gy) = (number(goal[0] - self.start[0]), number(goal[1] - self.start[1]));
        let one = number(1.0);
        let mut distance = number(0.0);
        let weight = number(self.weights.goal * self.dt);
        for step in track.chunks_exact(TRACK * BLOCK) {
            let [x, y] = quantities(simd, step, at);
            let (x, y): (Lanes<S, R>, Lanes<S, R>) = (x - gx, y - gy);
            [_, distance] = x.mul_add(x, y * y).roots();
            sum = distance.mul_add(weight, sum);
        }
        let sum = distance.mul_add(number(self.weights.terminal), sum);
        let Some(([cos, sin], end)) = self.goal_heading.zip(track.chunks_exact(TRACK * BLOCK).next_back()) else {
            return sum;
        };
        let [_, _, c, s] = quantities(simd, end, at);
        let turned = one - c.mul_add(number(cos), s * number(sin));
        (turned / (one + distance)).mul_add(number(self.weights.goal_yaw), sum)
    }

    fn under<S: Vector>(&self, simd: S, map: &Costmap, track: &[R], at: usize, mut sum: Lanes<S, R>) -> Lanes<S, R> {
        let number = |value: f64| Lanes::<S, R>::constant(simd, value);
        let zero = number(0.0);
        let weight = number(self.weights.map * self.dt);
        let mut hit = Mask::splat(simd, false);
        let mut worst_of_all = zero;
        let lethal = number(map.lethal().unwrap_or(f64::INFINITY));
        for step in track.chunks_exact(TRACK * BLOCK) {
            let [x, y] = quantities(simd, step, at);
            for (k, point) in self.points.iter().enumerate() {
                let (mut px, mut py) = (x, y);
                if *point != [0.0; 2] {
                    let (ux, uy) = (number(point[0]), number(point[1]));
                    let [_, _, c, s] = quantities(simd, step, at);
                    px = c.mul_add(ux, px) - s * uy;
                    py = s.mul_add(ux, py) + c * uy;
                }
                let value = self.between(simd, map, px, py);
                worst_of_all = if k == 0 { value } else { worst_of_all.max(value) };
            }
            hit = hit | !worst_of_all.lt(lethal);
            sum = worst_of_all.mul_add(weight, sum);
        }
        hit.select(sum + self.weights.collision, sum)
    }

    /// The map's cost at a position, interpolated bilinearly between cells.
    fn between<S: Vector>(&self, simd: S, map: &Costmap, x: Lanes<S, R>, y: Lanes<S, R>) -> Lanes<S, R> {
        let number = |value: f64| Lanes::<S, R>::constant(simd, value);
        let zero = number(0.0);
        let [rows, columns] = map.shape();
        let [dx, dy] = map.placement().spacing();
        let Direction { sin, cos } = map.placement().turn();
        let [column, row] = map.placement().grid_from_world(self.start[0], self.start[1]);
        let fx = x.mul_add(number(cos / dx), y.mul_add(number(sin / dx), number(column)));
        let fy = y.mul_add(number(cos / dy), x.mul_add(number(-sin / dy), number(row)));
        let (right, top) = (number((columns - 1) as f64), number((rows - 1) as f64));
        let inside = [fx.max(zero).min(right), fy.max(zero).min(top)];
        let whole =
            [inside[0].floor().min(number((columns - 2) as f64)), inside[1].floor().min(number((rows - 2) as f64))];
        let [tx, ty] = [inside[0] - whole[0], inside[1] - whole[1]];
        // SAFETY: `max` and `min` have clamped every position, also NaN, to cells whose neighbours are on the map.
        let [low, high] = unsafe { Lanes::corners(simd, map.values(), columns, whole) };
        let low = tx.mul_add(low[1] - low[0], low[0]);
        let high = tx.mul_add(high[1] - high[0], high[0]);
        let mut value = ty.mul_add(high - low, low);
        if let Some(outside) = map.outside() {
            let beyond = fx.lt(zero) | fy.lt(zero) | right.lt(fx) | top.lt(fy);
            value = beyond.select(number(outside), value);
        }
        value
    }

    /// Adds the costs of the path. The arc length of the point next to the rollout is updated at every step by the
    /// projection onto the path's direction at the last one.
    fn along<S: Vector>(&self, simd: S, track: &[R], at: usize, mut sum: Lanes<S, R>) -> Lanes<S, R> {
        let number = |value: f64| Lanes::<S, R>::constant(simd, value);
        let lanes = R::lanes::<S>();
        let (zero, length, spacing) = (number(0.0), number(self.length), number(self.spacing));
        let per_spacing = number(1.0 / self.spacing);
        let last = number((self.path.len() - 1) as f64);
        let weight = number(self.weights.path * self.dt);
        let askew = number(self.weights.heading * self.dt);
        let begin = number(self.progress);
        let mut place = begin;
        for step in track.chunks_exact(TRACK * BLOCK) {
            let [x, y, c, s] = quantities(simd, step, at);
            let whole = (place * per_spacing).floor().min(last);
            let mut index = [R::default(); BLOCK];
            whole.as_index().copy_to_slice(&mut index);
            let mut columns = [R::default(); TRACK * BLOCK];
            for lane in 0..lanes {
                let point = self.path[index[lane].to_index()];
                for (column, part) in columns.chunks_exact_mut(BLOCK).zip(point) {
                    column[lane] = part;
                }
            }
            let [px, py, tx, ty] = quantities(simd, &columns, 0);
            let (dx, dy) = (x - px, y - py);
            let desired = dx.mul_add(tx, dy * ty) + whole * spacing;
            place = desired.max(zero).min(length);
            let across = c * ty - s * tx;
            sum = (across * across).mul_add(askew, sum);
            let (beyond, aside) = (desired - place, dx * ty - dy * tx);
            let mut off = aside.abs();
            let is_beyond = zero.lt(beyond.abs());
            if is_beyond.any() {
                let [_, root] = aside.mul_add(aside, beyond * beyond).roots();
                off = is_beyond.select(root, off);
            }
            sum = off.mul_add(weight, sum);
        }
        (begin - place).mul_add(number(self.weights.progress), sum)
    }
}

impl Path {
    /// The points in another precision, relative to a position.
    pub fn write<R: Float>(&self, start: [f64; 2], to: &mut Vec<[R; 4]>) {
        to.clear();
        to.extend(self.points.iter().map(|[x, y, tx, ty]| [x - start[0], y - start[1], *tx, *ty].map(R::from_f64)));
    }

    pub fn spacing(&self) -> f64 {
        self.spacing
    }
}
