//! Constants of a rover and its encoders for the kernels of a step of odometry, and their memory.

use nalgebra::{Matrix3, Vector3};

use crate::settings::encoder::Encoder;
use crate::settings::{Readings, Settings};
use six_wheel_kinematics::estimate::Method;
use six_wheel_kinematics::kernels::normal_equations::LARGEST_ROVER;
use six_wheel_kinematics::kernels::wheel_lanes::{Eight, GROUP, level, order};
use six_wheel_kinematics::rover::{Mount, Rover};
use six_wheel_kinematics::wheels::Pivot;
use six_wheel_numerics::simd::level::Level;

/// Three numbers per wheel.
pub(crate) type Triple = [Eight; 3];

/// Constants of a rover and its encoders for the kernels of a step, and their memory.
///
/// Invariants: the wheels are in the lanes in [`order`], steered ones first, so that steered wheel `k` of the rover is
/// lane `k % GROUP` of group `k / GROUP`. Lanes without a wheel hold zeros: their radius, rows and shares are 0, so
/// that they add nothing to any sum, and their entry of `wheels` is no index of any array. Castors have the same zeros.
/// Every step writes `scratch` and `fitted` before it reads them; they are undefined between steps.
#[derive(Clone, Debug)]
pub(crate) struct StepConstants {
    pub(crate) level: Level,
    pub(crate) groups: Vec<Group>,
    /// One per group.
    pub(crate) scratch: Vec<StepScratch>,
    /// Rows of the wheels where they are not constants, one per group.
    pub(crate) fitted: Vec<WheelRows>,
    /// True if the solution of the least squares is a constant of the rover, and with it [`Group::shares`].
    pub(crate) is_constant: bool,
    /// True if readings are running totals whose differences are the increments: no encoder has a modulus, and no speed
    /// of a castor is limited.
    pub(crate) is_direct: bool,
}

/// Rows of eight wheels in the equations of a step.
#[derive(Clone, Debug, Default)]
pub(crate) struct WheelRows {
    /// Rolling and side-slip row.
    pub(crate) rows: [Triple; 2],
    /// 1 where a wheel has the row, 0 without a wheel or a reading, and for side-slip rows of wheels with rollers.
    pub(crate) has: [Eight; 2],
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
    /// Hub to ground [m].
    pub(crate) radius: Eight,
    /// Position of the pivot in the body, x and y [m].
    pub(crate) pivot: [Eight; 2],
    /// Constant rows. Those of a steered wheel are `a_0`, `b_0` for the heading 0; at the heading phi they are
    /// `a = cos phi a_0 + sin phi b_0` and `b = cos phi b_0 - sin phi a_0`.
    pub(crate) constant: WheelRows,
    /// Displacement [m, m, rad] that a metre measured along either row adds to the least-squares solution, for the
    /// constant rows.
    pub(crate) shares: [Triple; 2],
    /// Factor of the slip variance.
    pub(crate) slip_factor: Eight,
    /// Factor from the variance of slip across a wheel to that along it, by its rollers: `cot²(roller angle)`.
    pub(crate) passed_on: Eight,
}

/// Memory of eight wheels between the two halves of a step.
#[derive(Clone, Debug, Default)]
pub(crate) struct StepScratch {
    /// Displacement [m, m, rad] that a metre measured along either row adds, for the rows in the middle of the step,
    /// times the weight of the wheel.
    pub(crate) shares: [Triple; 2],
    /// Distance along the wheel's heading; of a steered wheel the chord of its arc [m].
    pub(crate) rolled: Eight,
    /// Distances measured along both rows [m].
    pub(crate) measured: [Eight; 2],
    /// Length of the residual [m].
    pub(crate) slid: Eight,
    /// Variance of the residual [m²].
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
    /// The constants of a rover with these settings.
    pub fn new(settings: &Settings, rover: &Rover) -> Self {
        let castors = || rover.wheels().iter().any(|wheel| wheel.pivot == Pivot::Castor);
        let has_constant_solution = settings.method == Method::LeastSquares
            && settings.readings != Readings::Speeds
            && settings.constant_error_count() == 0
            && rover.reading_bound <= LARGEST_ROVER;
        let solution = rover.solution.filter(|_| has_constant_solution);
        let mut constants = Self {
            level: level(),
            groups: Vec::new(),
            scratch: Vec::new(),
            fitted: Vec::new(),
            is_constant: solution.is_some(),
            is_direct: settings.readings == Readings::Angles && (settings.max_speed.is_none() || !castors()),
        };
        let order = order(rover);
        for (g, wheels) in order.chunks(GROUP).enumerate() {
            let mut group = Group { wheels: [usize::MAX; GROUP], ..Group::default() };
            for (lane, &i) in wheels.iter().enumerate() {
                let joint = settings.steering_encoder(g * GROUP + lane);
                let encoders = [settings.wheel_encoder(i), joint];
                let is_known = group.push(lane, i, rover, encoders, solution.as_ref());
                constants.is_constant &= is_known;
                let is_steered = matches!(rover.mounts[i], Mount::Steered(..));
                let has_modulus = encoders[0].modulus.is_some() || is_steered && joint.modulus.is_some();
                constants.is_direct &= !has_modulus;
                let factor = settings.wheel_noise.get(i).copied().unwrap_or(1.0);
                group.slip_factor[lane] = factor * factor;
            }
            constants.groups.push(group);
        }
        constants.scratch.resize(constants.groups.len(), StepScratch::default());
        constants.fitted.resize(constants.groups.len(), WheelRows::default());
        constants
    }
}

impl Group {
    /// Adds wheel `i` of the rover. Returns false if its rows are not constants rotated by its steering angle.
    fn push(
        &mut self,
        lane: usize,
        i: usize,
        rover: &Rover,
        encoders: [Encoder; 2],
        solution: Option<&Matrix3<f64>>,
    ) -> bool {
        let wheel = &rover.wheels()[i];
        self.wheels[lane] = i;
        self.count = lane + 1;
        self.per_count[0][lane] = encoders[0].angle_per_count();
        let mut is_known = true;
        let rows = match rover.mounts[i] {
            Mount::Castor(_) => return true,
            Mount::Fixed(rows) => [rows.rolling, rows.side_slip],
            Mount::Steered(..) => {
                is_known = wheel.roller_angle.is_none();
                self.steered += 1;
                self.steers[lane] = 1.0;
                self.heading[lane] = wheel.heading;
                self.per_count[1][lane] = encoders[1].angle_per_count();
                wheel.pivot_rows()
            }
        };
        self.radius[lane] = wheel.radius;
        self.passed_on[lane] = wheel.passed_on().map_or(0.0, |share| share * share);
        (self.pivot[0][lane], self.pivot[1][lane]) = (wheel.x, wheel.y);
        for (which, row) in rows.into_iter().enumerate() {
            self.constant.set(which, lane, &row);
            if let Some(solution) = solution {
                let share = rover.twist_at_origin(&(solution * rover.row_about_centre(&row)));
                set(&mut self.shares[which], lane, &share);
            }
        }
        is_known
    }
}

impl WheelRows {
    /// Sets the rolling (0) or the side-slip row (1) of a wheel.
    pub fn set(&mut self, which: usize, lane: usize, row: &Vector3<f64>) {
        set(&mut self.rows[which], lane, row);
        self.has[which][lane] = f64::from(u8::from(row.x != 0.0 || row.y != 0.0));
    }
}

/// Sets the vector of a lane.
pub(crate) fn set(triple: &mut Triple, lane: usize, vector: &Vector3<f64>) {
    for (part, number) in triple.iter_mut().zip(vector.iter()) {
        part[lane] = *number;
    }
}
