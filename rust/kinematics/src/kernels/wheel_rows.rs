//! The two equations of a wheel, for the twist about the centre of the pivots.

use nalgebra::Vector3;

use crate::rover_data::{Mount, RoverData};
use six_wheel_numerics::simd::lanes::Lanes;
use six_wheel_numerics::simd::vec3::row_times as dot;
use six_wheel_numerics::simd::vector::Vector;

/// Two rows `a`: each times the unknowns is a reading `b` [m/s]. The unknowns are the velocity of the centre of the pivots and
/// the yaw rate times the size of the rover [m/s].
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct RowPair(pub [[f64; 3]; 2]);

impl RowPair {
    /// `sum a aᵀ`, its upper half `00 01 02 11 12 22`.
    #[inline]
    pub fn normal(&self) -> [f64; 6] {
        let places = [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)];
        places.map(|(i, k)| self.0.iter().map(|row| row[i] * row[k]).sum())
    }

    /// `sum a b`: contribution to the right-hand side of the normal equations.
    #[inline(always)]
    pub fn moment<S: Vector>(&self, simd: S, readings: [Lanes<S>; 2]) -> [Lanes<S>; 3] {
        let mut moment = [readings[0]; 3];
        for (part, moment) in moment.iter_mut().enumerate() {
            let across = readings[1] * Lanes::splat(simd, self.0[1][part]);
            *moment = readings[0].mul_add(Lanes::splat(simd, self.0[0][part]), across);
        }
        moment
    }

    /// `a t - b`: residuals of both readings [m/s].
    #[inline(always)]
    fn residuals<S: Vector>(&self, simd: S, readings: [Lanes<S>; 2], unknowns: [Lanes<S>; 3]) -> [Lanes<S>; 2] {
        [dot(simd, &self.0[0], unknowns) - readings[0], dot(simd, &self.0[1], unknowns) - readings[1]]
    }

    /// `|a t - b|²`
    #[inline(always)]
    pub fn square<S: Vector>(&self, simd: S, readings: [Lanes<S>; 2], unknowns: [Lanes<S>; 3]) -> Lanes<S> {
        let [along, across] = self.residuals(simd, readings, unknowns);
        along.mul_add(along, across * across)
    }

    /// Half the gradient of [`Self::square`].
    #[inline(always)]
    pub fn slope<S: Vector>(&self, simd: S, readings: [Lanes<S>; 2], unknowns: [Lanes<S>; 3]) -> [Lanes<S>; 3] {
        self.moment(simd, self.residuals(simd, readings, unknowns))
    }
}

/// A wheel's rows: along its heading and across it; of its pivot along the axes where it is steered; none of a castor.
#[derive(Clone, Copy, Debug)]
pub(crate) struct WheelRows {
    pub rows: RowPair,
    /// Hub to ground [m].
    pub radius: f64,
    /// True if the wheel's weight is 1, false if it is 0.
    pub counts: bool,
    pub kind: RowKind,
    /// Direction at steering angle 0 of a steered wheel [rad].
    pub heading: f64,
    /// Offset of a steered wheel's contact from its pivot.
    pub offset: Option<Offset>,
}

/// Kind of the wheel. It is one byte: a single row takes a tenth of its time for the branches on it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum RowKind {
    Steered,
    Fixed,
    Castor,
}

/// Scrub and trail of a wheel.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Offset {
    /// [m]
    pub lengths: [f64; 2],
    /// As shares of the size of the rover.
    pub shares: [f64; 2],
}

impl WheelRows {
    /// Rows of wheel `i`.
    pub fn new(rover: &RoverData, i: usize, counts: bool) -> Self {
        let wheel = &rover.wheels()[i];
        let (rows, kind) = match rover.mounts[i] {
            Mount::Castor(_) => ([Vector3::zeros(); 2], RowKind::Castor),
            Mount::Fixed(rows) => ([rows.rolling, rows.side_slip], RowKind::Fixed),
            Mount::Steered(..) => (wheel.pivot_rows(), RowKind::Steered),
        };
        let lengths = [wheel.scrub, wheel.trail];
        let has_offset = kind == RowKind::Steered && !wheel.is_centred();
        Self {
            rows: RowPair(rows.map(|row| rover.row_about_centre(&row).into())),
            radius: wheel.radius,
            counts,
            kind,
            heading: wheel.heading,
            offset: has_offset.then(|| Offset { lengths, shares: lengths.map(|length| length / rover.size) }),
        }
    }

    /// The constant part of the wheel's normal equations. The moments of a wheel with scrub or trail depend on its
    /// direction and are not in it.
    #[inline]
    pub fn normal(&self) -> [f64; 6] {
        let mut rows = self.rows;
        if self.offset.is_some() {
            (rows.0[0][2], rows.0[1][2]) = (0.0, 0.0);
        }
        rows.normal()
    }

    /// Pivot of a steered wheel from the centre of the pivots, as a share of the size of the rover.
    #[inline(always)]
    pub fn arm<S: Vector>(&self, simd: S) -> [Lanes<S>; 2] {
        let [along, across] = &self.rows.0;
        [Lanes::splat(simd, across[2]), Lanes::splat(simd, -along[2])]
    }
}

impl Offset {
    /// A contact from its pivot: `p - trail e + scrub n` with `e = (cos, sin)`, `n = (-sin, cos)`.
    #[inline(always)]
    pub fn offset_point<S: Vector>(
        [x, y]: [Lanes<S>; 2],
        [scrub, trail]: [f64; 2],
        [sin, cos]: [Lanes<S>; 2],
    ) -> [Lanes<S>; 2] {
        [x - sin * scrub - cos * trail, y + cos * scrub - sin * trail]
    }
}
