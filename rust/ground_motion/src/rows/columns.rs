//! Between rows, as the caller keeps them, and lanes, as many rows at a time as there are.

use pulp::Simd;

use six_wheel_kinematics::steering::{ANGLE_TOLERANCE, SteeringRange};
use six_wheel_numerics::simd::lanes::{Lanes, Mask};
use six_wheel_numerics::simd::polynomials::angle;
use six_wheel_numerics::simd::vector::Vector;
use six_wheel_terrain::suspension::lanes::{Column, MOST, Turned, all};

/// Rows that are worked on together, from `first` on.
#[derive(Clone, Copy)]
pub(crate) struct Span {
    pub first: usize,
    pub count: usize,
}

impl Span {
    /// Numbers of these rows, `W` of the `width` that each has; the last row in lanes that have none.
    #[inline(always)]
    pub fn read<S: Vector, const W: usize>(self, simd: S, rows: &[f64], width: usize) -> [Lanes<S>; W] {
        let mut lanes = [all(simd, 0.0); W];
        let rows = &rows[self.first * width..];
        if W == 3 && width == 3 && self.count == S::F64_LANES {
            let three = Lanes::unbraid(simd, rows);
            lanes.copy_from_slice(&three);
            return lanes;
        }
        if W > 1 && rows.len() >= (S::F64_LANES - 1) * width + W.next_multiple_of(MOST) {
            for first in (0..W).step_by(MOST) {
                let eight = Lanes::columns(simd, &rows[first..], width);
                for (lanes, column) in lanes[first..].iter_mut().zip(eight) {
                    *lanes = column;
                }
            }
            return lanes;
        }
        if self.count == 1 {
            for (lanes, value) in lanes.iter_mut().zip(&rows[..width]) {
                *lanes = all(simd, *value);
            }
            return lanes;
        }
        let mut columns = [Column::ZERO; W];
        for lane in 0..S::F64_LANES {
            let row = &rows[lane.min(self.count - 1) * width..][..width];
            for (column, value) in columns.iter_mut().zip(row) {
                column.0[lane % MOST] = *value;
            }
        }
        for (lanes, column) in lanes.iter_mut().zip(&columns) {
            *lanes = column.load(simd);
        }
        lanes
    }

    /// One number of each of these rows, or the one that all have.
    #[inline(always)]
    pub fn one<S: Vector>(self, simd: S, values: &[f64]) -> Lanes<S> {
        match values {
            [value] => all(simd, *value),
            _ => self.read::<S, 1>(simd, values, 1)[0],
        }
    }

    /// Writes the first `width` of these numbers, a row of them per lane.
    #[inline(always)]
    pub fn write<S: Vector, const W: usize>(self, simd: S, lanes: &[Lanes<S>; W], width: usize, rows: &mut [f64]) {
        let rows = &mut rows[self.first * width..];
        if W == 3 && width == 3 && self.count == S::F64_LANES {
            Lanes::braid([lanes[0], lanes[1 % W], lanes[2 % W]], rows);
            return;
        }
        let whole = self.count == S::F64_LANES;
        if W > 1 && whole && rows.len() >= S::F64_LANES * width + MOST {
            // The last columns first: what goes past the end of a row is written once more.
            for first in (0..width.min(W)).step_by(MOST).rev() {
                let mut eight = [lanes[0]; MOST];
                for (column, lanes) in eight.iter_mut().zip(&lanes[first..]) {
                    *column = *lanes;
                }
                Lanes::rows(simd, eight, &mut rows[first..], width);
            }
            return;
        }
        let rows = &mut rows[..self.count * width];
        let mut columns = [Column::ZERO; W];
        for (column, lanes) in columns.iter_mut().zip(lanes) {
            *column = Column::of(*lanes);
        }
        for (lane, row) in rows.chunks_exact_mut(width.max(1)).enumerate() {
            for (value, column) in row.iter_mut().zip(&columns) {
                *value = column.0[lane % column.0.len()];
            }
        }
    }

    /// Writes the first `width` of the lowest bits of whole numbers, likewise.
    #[inline(always)]
    pub fn flags<S: Vector>(self, bits: Lanes<S>, width: usize, rows: &mut [bool]) {
        let rows = &mut rows[self.first * width..][..self.count * width];
        let column = Column::of(bits);
        for (row, bits) in rows.chunks_exact_mut(width.max(1)).zip(column.0) {
            let bits = bits as u32;
            for (k, value) in row.iter_mut().enumerate() {
                *value = bits >> k & 1 == 1;
            }
        }
    }
}

/// Lanes in which a number is finite.
#[inline(always)]
pub(crate) fn finite<S: Simd>(simd: S, number: Lanes<S>) -> Mask<S> {
    number.abs().at_most(all(simd, f64::MAX))
}

/// A mask as a column: 1 where it is true, else 0.
#[inline(always)]
pub(crate) fn truths<S: Simd>(simd: S, mask: Mask<S>) -> Column {
    Column::of(mask.select(all(simd, 1.0), all(simd, 0.0)))
}

/// Below these squares of speeds the plain way takes over [m^2/s^2].
const TINY: f64 = 1e-280;

/// A length, and the direction of the vector that has it, forwards or backwards so that it is not left behind; no
/// direction but `rest` where it is 0.
#[derive(Clone, Copy)]
pub(crate) struct Way<S: Simd> {
    pub length: Lanes<S>,
    /// The sign bit where it goes backwards.
    pub sign: Lanes<S>,
    /// Of the angle up to a quarter turn.
    pub turned: Turned<S>,
    pub rests: Mask<S>,
}

/// The way of a velocity ahead and aside. Adds to the doubtful lanes those whose squares are lost.
#[inline(always)]
pub(crate) fn way<S: Vector>([ahead, aside]: [Lanes<S>; 2], rest: Turned<S>, doubt: &mut Mask<S>) -> Way<S> {
    let (zero, one) = (all(ahead.simd(), 0.0), all(ahead.simd(), 1.0));
    let square = ahead.mul_add(ahead, aside * aside);
    let size = ahead.abs() + aside.abs();
    let rests = size.at_most(zero);
    *doubt = *doubt | (square.below(all(ahead.simd(), TINY)) & !rests);
    let inverse = rests.select(one, square).inverse_root();
    let near = square * inverse;
    // What the product rounds away is added back.
    let missing = (-near).mul_add(near, square);
    let length = missing.mul_add(inverse * all(ahead.simd(), 0.5), near);
    let sign = ahead.below(zero).select(all(ahead.simd(), -0.0), zero);
    Way {
        length,
        sign,
        turned: (rests.select(rest.0, aside.flip(sign) * inverse), rests.select(rest.1, ahead.flip(sign) * inverse)),
        rests,
    }
}

/// The angle of a direction that is not behind.
#[inline(always)]
pub(crate) fn angle_of<S: Simd>(simd: S, (sin, cos): Turned<S>) -> Lanes<S> {
    angle(simd, cos.abs(), sin.abs()).flip(sin.sign())
}

/// A steering angle as it comes, and what a joint makes of it.
#[derive(Clone, Copy)]
pub(crate) struct Within<S: Simd> {
    pub angle: Lanes<S>,
    /// The sign bit where it is half a turn from what it was.
    pub turned: Lanes<S>,
}

/// The angle, or half a turn from it, inside a range; doubtful where it is at its very ends, or outside.
#[inline(always)]
pub(crate) fn within<S: Simd>(simd: S, range: SteeringRange, angle: Lanes<S>, doubt: &mut Mask<S>) -> Within<S> {
    let half = all(simd, std::f64::consts::PI);
    let (lower, upper) = (all(simd, range.lower), all(simd, range.upper));
    let (least, most) = (all(simd, range.lower - ANGLE_TOLERANCE), all(simd, range.upper + ANGLE_TOLERANCE));
    let (back, on) = (angle - half, angle + half);
    let stays = least.at_most(angle) & angle.at_most(most);
    let goes_back = least.at_most(back) & back.at_most(most);
    let found = stays.select(angle, goes_back.select(back, on));
    *doubt = *doubt | !(lower.at_most(found) & found.at_most(upper));
    Within { angle: found, turned: stays.select(all(simd, 0.0), all(simd, -0.0)) }
}
