//! Logs of twists, read.

use pyo3::prelude::*;
use six_wheel_kinematics::table::Durations;
use six_wheel_numerics::error::Error;

use crate::convert::{
    Blocks, Broadcast, Output, Precision, Rows, Scalars, joined, joint, raise, refuse, refuse_shape, shape_text,
};

/// Logs of twists, with what goes with them.
pub struct Course<'py> {
    argument: &'static str,
    pub twists: Blocks<'py>,
    dt: Scalars<'py>,
    starts: Option<Rows<'py>>,
    /// Steps of a log.
    pub count: usize,
}

impl<'py> Course<'py> {
    pub fn read(
        argument: &'static str,
        mut twists: Blocks<'py>,
        dt: &Bound<'py, PyAny>,
        start: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Self> {
        let Some((&count, logs)) = twists.leading().split_last() else {
            return Err(refuse(argument, "have shape (..., n, 3)", "shape (3,)"));
        };
        let mut starts = start.map(|start| Rows::read("start", start, 3)).transpose()?;
        // One start for all logs is not repeated.
        if let Some(starts) = starts.as_mut().filter(|starts| !starts.is_single())
            && starts.leading != logs
        {
            let Some(common) = joint(logs, &starts.leading) else {
                let got = format!("leading axes {}", shape_text(&starts.leading));
                let rule = format!("be one pose or have leading axes {}", shape_text(logs));
                return Err(refuse("start", &rule, &got));
            };
            starts.spread("start", &common)?;
            twists.spread(argument, &joined(&common, count))?;
        }
        let mut dt = Scalars::read("dt", dt)?;
        dt.fit("dt", count)?;
        Ok(Self { argument, twists, dt, starts, count })
    }

    /// Reads controls: at least one axis of rollouts before that of the steps.
    pub fn read_controls(
        controls: &Bound<'py, PyAny>,
        dt: &Bound<'py, PyAny>,
        start: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Self> {
        let controls = Blocks::read("controls", controls, 3)?;
        if controls.leading().len() < 2 {
            return Err(refuse_shape("controls", "have shape (..., k, t, 3)", &controls.shape()));
        }
        Self::read("controls", controls, dt, start)
    }

    /// Leading axes of the logs.
    pub fn logs(&self) -> &[usize] {
        let leading = self.twists.leading();
        &leading[..leading.len() - 1]
    }

    /// The output for the poses.
    pub fn poses(
        &self,
        py: Python<'py>,
        argument: &str,
        out: Option<&Bound<'py, PyAny>>,
        precision: Option<Precision>,
    ) -> PyResult<Output<'py>> {
        let logs = self.logs().iter().copied();
        let shape: Vec<usize> = logs.chain([self.count + 1, 3]).collect();
        Output::of(py, argument, out, precision, &shape)
    }

    pub fn durations(&self) -> Durations<'_> {
        self.dt.steps().into()
    }

    /// One start for all logs, or one for each.
    pub fn starts(&self) -> &[[f64; 3]] {
        self.starts.as_ref().map_or(&[[0.0; 3]], Rows::triples)
    }

    /// The exception of a core error.
    pub fn raise(&self, mut error: Error) -> PyErr {
        if error.argument == "twists" || error.argument == "twist" {
            error.argument = self.argument.into();
        }
        let leading = if error.argument == "dt" { &[self.count][..] } else { self.twists.leading() };
        raise(error, leading)
    }
}
