//! See `doors/odometry.rs`.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| six_wheel_fuzz::odometry::one(data));
