//! A cell of a grid of heights.

use std::ops::{Add, Mul};

/// A cell with bilinear heights: `height = h00 + along a + across b + twist a b`, with a and b from 0 to 1 along
/// columns and rows.
#[derive(Clone, Copy, Debug)]
pub struct Cell<T = f64> {
    /// Height of the corner with the lowest column and row [m].
    pub h00: T,
    /// Rise along the columns at that corner, over the whole cell [m].
    pub along: T,
    /// Rise along the rows at that corner, over the whole cell [m].
    pub across: T,
    /// Height of the opposite corner above the sum of both rises [m].
    pub twist: T,
}

impl<T: Copy + Add<Output = T> + Mul<Output = T>> Cell<T> {
    /// Height at the fractions `a` of a column and `b` of a row [m].
    #[inline(always)]
    pub fn height(&self, a: T, b: T) -> T {
        self.h00 + self.along * a + (self.across + self.twist * a) * b
    }
}

impl Cell {
    /// Derivatives by `a` and `b` [m].
    #[inline]
    pub fn slope(&self, a: f64, b: f64) -> [f64; 2] {
        [self.along + self.twist * b, self.across + self.twist * a]
    }

    /// Height of the highest corner, the largest height of the cell [m].
    #[inline]
    pub fn highest(&self) -> f64 {
        let opposite = self.along + self.across + self.twist;
        self.h00 + self.along.max(self.across).max(opposite).max(0.0)
    }

    /// True if all four corners are known.
    #[inline]
    pub fn is_known(&self) -> bool {
        // A NaN in any corner makes the twist NaN.
        !self.twist.is_nan()
    }
}
