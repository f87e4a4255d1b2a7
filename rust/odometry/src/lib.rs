//! Dead reckoning in the plane with its covariance, and pre-integrated factors for graphs.

#[macro_use]
extern crate six_wheel_numerics;

pub mod health;
pub mod history;
pub(crate) mod log;
pub mod motion;
mod planar;
pub mod preintegrated;
mod propagation;
mod samples;
pub mod settings;
pub mod state;
pub(crate) mod step;
pub(crate) mod uncertainty;

pub use health::Health;
pub use planar::Odometry;
pub use preintegrated::Preintegrated;
pub use propagation::{arc, covariance, pose_gain};
pub use samples::recording::{Recording, Sample, TrackRows};
pub use samples::skipped_rows::SkippedRows;
pub use samples::whole_logs::LogOdometry;
pub use samples::{increments, recording, whole_logs};
pub use settings::dimensions::{self, Deviations};
pub use settings::encoder::{self, Encoder};
pub use settings::gyroscope::{self, Gyroscope};
pub use settings::noise::{self, Noise};
pub use settings::{Readings, Settings};
