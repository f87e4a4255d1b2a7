//! The quick way of `Suspension.settle`: one pose.

use pyo3::prelude::*;
use six_wheel_numerics::threads::workers::Workers;
use six_wheel_terrain::ground::{self, Settler, Status};

use super::Stand;
use crate::fastcall::{self, Answer, Arguments, three};
use crate::suspension::Suspension;
use crate::terrain::Terrain;

/// Puts the quick way before the method of the class.
pub fn install(py: Python<'_>) -> PyResult<()> {
    fastcall::install::<2, SettleCall>(py)
}

fast_method!(SettleCall<2>: Suspension, c"settle", [c"ground", c"poses"], 2, settle);

#[inline(always)]
fn settle<'py>(this: Borrowed<'_, 'py, Suspension>, [ground, pose]: Arguments<'_, 'py, 2>) -> Answer<'py> {
    let (py, suspension) = (this.py(), this.get());
    let (ground, pose) = (&ground?.cast::<Terrain>().ok()?.get().0, three(pose?)?);
    let settler = Settler::new(ground, &suspension.chain);
    let mut stands = vec![ground::Stand::nothing(Status::NotConverged)];
    ground::settle(&settler, &[pose], &[], Workers::PLAIN, &mut stands).ok()?;
    let stand = Stand {
        suspension: this.to_owned().unbind(),
        ground: ground.clone(),
        poses: vec![pose],
        steering: Vec::new(),
        stands,
        leading: Vec::new(),
        derivatives: false,
    };
    Some(Bound::new(py, stand).ok()?.into_any())
}
