//! Numbers of rollouts: registers of either precision, sums of squares, noise.

#[allow(clippy::needless_range_loop)] // components of several motions side by side
pub(crate) mod forms;
pub(crate) mod noise;
pub(crate) mod real;
pub(crate) mod registers;
pub(crate) mod squares;
