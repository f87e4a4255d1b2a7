//! Heights of a grid as they came, in either precision.

use std::sync::Arc;

/// Heights as they came, row after row.
#[derive(Clone, Debug)]
pub enum Heights {
    /// Single precision, widened where it is read.
    Single(Arc<Vec<f32>>),
    /// Double precision.
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

    /// Largest size of a known height [m]; infinite if one is.
    pub fn largest(&self) -> f64 {
        match self {
            Self::Single(heights) => largest(heights.iter().copied().map(f64::from)),
            Self::Double(heights) => largest(heights.iter().copied()),
        }
    }

    /// A height [m]; NaN where it is not known.
    #[inline]
    pub fn at(&self, index: usize) -> f64 {
        match self {
            Self::Single(heights) => f64::from(heights[index]),
            Self::Double(heights) => heights[index],
        }
    }
}

/// Largest size of the numbers, NaN left out, in eight sums that do not wait for each other.
fn largest(mut values: impl ExactSizeIterator<Item = f64>) -> f64 {
    let mut most = [0.0_f64; 8];
    for _ in 0..values.len() / 8 {
        for most in &mut most {
            *most = most.max(values.next().map_or(0.0, f64::abs));
        }
    }
    values.chain(most).fold(0.0, |most, value| most.max(value.abs()))
}
