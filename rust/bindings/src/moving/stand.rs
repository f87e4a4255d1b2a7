//! Reading where a rover stands.

use pyo3::prelude::*;
use six_wheel_core::Chain;
use six_wheel_core::moving::Footing;
use six_wheel_core::suspension::{MAX_FREE, MAX_WHEELS};

use crate::convert::{Rows, Scalars, refuse, shape_text};
use crate::given::other_kind;

/// A wheel further than this from the ground hangs [m]: a thousand times what settling leaves.
const HANGING: f64 = 1e-6;

/// A free angle nearer than this to its stop is at it [rad].
const STOPPED: f64 = 1e-9;

/// What the result of `settle` says, read once for all rows.
pub struct Stands<'py> {
    pub leading: Vec<usize>,
    roll: Scalars<'py>,
    pitch: Scalars<'py>,
    transform: Rows<'py>,
    joints: Option<Rows<'py>>,
    steering: Option<Rows<'py>>,
    angles: Rows<'py>,
    normals: Rows<'py>,
    gap: Rows<'py>,
    widths: [usize; 3],
}

impl<'py> Stands<'py> {
    pub fn read(chain: &Chain, stand: &Bound<'py, PyAny>) -> PyResult<Self> {
        let (wheels, joints, steered) = (
            chain.wheels().len(),
            chain.joints().len(),
            chain.steering().len(),
        );
        let rows =
            |name: &str, width| Rows::read(&format!("stand.{name}"), &stand.getattr(name)?, width);
        if !stand.hasattr("contact_angles")? {
            let remedy = "what settle(...) has returned";
            return Err(other_kind("stand", "a Stand", stand, remedy));
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
            let got = format!("shape {}", shape_text(&rows.shape()));
            let rule = format!("have leading axes {}", shape_text(&leading));
            Err(refuse(&format!("stand.{name}"), &rule, &got))
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
            widths: [wheels, joints, steered],
        })
    }

    /// Number of rows.
    pub fn count(&self) -> usize {
        self.leading.iter().product()
    }

    /// Whether it is one pose, not a batch.
    pub fn is_single(&self) -> bool {
        self.leading.is_empty()
    }

    /// One row, as the core takes it; a single pose is every row.
    pub fn row(&self, chain: &Chain, k: usize) -> Footing<'_> {
        let k = if self.is_single() { 0 } else { k };
        let [wheels, joints, steered] = self.widths;
        let of = |rows: &'_ Option<Rows<'py>>, width: usize| {
            // An empty array has no rows to take apart.
            rows.as_ref().map_or(0..0, |_| k * width..(k + 1) * width)
        };
        let angles = self
            .joints
            .as_ref()
            .map_or(&[][..], |rows| &rows.flat()[of(&self.joints, joints)]);
        let steering = self
            .steering
            .as_ref()
            .map_or(&[][..], |rows| &rows.flat()[of(&self.steering, steered)]);
        let gaps = &self.gap.flat()[k * wheels..][..wheels];
        let mut touching = [false; MAX_WHEELS];
        for (touching, gap) in touching.iter_mut().zip(gaps) {
            *touching = gap.abs() <= HANGING;
        }
        let mut stopped = [false; MAX_FREE];
        if gaps.iter().any(|gap| *gap > HANGING) {
            for ((stopped, angle), joint) in stopped.iter_mut().zip(angles).zip(chain.joints()) {
                let range = joint.range;
                *stopped = *angle <= range.lower + STOPPED || *angle >= range.upper - STOPPED;
            }
        }
        let transform = &self.transform.flat()[16 * k..][..16];
        Footing {
            attitude: [
                self.roll.at(k),
                self.pitch.at(k),
                transform[4].atan2(transform[0]),
            ],
            joints: angles,
            steering,
            angles: &self.angles.flat()[k * wheels..][..wheels],
            normals: &self.normals.triples()[k * wheels..][..wheels],
            touching,
            stopped,
        }
    }
}
