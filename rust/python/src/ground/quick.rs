//! The quick way of `Suspension.settle`: one pose.

use pyo3::prelude::*;
use six_wheel_terrain::ground;
use six_wheel_terrain::ground::{Settler, Status};

use super::Stand;
use crate::fast::{self, Method, Object, Quick, three};
use crate::suspension::Suspension;
use crate::terrain::Terrain;

/// Puts the quick way before the method of the class.
pub fn install(py: Python<'_>) -> PyResult<()> {
    fast::install::<2, OnePose>(py)
}

struct OnePose;

impl Quick<2> for OnePose {
    type Class = Suspension;

    fn method() -> &'static Method<2> {
        static METHOD: Method<2> = Method::new(c"settle", [c"ground", c"poses"], 2);
        &METHOD
    }

    #[inline(always)]
    fn call<'py>(
        this: Borrowed<'_, 'py, Suspension>,
        [ground, pose]: [Option<Object<'_, 'py>>; 2],
    ) -> Option<Bound<'py, PyAny>> {
        let (py, suspension) = (this.py(), this.get());
        let (ground, pose) = (&ground?.cast::<Terrain>().ok()?.get().0, three(pose?)?);
        let settler = Settler::new(ground, &suspension.chain);
        let mut stands = vec![ground::Stand::nothing(Status::NotConverged)];
        ground::settle(&settler, &[pose], &[], 1, &mut stands).ok()?;
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
}
