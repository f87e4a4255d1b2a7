//! How an array becomes registers and back; knows no rover.

pub(crate) mod crew;
pub(crate) mod lanes;
pub(crate) mod level;
pub(crate) mod places;
pub(crate) mod polynomials;
pub(crate) mod sizes;
pub(crate) mod stream;
pub(crate) mod table;
pub(crate) mod vector;
pub(crate) mod weave;
pub(crate) mod workers;
