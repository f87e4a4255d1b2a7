//! Ground of a step: a map, or unknown ground.

use nalgebra::{Rotation3, Vector3};

use crate::contact::{Contact, ContactPlane, Contacts};
use crate::rates::point_rows::in_body;
use six_wheel_kinematics::geometry::Direction;
use six_wheel_terrain::ground::{Settler, Stand, Status};
use six_wheel_terrain::suspension::{Chain, MAX_WHEELS, PlanPose};
use six_wheel_terrain::terrain::{Terrain, normal};

/// Source of the contacts of a step.
pub(crate) enum ContactSource<'a> {
    /// Without a map: from the joint angles.
    Unmapped,
    /// From a settled pose on a map.
    Ground(&'a Place),
}

/// A settled pose.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Place {
    pub pose: PlanPose,
    pub stand: Stand,
    steering: [f64; MAX_WHEELS],
}

impl Place {
    /// Settles a chain; the status where it does not stand.
    pub fn find(chain: &Chain, ground: &Terrain, pose: PlanPose, steering: &[f64; MAX_WHEELS]) -> Result<Self, Status> {
        if ![pose.x, pose.y, pose.yaw].iter().all(|part| part.is_finite()) {
            return Err(Status::NotConverged);
        }
        let stand = Settler::new(ground, chain).settle_finite(pose, &steering[..chain.steering().len()]);
        if !stand.status.stands() {
            return Err(stand.status);
        }
        Ok(Self { pose, stand, steering: *steering })
    }

    fn angles(&self, chain: &Chain) -> &[f64] {
        &self.steering[..chain.steering().len()]
    }

    /// The contacts of the wheels. None where a differential does not reach.
    pub fn contacts(&self, chain: &Chain) -> Option<Contacts> {
        let [_, roll, pitch, ref joints @ ..] = self.stand.state;
        let placed = in_body(chain, &joints[..chain.joints().len()], self.angles(chain))?;
        let body_from_world = Rotation3::from_euler_angles(roll, pitch, self.pose.yaw).inverse();
        let mut contacts = Contacts::none(chain, self.stand.stops.map(|stop| stop != 0));
        for (k, mount) in chain.wheels().iter().enumerate() {
            let contact = &self.stand.wheels[k];
            let plane = ContactPlane {
                frame: placed.wheel(k),
                normal: body_from_world * normal(contact.gradient),
                radius: mount.radius,
                at: Direction::from(contact.angle()),
            };
            contacts.wheels[k] = Contact::new(&placed, k, &plane, self.stand.touches(k));
        }
        Some(contacts)
    }

    /// Derivatives by x, y and yaw of z, and of the body's rotation in axes of the world. None where that is not
    /// determined.
    pub fn slopes(&self, chain: &Chain) -> Option<[(f64, Vector3<f64>); 3]> {
        // The derivatives do not depend on x and y of the body.
        let placed = chain.place(PlanPose { x: 0.0, y: 0.0, ..self.pose }, &self.stand.state, self.angles(chain))?;
        let by = six_wheel_terrain::ground::by_pose(chain, &placed, &self.stand)?;
        Some(std::array::from_fn(|k| {
            let about = placed.roll_axis * by[1][k] + placed.pitch_axis * by[2][k];
            let upright = if k == 2 { Vector3::z() } else { Vector3::zeros() };
            (by[0][k], about + upright)
        }))
    }
}
