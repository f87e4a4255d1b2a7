//! Bicubic heights, one axis at a time.

/// Values that can be continued in a straight line.
pub(super) trait Straight: Copy {
    fn beyond(self, inner: Self) -> Self;
}

impl Straight for f64 {
    fn beyond(self, inner: Self) -> Self {
        2.0 * self - inner
    }
}

impl Straight for (f64, f64) {
    fn beyond(self, inner: Self) -> Self {
        (self.0.beyond(inner.0), self.1.beyond(inner.1))
    }
}

/// The values before, at, after and after that of a place, of which there are `count`.
pub(super) fn four<T: Straight>(value: impl Fn(usize) -> T, i: usize, count: usize) -> [T; 4] {
    let (second, third) = (value(i), value(i + 1));
    let first = if i > 0 { value(i - 1) } else { second.beyond(third) };
    let fourth = if i + 2 < count { value(i + 2) } else { third.beyond(second) };
    [first, second, third, fourth]
}

/// Value and slope of the cubic through the inner two values whose slopes there are half the differences
/// across them. (E. Catmull, R. Rom, A class of local interpolating splines, 1974.)
pub(super) fn catmull_rom([p, q, r, s]: [f64; 4], t: f64) -> (f64, f64) {
    let (linear, square, cube) = (0.5 * (r - p), p - 2.5 * q + 2.0 * r - 0.5 * s, 0.5 * (s - p) + 1.5 * (q - r));
    (q + t * (linear + t * (square + t * cube)), linear + t * (2.0 * square + 3.0 * t * cube))
}
