//! Tests of rovers on ground: heights, suspensions, rims and bounds.

mod belly;
mod contact;
mod dimensions;
mod extent;
mod placed;
mod pyramid;
mod table;
mod terrain;
mod vehicles;

/// Numbers between two bounds, the same every time.
fn random() -> impl FnMut(f64, f64) -> f64 {
    let mut seed = 1_u64;
    move |low, high| {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        low + (high - low) * (seed >> 11) as f64 / (1_u64 << 53) as f64
    }
}
