//! The settings as numbers of one step, or of a register of steps.

use crate::arithmetic::Arithmetic;
use crate::settings::Settings;

/// Way of a wheel and turn of a joint over one step beyond which it is left to the plain core [m, rad]; half the turn is as
/// far as the chord is the polynomial. A wheel may turn by as many radians as metres.
pub(crate) const LARGEST_STEP: [f64; 2] = [1e50, std::f64::consts::FRAC_PI_2];

/// Share of a bound that is surely below it, however it is rounded.
pub(crate) const SURELY: f64 = 1.0 - 1e-9;

/// Variances and bounds of a step that follow from the settings.
#[derive(Clone, Copy, Debug)]
pub(crate) struct NoiseTerms<T> {
    /// Duration [s].
    pub dt: T,
    /// Variance of what a wheel rolled, but for slip [m²].
    pub reading_variance: T,
    /// Half the deviation of a steering angle [rad], and its variance.
    pub half_deviation: T,
    pub steering_variance: T,
    /// Slip of a wheel above which it is reported [m]; None: by the variances.
    pub slip_bound: Option<T>,
    /// Distance of a wheel and turn of a joint beyond which the plain core makes the step [m, rad]; at most
    /// [`LARGEST_STEP`].
    pub most: [T; 2],
    /// Variance along and across a wheel's heading per metre of its pivot [m].
    pub slip_variances: [f64; 2],
    /// Time constant of the filter of the twist [s].
    pub smoothing: f64,
}

impl Settings {
    /// Terms of a step of this duration [s].
    #[inline(always)]
    pub(crate) fn terms<F: Arithmetic>(&self, by: F, dt: F::Number) -> NoiseTerms<F::Number> {
        let noise = &self.noise;
        let read = by.number(noise.speed) * dt;
        let steering = by.number(noise.steering);
        let (reading_variance, deviation) = match noise.period {
            None => (read * read, steering),
            Some(period) => {
                let sharing = by.over(by.number(period), dt);
                (sharing * (read * read), by.sqrt(sharing) * steering)
            }
        };
        let most = |limit: Option<f64>, largest: f64| match limit {
            None => by.number(largest),
            Some(limit) => by.least(by.number(SURELY * limit) * dt, by.number(largest)),
        };
        let [way, turn] = LARGEST_STEP;
        NoiseTerms {
            dt,
            reading_variance,
            half_deviation: deviation * by.number(0.5),
            steering_variance: deviation * deviation,
            slip_bound: self.flagged_slip().map(|threshold| by.number(threshold) * dt),
            most: [most(self.max_speed, way), most(self.max_steering_rate, turn)],
            slip_variances: [noise.slip * noise.slip, noise.side_slip * noise.side_slip],
            smoothing: self.smoothing,
        }
    }

    /// Deviation of the turn in a step by the deviation of the gyroscope's reading at one end [rad].
    #[inline(always)]
    pub(crate) fn turn_deviation<F: Arithmetic>(&self, by: F, dt: F::Number) -> F::Number {
        let half = by.number(0.5 * self.rate_noise()) * dt;
        match self.noise.period {
            None => half,
            Some(period) => half * by.sqrt(by.over(by.number(period), dt)),
        }
    }
}
