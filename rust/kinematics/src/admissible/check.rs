//! Checks of single twists: the condition that a twist violates first, and by how much.

use crate::admissible::cone::{AdmissibleCone, Rates, SLIP_TOLERANCE};
use crate::geometry::Twist;
use crate::rover_data::RoverData;
use six_wheel_numerics::error::{Error, ErrorKind, finite, numbers, radians, short};
use six_wheel_numerics::simd::lanes::{Lanes, Mask};
use six_wheel_numerics::simd::level::{Kernel, Level};
use six_wheel_numerics::simd::vector::Vector;

/// Cause that keeps a rover from a twist.
#[derive(Clone, Copy, Debug)]
enum InfeasibilityCause {
    /// The unsteered wheels of a bank slide sideways [m/s].
    Slip { bank: usize, slip: f64 },
    /// A wheel slides sideways at the end of its range, the steering angle nearest to that of the twist [rad, m/s].
    Range { wheel: usize, angle: f64, slip: f64 },
}

/// One twist, in every lane.
struct OneTwist<'a> {
    cone: &'a AdmissibleCone,
    twist: [f64; 3],
    rates: &'a [f64],
}

/// Decision on one twist.
struct Decision {
    is_possible: bool,
    is_valid: bool,
}

impl Kernel for OneTwist<'_> {
    type Output = Decision;

    #[inline(always)]
    fn run<S: Vector>(self, simd: S) -> Decision {
        let twist = self.twist.map(|part| Lanes::splat(simd, part));
        let decision = self.cone.admissibility(simd, twist, Rates::Row(self.rates));
        Decision { is_possible: decision.is_possible.any(), is_valid: decision.is_valid.any() }
    }
}

/// The first cause that keeps a rover from a twist, by the same operations as [`AdmissibleCone::admissibility`].
struct FindCause<'a>(OneTwist<'a>);

impl Kernel for FindCause<'_> {
    type Output = Option<InfeasibilityCause>;

    #[inline(always)]
    fn run<S: Vector>(self, simd: S) -> Self::Output {
        let OneTwist { cone, twist: [vx, vy, omega], rates } = self.0;
        let twist = [vx + 0.0, vy, omega].map(|part| Lanes::splat(simd, part));
        let rates = Rates::Row(rates);
        let tolerance = cone.fastest(simd, twist, rates).0 * Lanes::splat(simd, SLIP_TOLERANCE);
        let slides = |slip: Lanes<S>| -> bool {
            let is_within: Mask<S> = slip.le(tolerance);
            !is_within.any()
        };
        for bank in 0..cone.banks.len() {
            let slip = cone.bank_slip(simd, bank, twist);
            if slides(slip) {
                return Some(InfeasibilityCause::Slip { bank, slip: slip.last(simd) });
            }
        }
        for limited in &cone.limited {
            let [angle, slip] = limited.slip(simd, twist, rates);
            if slides(slip) {
                let (angle, slip) = (angle.last(simd), slip.last(simd));
                return Some(InfeasibilityCause::Range { wheel: limited.wheel, angle, slip });
            }
        }
        None
    }
}

impl AdmissibleCone {
    fn decide(&self, twist: Twist, rates: Option<&[f64]>) -> Decision {
        Level::Scalar.run_any(self.one_twist(twist, rates))
    }

    fn one_twist<'a>(&'a self, twist: Twist, rates: Option<&'a [f64]>) -> OneTwist<'a> {
        OneTwist { cone: self, twist: twist.into(), rates: rates.unwrap_or_default() }
    }

    /// Fails unless the rover can make the twist: finite, without side slip, inside the steering ranges.
    pub fn check(&self, rover: &RoverData, twist: Twist, steering_rates: Option<&[f64]>) -> Result<(), Error> {
        let decision = self.decide(twist, steering_rates);
        if decision.is_possible {
            return Ok(());
        }
        valid(twist, decision.is_valid)?;
        match Level::Scalar.run_any(FindCause(self.one_twist(twist, steering_rates))) {
            Some(cause) => Err(infeasibility_error(rover, cause, twist)),
            None => Ok(()),
        }
    }

    /// Fails unless the twist and every wheel speed are finite.
    pub fn check_speeds(&self, twist: Twist) -> Result<(), Error> {
        valid(twist, self.decide(twist, None).is_valid)
    }

    /// True if the rover can make a twist. Fails if it is not finite.
    #[inline]
    pub fn admissible(&self, twist: Twist) -> Result<bool, Error> {
        let decision = self.decide(twist, None);
        if !decision.is_valid {
            valid(twist, false)?;
        }
        Ok(decision.is_possible)
    }

    /// True if the rover can make a twist; false if it is not finite.
    pub(crate) fn is_possible(&self, twist: Twist) -> bool {
        self.decide(twist, None).is_possible
    }
}

/// Fails unless a twist and its wheel speeds are finite.
fn valid(twist: Twist, is_valid: bool) -> Result<(), Error> {
    if is_valid {
        return Ok(());
    }
    finite("twist", &<[f64; 3]>::from(twist))?;
    Err(infeasible("keep every wheel speed finite", twist).of_kind(ErrorKind::Value))
}

fn infeasibility_error(rover: &RoverData, cause: InfeasibilityCause, twist: Twist) -> Error {
    let rule = match cause {
        InfeasibilityCause::Slip { bank, slip } => {
            let names: Vec<_> =
                rover.banks[bank].wheels.iter().map(|&i| format!("{:?}", rover.wheels()[i].name)).collect();
            format!(
                "let the unsteered wheels {} roll without side slip (they would slide at {} m/s; \
                 project() finds a twist that does not)",
                names.join(", "),
                short(slip)
            )
        }
        InfeasibilityCause::Range { wheel, angle, slip } => {
            let wheel = &rover.wheels()[wheel];
            let range = wheel.steering().unwrap_or_default();
            format!(
                "let wheel {:?} steer within {range} (at {} it would slide at {} m/s; \
                 project() finds a twist that does not)",
                wheel.name,
                radians(angle),
                short(slip)
            )
        }
    };
    infeasible(rule, twist)
}

/// The failure of a motion that the rover cannot make.
pub(crate) fn infeasible(rule: impl ToString, twist: Twist) -> Error {
    Error::value("twist", rule, numbers(&<[f64; 3]>::from(twist))).of_kind(ErrorKind::Infeasible)
}
