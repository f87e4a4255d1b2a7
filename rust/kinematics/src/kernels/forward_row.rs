//! Forward kinematics of one row: the directions of the steered wheels are computed with the wheels in the lanes, the sums over
//! the wheels are those of a row among many.

use pulp::Scalar;

use super::normal_equations::{ForwardConstants, LARGEST_SPEED, ReadingLanes};
use super::wheel_lanes::{GROUP, padded};
use crate::estimate::{Measured, Unseen};
use crate::geometry::Twist;
use crate::rover_data::{MAX_WHEELS, RoverData};
use six_wheel_numerics::error::Error;
use six_wheel_numerics::simd::lanes::Lanes;
use six_wheel_numerics::simd::level::Kernel;
use six_wheel_numerics::simd::polynomials::sin_cos;
use six_wheel_numerics::simd::vector::Vector;

impl ForwardConstants {
    /// The twist of one row of readings.
    #[inline]
    pub fn solve_row(&self, rover: &RoverData, measured: Measured<'_>, unseen: Unseen) -> Result<Twist, Error> {
        if let Some(rates) = measured.steering_rates
            && !rates.iter().all(|rate| rate.abs() <= LARGEST_SPEED)
        {
            rover.check_readings(measured)?;
        }
        let twist = match (self.is_regular, self.solution.is_some(), self.joints <= GROUP) {
            (false, ..) => None,
            (true, true, true) => self.run::<true, GROUP>(measured),
            (true, false, true) => self.run::<false, GROUP>(measured),
            (true, true, false) => self.run::<true, MAX_WHEELS>(measured),
            (true, false, false) => self.run::<false, MAX_WHEELS>(measured),
        };
        twist.map_or_else(|| rover.forward_rarely(measured, unseen), Ok)
    }

    #[inline]
    fn run<const CENTRED: bool, const JOINTS: usize>(&self, measured: Measured<'_>) -> Option<Twist> {
        self.level.run_any(ForwardRow::<CENTRED, JOINTS> { constants: self, measured })
    }
}

/// One row of a rover with up to `JOINTS` steering joints; `CENTRED`: without scrub and trail. Its output is None for
/// rows of [`crate::rover_data::RoverData::forward_rarely`].
struct ForwardRow<'a, const CENTRED: bool, const JOINTS: usize> {
    constants: &'a ForwardConstants,
    measured: Measured<'a>,
}

impl<const CENTRED: bool, const JOINTS: usize> Kernel for ForwardRow<'_, CENTRED, JOINTS> {
    type Output = Option<Twist>;

    #[inline(always)]
    fn run<S: Vector>(self, simd: S) -> Option<Twist> {
        let Self { constants, measured } = self;
        let mut directions = [[0.0; JOINTS]; 3];
        for (group, headings) in constants.headings.iter().take(JOINTS / GROUP).enumerate() {
            for k in 0..GROUP / S::F64_LANES {
                let first = group * GROUP + k * S::F64_LANES;
                let Some(angles) = measured.steering.get(first..).filter(|angles| !angles.is_empty()) else {
                    break;
                };
                let angles = padded(simd, angles);
                let (sin, cos) = sin_cos(simd, angles + Lanes::load(simd, S::as_simd_f64s(headings).0, k));
                for (column, lanes) in directions.iter_mut().zip([angles, sin, cos]) {
                    lanes.store(S::as_mut_simd_f64s(column).0, first / S::F64_LANES);
                }
            }
        }
        let row = SingleRow { measured, directions: &directions };
        let sums = constants.sum::<Scalar, SingleRow<'_, JOINTS>, false, CENTRED>(Scalar, row, &mut []);
        let (unknowns, is_solved) = constants.solve::<Scalar, CENTRED>(Scalar, &sums);
        if !is_solved.any() {
            return None;
        }
        let [vx, vy, omega] = constants.twist_at_origin(unknowns);
        Some(Twist { vx: vx.sum(), vy: vy.sum(), omega: omega.sum() })
    }
}

/// One row: its readings, and the angles [rad] of its joints with the sines and cosines of the wheels' directions.
#[derive(Clone, Copy)]
struct SingleRow<'a, const JOINTS: usize> {
    measured: Measured<'a>,
    directions: &'a [[f64; JOINTS]; 3],
}

impl<const JOINTS: usize> SingleRow<'_, JOINTS> {
    /// Angle (0), sine (1) or cosine (2) of a joint.
    #[inline(always)]
    fn number(self, column: usize, joint: usize) -> Lanes<Scalar> {
        Lanes::splat(Scalar, self.directions[column][joint % JOINTS])
    }
}

#[inline_always]
impl<'a, const JOINTS: usize> ReadingLanes<'a, Scalar> for SingleRow<'a, JOINTS> {
    type Cell = f64;

    fn speeds(self) -> &'a [f64] {
        self.measured.speeds
    }

    fn load(self, simd: Scalar, cell: &f64) -> Lanes<Scalar> {
        Lanes::splat(simd, *cell)
    }

    fn store(self, cell: &mut f64, lanes: Lanes<Scalar>) {
        *cell = lanes.sum();
    }

    fn angle(self, _: Scalar, joint: usize) -> Lanes<Scalar> {
        self.number(0, joint)
    }

    fn direction(self, _: Scalar, joint: usize, _: Lanes<Scalar>, _: f64) -> [Lanes<Scalar>; 2] {
        [self.number(1, joint), self.number(2, joint)]
    }

    fn rate(self, simd: Scalar, joint: usize) -> Option<Lanes<Scalar>> {
        #[expect(clippy::manual_map, reason = "a closure over registers would be a call")]
        match self.measured.steering_rates {
            Some(rates) => Some(Lanes::splat(simd, rates[joint])),
            None => None,
        }
    }
}
