//! Arguments of `Odometry`: encoders, readings of one instant, poses and covariances.

use pyo3::intern;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList, PyMapping};
use six_wheel_odometry::dimensions::NUMBERS;
use six_wheel_odometry::{Deviations, Encoder as CoreEncoder, Readings, Settings};

use super::values::{Encoder, Noise};
use crate::arguments::other_kind;
use crate::convert::{OrRaise, Rows, choice, items, number, refuse, refuse_shape};

/// An encoder for all joints, one per joint, or some by name.
fn encoders(argument: &str, given: Option<&Bound<'_, PyAny>>, names: &[&str]) -> PyResult<Vec<CoreEncoder>> {
    let Some(given) = given else { return Ok(Vec::new()) };
    let one = |item: &Bound<'_, PyAny>| {
        item.cast::<Encoder>()
            .map(|encoder| encoder.get().0)
            .map_err(|_| other_kind(argument, "an Encoder, several of them or a dict of them by name", item, ""))
    };
    if let Ok(mapping) = given.cast::<PyMapping>() {
        return by_name(argument, mapping, names, CoreEncoder::default(), one);
    }
    if given.is_instance_of::<Encoder>() {
        return Ok(vec![one(given)?]);
    }
    if !given.hasattr(intern!(given.py(), "__iter__"))? {
        return one(given).map(|encoder| vec![encoder]);
    }
    // One more than there may be, to tell.
    let items = items(argument, given, names.len() + 1)?;
    let all: Vec<CoreEncoder> = items.iter().map(one).collect::<PyResult<_>>()?;
    if all.len() == names.len() {
        Ok(all)
    } else {
        Err(refuse(argument, format!("be one encoder or {}", names.len()), all.len()))
    }
}

/// The kind of readings by the arguments `readings` and `increments`; counts are angles in another unit.
fn readings_of((readings, increments): (&str, bool), encoders: bool) -> PyResult<Readings> {
    let all = [("angles", Readings::Angles), ("speeds", Readings::Speeds), ("ticks", Readings::Angles)];
    let got = |name: &str| match name {
        "increments" => "'increments': leave it out and give increments=True".into(),
        _ => format!("'{name}'"),
    };
    let kind = choice("readings", readings, got, &all)?;
    match (readings, increments) {
        ("ticks", _) if !encoders => Err(refuse("wheel_encoders", "be given with readings='ticks'", "None")),
        ("speeds", true) => Err(refuse("increments", "be left out with readings='speeds'", "True")),
        (_, true) => Ok(Readings::Increments),
        _ => Ok(kind),
    }
}

/// The settings that all odometry has: noise, kind of readings, encoders of these wheels and steered wheels.
pub fn settings(
    noise: Option<Bound<'_, Noise>>,
    kind: (&str, bool),
    [wheel_encoders, steering_encoders]: [Option<&Bound<'_, PyAny>>; 2],
    [wheels, steered]: [&[&str]; 2],
) -> PyResult<Settings> {
    Ok(Settings {
        noise: noise.map(|noise| noise.get().0).unwrap_or_default(),
        readings: readings_of(kind, wheel_encoders.is_some())?,
        wheel_encoders: encoders("wheel_encoders", wheel_encoders, wheels)?,
        steering_encoders: encoders("steering_encoders", steering_encoders, steered)?,
        ..Settings::default()
    })
}

/// A number for every wheel: all of them in their order, or some by name, the others 1.
pub fn by_wheel(argument: &'static str, value: Option<&Bound<'_, PyAny>>, names: &[&str]) -> PyResult<Vec<f64>> {
    let Some(value) = value else { return Ok(Vec::new()) };
    let Ok(mapping) = value.cast::<PyMapping>() else {
        return Ok(Rows::read_numbers(argument, value)?.over(&[names.len()])?.flat().to_vec());
    };
    by_name(argument, mapping, names, 1.0, |one| number(argument, one))
}

/// Values by name as values in the order of all names, with the default for those that are not named.
fn by_name<T: Clone>(
    argument: &str,
    given: &Bound<'_, PyMapping>,
    names: &[&str],
    usual: T,
    read: impl Fn(&Bound<'_, PyAny>) -> PyResult<T>,
) -> PyResult<Vec<T>> {
    let mut all = vec![usual; names.len()];
    for pair in given.items()?.iter() {
        let (name, value): (String, Bound<'_, PyAny>) = pair.extract()?;
        let Some(place) = names.iter().position(|known| *known == name) else {
            return Err(refuse(argument, format!("name some of {}", names.join(", ")), format!("'{name}'")));
        };
        all[place] = read(&value)?;
    }
    Ok(all)
}

/// Deviations of the dimensions: for each a table of all numbers of the wheels.
pub fn deviations(value: Option<&Bound<'_, PyAny>>, wheels: usize) -> PyResult<Deviations> {
    let Some(value) = value else { return Ok(Deviations::default()) };
    let rows = Rows::read("dimensions", value, NUMBERS)?;
    match rows.leading.as_slice() {
        [0, _] => Ok(Deviations::default()),
        [_, each] if *each == wheels => Deviations::new(rows.finite()?.flat(), wheels).or_raise(&[]),
        _ => Err(rows.refuse_shape(format!("(k, {wheels}, {NUMBERS})"))),
    }
}

/// A covariance, zero if it is left out: variances or a matrix of the numbers at one of these lists of places, of which `rule`
/// has the shapes. The numbers at other places have the variance `others`.
pub fn covariance_of<const N: usize>(
    value: Option<&Bound<'_, PyAny>>,
    lists: &[&[usize]],
    others: f64,
    rule: &str,
) -> PyResult<[[f64; N]; N]> {
    let mut matrix = [[0.0; N]; N];
    let Some(value) = value else { return Ok(matrix) };
    let numbers = Rows::read_numbers("covariance", value)?;
    let (shape, flat) = (numbers.leading.as_slice(), numbers.flat());
    let fits = |places: &&&[usize]| shape == [places.len()] || shape == [places.len(); 2];
    let Some(places) = lists.iter().find(fits) else { return Err(refuse_shape("covariance", rule, shape)) };
    for k in (0..N).filter(|k| !places.contains(k)) {
        matrix[k][k] = others;
    }
    for (i, &row) in places.iter().enumerate() {
        match shape {
            [_] => matrix[row][row] = flat[i],
            _ => places.iter().enumerate().for_each(|(k, &column)| matrix[row][column] = flat[i * places.len() + k]),
        }
    }
    Ok(matrix)
}

/// A covariance of x, y and yaw: three variances or a matrix.
pub fn covariance(value: Option<&Bound<'_, PyAny>>) -> PyResult<[[f64; 3]; 3]> {
    covariance_of(value, &[&[0, 1, 2]], 0.0, "have shape (3,) or (3, 3)")
}

/// The covariance or, in its place, the squares of standard deviations.
pub fn variances<'py>(
    py: Python<'py>,
    covariance: Option<&Bound<'py, PyAny>>,
    std: Option<&Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyAny>> {
    let std = match (covariance, std) {
        (Some(covariance), None) => return Ok(covariance.clone()),
        (None, Some(std)) => std,
        (None, None) => return Err(refuse("covariance", "be given, or std in its place", "None")),
        (Some(_), Some(_)) => return Err(refuse("std", "be left out beside covariance", "both")),
    };
    let deviations = Rows::read_numbers("std", std)?;
    if let Some(negative) = deviations.flat().iter().find(|deviation| deviation.is_nan() || **deviation < 0.0) {
        return Err(refuse("std", "hold deviations of at least 0", negative));
    }
    if deviations.leading.len() != 1 {
        return Err(refuse_shape("std", "have shape (3,), or (6,) in space", &deviations.leading));
    }
    let squares: Vec<f64> = deviations.flat().iter().map(|deviation| deviation * deviation).collect();
    Ok(PyList::new(py, squares)?.into_any())
}

/// Readings of the steering joints over these leading axes; None for rovers that do not steer.
pub fn steering<'py>(value: &Bound<'py, PyAny>, joints: usize, leading: &[usize]) -> PyResult<Option<Rows<'py>>> {
    match value.is_none() {
        false => Rows::read("steering", value, joints)?.over(leading).map(Some),
        true if joints == 0 => Ok(None),
        true => Err(refuse("steering", "hold the angles of the steered wheels", "None")),
    }
}

/// The columns of every log: readings of wheels and steering, and their stamps.
pub struct Columns<'py> {
    pub wheels: Rows<'py>,
    pub steering: Option<Rows<'py>>,
    pub stamps: Rows<'py>,
    pub is_strict: bool,
}

impl<'py> Columns<'py> {
    /// `widths`: wheels and steered wheels.
    pub fn read(
        wheels: &Bound<'py, PyAny>,
        steering: &Bound<'py, PyAny>,
        stamps: &Bound<'py, PyAny>,
        errors: &str,
        widths: [usize; 2],
    ) -> PyResult<Self> {
        // An impossible row ends the run, or is flagged.
        let is_strict = choice("errors", errors, |name| format!("'{name}'"), &[("flag", false), ("raise", true)])?;
        let wheels = Rows::read("wheel_angles", wheels, widths[0])?.table()?;
        let leading = wheels.leading.as_slice();
        let steering = self::steering(steering, widths[1], leading)?;
        let stamps = column("stamps", stamps, leading)?;
        Ok(Self { wheels, steering, stamps, is_strict })
    }

    /// A column that may be left out.
    pub fn optional(&self, argument: &'static str, value: Option<&Bound<'py, PyAny>>) -> PyResult<Option<Rows<'py>>> {
        let read = |value| column(argument, value, &self.wheels.leading);
        value.map(read).transpose()
    }

    /// Angles of the steered wheels, row by row.
    pub fn angles(&self) -> &[f64] {
        self.steering.as_ref().map_or(&[], Rows::flat)
    }
}

/// One number a row.
pub fn column<'py>(argument: &'static str, value: &Bound<'py, PyAny>, leading: &[usize]) -> PyResult<Rows<'py>> {
    Rows::read_numbers(argument, value)?.over(leading)
}

/// The track of `six_wheel.kinematics.odometry` under this name.
pub fn build_track<'py>(keywords: &Bound<'py, PyDict>, name: &str) -> PyResult<Bound<'py, PyAny>> {
    let py = keywords.py();
    py.import(intern!(py, "six_wheel.kinematics.odometry"))?.getattr(name)?.call((), Some(keywords))
}
