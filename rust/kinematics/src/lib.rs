//! Kinematics of wheeled rovers: one wheel equation, any layout.
//!
//! A rover is data: a list of [`Wheel`]s. [`Rover`] checks it once. Its methods, without state and allocation, compute
//! the motion of every wheel for a desired body twist ([`Rover::inverse`]), the twist from readings of the wheels
//! ([`Rover::forward`], [`Rover::fit`]), and the admissible twists of the layout ([`Rover::check`],
//! [`Rover::project`]).
//!
//! Conventions (REP 103): x forward, y left, angles counter-clockwise in radians, SI units. A twist is
//! the velocity of the body frame in body axes. Nothing here divides by a turning radius, so driving
//! straight, on the spot and sideways are ordinary values of the same expressions.
//!
//! Modules, from below: [`geometry`] (twist, pose, exp and log), [`wheels`] (the wheel equation), [`steering`] (the range of
//! a steering angle), [`rover_data`] (a checked list of wheels), [`kernels`] (the formulas, one body for every level),
//! [`pose_logs`] (poses along logs), [`admissible`] (limits, faces of the admissible set), [`estimate`] (forward, fit,
//! derivatives), [`rover`] (the data with the constants of its kernels), [`layouts`] and [`presets`] (named vehicles),
//! [`mobility`] (rank of the constraints), [`units`] (numbers that cannot be metres and radians), [`batch`] (whole arrays).

#[macro_use]
extern crate six_wheel_numerics;

pub mod admissible;
pub mod batch;
pub mod estimate;
pub mod geometry;
pub mod inverse;
pub mod kernels;
pub mod layouts;
pub mod mobility;
pub mod pose_logs;
pub mod presets;
pub mod rover;
pub mod rover_data;
pub mod se2;
pub mod steering;
pub mod table;
pub mod units;
pub mod wheels;

pub use admissible::Keep;
pub use estimate::{Fit, Measured, Method, Unseen};
pub use geometry::{Pose, Twist};
pub use layouts::{Drive, SkidCentres};
pub use mobility::Mobility;
pub use rover::{Inputs, Rover};
pub use steering::SteeringRange;
pub use wheels::{Pivot, Wheel};
