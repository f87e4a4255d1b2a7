//! Circles over a grid, one alone or one in every lane, and the cells below them.

use crate::terrain::{Heights, Terrain};
use six_wheel_numerics::simd::lanes::{Lanes, Mask};
use six_wheel_numerics::simd::vector::Vector;

/// An expression for the indices 0 and 1. A closure would be compiled without the instructions of the level.
macro_rules! both {
    ($k: ident, $value: expr) => {
        [
            {
                let $k = 0;
                $value
            },
            {
                let $k = 1;
                $value
            },
        ]
    };
}
pub(crate) use both;

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
#[derive(Clone, Copy)]
pub(crate) struct Cells<S: Vector> {
    pub h00: Lanes<S>,
    pub along: Lanes<S>,
    pub across: Lanes<S>,
    pub twist: Lanes<S>,
}

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
    Cells { h00, along, across, twist: inside.select(twist, Lanes::splat(simd, f64::NAN)) }
}

/// Corners of the cells that begin at these places, as near to them as there are any.
#[inline(always)]
fn singles<S: Vector>(simd: S, ground: &Terrain, place: Lanes<S>) -> [Lanes<S>; 4] {
    let [rows, columns] = ground.shape();
    let (places, mut corners) = (spread(place), [[0.0; RIMS]; 4]);
    for lane in 0..S::F64_LANES {
        let place = (places[lane] as usize).min((rows - 1) * columns - 2); // NaN is 0
        for (corner, offset) in corners.iter_mut().zip([0, 1, columns, columns + 1]) {
            corner[lane] = ground.heights().at(place + offset);
        }
    }
    [
        Lanes::from_slice(simd, &corners[0]),
        Lanes::from_slice(simd, &corners[1]),
        Lanes::from_slice(simd, &corners[2]),
        Lanes::from_slice(simd, &corners[3]),
    ]
}

/// A circle over a grid: horizontal coordinates in columns and rows, heights in metres. Its points are
/// `centre + forward sin t - up cos t`, with t the contact angle.
#[derive(Clone, Copy, Debug)]
pub struct WheelCircle {
    /// Hub of the wheel.
    pub centre: [f64; 3],
    /// Radius times the direction in which the wheel rolls.
    pub forward: [f64; 3],
    /// Radius times the direction of its steering axis, upwards.
    pub up: [f64; 3],
}

/// A circle in every lane.
#[derive(Clone, Copy)]
pub struct RimLanes<S: Vector> {
    /// As in [`WheelCircle`].
    pub centre: [Lanes<S>; 3],
    /// Likewise.
    pub forward: [Lanes<S>; 3],
    /// Likewise.
    pub up: [Lanes<S>; 3],
}

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
impl<S: Vector> RimLanes<S> {
    /// The circles from this one on, one per lane; lanes without one repeat the last.
    pub fn load(simd: S, circles: &[WheelCircle; RIMS], first: usize) -> Self {
        let mut columns = [[0.0; RIMS]; 9];
        for lane in 0..S::F64_LANES {
            let circle = &circles[(first + lane).min(RIMS - 1)];
            for k in 0..3 {
                columns[k][lane] = circle.centre[k];
                columns[3 + k][lane] = circle.forward[k];
                columns[6 + k][lane] = circle.up[k];
            }
        }
        let zero = Lanes::splat(simd, 0.0);
        let mut rims = Self { centre: [zero; 3], forward: [zero; 3], up: [zero; 3] };
        for k in 0..3 {
            rims.centre[k] = Lanes::from_slice(simd, &columns[k]);
            rims.forward[k] = Lanes::from_slice(simd, &columns[3 + k]);
            rims.up[k] = Lanes::from_slice(simd, &columns[6 + k]);
        }
        rims
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
