//! The rims of wheels over the ground: the least gap of as many as there are lanes.

pub(crate) mod candidate;
pub(crate) mod circles;
pub(crate) mod contact;
pub(crate) mod search;
