//! Arguments of `Mppi`.

use pyo3::prelude::*;
use pyo3::types::PyDict;
use six_wheel_planner::{Precision, Weights};

use super::costmap::Costmap;
use crate::convert::{Rows, memory, number, refuse, refuse_type, short_repr};

/// The state of the rover as the attributes of an object.
pub struct Seen<'py> {
    pub pose: Bound<'py, PyAny>,
    pub twist: Option<Bound<'py, PyAny>>,
    pub steering: Option<Bound<'py, PyAny>>,
    pub frame: Option<String>,
}

impl<'py> Seen<'py> {
    pub fn of(state: &Bound<'py, PyAny>) -> PyResult<Self> {
        let Some(pose) = state.getattr_opt("pose")? else {
            return Ok(Self { pose: state.clone(), twist: None, steering: None, frame: None });
        };
        let given = |name: &str| Ok::<_, PyErr>(state.getattr_opt(name)?.filter(|value| !value.is_none()));
        Ok(Self {
            pose,
            twist: given("twist")?,
            steering: given("steering")?,
            frame: given("frame")?.map(|frame| frame.extract()).transpose()?,
        })
    }
}

pub fn check_frame(costmap: Option<&Bound<'_, Costmap>>, frame: Option<&str>) -> PyResult<()> {
    let (Some(map), Some(frame)) = (costmap, frame) else { return Ok(()) };
    match &map.get().frame {
        Some(own) if own != frame => {
            Err(refuse("costmap", format!("be in the frame of the state, {frame:?}"), format!("{own:?}")))
        }
        _ => Ok(()),
    }
}

/// A whole number that is not negative.
pub fn whole(argument: &str, value: &Bound<'_, PyAny>) -> PyResult<u64> {
    let index = value.call_method0("__index__");
    let index = index.map_err(|_| refuse_type(argument, "be a whole number", short_repr(value)))?;
    index.extract::<u64>().map_err(|_| {
        refuse(argument, if argument == "seed" { "be 0 to 2^64 - 1" } else { "be a whole number from 0 on" }, index)
    })
}

pub fn size(count: u64) -> usize {
    usize::try_from(count).unwrap_or(usize::MAX)
}

pub fn precision(dtype: &Bound<'_, PyAny>) -> PyResult<Precision> {
    let name = dtype.py().import("numpy")?.getattr("dtype")?.call1((dtype,));
    let name = name.and_then(|dtype| dtype.getattr("name")?.extract::<String>());
    match name.as_deref() {
        Ok("float32") => Ok(Precision::Single),
        Ok("float64") => Ok(Precision::Double),
        _ => Err(refuse("dtype", "be float32 or float64", short_repr(dtype))),
    }
}

pub fn read_weights(given: &Bound<'_, PyDict>) -> PyResult<Weights> {
    let mut values = Weights::default().values();
    for (key, value) in given.iter() {
        let name: String = key.extract().map_err(|_| refuse("cost_weights", "have names", "another key"))?;
        let Some(place) = Weights::NAMES.iter().position(|known| *known == name) else {
            return Err(refuse("cost_weights", format!("be of {}", Weights::NAMES.join(", ")), format!("{name:?}")));
        };
        values[place] = number(&name, &value)?;
    }
    Ok(Weights::of(values))
}

/// Rows of two numbers, or of three; and how many they have.
fn two_or_three<'py>(
    read: impl Fn(&'static str, &Bound<'py, PyAny>, usize) -> PyResult<Rows<'py>>,
    argument: &'static str,
    value: &Bound<'py, PyAny>,
) -> PyResult<(Rows<'py>, usize)> {
    let two = read(argument, value, 2).map(|rows| (rows, 2));
    two.or_else(|error| read(argument, value, 3).map(|rows| (rows, 3)).map_err(|_| error))
}

/// Points of two coordinates, of rows with two or three.
pub fn points(argument: &'static str, value: &Bound<'_, PyAny>) -> PyResult<Vec<[f64; 2]>> {
    let (rows, width) = two_or_three(|name, value, width| Rows::read(name, value, width)?.table(), argument, value)?;
    memory::gathered(rows.flat().chunks_exact(width).map(|row| [row[0], row[1]]))
}

/// A place of two coordinates, or a pose: its place and its yaw.
pub fn pose_or_place(argument: &'static str, value: &Bound<'_, PyAny>) -> PyResult<(Option<[f64; 2]>, Option<f64>)> {
    let row = two_or_three(Rows::read, argument, value)?.0.over(&[])?;
    Ok((Some([row.flat()[0], row.flat()[1]]), row.flat().get(2).copied()))
}
