//! Settled poses as arguments.

use pyo3::prelude::*;
use six_wheel_ground_motion::{SettledPoseInput, SettledPoses};
use six_wheel_terrain::suspension::Chain;

use crate::arguments::other_kind;
use crate::convert::{Rows, Scalars, refuse_shape, shape_text};
use crate::settle::Stand;

/// Settled poses: the result of `settle`, or an object with the same attributes. Read once for all rows.
pub enum Stands<'py> {
    /// The numbers as they are.
    Settled(Bound<'py, Stand>),
    /// The numbers of its attributes.
    Told(Box<Attributes<'py>>),
}

/// Attributes of an object like `SettledPose`.
pub struct Attributes<'py> {
    leading: Vec<usize>,
    roll: Scalars<'py>,
    pitch: Scalars<'py>,
    transform: Rows<'py>,
    joints: Option<Rows<'py>>,
    steering: Option<Rows<'py>>,
    angles: Rows<'py>,
    normals: Rows<'py>,
    gap: Rows<'py>,
}

impl<'py> Attributes<'py> {
    fn read(chain: &Chain, stand: &Bound<'py, PyAny>) -> PyResult<Self> {
        let (wheels, joints, steered) = (chain.wheels().len(), chain.joints().len(), chain.steering().len());
        let rows = |name: &str, width| Rows::read(&format!("stand.{name}"), &stand.getattr(name)?, width);
        if !stand.hasattr("contact_angles")? {
            let remedy = "what settle(...) has returned";
            return Err(other_kind("stand", "a SettledPose", stand, remedy));
        }
        let angles = rows("contact_angles", wheels)?;
        let leading = angles.leading.clone();
        let beside = |name: &str, width: usize| {
            let rows = rows(name, width)?;
            // A matrix has one more axis than a row of numbers.
            let axes = leading.len();
            if rows.leading.get(..axes) == Some(&leading[..]) {
                return Ok(rows);
            }
            let rule = format!("have leading axes {}", shape_text(&leading));
            Err(refuse_shape(&format!("stand.{name}"), &rule, &rows.shape()))
        };
        let scalars = |name: &str| {
            let argument = format!("stand.{name}");
            let scalars = Scalars::read(&argument, &stand.getattr(name)?)?;
            scalars.fit_exactly(&argument, &leading)?;
            PyResult::Ok(scalars)
        };
        let some = |name: &str, width: usize| (width > 0).then(|| beside(name, width)).transpose();
        Ok(Self {
            roll: scalars("roll")?,
            pitch: scalars("pitch")?,
            transform: beside("transform", 4)?,
            joints: some("joints", joints)?,
            steering: some("steering", steered)?,
            normals: beside("normals", 3)?,
            gap: beside("gap", wheels)?,
            angles,
            leading: leading.clone(),
        })
    }
}

impl<'py> Stands<'py> {
    pub fn read(chain: &Chain, stand: &Bound<'py, PyAny>) -> PyResult<Self> {
        let fits = |stand: &Stand| {
            let stood = &stand.suspension.get().chain;
            stood.wheels().len() == chain.wheels().len()
                && stood.joints().len() == chain.joints().len()
                && stood.steering().len() == chain.steering().len()
        };
        match stand.cast::<Stand>() {
            Ok(settled) if fits(settled.get()) => Ok(Self::Settled(settled.clone())),
            // Another suspension's: what its arrays say is looked at, and refused where it does not fit.
            _ => Attributes::read(chain, stand).map(|told| Self::Told(Box::new(told))),
        }
    }

    /// Lengths of the leading axes.
    pub fn leading(&self) -> &[usize] {
        match self {
            Self::Settled(stand) => &stand.get().leading,
            Self::Told(told) => &told.leading,
        }
    }

    /// Number of rows.
    pub fn count(&self) -> usize {
        self.leading().iter().product()
    }

    /// True for one pose, false for a batch.
    pub fn is_single(&self) -> bool {
        self.leading().is_empty()
    }

    /// Reads numbers beside the poses. Where a pose does not stand they may be NaN, as other calls give them for it.
    pub fn read_beside(
        &self,
        name: &'static str,
        value: &Bound<'py, PyAny>,
        width: usize,
        leading: &[usize],
    ) -> PyResult<Rows<'py>> {
        let rows = Rows::read_over(name, value, width, leading)?;
        rows.check_finite_where(name, |row| !self.stands(if self.is_single() { 0 } else { row }))?;
        Ok(rows)
    }

    /// True if a pose stands.
    fn stands(&self, row: usize) -> bool {
        match self {
            Self::Settled(stand) => stand.get().stands[row].status.stands(),
            Self::Told(told) => !told.roll.flat()[row].is_nan(),
        }
    }

    /// As the core takes them.
    pub fn footings(&self) -> SettledPoses<'_> {
        match self {
            Self::Settled(stand) => {
                let stand = stand.get();
                SettledPoses::Settled { stands: &stand.stands, poses: &stand.poses, steering: &stand.steering }
            }
            Self::Told(told) => SettledPoses::Input(SettledPoseInput {
                roll: told.roll.flat(),
                pitch: told.pitch.flat(),
                transform: told.transform.flat().as_chunks().0,
                joints: told.joints.as_ref().map_or(&[], Rows::flat),
                steering: told.steering.as_ref().map_or(&[], Rows::flat),
                angles: told.angles.flat(),
                normals: told.normals.triples(),
                gap: told.gap.flat(),
            }),
        }
    }
}
