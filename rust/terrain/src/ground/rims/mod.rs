//! The rims of wheels over the ground: the least gap of a rim in every lane.

mod arcs;
mod candidate;
pub mod circles;
pub mod contact;
pub mod extent;
pub mod interval;
pub mod walk;
