//! Laws of the controller: for random rovers, limits and streams of commands no limit is exceeded, the wheels
//! have one centre of rotation, and every step that is not what was asked for says why.
//!
//! One million steps; `SOAK` times as many if that is set.

mod checker;
mod commands;
mod limits;
mod random;
mod stops;
