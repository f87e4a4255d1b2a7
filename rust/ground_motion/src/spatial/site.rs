//! Ground of a step: a map, or unknown ground.

use nalgebra::Vector3;

use crate::Footing;
use six_wheel_terrain::ground::{Settler, Stand, Status};
use six_wheel_terrain::suspension::{Chain, MAX_FREE, MAX_WHEELS, PlanPose};
use six_wheel_terrain::terrain::{Terrain, normal};

/// Source of the contacts of a step.
pub(crate) enum ContactSource<'a> {
    /// Without a map: from the joint angles.
    Unmapped,
    /// From a settled pose on a map.
    Ground(&'a Place),
}

/// A settled pose, in the layout of [`Footing`].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Place {
    pub pose: PlanPose,
    pub stand: Stand,
    pub angles: [f64; MAX_WHEELS],
    steering: [f64; MAX_WHEELS],
    normals: [[f64; 3]; MAX_WHEELS],
    touching: [bool; MAX_WHEELS],
    stopped: [bool; MAX_FREE],
    joints: usize,
    steered: usize,
    wheels: usize,
}

impl Place {
    /// Settles a chain; the status where it does not stand.
    pub fn find(chain: &Chain, ground: &Terrain, pose: PlanPose, steering: &[f64; MAX_WHEELS]) -> Result<Self, Status> {
        if ![pose.x, pose.y, pose.yaw].iter().all(|part| part.is_finite()) {
            return Err(Status::NotConverged);
        }
        let steered = chain.steering().len();
        let stand = Settler::new(ground, chain).settle_finite(pose, &steering[..steered]);
        if !stand.status.stands() {
            return Err(stand.status);
        }
        let mut place = Self {
            pose,
            angles: [f64::NAN; MAX_WHEELS],
            steering: *steering,
            normals: [[f64::NAN; 3]; MAX_WHEELS],
            touching: [false; MAX_WHEELS],
            stopped: [false; MAX_FREE],
            joints: chain.joints().len(),
            steered,
            wheels: chain.wheels().len(),
            stand,
        };
        for wheel in 0..place.wheels {
            let contact = &stand.wheels[wheel];
            place.angles[wheel] = contact.angle();
            place.normals[wheel] = normal(contact.gradient).into();
            place.touching[wheel] = stand.touches(wheel);
        }
        for (stopped, stop) in place.stopped.iter_mut().zip(stand.stops) {
            *stopped = stop != 0;
        }
        Ok(place)
    }

    /// The settled pose as input of the motion on the ground.
    pub fn footing(&self) -> Footing<'_> {
        let [_, roll, pitch, ref joints @ ..] = self.stand.state;
        Footing {
            attitude: [roll, pitch, self.pose.yaw],
            joints: &joints[..self.joints],
            steering: &self.steering[..self.steered],
            angles: &self.angles[..self.wheels],
            normals: &self.normals[..self.wheels],
            touching: self.touching,
            stopped: self.stopped,
        }
    }

    /// Derivatives by x, y and yaw of z, and of the body's rotation in axes of the world. None where that is not
    /// determined.
    pub fn slopes(&self, chain: &Chain) -> Option<[(f64, Vector3<f64>); 3]> {
        let steering = &self.steering[..self.steered];
        // The derivatives do not depend on x and y of the body.
        let placed = chain.place(PlanPose { x: 0.0, y: 0.0, ..self.pose }, &self.stand.state, steering)?;
        let by = six_wheel_terrain::ground::by_pose(chain, &placed, &self.stand)?;
        Some(std::array::from_fn(|k| {
            let about = placed.roll_axis * by[1][k] + placed.pitch_axis * by[2][k];
            let upright = if k == 2 { Vector3::z() } else { Vector3::zeros() };
            (by[0][k], about + upright)
        }))
    }
}
