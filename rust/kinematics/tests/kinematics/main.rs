//! Tests of kinematics: laws, derivatives, and the same bits at every level.

mod angles;
mod fit;
mod inverse;
mod laws;
mod maps;
mod poses;
mod presets;
mod projection;
mod random;
mod sensitivity;
mod streams;
mod units;
