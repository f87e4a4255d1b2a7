//! `six_wheel.SettledPose`: settled poses.

use std::sync::Arc;

use numpy::Element;
use pyo3::prelude::*;
use pyo3::types::PyString;
use six_wheel_ground_motion::SettledPoses;
use six_wheel_kinematics::geometry::Direction;
use six_wheel_terrain::ground::{self, Contact, DIMENSIONS, by_dimension, by_pose, rim_point};
use six_wheel_terrain::suspension::{MAX_FREE, Placed, PlanPose};
use six_wheel_terrain::terrain::Terrain;

use crate::convert::{Array, OrRaise, Output, memory, scalar_or_array};
use crate::suspension::{RockerBogie, Suspension};

/// Settled poses of a rover on ground, as many as were asked for, each with its status.
///
/// Arrays have the leading axes of the poses, and are made when they are asked for. Numbers are NaN where the
/// rover does not stand, and for wheels over which nothing is known. Wheels are in the order of
/// `Suspension.wheel_names`.
#[pyclass(frozen, module = "six_wheel", name = "SettledPose")]
pub struct Stand {
    /// The suspension that stands.
    pub suspension: Py<Suspension>,
    /// The ground below it.
    pub ground: Arc<Terrain>,
    /// Rows x, y, yaw.
    pub poses: Vec<[f64; 3]>,
    /// None, one row, or one per pose.
    pub steering: Vec<f64>,
    /// The settled poses.
    pub stands: Vec<ground::Stand>,
    /// Leading axes.
    pub leading: Vec<usize>,
    /// True if derivatives were asked for.
    pub derivatives: bool,
}

impl Stand {
    /// Steering angles of a row.
    pub fn angles(&self, row: usize) -> &[f64] {
        let joints = self.suspension.get().chain.steering().len();
        if self.steering.len() > joints { &self.steering[row * joints..][..joints] } else { &self.steering }
    }

    /// The chain at a row, by its distances from node (0, 0) of the ground; None where it does not stand.
    pub fn placed(&self, row: usize) -> Option<Placed<'_>> {
        let chain = &self.suspension.get().chain;
        let pose = PlanPose::from(self.poses[row]);
        self.stands[row].place(chain, &self.ground, pose, self.angles(row))
    }

    /// As calls of the core take them.
    pub fn footings(&self) -> SettledPoses<'_> {
        SettledPoses::Settled { stands: &self.stands, poses: &self.poses, steering: &self.steering }
    }

    fn wheels(&self) -> usize {
        self.suspension.get().chain.wheels().len()
    }

    fn joint_count(&self) -> usize {
        self.suspension.get().chain.joints().len()
    }

    /// An array with these last axes, a row at a time.
    fn array<'py>(
        &self,
        py: Python<'py>,
        last: &[usize],
        fill: impl Fn(usize, &ground::Stand, &mut [f64]),
    ) -> PyResult<Array<'py>> {
        let shape: Vec<usize> = self.leading.iter().chain(last).copied().collect();
        let width = last.iter().product::<usize>();
        let mut output = Output::fresh(py, &shape)?;
        let rows = output.flat().chunks_exact_mut(width.max(1));
        for (k, (row, stand)) in rows.zip(&self.stands).enumerate() {
            fill(k, stand, row);
        }
        output.finish()
    }

    /// One value per pose.
    fn scalars<T: Element>(&self, py: Python<'_>, value: impl Fn(&ground::Stand) -> T) -> PyResult<Py<PyAny>> {
        let values = memory::gathered(self.stands.iter().map(value))?;
        scalar_or_array(py, values, &self.leading)
    }

    /// One number per wheel.
    fn per_wheel<'py>(&self, py: Python<'py>, value: impl Fn(&Contact) -> f64) -> PyResult<Array<'py>> {
        self.array(py, &[self.wheels()], |_, stand, row| {
            for (target, contact) in row.iter_mut().zip(&stand.wheels) {
                *target = value(contact);
            }
        })
    }

    /// An array with these last axes, a row at a time; NaN where the rover does not stand.
    fn where_placed<'py>(
        &self,
        py: Python<'py>,
        last: &[usize],
        fill: impl Fn(usize, &Placed<'_>, &mut [f64]),
    ) -> PyResult<Array<'py>> {
        self.array(py, last, |k, _, row| {
            row.fill(f64::NAN);
            if let Some(placed) = self.placed(k) {
                fill(k, &placed, row);
            }
        })
    }

    /// A point per wheel, in the world.
    fn points<'py, P: Into<[f64; 3]>>(
        &self,
        py: Python<'py>,
        point: impl Fn(&Placed<'_>, &Contact, usize) -> P,
    ) -> PyResult<Array<'py>> {
        let [x0, y0] = self.ground.placement().origin();
        self.where_placed(py, &[self.wheels(), 3], |k, placed, row| {
            for (wheel, target) in row.as_chunks_mut().0.iter_mut().enumerate() {
                let [x, y, z] = point(placed, &self.stands[k].wheels[wheel], wheel).into();
                *target = [x0 + x, y0 + y, z];
            }
        })
    }

    /// Points of the rims at these contact angles.
    fn rim_points<'py>(&self, py: Python<'py>, at: impl Fn(&Contact) -> Direction) -> PyResult<Array<'py>> {
        let chain = &self.suspension.get().chain;
        self.points(py, |placed, contact, wheel| rim_point(chain, placed, wheel, at(contact)))
    }
}

argument_kind! { Stand: "a SettledPose", |_| "what settle(...) has returned".into() }

getters! { Stand, self, py:
    /// The ground it stands on.
    ground: crate::terrain::Terrain = crate::terrain::Terrain(self.ground.clone());
    /// The suspension that stands.
    suspension: Py<Suspension> = self.suspension.clone_ref(py);
    /// Rows ``[x, y, yaw]`` that were asked for, shape (..., 3) [m, m, rad].
    poses: PyResult<Array<'py>> = self.array(py, &[3], |k, _, row| row.copy_from_slice(&self.poses[k]));
    /// Height of the body's origin, shape (...) [m].
    z: PyResult<Py<PyAny>> = self.scalars(py, |stand| stand.state[0]);
    /// Roll, positive with the right side down, shape (...) [rad].
    roll: PyResult<Py<PyAny>> = self.scalars(py, |stand| stand.state[1]);
    /// Pitch, positive with the nose down, shape (...) [rad].
    pitch: PyResult<Py<PyAny>> = self.scalars(py, |stand| stand.state[2]);
    /// Least vertical distance of every rim over the ground, shape (..., wheels) [m]: 0 but for wheels that hang.
    gap: PyResult<Array<'py>> = self.per_wheel(py, |contact| contact.gap);
    /// Contact angles, shape (..., wheels) [rad]: 0 straight below the wheel, positive to its front.
    contact_angles: PyResult<Array<'py>> = self.per_wheel(py, Contact::angle);
    /// Contact angles of the next best contact, shape (..., wheels) [rad]; NaN unless its gap is the same to 1e-7 m.
    next_contact_angles: PyResult<Array<'py>> = self.per_wheel(py, |contact| contact.next);
    /// Points of the rims where the gaps are least, in the world, shape (..., wheels, 3) [m].
    contacts: PyResult<Array<'py>> = self.rim_points(py, |contact| contact.at);
    /// The next best contacts, shape (..., wheels, 3) [m]; NaN unless their gaps are the same to 1e-7 m.
    next_contacts: PyResult<Array<'py>> = self.rim_points(py, |contact| Direction::from(contact.next));
    /// `SettleStatus` of the pose, or an array of them: settled, at_stop, off_map, unknown_cells, not_converged.
    status: PyResult<Bound<'py, PyAny>> = {
        let codes = self.scalars(py, |stand| stand.status.reported() as i64)?;
        py.import("six_wheel.kinematics.statuses")?.call_method1("settle_statuses", (codes,))
    };
    /// True if the rover stands: settled, or at a stop.
    stands: PyResult<Py<PyAny>> = self.scalars(py, |stand| stand.status.stands());
    /// Reason for which the rover does not stand at the pose, or an array of reasons, shape (...); empty where it
    /// stands. Where the solution has not converged, the rover may have tipped over.
    reason: PyResult<Bound<'py, PyAny>> = {
        if self.leading.is_empty() {
            return Ok(PyString::new(py, self.stands[0].status.reason()).into_any());
        }
        let words = self.scalars(py, |stand| PyString::new(py, stand.status.reason()).into_any().unbind());
        Ok(words?.into_bound(py))
    };
    /// Steering angles that were given, shape (..., steered) [rad].
    steering: PyResult<Array<'py>> = {
        let joints = self.suspension.get().chain.steering().len();
        self.array(py, &[joints], |k, _, row| {
            let angles = self.angles(k);
            row[..angles.len()].copy_from_slice(angles);
        })
    };
    /// Free angles, shape (..., joints) [rad]: rho, beta_1, beta_2 of a rocker-bogie.
    joints: PyResult<Array<'py>> = {
        let joints = self.joint_count();
        self.array(py, &[joints], |_, stand, row| row.copy_from_slice(&stand.state[3..3 + joints]))
    };
    /// Stop at which each joint is, shape (..., joints): -1 the lower, 1 the upper, 0 none.
    stops: PyResult<Array<'py>> = self.array(py, &[self.joint_count()], |_, stand, row| {
        for (target, stop) in row.iter_mut().zip(stand.stops) {
            *target = f64::from(stop);
        }
    });
    /// Unit normals of the ground at the contacts, in the world, shape (..., wheels, 3). On a crease the mix of
    /// both sides that is square to the rim.
    normals: PyResult<Array<'py>> = self.array(py, &[self.wheels(), 3], |_, stand, row| {
        for (target, contact) in row.as_chunks_mut().0.iter_mut().zip(&stand.wheels) {
            *target = six_wheel_terrain::terrain::normal(contact.gradient).into();
        }
    });
    /// ``world_from_body``, shape (..., 4, 4): takes coordinates in the body to the world [m].
    transform: PyResult<Array<'py>> = self.where_placed(py, &[4, 4], |k, placed, row| {
        let [x, y, _] = self.poses[k];
        for (i, origin) in [x, y, placed.origin.z].into_iter().enumerate() {
            for j in 0..3 {
                row[4 * i + j] = placed.rotation[(i, j)];
            }
            row[4 * i + 3] = origin;
        }
        row[12..].copy_from_slice(&[0.0, 0.0, 0.0, 1.0]);
    });
    /// Wheel centres in the world, shape (..., wheels, 3) [m].
    wheel_centres: PyResult<Array<'py>> = self.points(py, |placed, _, wheel| placed.wheel(wheel).centre);
    /// Derivatives of z, roll, pitch and the free angles by x, y and yaw, shape (..., 3 + joints, 3); None unless
    /// `derivatives` were asked for. Joints at stops stay there; NaN where the state is not determined.
    by_pose: PyResult<Option<Array<'py>>> = {
        if !self.derivatives {
            return Ok(None);
        }
        let chain = &self.suspension.get().chain;
        let count = chain.state_count();
        let array = self.where_placed(py, &[count, 3], |k, placed, row| {
            if let Some(found) = by_pose(chain, placed, &self.stands[k]) {
                row.copy_from_slice(&found.as_flattened()[..3 * count]);
            }
        });
        array.map(Some)
    };
    /// Derivatives of the six numbers of a rocker-bogie by its dimensions, shape (..., 6, 16): by x, y and z of
    /// each vector in the order of `RockerBogie.dimensions`, and by the wheel radius; None unless `derivatives`
    /// were asked for, and for other chains.
    by_dimension: PyResult<Option<Array<'py>>> = {
        let suspension = self.suspension.bind(py);
        let Ok(rover) = suspension.cast::<RockerBogie>() else { return Ok(None) };
        if !self.derivatives {
            return Ok(None);
        }
        let (chain, of) = (&suspension.get().chain, rover.get().core().dimensions());
        let array = self.where_placed(py, &[6, DIMENSIONS], |k, placed, row| {
            if let Some(found) = by_dimension(chain, of, placed, &self.stands[k]) {
                row.copy_from_slice(found.as_flattened());
            }
        });
        array.map(Some)
    };
}

pickled_by_fields! { Stand, this, py:
    (
        suspension: Py<Suspension> = &this.suspension,
        ground: Py<crate::terrain::Terrain> = this.ground(py),
        poses: Vec<[f64; 3]> = &this.poses,
        steering: Vec<f64> = &this.steering,
        codes: Vec<(u8, [i8; MAX_FREE], u8)> =
            this.stands.iter().map(|stand| (stand.status as u8, stand.stops, stand.hanging)).collect::<Vec<_>>(),
        numbers: Vec<Vec<f64>> = this.stands.iter().map(|stand| stand.numbers().to_vec()).collect::<Vec<_>>(),
        leading: Vec<usize> = &this.leading,
        derivatives: bool = this.derivatives,
    )
    {
        let parts = codes.into_iter().zip(&numbers);
        let stands = parts.map(|((status, stops, hanging), numbers)| ground::Stand::from_parts(status, stops, hanging, numbers));
        let stands = stands.collect::<Result<Vec<_>, _>>().or_raise(&[])?;
        let ground = ground.get().0.clone();
        Self { suspension, ground, poses, steering, stands, leading, derivatives }
    }
}

#[pymethods]
impl Stand {
    fn __len__(&self) -> usize {
        self.leading.first().copied().unwrap_or(1)
    }

    fn __repr__(slf: &Bound<'_, Self>) -> PyResult<String> {
        let this = slf.get();
        if this.leading.is_empty() {
            let names = ["status", "z", "roll", "pitch", "joints"];
            return crate::classes::repr_of_attributes("SettledPose", slf.as_any(), &names);
        }
        let mut counts = Vec::new();
        for status in ground::Status::ALL {
            let count = this.stands.iter().filter(|stand| stand.status.reported() == status).count();
            if count > 0 {
                counts.push(format!("{count} {}", status.name()));
            }
        }
        Ok(format!("SettledPose(<{}>)", counts.join(", ")))
    }
}
