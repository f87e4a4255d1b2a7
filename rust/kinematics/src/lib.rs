//! Kinematics of wheeled rovers: one wheel equation, any layout.
//!
//! A rover is data: a list of [`Wheel`]s. [`Rover`] checks it once and then answers, without state and
//! without allocation, what every wheel has to do for a wanted body twist ([`Rover::inverse`]), which
//! twist the wheels report ([`Rover::forward`], [`Rover::fit`]), and which twists the layout can make at
//! all ([`Rover::check`], [`Rover::project`]).
//!
//! Conventions (REP 103): x forward, y left, angles counter-clockwise in radians, SI units. A twist is
//! the velocity of the body frame in body axes. Nothing here divides by a turning radius, so driving
//! straight, on the spot and sideways are ordinary values of the same expressions.
//!
//! Rooms: [`geometry`] (twist, pose, exp and log), [`wheels`] (the wheel equation), [`steering`] (which angle
//! a wheel takes), [`rover`] (a checked list of wheels; inverse), [`layouts`] and [`presets`] (named
//! vehicles), [`estimate`] (forward, fit, derivatives), [`odometry`] (dead reckoning), [`admissible`] (limits,
//! projection), [`mobility`] (rank of the constraints), [`batch`] (whole arrays), [`profiles`] (values over time,
//! transitions), [`controller`] (limits, steps), [`suspension`] (rocker-bogies and other chains),
//! [`units`] (numbers that cannot be metres and radians), [`terrain`] (ground as a grid of heights), [`four_axle`] (axles on lockable pivots: brakes, sequences, simulation).

pub mod admissible;
pub mod batch;
pub mod bounds;
pub mod controller;
pub mod error;
pub mod estimate;
pub mod four_axle;
pub mod geometry;
pub mod ground;
pub mod heights;
mod interval;
mod jacobi;
pub mod layouts;
pub mod mobility;
pub mod moving;
pub mod odometry;
pub mod planner;
pub mod presets;
pub mod profiles;
pub mod pyramid;
pub mod rover;
pub mod rover_data;
pub mod steering;
pub mod suspension;
pub mod terrain;
pub mod units;
pub mod wheels;

pub use admissible::Keep;
pub use controller::{Controller, Limits};
pub use error::{Error, ErrorKind};
pub use estimate::{Fit, Measured, Method, Unseen};

pub use four_axle::FourAxle;
pub use geometry::{Pose, Twist};
pub use layouts::{Drive, SkidCentres};
pub use mobility::Mobility;
pub use odometry::Odometry;
pub use rover::{Inputs, Rover};
pub use steering::SteeringRange;
pub use suspension::{Chain, RockerBogie};
pub use terrain::Terrain;
pub use wheels::{Pivot, Wheel};
