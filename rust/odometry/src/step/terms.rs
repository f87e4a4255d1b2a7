//! Variances and bounds of a step by the settings, in every lane.

use pulp::Simd;

use crate::settings::Settings;
use six_wheel_numerics::error::HUGE;
use six_wheel_numerics::simd::lanes::Lanes;

/// Distance and rotation of a wheel in one step up to which sums of squares are finite [m, rad].
pub(crate) const LARGEST_ROTATION: f64 = 1e50;

/// Factor of a bound with which it is below the exact bound after rounding.
pub(crate) const ROUNDED_DOWN: f64 = 1.0 - 1e-9;

/// Variances and bounds of a step that follow from the settings.
#[derive(Clone, Copy)]
pub(crate) struct NoiseTerms<S: Simd> {
    /// Variance of the distance that a wheel rolled by readings of this step alone, without slip [m²].
    pub own_variance: Lanes<S>,
    /// Variance of that distance by readings that the neighbouring steps share [m²].
    pub shared_variance: Lanes<S>,
    /// Half the deviation of a steering angle [rad], and the variance of the angle [rad²].
    pub half_deviation: Lanes<S>,
    pub steering_variance: Lanes<S>,
    /// Slip of a wheel above which it is reported [m]; None: by the variances.
    pub slip_bound: Option<Lanes<S>>,
    /// Distance of a wheel [m] and increment of a steering angle [rad] above which a step has to be checked.
    pub checked_above: [Lanes<S>; 2],
    /// Variance along and across a wheel's heading per metre of its pivot [m].
    pub slip_variances: [f64; 2],
}

impl<S: Simd> NoiseTerms<S> {
    /// Terms of a step of this duration [s]; `from_rates`: its wheel rotations are means of readings at both ends.
    #[inline(always)]
    pub fn new(settings: &Settings, dt: Lanes<S>, from_rates: bool) -> Self {
        let splat = |number| Lanes::splat(dt.simd(), number);
        let noise = &settings.noise;
        let read = splat(noise.speed) * dt;
        let steering = splat(noise.steering);
        let (reading_variance, deviation) = match noise.period {
            None => (read * read, steering),
            Some(period) => {
                let sharing = splat(period) / dt;
                (sharing * (read * read), sharing.sqrt() * steering)
            }
        };
        let limit = |limit: Option<f64>, largest: f64| match limit {
            None => splat(largest),
            Some(limit) => (splat(ROUNDED_DOWN * limit) * dt).min(splat(largest)),
        };
        let [own_variance, shared_variance] =
            if from_rates { [splat(0.0), reading_variance] } else { [reading_variance, splat(0.0)] };
        Self {
            own_variance,
            shared_variance,
            half_deviation: deviation * splat(0.5),
            steering_variance: deviation * deviation,
            slip_bound: settings.flagged_slip().map(|threshold| splat(threshold) * dt),
            checked_above: [limit(settings.max_speed, LARGEST_ROTATION), limit(settings.max_steering_rate, HUGE)],
            slip_variances: [noise.slip * noise.slip, noise.side_slip * noise.side_slip],
        }
    }
}

/// Deviation of the yaw increment of a step by that of the gyroscope's reading at one end, which counts for half the
/// step [rad].
#[inline(always)]
pub(crate) fn gyroscope_deviation<S: Simd>(settings: &Settings, dt: Lanes<S>) -> Lanes<S> {
    let splat = |number| Lanes::splat(dt.simd(), number);
    let half = splat(0.5 * settings.rate_noise()) * dt;
    match settings.noise.period {
        None => half,
        Some(period) => half * (splat(period) / dt).sqrt(),
    }
}
