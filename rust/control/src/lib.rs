//! Motion over time within limits: a controller of single steps, and profiles of whole transitions.

pub mod controller;
mod motion;
pub mod profiles;

pub use controller::{Controller, Limits};
