//! Settings of odometry in space: constant while it runs.

use six_wheel_numerics::error::{Error, not_negative};
use six_wheel_odometry::settings::Settings;
use six_wheel_terrain::suspension::Chain;

/// Settings of odometry in space.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings3 {
    /// Settings shared with planar odometry. Wheels have equal weights, and covariances are not inflated.
    pub common: Settings,
    /// Standard deviation of the readings of roll and of pitch [rad].
    pub attitude_noise: f64,
    /// Standard deviation of the readings of every free angle [rad].
    pub joint_noise: f64,
}

impl Default for Settings3 {
    fn default() -> Self {
        Self { common: Settings::default(), attitude_noise: 0.002, joint_noise: 0.001 }
    }
}

impl Settings3 {
    pub(crate) fn check(&self, chain: &Chain) -> Result<(), Error> {
        self.common.check_for(chain.wheels().len(), chain.steering().len())?;
        not_negative("attitude_noise", self.attitude_noise)?;
        not_negative("joint_noise", self.joint_noise)
    }

    /// Standard deviation of the distance that a wheel's centre moves across the ground over one step [m].
    pub(crate) fn centre_deviation(&self, reach: f64) -> f64 {
        reach * (2.0 * (self.attitude_noise.powi(2) + self.joint_noise.powi(2))).sqrt()
    }
}
