//! Arguments of the named layouts for their wheels: one value for all of them, or one each.

use pyo3::prelude::*;
use pyo3::types::{PyMapping, PyString};
use six_wheel_kinematics::rover::{MAX_WHEELS, Rover as Core};
use six_wheel_kinematics::wheels::{Pivot, Wheel};
use six_wheel_numerics::error::Error;

use crate::convert::{OrRaise, items, number, refuse};
use crate::rover::Rover;
use crate::wheel::steering_range;

type Argument<'a, 'py> = Option<&'a Bound<'py, PyAny>>;

/// Arguments of a layout that hold values for single wheels.
#[derive(Default)]
pub struct PerWheel<'a, 'py> {
    pub steering_limit: Argument<'a, 'py>,
    pub scrub: Argument<'a, 'py>,
    pub trail: Argument<'a, 'py>,
    pub names: Option<Vec<String>>,
}

impl PerWheel<'_, '_> {
    /// A layout's rover with all that was given for its wheels; what was not stays as the layout has it.
    pub fn fit(&self, py: Python<'_>, layout: Result<Core, Error>) -> PyResult<Rover> {
        let layout = layout.or_raise(&[])?;
        let mut wheels = layout.wheels().to_vec();
        if let Some(names) = &self.names {
            if names.len() != wheels.len() {
                return Err(refuse("names", format!("hold {} names, one per wheel", wheels.len()), names.len()));
            }
            for (wheel, name) in wheels.iter_mut().zip(names) {
                wheel.name.clone_from(name);
            }
        }
        for (argument, value) in [("scrub", self.scrub), ("trail", self.trail)] {
            let all: Vec<usize> = (0..wheels.len()).collect();
            let is_one = |value: &Bound<'_, PyAny>| !is_several(value);
            each(argument, value, &mut wheels, &all, is_one, |wheel, label, value| {
                let target = if argument == "scrub" { &mut wheel.scrub } else { &mut wheel.trail };
                *target = number(label, value)?;
                Ok(())
            })?;
        }
        let is_one = |value: &Bound<'_, PyAny>| !is_several(value) || value.extract::<[f64; 2]>().is_ok();
        each("steering_limit", self.steering_limit, &mut wheels, layout.steered(), is_one, |wheel, _, value| {
            if let Some(range) = steering_range(Some(value))? {
                wheel.pivot = Pivot::Steered(range);
            }
            Ok(())
        })?;
        Rover::named(py, Core::new(wheels))
    }
}

/// True if a value is a mapping or a sequence of values; text is one value.
fn is_several(value: &Bound<'_, PyAny>) -> bool {
    !value.is_instance_of::<PyString>() && value.try_iter().is_ok()
}

/// Sets what an argument says of some of the wheels: a mapping by their names, one value for all of them, or one each in their
/// order. The setter gets the wheel, how a message calls the value, and the value; None leaves a wheel as it is.
fn each<'py>(
    argument: &str,
    value: Argument<'_, 'py>,
    wheels: &mut [Wheel],
    places: &[usize],
    is_one: impl Fn(&Bound<'py, PyAny>) -> bool,
    set: impl Fn(&mut Wheel, &str, &Bound<'py, PyAny>) -> PyResult<()>,
) -> PyResult<()> {
    let Some(value) = value else { return Ok(()) };
    let listed = || places.iter().map(|&i| wheels[i].name.as_str()).collect::<Vec<_>>().join(", ");
    let given: Vec<(usize, String, Bound<'py, PyAny>)> = if let Ok(by_name) = value.cast::<PyMapping>() {
        let mut given = Vec::new();
        for item in by_name.items()?.iter() {
            let (key, value): (Bound<'py, PyAny>, Bound<'py, PyAny>) = item.extract()?;
            let name: String = key.extract().unwrap_or_default();
            let Some(&i) = places.iter().find(|&&i| wheels[i].name == name) else {
                return Err(refuse(argument, format!("name wheels of {}", listed()), key.repr()?));
            };
            given.push((i, format!("{argument}[{name:?}]"), value));
        }
        given
    } else if is_one(value) {
        places.iter().map(|&i| (i, argument.to_owned(), value.clone())).collect()
    } else {
        let values = items(argument, value, MAX_WHEELS)?;
        if values.len() != places.len() {
            let rule = format!("be one value or {}, one each for {}", places.len(), listed());
            return Err(refuse(argument, &rule, format!("{} values", values.len())));
        }
        let numbered = places.iter().zip(values).enumerate();
        numbered.map(|(k, (&i, value))| (i, format!("{argument}[{k}]"), value)).collect()
    };
    let is_given = |(_, _, value): &&(usize, String, Bound<'py, PyAny>)| !value.is_none();
    given.iter().filter(is_given).try_for_each(|(i, label, value)| set(&mut wheels[*i], label, value))
}
