//! Heights of a grid in the precision of the caller's array.

use std::sync::Arc;

/// Heights [m], row after row.
#[derive(Clone, Debug)]
pub enum Heights {
    /// In single precision, converted at every read.
    Single(Arc<Vec<f32>>),
    /// In double precision.
    Double(Arc<Vec<f64>>),
}

impl Heights {
    /// Number of heights.
    #[inline]
    pub fn len(&self) -> usize {
        match self {
            Self::Single(heights) => heights.len(),
            Self::Double(heights) => heights.len(),
        }
    }

    /// True if there are no heights.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Largest absolute value of a known height [m]; infinite if one is.
    pub fn largest(&self) -> f64 {
        match self {
            Self::Single(heights) => largest(heights.iter().copied().map(f64::from)),
            Self::Double(heights) => largest(heights.iter().copied()),
        }
    }

    /// A height [m]; NaN where it is unknown.
    #[inline]
    pub fn at(&self, index: usize) -> f64 {
        match self {
            Self::Single(heights) => f64::from(heights[index]),
            Self::Double(heights) => heights[index],
        }
    }
}

/// Largest absolute value of the numbers without NaN, by eight independent maxima.
fn largest(mut values: impl ExactSizeIterator<Item = f64>) -> f64 {
    let mut most = [0.0_f64; 8];
    for _ in 0..values.len() / 8 {
        for most in &mut most {
            *most = most.max(values.next().map_or(0.0, f64::abs));
        }
    }
    values.chain(most).fold(0.0, |most, value| most.max(value.abs()))
}
