//! The rims of wheels over the ground: the least gap of a rim in every lane.

mod arcs;
mod candidate;
pub(crate) mod circles;
pub(crate) mod contact;
pub(crate) mod extent;
pub(crate) mod interval;
pub(crate) mod walk;
