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

/// One row with steered wheels that are all `CENTRED` or not, of up to so many joints. None where it is a rare one.
struct ForwardRow<'a, const CENTRED: bool, const JOINTS: usize> {
    constants: &'a ForwardConstants,
    measured: Measured<'a>,
}

impl<const CENTRED: bool, const JOINTS: usize> Kernel for ForwardRow<'_, CENTRED, JOINTS> {
    type Output = Option<Twist>;

    #[inline(always)]
    fn run<S: Vector>(self, simd: S) -> Option<Twist> {
        let Self { constants, measured } = self;
        let [mut sines, mut cosines] = [[0.0; JOINTS]; 2];
        let angles = measured.steering.chunks(S::F64_LANES);
        for (k, (angles, heading)) in angles.zip(S::as_simd_f64s(&constants.headings).0).enumerate() {
            let heading = Lanes::load(simd, std::slice::from_ref(heading), 0);
            let (sin, cos) = sin_cos(simd, padded(simd, angles) + heading);
            sin.store(S::as_mut_simd_f64s(&mut sines).0, k);
            cos.store(S::as_mut_simd_f64s(&mut cosines).0, k);
        }
        let row = SingleRow { measured, sines: &sines, cosines: &cosines };
        let sums = constants.sum::<Scalar, SingleRow<'_>, false, CENTRED>(Scalar, row, &mut []);
        let (unknowns, is_solved) = constants.solve::<Scalar, CENTRED>(Scalar, &sums);
        if !is_solved.any() {
            return None;
        }
        let [vx, vy, omega] = constants.unshifted(unknowns);
        Some(Twist { vx: vx.sum(), vy: vy.sum(), omega: omega.sum() })
    }
}

/// One row, its directions known.
#[derive(Clone, Copy)]
struct SingleRow<'a> {
    measured: Measured<'a>,
    sines: &'a [f64],
    cosines: &'a [f64],
}

impl<'a> ReadingLanes<'a, Scalar> for SingleRow<'a> {
    type Cell = f64;

    #[inline(always)]
    fn speeds(self) -> &'a [f64] {
        self.measured.speeds
    }

    #[inline(always)]
    fn load(self, simd: Scalar, cell: &f64) -> Lanes<Scalar> {
        Lanes::splat(simd, *cell)
    }

    #[inline(always)]
    fn store(self, cell: &mut f64, lanes: Lanes<Scalar>) {
        *cell = lanes.sum();
    }

    #[inline(always)]
    fn angle(self, simd: Scalar, joint: usize) -> Lanes<Scalar> {
        Lanes::splat(simd, self.measured.steering[joint])
    }

    #[inline(always)]
    fn direction(self, simd: Scalar, joint: usize, _: Lanes<Scalar>, _: f64) -> [Lanes<Scalar>; 2] {
        [Lanes::splat(simd, self.sines[joint]), Lanes::splat(simd, self.cosines[joint])]
    }

    #[inline(always)]
    fn rate(self, simd: Scalar, joint: usize) -> Option<Lanes<Scalar>> {
        match self.measured.steering_rates {
            Some(rates) => Some(Lanes::splat(simd, rates[joint])),
            None => None,
        }
    }
}
