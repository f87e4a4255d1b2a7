//! Motion over time within limits: a controller of single steps, and profiles of whole transitions.

#[macro_use]
extern crate six_wheel_numerics;

pub mod controller;
mod motion;
pub mod profiles;

pub use controller::{Controller, Limits};
