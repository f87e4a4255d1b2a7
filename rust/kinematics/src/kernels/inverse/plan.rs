//! The constants of a rover for the inverse kinematics of many rows, and the twists that surely pass.

use pulp::Simd;

use crate::geometry::Twist;
use crate::kernels::choice::SteeringQuery;
use crate::kernels::cone::Cone;
use crate::kernels::steered::{EITHER, ONLY, Reach, Steered};
use crate::rover_data::{Inputs, Mount, RoverData};
use crate::wheels::Wheel;
use six_wheel_numerics::error::Error;
use six_wheel_numerics::simd::lanes::{Lanes, Mask};
use six_wheel_numerics::weave::Column;

/// Constants of one wheel, by its kind.
#[derive(Clone, Copy, Debug)]
pub enum WheelKind {
    /// Rolling row of a fixed wheel.
    Fixed([f64; 3]),
    /// A castor.
    Castor(Steered),
    /// A steered wheel.
    Steered(Steered),
}

/// Constants of a rover for the inverse kernel.
pub struct InverseConstants<'a> {
    /// The rover.
    pub rover: &'a RoverData,
    /// Its admissible twists.
    pub cone: &'a Cone,
    /// Every wheel with one over its radius.
    pub parts: Vec<(WheelKind, f64)>,
    /// Number of its steering joints.
    pub joints: usize,
    /// Side-slip rows of its axle groups.
    pub banks: Vec<[f64; 3]>,
    /// True if every steered wheel has a [`Reach`], which decides its angle except at rest and at the
    /// ends of the range.
    pub(crate) is_simple: bool,
    /// True if every steered wheel has [`ONLY`] one way of making a motion, unless it rests.
    pub(crate) is_inner: bool,
    /// True if some wheels may have to ask the others which of two ways to go ([`EITHER`]).
    pub(crate) asks: bool,
}

impl<'a> InverseConstants<'a> {
    /// Nothing where sizes are extreme.
    pub fn new(rover: &'a RoverData, cone: &'a Cone) -> Option<Self> {
        let part = |(wheel, mount): (&Wheel, &Mount)| {
            let part = match (*mount, Steered::new(wheel, *mount)) {
                (Mount::Castor(_), Some(steered)) => WheelKind::Castor(steered),
                (_, Some(steered)) => WheelKind::Steered(steered),
                (Mount::Fixed(rows), None) => WheelKind::Fixed(rows.rolling.into()),
                (_, None) => return None,
            };
            Some((part, 1.0 / wheel.radius))
        };
        let wheels = rover.wheels();
        let parts: Option<Vec<_>> = wheels.iter().zip(&rover.mounts).map(part).collect();
        let parts = parts?;
        let all = |holds: &dyn Fn(&Reach) -> bool| {
            parts.iter().all(|(part, _)| match part {
                WheelKind::Steered(steered) => steered.reach.as_ref().is_some_and(holds),
                WheelKind::Fixed(_) | WheelKind::Castor(_) => true,
            })
        };
        Some(Self {
            rover,
            cone,
            is_simple: all(&|_| true),
            is_inner: all(&|reach| reach.ways == ONLY),
            asks: !all(&|reach| reach.ways != EITHER),
            parts,
            joints: rover.steered().len(),
            banks: rover.banks.iter().map(|bank| bank.row.into()).collect(),
        })
    }

    /// Row by row; `row` is the first of the twists among those of the inputs, `first` among those of the batch.
    pub(crate) fn check_rows(
        &self,
        twists: &[[f64; 3]],
        inputs: Inputs<'_>,
        row: usize,
        first: usize,
    ) -> Result<(), Error> {
        for (k, twist) in twists.iter().enumerate() {
            let inputs = inputs.row(self.rover, row + k);
            let checked = inputs.check().and_then(|()| self.rover.check(Twist::from(*twist), inputs.steering_rates));
            checked.map_err(|error| error.at_row(first + row + k))?;
        }
        Ok(())
    }

    /// Lanes whose twist the plain core would surely let pass.
    #[inline(always)]
    pub(crate) fn passes<S: Simd>(&self, simd: S, twist: [Lanes<S>; 3], rates: &[Column], k: usize) -> Mask<S> {
        let mut passes = self.cone.judge(simd, twist).yes;
        if self.cone.is_whole {
            return passes;
        }
        let zero = Lanes::splat(simd, 0.0);
        let mut joint = 0;
        for (part, _) in &self.parts {
            let WheelKind::Steered(steered) = part else {
                continue;
            };
            if steered.trail != 0.0 {
                let rate = rates.get(joint).map_or(zero, |rates| rates.load(simd, k));
                let mut fits = steered.reaches(simd, twist, rate);
                if (!fits).any() {
                    let asked = SteeringQuery { twist, before: zero, rate };
                    let chosen = steered.choose(simd, asked, None);
                    fits = fits | (chosen.inside & chosen.sure);
                }
                passes = passes & fits;
            }
            joint += 1;
        }
        passes
    }
}

/// The rows of a block out of those of a batch.
pub(crate) fn block(values: Option<&[f64]>, width: usize, first: usize, count: usize) -> &[f64] {
    values.map_or(&[], |values| &values[first * width..(first + count) * width])
}
