//! One number at a time.

use pulp::Scalar;

use super::{Vector, exponent_of, least_pair, of_pair, pair_at};

#[inline_always]
impl Vector for Scalar {
    fn zip(self, pair: [f64; 2]) -> [f64; 2] {
        pair
    }

    fn unzip(self, pair: [f64; 2]) -> [f64; 2] {
        pair
    }

    fn interleave3(self, registers: [f64; 3]) -> [f64; 3] {
        registers
    }

    fn deinterleave3(self, registers: [f64; 3]) -> [f64; 3] {
        registers
    }

    fn transpose(self, rows: [f64; 8]) -> [f64; 8] {
        rows
    }

    fn shift<const LOG: u32>(self, _: f64) -> f64 {
        0.0
    }

    fn last(self, register: f64) -> f64 {
        register
    }

    fn broadcast_last(self, register: f64) -> f64 {
        register
    }

    fn gather(self, table: &[f64], place: f64) -> f64 {
        let last = table.len().saturating_sub(1);
        table.get((place as usize).min(last)).copied().unwrap_or(f64::NAN)
    }

    unsafe fn pairs(self, table: &[[f32; 2]], place: f64) -> f64 {
        pair_at(table, place)
    }

    fn exponent(self, number: f64) -> f64 {
        exponent_of(number)
    }

    fn least_pairs(self, a: f64, b: f64) -> f64 {
        least_pair(a, b)
    }

    fn deinterleave2(self, pair: f64) -> [f64; 2] {
        of_pair(pair).map(f64::from)
    }
}
