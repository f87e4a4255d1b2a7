//! Numbers of several rovers, or of several wheels, in the lanes of a register.

use pulp::Simd;

use six_wheel_numerics::simd::lanes::Lanes;
pub use six_wheel_numerics::simd::vec3::{
    Vec3 as Vectors, add as sum, add_scaled as along, cross, dot, scale as scaled, sub as less,
};

/// Sine and cosine.
pub type Turned<S> = (Lanes<S>, Lanes<S>);

/// Lanes of the widest level.
pub const MOST: usize = 8;

/// One number of up to [`MOST`] rovers.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub struct Column(pub [f64; MOST]);

#[inline_always]
impl Column {
    /// All zero.
    pub const ZERO: Self = Self([0.0; MOST]);

    /// The numbers of the first rovers, one per lane.
    pub fn load<S: Simd>(&self, simd: S) -> Lanes<S> {
        Lanes::load(simd, S::as_simd_f64s(&self.0[..S::F64_LANES]).0, 0)
    }

    /// The lanes as a column, zero beyond them.
    pub fn of<S: Simd>(lanes: Lanes<S>) -> Self {
        let mut column = Self::ZERO;
        lanes.store(S::as_mut_simd_f64s(&mut column.0[..S::F64_LANES]).0, 0);
        column
    }
}

/// A row of numbers for every lane: their columns.
#[inline(always)]
pub fn columns<S: Simd, const N: usize>(simd: S, row: impl Fn(usize) -> [f64; N]) -> [Lanes<S>; N] {
    let mut columns = [Column::ZERO; N];
    for lane in 0..S::F64_LANES {
        for (column, value) in columns.iter_mut().zip(row(lane)) {
            column.0[lane % MOST] = value;
        }
    }
    let mut lanes = [all(simd, 0.0); N];
    for (lanes, column) in lanes.iter_mut().zip(&columns) {
        *lanes = column.load(simd);
    }
    lanes
}

/// Largest angle of poses in lanes [rad]: about a hundred turns. Poses with larger ones are computed one at a time.
pub const LARGEST_TURN: f64 = 600.0;

/// The same number in every lane.
#[inline(always)]
pub fn all<S: Simd>(simd: S, value: f64) -> Lanes<S> {
    Lanes::splat(simd, value)
}

/// The same vector in every lane.
#[inline(always)]
pub fn splat<S: Simd>(simd: S, vector: [f64; 3]) -> Vectors<S> {
    let [x, y, z] = vector;
    [all(simd, x), all(simd, y), all(simd, z)]
}

/// A vector rotated about axis `K` by an angle: `Rx(angle) v`, `Ry(angle) v` or `Rz(angle) v`.
#[inline(always)]
pub fn turn_about<const K: usize, S: Simd>((sin, cos): Turned<S>, vector: Vectors<S>) -> Vectors<S> {
    let (first, second) = ((K + 1) % 3, (K + 2) % 3);
    let mut turned = vector;
    turned[first] = vector[first].mul_add(cos, -(vector[second] * sin));
    turned[second] = vector[second].mul_add(cos, vector[first] * sin);
    turned
}

/// A vector in axes that are rotated by this angle about z: `Rz(-angle) v`.
#[inline(always)]
pub fn from_turned<S: Simd>((sin, cos): Turned<S>, vector: Vectors<S>) -> Vectors<S> {
    turn_about::<2, S>((-sin, cos), vector)
}
