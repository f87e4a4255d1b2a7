//! Rates on the ground: contacts, the suspension that follows it, and the planar motion that fits the wheels best.

pub(crate) mod constants;
pub(crate) mod contact_rows;
pub(crate) mod fit;
pub(crate) mod least_squares;
pub(crate) mod point_rows;
pub(crate) mod suspension_rates;
