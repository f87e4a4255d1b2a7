//! Mobility of a rover at given steering angles, from the rank of its constraints.
//!
//! G. Campion, G. Bastin, B. d'Andrea-Novel, Structural properties and classification of kinematic and dynamic
//! models of wheeled mobile robots, IEEE Transactions on Robotics and Automation 12(1), 1996.

use nalgebra::Vector3;

use crate::admissible::Keep;
use crate::geometry::Direction;
use crate::geometry::Twist;
use crate::rover::Rover;
use crate::rover_data::{Inputs, MAX_WHEELS, Mount};
use six_wheel_numerics::error::{Error, finite};
use six_wheel_numerics::jacobi::{Jacobi, triangle};

/// Side slip per metre driven up to which steering angles count as concurrent [m/m]: far below what an
/// encoder resolves, far above rounding.
pub const CONCURRENT: f64 = 1e-6;

/// Degrees of freedom of a rover at given steering angles.
#[derive(Clone, Debug, PartialEq)]
pub struct Mobility {
    /// Dimension of the motions that no wheel resists: 0 is locked.
    pub degree_of_mobility: usize,
    /// Number of steering directions that can be chosen independently.
    pub degree_of_steerability: usize,
    /// Rank of the no-side-slip rows.
    pub rank: usize,
    /// Singular values of the no-side-slip rows, largest first, three of them.
    pub singular_values: [f64; 3],
    /// The free motions, one unit twist each.
    pub motions: Vec<Twist>,
}

impl Mobility {
    /// Sum of the degrees of mobility and steerability.
    pub fn degree_of_manoeuvrability(&self) -> usize {
        self.degree_of_mobility + self.degree_of_steerability
    }

    /// The singular value at the rank: the smallest one that is not zero, or 0 if all are.
    ///
    /// It is the distance of a locked rover from moving, or of a mobile one from losing a constraint.
    #[inline]
    pub fn margin(&self) -> f64 {
        self.rank.checked_sub(1).map_or(0.0, |last| self.singular_values[last])
    }
}

impl Rover {
    /// Mobility at these steering angles [rad]; without any, at the angles of a possible motion.
    ///
    /// Unsteered wheels count with the mean axle of their bank; wheels with rollers and castors resist nothing.
    pub fn mobility(&self, steering: Option<&[f64]>) -> Result<Mobility, Error> {
        let mut agreeing = [0.0; MAX_WHEELS];
        let steering = match steering {
            Some(angles) => {
                finite("steering", angles)?;
                angles
            }
            None => {
                let some_turn = Twist { vx: 1.0, vy: 0.0, omega: 0.1 / self.size };
                let twist = self.project(some_turn, Keep::Nearest)?;
                let (mut speeds, joints) = ([0.0; MAX_WHEELS], self.steered().len());
                let inputs = Inputs::default();
                self.inverse(twist, inputs, &mut agreeing, &mut speeds[..self.wheels().len()])?;
                &agreeing[..joints]
            }
        };
        let (fixed, all) = self.side_slip_rows(steering);
        let bound = decompose(&fixed).rank(CONCURRENT);
        let decomposed = decompose(&all);
        let rank = decomposed.rank(CONCURRENT);
        Ok(Mobility {
            degree_of_mobility: 3 - rank,
            degree_of_steerability: rank - bound,
            rank,
            singular_values: decomposed.values.into(),
            motions: (rank..3).map(|k| Twist::from(decomposed.turn.column(k).into_owned())).collect(),
        })
    }

    /// The rows of side slip: of the unsteered wheels alone, and of all wheels.
    fn side_slip_rows(&self, steering: &[f64]) -> (Vec<Vector3<f64>>, Vec<Vector3<f64>>) {
        let (mut fixed, mut steered) = (Vec::new(), Vec::new());
        let mut angles = steering.iter();
        for (i, (wheel, mount)) in self.wheels().iter().zip(&self.mounts).enumerate() {
            match mount {
                // Mobility depends on axles that are parallel or not; an estimate lets nearly parallel ones
                // share their rows.
                Mount::Fixed(rows) => {
                    let bank = self.banks.iter().find(|bank| bank.wheels.contains(&i));
                    fixed.push(bank.map_or(rows.side_slip, |bank| bank.row));
                }
                Mount::Castor(_) => {}
                Mount::Steered(..) => {
                    let angle = wheel.heading + angles.next().copied().unwrap_or_default();
                    steered.push(wheel.rows(Direction::from(angle)).side_slip);
                }
            }
        }
        let all = fixed.iter().chain(&steered).copied().collect();
        (fixed, all)
    }
}

/// Singular values and vectors of stacked rows.
fn decompose(rows: &[Vector3<f64>]) -> Jacobi<3, 3> {
    Jacobi::new(&triangle(rows.iter().copied()))
}
