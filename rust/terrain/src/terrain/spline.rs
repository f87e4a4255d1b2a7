//! Bicubic heights, one axis at a time.

/// Values with linear extrapolation.
pub(super) trait LinearExtrapolation: Copy {
    /// The value one step after `self`, on the line through `inner`, one step before, and `self`.
    fn beyond(self, inner: Self) -> Self;
}

impl LinearExtrapolation for f64 {
    fn beyond(self, inner: Self) -> Self {
        2.0 * self - inner
    }
}

impl LinearExtrapolation for (f64, f64) {
    fn beyond(self, inner: Self) -> Self {
        (self.0.beyond(inner.0), self.1.beyond(inner.1))
    }
}

/// The values `i - 1` to `i + 2` of `count` values, extrapolated at both ends.
pub(super) fn four<T: LinearExtrapolation>(value: impl Fn(usize) -> T, i: usize, count: usize) -> [T; 4] {
    let (second, third) = (value(i), value(i + 1));
    let first = if i > 0 { value(i - 1) } else { second.beyond(third) };
    let fourth = if i + 2 < count { value(i + 2) } else { third.beyond(second) };
    [first, second, third, fourth]
}

/// Value and slope at t, 0 to 1, of the cubic through the inner two values q and r with the slopes `(r - p) / 2` and
/// `(s - q) / 2`. (E. Catmull, R. Rom, A class of local interpolating splines, 1974.)
pub(super) fn catmull_rom([p, q, r, s]: [f64; 4], t: f64) -> (f64, f64) {
    let (linear, square, cube) = (0.5 * (r - p), p - 2.5 * q + 2.0 * r - 0.5 * s, 0.5 * (s - p) + 1.5 * (q - r));
    (q + t * (linear + t * (square + t * cube)), linear + t * (2.0 * square + 3.0 * t * cube))
}
