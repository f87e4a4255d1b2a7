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

    /// A height [m]; NaN where it is not known.
    #[inline]
    pub fn at(&self, index: usize) -> f64 {
        match self {
            Self::Single(heights) => f64::from(heights[index]),
            Self::Double(heights) => heights[index],
        }
    }
}
