//! Leading axes of several arguments, brought together as NumPy does.

use pyo3::PyResult;

use super::errors::{refuse, shape_text};

/// An argument with leading axes.
pub trait Broadcast {
    /// Their lengths.
    fn leading(&self) -> &[usize];

    /// The shape of the whole argument over other leading axes.
    fn shape_over(&self, leading: &[usize]) -> Vec<usize>;

    /// The rule of an argument beside others with these leading axes.
    fn rule(&self, leading: &[usize]) -> String {
        format!("have shape {}", shape_text(&self.shape_over(leading)))
    }

    /// Repeats what there is over these axes.
    fn spread(&mut self, argument: &str, leading: &[usize]) -> PyResult<()>;
}

/// An argument by its name.
pub type Named<'a> = (&'static str, &'a mut dyn Broadcast);

/// An argument with its name.
pub fn named<'a>(argument: &'static str, value: &'a mut dyn Broadcast) -> Named<'a> {
    (argument, value)
}

/// An argument that may have been left out.
pub fn given<'a, T: Broadcast>(argument: &'static str, value: &'a mut Option<T>) -> Option<Named<'a>> {
    value.as_mut().map(|value| named(argument, value))
}

/// The leading axes of all arguments together: counted from the last one, each has the same length in all of them,
/// or 1, or is not there. What does not fit is named beside the first argument that it does not fit.
pub fn together<'a>(arguments: impl IntoIterator<Item = Named<'a>>) -> PyResult<Vec<usize>> {
    let mut arguments: Vec<Named<'a>> = arguments.into_iter().collect();
    let mut common: Vec<usize> = Vec::new();
    for (k, (argument, value)) in arguments.iter().enumerate() {
        common = match joint(&common, value.leading()) {
            Some(joint) => joint,
            None => {
                let unfit = |(_, other): &&Named<'a>| joint(other.leading(), value.leading()).is_none();
                let beside = arguments[..k].iter().find(unfit).map_or("the others", |(other, _)| other);
                let got = format!("shape {} beside {beside}", shape_text(&value.shape_over(value.leading())));
                return Err(refuse(argument, value.rule(&common), &got));
            }
        };
    }
    for (argument, value) in &mut arguments {
        if value.leading() != common {
            value.spread(argument, &common)?;
        }
    }
    Ok(common)
}

/// The axes of two arguments together, if there are any.
pub fn joint(first: &[usize], second: &[usize]) -> Option<Vec<usize>> {
    let axes = first.len().max(second.len());
    let length = |shape: &[usize], axis: usize| {
        let missing = axes - shape.len();
        axis.checked_sub(missing).map_or(1, |axis| shape[axis])
    };
    (0..axes)
        .map(|axis| match (length(first, axis), length(second, axis)) {
            (a, b) if a == b => Some(a),
            (1, b) => Some(b),
            (a, 1) => Some(a),
            _ => None,
        })
        .collect()
}

/// The row that each row over common axes has among those of an argument's own.
pub fn rows_over(own: &[usize], common: &[usize]) -> Vec<usize> {
    let mut rows = vec![0];
    for (axis, &length) in common.iter().enumerate() {
        let own = (axis + own.len()).checked_sub(common.len()).map_or(1, |axis| own[axis]);
        rows = rows.iter().flat_map(|row| (0..length).map(move |k| row * own + if own == 1 { 0 } else { k })).collect();
    }
    rows
}

/// Leading axes with a last one.
pub fn joined(leading: &[usize], last: usize) -> Vec<usize> {
    leading.iter().copied().chain([last]).collect()
}
