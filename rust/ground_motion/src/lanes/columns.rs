//! Loads and stores between rows of the caller's arrays and lanes, and the angles and lengths of vectors in lanes.

use pulp::Simd;

use six_wheel_kinematics::se2::angles::reduce_lanes;
use six_wheel_numerics::simd::lanes::{Lanes, Mask};
use six_wheel_numerics::simd::polynomials::{angle, direction};
use six_wheel_numerics::simd::vector::Vector;
use six_wheel_terrain::suspension::lanes::{Column, LARGEST_TURN, MOST, Turned, all, columns};

/// Consecutive rows, one per lane: `count` rows from row `first` on.
#[derive(Clone, Copy)]
pub(crate) struct Span {
    pub first: usize,
    pub count: usize,
}

#[inline_always]
impl Span {
    /// Numbers of these rows, `W` of the `width` that each has; the last row in lanes that have none.
    pub fn read<S: Vector, const W: usize>(self, simd: S, rows: &[f64], width: usize) -> [Lanes<S>; W] {
        let mut lanes = [all(simd, 0.0); W];
        let rows = &rows[self.first * width..];
        if W == 3 && width == 3 && self.count == S::F64_LANES {
            let three = Lanes::deinterleave3(simd, rows);
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
        columns(simd, |lane| {
            let row = &rows[lane.min(self.count - 1) * width..][..width];
            std::array::from_fn(|k| row.get(k).copied().unwrap_or(0.0))
        })
    }

    /// One number of each of these rows; a single value stands for every row.
    pub fn one<S: Vector>(self, simd: S, values: &[f64]) -> Lanes<S> {
        match values {
            [value] => all(simd, *value),
            _ => self.read::<S, 1>(simd, values, 1)[0],
        }
    }

    /// Writes the first `width` of these numbers, a row of them per lane.
    pub fn write<S: Vector, const W: usize>(self, simd: S, lanes: &[Lanes<S>; W], width: usize, rows: &mut [f64]) {
        let rows = &mut rows[self.first * width..];
        if W == 3 && width == 3 && self.count == S::F64_LANES {
            Lanes::interleave3([lanes[0], lanes[1 % W], lanes[2 % W]], rows);
            return;
        }
        let whole = self.count == S::F64_LANES;
        if W > 1 && whole && rows.len() >= S::F64_LANES * width + MOST {
            // The last columns first: numbers stored past the end of a row are overwritten by the next store.
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

    /// Writes the lowest `width` bits of whole numbers as flags, a row of them per lane.
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

/// Lanes in which a number is not NaN.
#[inline(always)]
pub(crate) fn is_number<S: Simd>(number: Lanes<S>) -> Mask<S> {
    number.le(number)
}

/// Angles [rad], less whole turns where they are beyond [`LARGEST_TURN`].
#[inline(always)]
pub(crate) fn wrap_far<S: Vector, const N: usize>(simd: S, mut angles: [Lanes<S>; N]) -> [Lanes<S>; N] {
    let mut largest = all(simd, 0.0);
    for angle in &angles {
        largest = angle.abs().max(largest);
    }
    if all(simd, LARGEST_TURN).lt(largest).any() {
        for angle in &mut angles {
            *angle = reduce_lanes(simd, *angle, LARGEST_TURN);
        }
    }
    angles
}

/// Sine and cosine of an angle of any size [rad].
#[inline(always)]
pub(crate) fn direction_of<S: Vector>(simd: S, angle: Lanes<S>) -> Turned<S> {
    let [angle] = wrap_far(simd, [angle]);
    direction(simd, angle)
}

/// Least and largest squares of [`roots`].
const ROOTS: [f64; 2] = [1e-30, 1e36];

/// One over the square root of a number within [`ROOTS`], and the root, to two last places; the same bits at every level.
#[inline(always)]
pub(crate) fn roots<S: Vector>(simd: S, number: Lanes<S>) -> [Lanes<S>; 2] {
    let mut register = [simd.splat_f64s(0.0)];
    number.store(&mut register, 0);
    let [inverse, root] = simd.steady_roots(register[0]);
    [Lanes::load(simd, &[inverse], 0), Lanes::load(simd, &[root], 0)]
}

/// The inverse length of a vector of about unit length, of which this is the square; finite at 0.
#[inline(always)]
pub(crate) fn inverse_length<S: Vector>(simd: S, square: Lanes<S>) -> Lanes<S> {
    let [inverse, _] = roots(simd, square.max(all(simd, ROOTS[0])));
    inverse
}

/// A plane vector in polar form with an angle of at most a quarter turn: a vector that points backwards has the
/// direction opposite to it, and its sign bit is set.
#[derive(Clone, Copy)]
pub(crate) struct Polar<S: Simd> {
    pub length: Lanes<S>,
    /// The sign bit where it points backwards.
    pub sign: Lanes<S>,
    /// Sine and cosine of the angle, which is a quarter turn at most; sine 0 and cosine 1 where the vector is 0.
    pub turned: Turned<S>,
    /// Lanes in which the vector is 0.
    pub is_zero: Mask<S>,
}

/// A vector, given by its parts ahead and to the left, in polar form.
#[inline(always)]
pub(crate) fn polar<S: Vector>([mut ahead, mut left]: [Lanes<S>; 2]) -> Polar<S> {
    let simd = ahead.simd();
    let (zero, one) = (all(simd, 0.0), all(simd, 1.0));
    let size = ahead.abs() + left.abs();
    let is_zero = size.le(zero);
    let mut square = ahead.mul_add(ahead, left * left);
    let mut unit = one;
    let fits = all(simd, ROOTS[0]).le(square) & square.le(all(simd, ROOTS[1]));
    let scaled = !(fits | is_zero);
    if scaled.any() {
        unit = scaled.select(size, one);
        (ahead, left) = (ahead / unit, left / unit);
        square = ahead.mul_add(ahead, left * left);
    }
    let [inverse, _] = roots(simd, is_zero.select(one, square));
    let near = square * inverse;
    // The rounding of the root is added back.
    let rest = (-near).mul_add(near, square);
    let length = rest.mul_add(inverse * all(simd, 0.5), near) * unit;
    let sign = ahead.lt(zero).select(all(simd, -0.0), zero);
    let turned = (left.xor_sign(sign) * inverse, is_zero.select(one, ahead.xor_sign(sign) * inverse));
    Polar { length, sign, turned, is_zero }
}

/// The angle of a direction that does not point backwards [rad].
#[inline(always)]
pub(crate) fn angle_of<S: Simd>(simd: S, (sin, cos): Turned<S>) -> Lanes<S> {
    angle(simd, cos.abs(), sin.abs()).xor_sign(sin.sign_bit())
}
