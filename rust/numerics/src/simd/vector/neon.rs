//! Registers of two numbers.

use pulp::aarch64::Neon;
use pulp::f64x2;

use super::{Vector, exponent_of, least_pair, of_pair, pair_at};

#[inline_always]
impl Vector for Neon {
    fn zip(self, [a, b]: [f64x2; 2]) -> [f64x2; 2] {
        [f64x2(a.0, b.0), f64x2(a.1, b.1)]
    }

    fn unzip(self, pair: [f64x2; 2]) -> [f64x2; 2] {
        self.zip(pair)
    }

    fn interleave3(self, [a, b, c]: [f64x2; 3]) -> [f64x2; 3] {
        [f64x2(a.0, b.0), f64x2(c.0, a.1), f64x2(b.1, c.1)]
    }

    fn deinterleave3(self, [a, b, c]: [f64x2; 3]) -> [f64x2; 3] {
        [f64x2(a.0, b.1), f64x2(a.1, c.0), f64x2(b.0, c.1)]
    }

    fn transpose(self, [a, b, c, d, e, f, g, h]: [f64x2; 8]) -> [f64x2; 8] {
        let ([a, b], [c, d]) = (self.zip([a, b]), self.zip([c, d]));
        let ([e, f], [g, h]) = (self.zip([e, f]), self.zip([g, h]));
        [a, b, c, d, e, f, g, h]
    }

    fn shift<const LOG: u32>(self, register: f64x2) -> f64x2 {
        f64x2(0.0, register.0)
    }

    fn last(self, register: f64x2) -> f64 {
        register.1
    }

    fn broadcast_last(self, register: f64x2) -> f64x2 {
        f64x2(register.1, register.1)
    }

    fn gather(self, table: &[f64], places: f64x2) -> f64x2 {
        let Some(last) = table.len().checked_sub(1) else {
            return f64x2(f64::NAN, f64::NAN);
        };
        let at = |place: f64| table[(place as usize).min(last)]; // NaN is 0
        f64x2(at(places.0), at(places.1))
    }

    unsafe fn pairs(self, table: &[[f32; 2]], places: f64x2) -> f64x2 {
        f64x2(pair_at(table, places.0), pair_at(table, places.1))
    }

    fn exponent(self, numbers: f64x2) -> f64x2 {
        f64x2(exponent_of(numbers.0), exponent_of(numbers.1))
    }

    fn least_pairs(self, a: f64x2, b: f64x2) -> f64x2 {
        f64x2(least_pair(a.0, b.0), least_pair(a.1, b.1))
    }

    fn deinterleave2(self, pairs: f64x2) -> [f64x2; 2] {
        let ([a, c], [b, d]) = (of_pair(pairs.0), of_pair(pairs.1));
        [f64x2(a.into(), b.into()), f64x2(c.into(), d.into())]
    }
}
