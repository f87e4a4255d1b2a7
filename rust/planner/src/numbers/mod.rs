//! Numbers of rollouts: registers of either precision, sums of squares, noise.

pub(crate) mod noise;
#[allow(clippy::needless_range_loop)] // components of several motions side by side
pub(crate) mod norms;
pub(crate) mod real;
pub(crate) mod registers;
pub(crate) mod squares;
