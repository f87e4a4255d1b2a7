//! Arguments as arrays of real numbers. Masked arrays, ragged lists and values that are no numbers are refused by name.

use numpy::{PyArrayDescrMethods, PyArrayDyn, PyArrayMethods, PyUntypedArray, PyUntypedArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyBool, PyBytes, PyDict, PyFloat, PyInt, PyList, PyString, PyTuple, PyType};

use super::errors::{is_of_another_kind, refuse, refuse_type, short_repr};
use super::memory;
use super::numpy_module::{numpy, ready};
use super::strided;

/// Depth to which lists are searched for masked arrays.
pub const DEEP: usize = 8;

/// Letters of a value that are shown.
const LONGEST: usize = 40;

/// Three floats or integers in a tuple or list.
pub(super) fn three_numbers(value: &Bound<'_, PyAny>) -> Option<[f64; 3]> {
    let number = |item: PyResult<Bound<'_, PyAny>>| {
        let item = item.ok()?;
        if let Ok(float) = item.cast::<PyFloat>() {
            return Some(float.value());
        }
        item.is_exact_instance_of::<PyInt>().then(|| item.extract().ok())?
    };
    if let Ok(tuple) = value.cast::<PyTuple>() {
        let item = |k| number(tuple.get_item(k));
        return if tuple.len() == 3 { Some([item(0)?, item(1)?, item(2)?]) } else { None };
    }
    let list = value.cast::<PyList>().ok().filter(|list| list.len() == 3)?;
    let item = |k| number(list.get_item(k));
    Some([item(0)?, item(1)?, item(2)?])
}

/// An argument as an array of real numbers, in its own memory and layout if NumPy can view that.
pub fn read_array<'py>(argument: &str, value: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyUntypedArray>> {
    let py = value.py();
    ready(py)?;
    refuse_masks(argument, value, 0)?;
    let array = match value.cast::<PyUntypedArray>() {
        Ok(array) => array.clone(),
        Err(_) => {
            before_code_of(value)?;
            numpy(py)?
                .call_method1(intern!(py, "asarray"), (value,))
                .map_err(|error| not_rectangular(argument, value, error))?
                .cast_into()?
        }
    };
    let dtype = array.dtype();
    if !matches!(dtype.kind(), b'f' | b'i' | b'u') {
        let got = odd_one(value, &array)?.unwrap_or_else(|| format!("dtype {dtype}"));
        return Err(refuse_type(argument, "be real numbers", &got));
    }
    Ok(array)
}

/// Keeps what the call has read so far, where reading this value runs code of the caller's.
fn before_code_of(value: &Bound<'_, PyAny>) -> PyResult<()> {
    if memory::reads() && runs_code(value, 0) { strided::keep_read(value.py()) } else { Ok(()) }
}

/// False for plain numbers, arrays, and lists and tuples of them.
fn runs_code(value: &Bound<'_, PyAny>, depth: usize) -> bool {
    let is_plain = value.is_exact_instance_of::<PyFloat>()
        || value.is_exact_instance_of::<PyInt>()
        || value.is_instance_of::<PyBool>()
        || value.is_none()
        || value.cast::<PyUntypedArray>().is_ok();
    if is_plain {
        return false;
    }
    if depth == DEEP {
        return true;
    }
    if let Ok(list) = value.cast_exact::<PyList>() {
        list.iter().any(|item| runs_code(&item, depth + 1))
    } else if let Ok(tuple) = value.cast_exact::<PyTuple>() {
        tuple.iter().any(|item| runs_code(&item, depth + 1))
    } else {
        true
    }
}

/// The first value that is no number, with its place: `None at [2]`. Nothing where an array has another dtype all through.
fn odd_one(value: &Bound<'_, PyAny>, array: &Bound<'_, PyUntypedArray>) -> PyResult<Option<String>> {
    if value.is_none() {
        return Ok(Some("None".into()));
    }
    if array.ndim() == 0 && value.is_instance_of::<PyString>() {
        return Ok(Some(short_repr(value)));
    }
    if array.ndim() == 0 {
        let kind = value.get_type().name()?;
        let mut got = format!("a {kind}");
        if value.is_instance_of::<PyDict>() {
            got += ": give its values as an array, in the order of the rover's wheels";
        }
        return Ok(Some(got));
    }
    let is_array = value.cast::<PyUntypedArray>().is_ok();
    if array.dtype().kind() != b'O' && is_array {
        return Ok(None);
    }
    let lists = if is_array { value.call_method0(intern!(value.py(), "tolist"))? } else { value.clone() };
    let mut place = Vec::new();
    let found = first_odd(&lists, &mut place);
    let place: Vec<String> = place.iter().map(usize::to_string).collect();
    Ok(found.map(|found| format!("{found} at [{}]", place.join(", "))))
}

/// The first item of nested lists that is no number; `place` is where.
fn first_odd(value: &Bound<'_, PyAny>, place: &mut Vec<usize>) -> Option<String> {
    if place.len() < DEEP && (value.is_instance_of::<PyList>() || value.is_instance_of::<PyTuple>()) {
        for (k, item) in value.try_iter().ok()?.enumerate() {
            place.push(k);
            let found = first_odd(&item.ok()?, place);
            if found.is_some() {
                return found;
            }
            place.pop();
        }
        return None;
    }
    let is_number =
        !value.is_instance_of::<PyBool>() && !value.is_instance_of::<PyString>() && value.extract::<f64>().is_ok();
    (!is_number).then(|| {
        let text = short_repr(value);
        if text.chars().count() > LONGEST {
            let begin: String = text.chars().take(LONGEST).collect();
            return format!("{begin}...");
        }
        text
    })
}

/// The numbers of an array of single precision, one after the other; None for any other.
pub fn singles(argument: &str, array: &Bound<'_, PyUntypedArray>) -> PyResult<Option<Vec<f32>>> {
    let py = array.py();
    if array.cast::<PyArrayDyn<f32>>().is_err() {
        return Ok(None);
    }
    let _held = memory::read(argument, array)?;
    let flat =
        numpy(py)?.call_method1(intern!(py, "require"), (array, "f", ["C", "A"]))?.cast_into::<PyArrayDyn<f32>>()?;
    let numbers = flat.readonly();
    memory::gathered(numbers.as_slice()?.iter().copied()).map(Some)
}

/// Refuses masked arrays, whose masked numbers would be read like the others.
pub fn refuse_masks(argument: &str, value: &Bound<'_, PyAny>, depth: usize) -> PyResult<()> {
    static MASKED: PyOnceLock<Py<PyType>> = PyOnceLock::new();
    let py = value.py();
    if let Ok(array) = value.cast::<PyUntypedArray>() {
        if array.is_exact_instance_of::<PyUntypedArray>() {
            return Ok(());
        }
        if value.is_instance(MASKED.import(py, "numpy.ma", "MaskedArray")?)? {
            let got = "a masked array: fill it, or leave out what is masked";
            return Err(refuse_type(argument, "be without a mask", got));
        }
        return Ok(());
    }
    if depth == DEEP {
        return Ok(());
    }
    let item = |item: Bound<'_, PyAny>| {
        if item.is_exact_instance_of::<PyFloat>() {
            return Ok(());
        }
        refuse_masks(argument, &item, depth + 1)
    };
    if let Ok(list) = value.cast::<PyList>() {
        list.iter().try_for_each(item)
    } else if let Ok(tuple) = value.cast::<PyTuple>() {
        tuple.iter().try_for_each(item)
    } else {
        Ok(())
    }
}

/// NumPy's own complaint about the shape of lists, in the words of this library. What an argument's own code
/// raises comes through.
pub fn not_rectangular(argument: &str, value: &Bound<'_, PyAny>, error: PyErr) -> PyErr {
    let py = value.py();
    let is_own = error.traceback(py).is_none()
        && error.is_instance_of::<PyValueError>(py)
        && error.to_string().contains("inhomogeneous");
    if !is_own {
        return error;
    }
    let kind = value.get_type().name().map_or_else(|_| "an object".into(), |name| name.to_string());
    refuse(argument, "be numbers of one rectangular shape", format!("a ragged {kind}"))
}

/// A number of a constructor.
pub fn number(argument: &str, value: &Bound<'_, PyAny>) -> PyResult<f64> {
    number_by_rule(argument, "be a number", value)
}

/// A number; another value is refused by this rule.
fn number_by_rule(argument: &str, rule: &str, value: &Bound<'_, PyAny>) -> PyResult<f64> {
    let py = value.py();
    let refused = || refuse_type(argument, rule, short_repr(value));
    if value.is_instance_of::<PyBool>() {
        return Err(refused());
    }
    refuse_masks(argument, value, DEEP)?;
    before_code_of(value)?;
    value.extract::<f64>().map_err(|error| if is_of_another_kind(py, &error) { refused() } else { error })
}

/// The two numbers of a pair, or the only one.
pub fn pair_or_one(argument: &str, value: &Bound<'_, PyAny>) -> PyResult<Result<[f64; 2], f64>> {
    let is_text = value.is_instance_of::<PyString>() || value.is_instance_of::<PyBytes>();
    let Some([first, second]) = value.extract::<[Bound<'_, PyAny>; 2]>().ok().filter(|_| !is_text) else {
        let rule = if is_text { "be a number" } else { "be a number or two numbers" };
        return number_by_rule(argument, rule, value).map(Err);
    };
    Ok(Ok([number(&format!("{argument}[0]"), &first)?, number(&format!("{argument}[1]"), &second)?]))
}

/// Two numbers.
pub fn pair(argument: &str, value: &Bound<'_, PyAny>) -> PyResult<[f64; 2]> {
    value.extract().map_err(|error| match is_of_another_kind(value.py(), &error) {
        true => refuse(argument, "be two numbers", short_repr(value)),
        false => error,
    })
}

/// The items of an iterable, `most` at most: more are none that could be meant.
pub fn items<'py>(argument: &str, value: &Bound<'py, PyAny>, most: usize) -> PyResult<Vec<Bound<'py, PyAny>>> {
    let mut items = Vec::new();
    before_code_of(value)?;
    for item in value.try_iter()? {
        if items.len() == most {
            return Err(refuse(argument, format!("hold {most} at most"), "more"));
        }
        items.try_reserve(1).map_err(|_| memory::none_for(&[items.len()]))?;
        items.push(item?);
    }
    Ok(items)
}

/// One of some names; another value is refused with all names.
pub fn name(value: &Bound<'_, PyAny>) -> String {
    value.extract().unwrap_or_else(|_| short_repr(value))
}
