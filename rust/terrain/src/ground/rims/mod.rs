//! The rims of wheels over the ground: the least gap of one, and of eight at once.

pub(crate) mod circle;
pub(crate) mod circles;
pub(crate) mod lanes;
pub(crate) mod rim;
pub(crate) mod search;
