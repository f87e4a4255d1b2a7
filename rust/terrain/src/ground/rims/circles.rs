//! Circles over a grid, one alone or one in every lane, and the cells below them.

use crate::suspension::lanes;
use crate::terrain::{Cell, Heights, Terrain};
use six_wheel_numerics::simd::lanes::{Lanes, Mask};
use six_wheel_numerics::simd::vector::Vector;

/// Circles that are searched together.
pub const RIMS: usize = 8;

/// Larger than any gap [m].
pub const FAR: f64 = 1e30;

/// The numbers of the lanes.
#[inline(always)]
pub fn spread<S: Vector>(lanes: Lanes<S>) -> [f64; RIMS] {
    let mut values = [0.0; RIMS];
    lanes.copy_to_slice(&mut values);
    values
}

/// Cells of the lanes.
pub(crate) type Cells<S> = Cell<Lanes<S>>;

/// The cells with these lowest columns and rows; NaN off the map.
#[inline(always)]
pub(crate) fn cells<S: Vector>(simd: S, ground: &Terrain, column: Lanes<S>, row: Lanes<S>) -> Cells<S> {
    let [rows, columns] = ground.shape();
    let zero = Lanes::splat(simd, 0.0);
    let last = [Lanes::splat(simd, columns as f64 - 2.0), Lanes::splat(simd, rows as f64 - 2.0)];
    let inside = zero.le(column) & zero.le(row) & column.le(last[0]) & row.le(last[1]);
    let place = row.mul_add(Lanes::splat(simd, columns as f64), column);
    let [h00, h10, h01, h11] = match ground.heights() {
        Heights::Double(heights) => place.square(heights, columns),
        Heights::Single(_) => singles(simd, ground, place),
    };
    let (along, across) = (h10 - h00, h01 - h00);
    let twist = (h11 - h10) - across;
    Cell { h00, along, across, twist: inside.select(twist, Lanes::splat(simd, f64::NAN)) }
}

/// Corners of the cells that begin at these places, as near to them as there are any.
#[inline(always)]
fn singles<S: Vector>(simd: S, ground: &Terrain, place: Lanes<S>) -> [Lanes<S>; 4] {
    let [rows, columns] = ground.shape();
    let places = spread(place);
    lanes::columns(simd, |lane| {
        let place = (places[lane] as usize).min((rows - 1) * columns - 2); // NaN is 0
        [0, 1, columns, columns + 1].map(|offset| ground.heights().at(place + offset))
    })
}

/// A circle over a grid: horizontal coordinates in columns and rows, heights in metres. Its points are
/// `centre + forward sin t - up cos t`, with t the contact angle.
#[derive(Clone, Copy, Debug)]
pub struct Circle<T> {
    /// Hub of the wheel.
    pub centre: [T; 3],
    /// Radius times the direction in which the wheel rolls.
    pub forward: [T; 3],
    /// Radius times the direction of its steering axis, upwards.
    pub up: [T; 3],
}

/// One circle.
pub type WheelCircle = Circle<f64>;

/// A circle in every lane.
pub type RimLanes<S> = Circle<Lanes<S>>;

/// A point of every rim: where it is and how it moves along the rim.
#[derive(Clone, Copy)]
pub(crate) struct Point<S: Vector> {
    pub sin: Lanes<S>,
    pub cos: Lanes<S>,
    /// Vector from the centre to the point.
    pub spoke: [Lanes<S>; 3],
    /// Derivative by the contact angle.
    pub tangent: [Lanes<S>; 3],
}

/// Gap, its first three derivatives along the rim, and the slope of the ground.
#[derive(Clone, Copy)]
pub(crate) struct GapDerivatives<S: Vector> {
    pub gap: Lanes<S>,
    pub rise: Lanes<S>,
    pub curvature: Lanes<S>,
    pub third: Lanes<S>,
    pub slope: [Lanes<S>; 2],
}

impl<S: Vector> Point<S> {
    /// `yes` where true, `no` elsewhere.
    #[inline(always)]
    pub(crate) fn pick(mask: Mask<S>, yes: &Self, no: &Self) -> Self {
        let [mut spoke, mut tangent] = [no.spoke, no.tangent];
        for k in 0..3 {
            spoke[k] = mask.select(yes.spoke[k], no.spoke[k]);
            tangent[k] = mask.select(yes.tangent[k], no.tangent[k]);
        }
        Self { sin: mask.select(yes.sin, no.sin), cos: mask.select(yes.cos, no.cos), spoke, tangent }
    }
}

#[inline_always]
impl<S: Vector> Circle<Lanes<S>> {
    /// The circles from this one on, one per lane; lanes without one repeat the last.
    pub fn load(simd: S, circles: &[WheelCircle; RIMS], first: usize) -> Self {
        let circle = |lane: usize| &circles[(first + lane).min(RIMS - 1)];
        Self {
            centre: lanes::columns(simd, |lane| circle(lane).centre),
            forward: lanes::columns(simd, |lane| circle(lane).forward),
            up: lanes::columns(simd, |lane| circle(lane).up),
        }
    }

    /// Rotates the circles by half a turn: the upper halves become the lower ones.
    pub(crate) fn turn_over(&mut self) {
        for k in 0..3 {
            self.forward[k] = -self.forward[k];
            self.up[k] = -self.up[k];
        }
    }

    /// Point of every rim at this sine and cosine of its contact angle.
    pub(crate) fn point(&self, sin: Lanes<S>, cos: Lanes<S>) -> Point<S> {
        let [mut spoke, mut tangent] = [self.centre; 2];
        for k in 0..3 {
            spoke[k] = self.forward[k] * sin - self.up[k] * cos;
            tangent[k] = self.forward[k] * cos + self.up[k] * sin;
        }
        Point { sin, cos, spoke, tangent }
    }

    /// The gap over a cell, with the vector `from` its lowest corner to the centre.
    pub(crate) fn derivatives(&self, cell: &Cells<S>, from: [Lanes<S>; 2], at: &Point<S>) -> GapDerivatives<S> {
        let (a, b) = (from[0] + at.spoke[0], from[1] + at.spoke[1]);
        let across = cell.twist.mul_add(a, cell.across);
        let along = cell.twist.mul_add(b, cell.along);
        let height = across.mul_add(b, cell.along.mul_add(a, cell.h00));
        let [x, y, z] = at.tangent;
        let rise = z - (along * x + across * y);
        let turning = cell.twist * x * y;
        let curvature = (along * at.spoke[0] + across * at.spoke[1] - at.spoke[2]) - (turning + turning);
        let bending = cell.twist * (at.spoke[0] * y + at.spoke[1] * x);
        GapDerivatives {
            third: (bending + bending + bending) - rise,
            gap: (self.centre[2] + at.spoke[2]) - height,
            rise,
            curvature,
            slope: [along, across],
        }
    }
}
