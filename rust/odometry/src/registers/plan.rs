//! Constants of a rover and its encoders for the kernel of a step of odometry, and its memory.

use nalgebra::Vector3;

use crate::settings::encoder::Encoder;
use crate::settings::{Readings, Settings};
use six_wheel_kinematics::estimate::Method;
use six_wheel_kinematics::kernels::readings::LARGEST_ROVER;
use six_wheel_kinematics::kernels::wheel_lanes::{Eight, GROUP, level, order};
use six_wheel_kinematics::rover::{Mount, Rover};
use six_wheel_kinematics::wheels::Pivot;
use six_wheel_numerics::simd::level::Level;
use six_wheel_numerics::simd::polynomials::LARGEST_ANGLE;

/// Three numbers per wheel.
pub(crate) type Triple = [Eight; 3];

/// Constants of a rover and its encoders for the kernel of a step, and its memory.
///
/// Invariants: the wheels stand in the lanes in [`order`], steered ones first, so steered wheel `k` of the rover is
/// lane `k % GROUP` of group `k / GROUP`. Lanes without a wheel hold zeros: their radius, rows and shares are 0, so
/// they roll nowhere and add nothing, and their entry of `wheels` is no index of any array. The same numbers make a
/// castor measure nothing. A plan exists only where the solution of the least squares is a constant of the rover, so
/// `shares` are constants too. `rooms` are written by every step before they are read and mean nothing between steps.
#[derive(Clone, Debug)]
pub(crate) struct StepConstants {
    pub(crate) level: Level,
    pub(crate) groups: Vec<Group>,
    /// One per group.
    pub(crate) rooms: Vec<StepScratch>,
}

/// Eight wheels.
#[derive(Clone, Debug, Default)]
pub(crate) struct Group {
    /// Index of each wheel in the rover; [`usize::MAX`] where there is none.
    pub(crate) wheels: [usize; GROUP],
    /// Number of wheels: lanes `0..count`.
    pub(crate) count: usize,
    /// Number of steered wheels: lanes `0..steered`.
    pub(crate) steered: usize,
    /// 1 for a steered wheel, 0 for another.
    pub(crate) steers: Eight,
    /// Direction at steering angle 0 [rad].
    pub(crate) heading: Eight,
    /// Angle of a wheel and of its joint per count of their encoders [rad].
    pub(crate) per_count: [Eight; 2],
    /// [m]
    pub(crate) radius: Eight,
    /// Place of the pivot in the body, x and y [m].
    pub(crate) pivot: [Eight; 2],
    /// Rolling and side-slip row. Those of a steered wheel are for the wheel pointing ahead: pointing by `a` to the left,
    /// they are `cos a` times the one and `sin a` times the other, and `cos a` times the other less `sin a` times the one.
    pub(crate) rows: [Triple; 2],
    /// Displacement [m, m, rad] that a metre measured along either row adds to the least-squares solution.
    pub(crate) shares: [Triple; 2],
    /// 1 where a wheel measures along the row, 0 where rollers or the lack of a wheel leave it out.
    pub(crate) has: [Eight; 2],
    /// Share of the variance across a wheel that its rollers pass on along it.
    pub(crate) passed_on: Eight,
}

/// Memory of eight wheels between the two halves of a step.
#[derive(Clone, Debug, Default)]
pub(crate) struct StepScratch {
    /// [`Group::shares`] with the wheel pointing where it pointed in the middle of the step.
    pub(crate) shares: [Triple; 2],
    /// Way along the wheel's heading, for a steered one along the chord [m].
    pub(crate) rolled: Eight,
    /// The same in the axes of the rows [m].
    pub(crate) way: [Eight; 2],
    /// Length of what the fitted displacement and the wheel disagree by [m].
    pub(crate) slid: Eight,
    /// Variance of that [m²].
    pub(crate) variance: Eight,
}

impl Group {
    /// Registers with a wheel in them.
    #[inline(always)]
    pub fn registers(&self, lanes: usize) -> usize {
        self.count.div_ceil(lanes).min(GROUP / lanes)
    }
}

impl StepConstants {
    /// Constants for settings that the kernel serves: totals, wheels that weigh and slip alike, dimensions that are
    /// known.
    pub fn of(settings: &Settings, rover: &Rover) -> Option<Self> {
        let castors = || rover.wheels().iter().any(|wheel| wheel.pivot == Pivot::Castor);
        let is_plain = settings.readings == Readings::Angles
            && settings.method == Method::LeastSquares
            && !settings.inflate
            && settings.lasting() == 0
            && settings.wheel_noise.is_empty()
            && (settings.max_speed.is_none() || !castors());
        let encoders = (|wheel| settings.wheel_encoder(wheel), |joint| settings.steering_encoder(joint));
        is_plain.then(|| Self::new(rover, encoders.0, encoders.1)).flatten()
    }

    /// Nothing where the normal equations depend on the readings, a counter starts over, or the machine has no kernel.
    pub fn new(
        rover: &Rover,
        wheel_encoder: impl Fn(usize) -> Encoder,
        steering_encoder: impl Fn(usize) -> Encoder,
    ) -> Option<Self> {
        let level = level()?;
        let solution = rover.solution?;
        if rover.reading_bound > LARGEST_ROVER {
            return None;
        }
        let share = |row: Vector3<f64>| rover.unshifted(&(solution * rover.shifted(&row)));
        let nobody = Group { wheels: [usize::MAX; GROUP], ..Group::default() };
        let order = order(rover);
        let mut groups = vec![nobody; order.len().div_ceil(GROUP)];
        for (k, &i) in order.iter().enumerate() {
            let (wheel, group, lane) = (&rover.wheels()[i], &mut groups[k / GROUP], k % GROUP);
            let encoder = wheel_encoder(i);
            if encoder.modulus.is_some() {
                return None;
            }
            group.wheels[lane] = i;
            group.count = lane + 1;
            group.per_count[0][lane] = encoder.angle_per_count();
            let rows = match rover.mounts[i] {
                Mount::Castor(_) => continue,
                Mount::Fixed(rows) => [rows.rolling, rows.side_slip],
                Mount::Steered(..) => {
                    let encoder = steering_encoder(k);
                    if encoder.modulus.is_some()
                        || wheel.roller_angle.is_some()
                        || wheel.heading.abs() > LARGEST_ANGLE / 2.0
                    {
                        return None;
                    }
                    group.steered += 1;
                    group.steers[lane] = 1.0;
                    group.heading[lane] = wheel.heading;
                    group.per_count[1][lane] = encoder.angle_per_count();
                    [Vector3::new(1.0, 0.0, -wheel.y), Vector3::new(0.0, 1.0, wheel.x)]
                }
            };
            group.radius[lane] = wheel.radius;
            group.passed_on[lane] = wheel.passed_on().map_or(0.0, |share| share * share);
            (group.pivot[0][lane], group.pivot[1][lane]) = (wheel.x, wheel.y);
            for (which, row) in rows.into_iter().enumerate() {
                group.has[which][lane] = f64::from(u8::from(row.x != 0.0 || row.y != 0.0));
                let share = share(row);
                for part in 0..3 {
                    group.rows[which][part][lane] = row[part];
                    group.shares[which][part][lane] = share[part];
                }
            }
        }
        Some(Self { level, rooms: vec![StepScratch::default(); groups.len()], groups })
    }
}
