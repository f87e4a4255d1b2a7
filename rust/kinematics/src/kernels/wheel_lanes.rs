//! Wheels in the lanes of a register: their order, and one number per wheel.

use pulp::Simd;

use crate::rover_data::RoverData;
use six_wheel_numerics::simd::lanes::Lanes;
use six_wheel_numerics::simd::level::Level;

/// Wheels in a group: a whole number of registers on every level.
pub const GROUP: usize = 8;

/// One number per wheel of a group.
pub type Eight = [f64; GROUP];

/// The level of one row. Registers of eight are no faster: steered wheels are mostly four, and a row of four
/// angles fills a register of four without masks.
#[inline]
pub fn level() -> Level {
    [Level::Avx2, Level::Neon].into_iter().find(|level| level.is_here()).unwrap_or(Level::Scalar)
}

/// The order of the lanes: wheels by index, the steered ones first.
#[inline]
pub fn order(rover: &RoverData) -> Vec<usize> {
    let others = (0..rover.wheels().len()).filter(|i| !rover.steered().contains(i));
    rover.steered().iter().copied().chain(others).collect()
}

/// A register of numbers, zero beyond their end.
#[inline(always)]
pub fn padded<S: Simd>(simd: S, numbers: &[f64]) -> Lanes<S> {
    if let [register, ..] = S::as_simd_f64s(numbers).0 {
        return Lanes::load(simd, std::slice::from_ref(register), 0);
    }
    let mut room = [0.0; GROUP];
    for (place, number) in room.iter_mut().zip(numbers) {
        *place = *number;
    }
    Lanes::load(simd, S::as_simd_f64s(&room).0, 0)
}
