//! Conditions under which a brake may be set or released.
//!
//! Both pairs may be locked where the axle lines share a point: else the robot cannot move. Both may be free where they
//! do not: else the wheel speeds do not determine whether the body moves or the axles turn about their pivots. At any
//! angles one of the two is allowed, so that a robot at rest can always change from one free pair to the other.

use nalgebra::{Matrix2, Vector2, Vector3};

use super::brakes::{Brake, Brakes, Pair};
use super::{Axles, FourAxle, RANK_TOLERANCE, pair_motions};
use six_wheel_numerics::error::{Error, ErrorKind, numbers};
use six_wheel_numerics::jacobi::Jacobi;

impl FourAxle {
    /// Locks a pair. Fails, without effect, where both pairs locked could not move.
    pub fn lock(&self, angles: &Axles, brakes: Brakes, pair: Pair) -> Result<Brakes, Error> {
        self.check_angles(angles)?;
        let locked = brakes.with(pair, Brake::Locked);
        if locked == brakes || !locked.both(Brake::Locked) {
            return Ok(locked);
        }
        self.check_free(angles, pair).map(|()| locked)
    }

    /// Fails if both pairs locked could not move; the error names the nearest possible angles of this pair.
    pub(super) fn check_free(&self, angles: &Axles, pair: Pair) -> Result<(), Error> {
        let mobility = self.mobility_unchecked(angles);
        if mobility.degree() > 0 {
            return Ok(());
        }
        let remedy = self
            .nearest_lockable_angles(angles, pair)
            .map_or_else(|| "beyond the steering range".into(), |[left, right]| format!("({left:.6}, {right:.6})"));
        let rule = format!(
            "let the robot move with front and rear locked (axle lines without a common point: \
             driving slides {:.3} m per metre, smallest singular value {:.3}; beside the {} axles as they \
             are, {} must be at {remedy})",
            mobility.slip,
            mobility.singular_values[2],
            pair.other().name(),
            pair.name(),
        );
        Err(Error::value("steering", rule, numbers(angles)).of_kind(ErrorKind::Infeasible))
    }

    /// Frees a pair. Fails, without effect, where with both pairs free the wheel speeds would not determine the motion.
    ///
    /// The counterpart of [`Self::lock`]: with both pairs free the axle lines must not share a point. Otherwise the
    /// same wheel speeds could move the body or turn its axles about their pivots.
    pub fn release(&self, angles: &Axles, brakes: Brakes, pair: Pair) -> Result<Brakes, Error> {
        self.check_angles(angles)?;
        let freed = brakes.with(pair, Brake::Free);
        if freed == brakes || !freed.both(Brake::Free) || self.mobility_unchecked(angles).degree() == 0 {
            return Ok(freed);
        }
        let rule = format!(
            "hold the body while front and rear are free (the robot could move, and no brake would say how; \
             lock {} first)",
            pair.other().name()
        );
        Err(Error::value("steering", rule, numbers(angles)).of_kind(ErrorKind::Infeasible))
    }

    /// Sets both brakes: locks first, or releases first where both pairs locked could not move.
    pub fn switch(&self, angles: &Axles, from: Brakes, to: Brakes) -> Result<Brakes, Error> {
        let pairs = [Pair::Rear, Pair::Front];
        let right = |brake: Brake| pairs.into_iter().filter(move |pair| to.of(*pair) == brake);
        let locks = |from| right(Brake::Locked).try_fold(from, |brakes, pair| self.lock(angles, brakes, pair));
        let releases = |from| right(Brake::Free).try_fold(from, |brakes, pair| self.release(angles, brakes, pair));
        locks(from).and_then(releases).or_else(|refused| releases(from).and_then(locks).map_err(|_| refused))
    }

    /// Angles of a pair at which it can be locked while the other pair keeps its angles: of these the ones with the
    /// least slip of the present axles [rad].
    fn nearest_lockable_angles(&self, angles: &Axles, pair: Pair) -> Option<[f64; 2]> {
        let normals = self.side_slip(angles);
        let [left, right] = pair.axles();
        let held = pair_motions(&normals, pair.other());
        let (one, two) = (held.turn.column(2), held.turn.column(1));
        let slip = |motion: &Vector3<f64>| {
            Vector2::new(normals.row(left).transpose().dot(motion), normals.row(right).transpose().dot(motion))
        };
        let motion = if held.values.y > RANK_TOLERANCE {
            one.into_owned()
        } else {
            // Axles in line: the centre of rotation may be any point of their line.
            let slips = Matrix2::from_columns(&[slip(&one.into_owned()), slip(&two.into_owned())]);
            let best = Jacobi::new(&slips).turn.column(1).into_owned();
            one * best.x + two * best.y
        };
        let aimed = self.aim(self.unit(motion), angles).ok()?;
        Some([aimed[left], aimed[right]])
    }
}
