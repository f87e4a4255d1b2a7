//! Settled poses as arguments.

use pyo3::prelude::*;
use six_wheel_ground_motion::{SettledPoseInput, SettledPoses};
use six_wheel_terrain::suspension::Chain;

use crate::arguments::other_kind;
use crate::convert::{Broadcast, Rows, joined, refuse_shape, rows_over, shape_text};
use crate::settle::Stand;

/// Settled poses: the result of `settle`, or an object with the same attributes. Read once for all rows.
pub enum Stands<'py> {
    /// The numbers as they are.
    Settled(Bound<'py, Stand>),
    /// The same over more axes.
    Repeated(Box<Stand>),
    /// The numbers of its attributes.
    Told(Box<Attributes<'py>>),
}

/// Settled poses over more axes than they had.
fn repeated(py: Python<'_>, stand: &Stand, leading: &[usize]) -> Stand {
    let rows = rows_over(&stand.leading, leading);
    let one = stand.steering.is_empty() || stand.stands.len() * stand.angles(0).len() != stand.steering.len();
    Stand {
        suspension: stand.suspension.clone_ref(py),
        ground: stand.ground.clone(),
        poses: rows.iter().map(|&row| stand.poses[row]).collect(),
        steering: match one {
            true => stand.steering.clone(),
            false => rows.iter().flat_map(|&row| stand.angles(row)).copied().collect(),
        },
        stands: rows.iter().map(|&row| stand.stands[row]).collect(),
        leading: leading.to_vec(),
        derivatives: stand.derivatives,
    }
}

/// Attributes of an object like `SettledPose`.
pub struct Attributes<'py> {
    leading: Vec<usize>,
    roll: Rows<'py>,
    pitch: Rows<'py>,
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
        let rows = |name: &str, width| Rows::read(format!("stand.{name}"), &stand.getattr(name)?, width);
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
            Err(refuse_shape(rows.argument(), &rule, &rows.shape()))
        };
        let scalars = |name: &str| Rows::read_numbers(format!("stand.{name}"), &stand.getattr(name)?)?.over(&leading);
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

    /// Fails unless numbers beside the poses are finite. Where a pose does not stand they may be NaN, as other calls give
    /// them for it.
    pub fn check_finite(&self, rows: &Rows<'py>) -> PyResult<()> {
        let single = self.leading().iter().product::<usize>() == 1;
        rows.check_finite_where(|row| !self.stands(if single { 0 } else { row }))
    }

    /// The numbers as they are, or those of the attributes.
    fn known(&self) -> Result<&Stand, &Attributes<'py>> {
        match self {
            Self::Settled(stand) => Ok(stand.get()),
            Self::Repeated(stand) => Ok(stand),
            Self::Told(told) => Err(told),
        }
    }

    /// True if a pose stands.
    fn stands(&self, row: usize) -> bool {
        self.known().map_or_else(|told| !told.roll.flat()[row].is_nan(), |stand| stand.stands[row].status.stands())
    }

    /// As the core takes them.
    pub fn footings(&self) -> SettledPoses<'_> {
        match self.known() {
            Ok(stand) => stand.footings(),
            Err(told) => SettledPoses::Input(SettledPoseInput {
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

impl Broadcast for Stands<'_> {
    fn argument(&self) -> &str {
        "stand"
    }

    fn leading(&self) -> &[usize] {
        self.known().map_or_else(|told| &told.leading, |stand| &stand.leading)
    }

    fn shape_over(&self, leading: &[usize]) -> Vec<usize> {
        leading.to_vec()
    }

    /// One pose stays one: the core takes it for all rows.
    fn spread(&mut self, leading: &[usize]) -> PyResult<()> {
        if self.leading().iter().product::<usize>() == 1 {
            return Ok(());
        }
        match self {
            Self::Settled(stand) => *self = Self::Repeated(Box::new(repeated(stand.py(), stand.get(), leading))),
            Self::Repeated(_) => {}
            Self::Told(told) => {
                let wheels = told.normals.leading.last().copied().unwrap_or_default();
                told.leading = leading.to_vec();
                told.roll.spread(leading)?;
                told.pitch.spread(leading)?;
                told.transform.spread(&joined(leading, 4))?;
                told.normals.spread(&joined(leading, wheels))?;
                let numbers =
                    [told.joints.as_mut(), told.steering.as_mut(), Some(&mut told.angles), Some(&mut told.gap)];
                for rows in numbers.into_iter().flatten() {
                    rows.spread(leading)?;
                }
            }
        }
        Ok(())
    }
}
