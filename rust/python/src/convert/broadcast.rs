//! Leading axes of several arguments, brought together as NumPy does.

use pyo3::PyResult;

use super::errors::{refuse, shape_text};

/// An argument with leading axes.
pub trait Broadcast {
    /// Its name.
    fn argument(&self) -> &str;

    /// Their lengths.
    fn leading(&self) -> &[usize];

    /// The shape of the whole argument over other leading axes.
    fn shape_over(&self, leading: &[usize]) -> Vec<usize>;

    /// The rule of an argument beside others with these leading axes.
    fn rule(&self, leading: &[usize]) -> String {
        format!("have shape {}", shape_text(&self.shape_over(leading)))
    }

    /// Repeats what there is over these axes.
    fn spread(&mut self, leading: &[usize]) -> PyResult<()>;
}

/// An argument that may have been left out.
pub trait Given {
    /// The argument, if there is one.
    fn given(&mut self) -> Option<&mut dyn Broadcast>;
}

impl<T: Broadcast> Given for T {
    fn given(&mut self) -> Option<&mut dyn Broadcast> {
        Some(self)
    }
}

impl<T: Broadcast> Given for Option<T> {
    fn given(&mut self) -> Option<&mut dyn Broadcast> {
        self.as_mut().map(|value| value as &mut dyn Broadcast)
    }
}

/// The leading axes of all arguments together: counted from the last one, each has the same length in all of them,
/// or 1, or is not there. What does not fit is named beside the first argument that it does not fit.
pub fn together<const N: usize>(arguments: [&mut dyn Given; N]) -> PyResult<Vec<usize>> {
    let mut arguments: Vec<&mut dyn Broadcast> = arguments.into_iter().filter_map(Given::given).collect();
    let mut common: Vec<usize> = Vec::new();
    for (k, value) in arguments.iter().enumerate() {
        common = match joint(&common, value.leading()) {
            Some(joint) => joint,
            None => {
                let unfit = arguments[..k].iter().find(|other| joint(other.leading(), value.leading()).is_none());
                let beside = unfit.map_or("the others", |other| other.argument());
                let got = format!("shape {} beside {beside}", shape_text(&value.shape_over(value.leading())));
                return Err(refuse(value.argument(), value.rule(&common), &got));
            }
        };
    }
    for value in &mut arguments {
        if value.leading() != common {
            value.spread(&common)?;
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
