//! Rovers on real ground: how the rates of body, joints and wheels belong together.
//!
//! At a contact the normal of the ground is `n`, the tangent of the rim `T = h cos t + u sin t`, and `l = n x T` points
//! to the left. The velocity of the touching point is 0 along `n`; along `T`, with the wheel's own rotation included,
//! and along `l` it is 0 where the wheel does not slip. These velocities are linear in the body's six rates and the
//! rates of the joints ([`Contacts`]); vectors are in the axes of the body, a twist is `(vx, vy, vz, wx, wy, wz)` of
//! the body's origin.
//!
//! An encoder measures the wheel's rotation against the link that carries it: its rate is `v_c . T / r - w . axle`,
//! with the velocity `v_c` of the wheel's centre and the angular velocity `w` of the link.
//!
//! (M. Tarokh, G. McDermott, Kinematics modeling and analyses of articulated rovers, IEEE T-RO 21(4), 2005;
//! N. Seegmiller, A. Kelly, Enhanced 3D kinematic modeling of wheeled mobile robots, RSS 2014.)

#[macro_use]
extern crate six_wheel_numerics;

mod contact;
pub mod driving;
mod lanes;
mod motion;
mod rates;
mod response;
mod rows;
mod slip;
pub mod spatial;
mod steering;
mod unmapped;

pub use contact::{Contacts, rest_offset};
pub use driving::{Drives, Driving, Lift, Turns};
pub use lanes::settled_poses::{SettledPoseInput, SettledPoses};
pub use motion::{BodyMotion, Command, Readings, View};
pub use rates::contact_rows::COLUMNS;
pub use rates::point_rows::Row;
pub use response::Response;
pub use rows::{
    BodyMotions, Commands, Prepared, ReadingRows, SlipInput, Slips, forward_rows, inverse_rows, slip_rows,
    traction_rows,
};
pub use slip::SlipTest;
pub use unmapped::{AVERAGING_LENGTH, ClimbInput, SiteContacts, Unmapped};
