//! The Denavit-Hartenberg table of dimensions, and the frames of its rows.

use nalgebra::{Matrix3, Rotation3, Vector3};

use super::chain::Chain;
use super::dimensions::Dimensions;
use super::placed::{Placed, WheelFrame};
use six_wheel_kinematics::geometry::Direction;

/// Number of frames of the chain.
pub const FRAMES: usize = 15;

/// Largest number of joints: rocker, two bogies, six steered wheels.
pub const MAX_JOINTS: usize = 9;

// Indices of frames: where a chain continues.
const D: usize = 0;
const B1: usize = 1;
const B2: usize = 2;
const S1: usize = 3;
const A1: usize = 9;

const MOUNTS: [&str; 6] = ["S1", "S2", "S3", "S4", "S5", "S6"];
const AXLES: [&str; 6] = ["A1", "A2", "A3", "A4", "A5", "A6"];

// Indices of joints, with the sign of their angle in a row.
const RHO: Turn = Some((0, 1.0));
const MINUS_RHO: Turn = Some((0, -1.0));
const BETA_1: Turn = Some((1, 1.0));
const BETA_2: Turn = Some((2, 1.0));
/// Index of the first steering joint.
pub(super) const FIRST_PSI: usize = 3;

// The angles alpha of the chain: a quarter turn down, 0, a quarter turn up, exactly.
const DOWN: Direction = Direction { sin: -1.0, cos: 0.0 };
const LEVEL: Direction = Direction { sin: 0.0, cos: 1.0 };
const UP: Direction = Direction { sin: 1.0, cos: 0.0 };

/// The joint whose angle is added to a link's gamma, and the sign with which it is.
pub type Turn = Option<(usize, f64)>;

/// One row of the table: `Rotz(gamma + joint) Transz(d) Transx(a) Rotx(alpha)` from the parent.
#[derive(Clone, Copy, Debug)]
pub struct Link {
    /// Name of the frame: D, B1, B2, S1 to S6, A1 to A6; odd left, even right.
    pub frame: &'static str,
    /// Index of the frame it starts from; `None` is the rover's own, R.
    pub parent: Option<usize>,
    /// The joint that turns it.
    pub joint: Turn,
    /// Angle about the parent's z axis at joint angle 0 [rad].
    pub gamma: f64,
    /// Shift along the parent's z axis [m].
    pub d: f64,
    /// Shift along the new x axis [m].
    pub a: f64,
    /// Angle about the new x axis.
    pub alpha: Direction,
}

impl Dimensions {
    /// The chain. Comments give the symbols of Tarokh et al. for Rocky 7.
    pub(super) fn links(&self) -> [Link; FRAMES] {
        let [k2, half_track, k1] = self.rocker_pivot;
        let [x_bogie, y_bogie, z_bogie] = self.rocker_to_bogie;
        let (k6, k9) = (x_bogie.hypot(z_bogie), (-z_bogie).atan2(x_bogie));
        let bogie = half_track + y_bogie; // k3
        let psi = |wheel| -> Turn {
            let mut steered = self.steered.wheels().iter();
            let place = steered.position(|&other| other == wheel)?;
            Some((FIRST_PSI + place, 1.0))
        };
        let row = |frame, parent, joint, gamma, d, a, alpha| Link { frame, parent, joint, gamma, d, a, alpha };
        let mut rows = [row("D", None, None, 0.0, k1, k2, DOWN); FRAMES];
        rows[B1] = row("B1", Some(D), RHO, k9, bogie, k6, LEVEL);
        rows[B2] = row("B2", Some(D), MINUS_RHO, k9, -bogie, k6, LEVEL);
        for wheel in 0..6 {
            let (pair, left) = (wheel / 2, wheel % 2 == 0);
            // k4, 0, -k5 in front; k7, k3b, -k8 and -k7, k3b, -k8 on the bogie
            let [x, y, z] = self.to_wheel(pair);
            let side = if left { 1.0 } else { -1.0 };
            let (mount, axle) = (MOUNTS[wheel], AXLES[wheel]);
            rows[S1 + wheel] = if self.bogie.carries(pair) {
                let (parent, beta) = if left { (B1, BETA_1) } else { (B2, BETA_2) };
                row(mount, Some(parent), beta, -k9, side * y, x, UP)
            } else {
                let rho = if left { RHO } else { MINUS_RHO };
                row(mount, Some(D), rho, 0.0, side * (half_track + y), x, UP)
            };
            rows[A1 + wheel] = row(axle, Some(S1 + wheel), psi(wheel), 0.0, z, 0.0, LEVEL);
        }
        rows
    }
}

/// `rover_from_frame`: rotation, and origin [m].
pub type Frame = (Matrix3<f64>, Vector3<f64>);

/// All frames of a table for its chain with the body at the origin. They are fixed to links and wheels of the chain;
/// each has its z axis along the joint of the next.
pub(super) fn frames(links: &[Link; FRAMES], chain: &Chain, placed: &Placed<'_>) -> [Frame; FRAMES] {
    let down = Matrix3::from_columns(&[Vector3::x(), -Vector3::z(), Vector3::y()]);
    let mut frames = [(down, Vector3::new(links[D].a, 0.0, links[D].d)); FRAMES];
    let bogie = down * Rotation3::from_axis_angle(&Vector3::z_axis(), links[B1].gamma);
    for (side, frame) in [B1, B2].into_iter().enumerate() {
        let ((rocker, _), (_, origin)) = (placed.part(side), placed.part(2 + side));
        frames[frame] = (rocker * bogie, origin);
    }
    for wheel in 0..AXLES.len() {
        let mount = chain.mount(wheel);
        let WheelFrame { centre, forward, axle, up } = placed.wheel(wheel);
        let carrier = mount.link.map_or(placed.rotation, |link| placed.part(link).0);
        frames[S1 + wheel] = (carrier, centre - up * mount.centre[2]);
        frames[A1 + wheel] = (Matrix3::from_columns(&[forward, axle, up]), centre);
    }
    frames
}
