//! Derivatives of a settled state by the implicit function theorem: the gaps stay closed.

use nalgebra::Vector3;

use super::active_set::ActiveSet;
use super::linear_system::LinearSystem;
use super::stand::{Contact, Stand, gap_slopes, rim_point};
use crate::suspension::{Bogie, Chain, Dimensions, MAX_FREE, MAX_STATE, Placed};

/// Number of dimensions of a rocker-bogie: five vectors and the wheel radius.
pub const DIMENSIONS: usize = 16;

/// Derivatives of z, roll, pitch and the free angles by variables with these derivatives of the wheels' gaps. None
/// where the state is not determined.
fn state_derivatives<const N: usize>(
    chain: &Chain,
    placed: &Placed<'_>,
    stand: &Stand,
    rates: impl Fn(usize, Vector3<f64>, &Contact) -> [f64; N],
) -> Option<[[f64; N]; MAX_STATE]> {
    let hold = ActiveSet {
        joints: std::array::from_fn(|k: usize| (k < MAX_FREE && stand.stops[k] != 0).then_some(0.0)),
        hanging: u32::from(stand.hanging),
    };
    let count = chain.state_count();
    let mut system = LinearSystem::<N>::empty();
    for wheel in (0..chain.wheels().len()).filter(|&wheel| stand.touches(wheel)) {
        let contact = &stand.wheels[wheel];
        let point = rim_point(chain, placed, wheel, contact.at);
        let (_, slopes) = gap_slopes(placed, wheel, point, contact);
        let mut row = [0.0; MAX_STATE];
        for (target, k) in row.iter_mut().zip(hold.free_columns(count)) {
            *target = slopes[k];
        }
        system.push(row, rates(wheel, point, contact).map(|rate| -rate));
    }
    let solution = system.solve()?;
    let mut derivatives = [[0.0; N]; MAX_STATE];
    for (value, k) in solution.iter().zip(hold.free_columns(count)) {
        derivatives[k] = *value;
    }
    Some(derivatives)
}

/// Derivatives of a settled state by x, y and yaw. None where the state is not determined.
#[inline]
pub fn by_pose(chain: &Chain, placed: &Placed<'_>, stand: &Stand) -> Option<[[f64; 3]; MAX_STATE]> {
    state_derivatives(chain, placed, stand, |wheel, point, contact| gap_slopes(placed, wheel, point, contact).0)
}

/// Derivatives of a settled state by the dimensions of a rocker-bogie, in the order of [`Dimensions::vectors`], and
/// by its wheel radius. None where the state is not determined.
pub fn by_dimension(
    chain: &Chain,
    of: &Dimensions,
    placed: &Placed<'_>,
    stand: &Stand,
) -> Option<[[f64; DIMENSIONS]; MAX_STATE]> {
    state_derivatives(chain, placed, stand, |wheel, _, contact| {
        let upwards = contact.upwards();
        let mut rates = [0.0; DIMENSIONS];
        for (rate, shift) in rates.iter_mut().zip(shift_by_dimension(of, placed, wheel)) {
            *rate = upwards.dot(&shift);
        }
        rates[DIMENSIONS - 1] = upwards.dot(&placed.wheel(wheel).spoke(contact.at));
        rates
    })
}

/// Derivatives of the centre of a wheel by the vectors of a rocker-bogie, at a constant state.
pub fn shift_by_dimension(of: &Dimensions, placed: &Placed<'_>, wheel: usize) -> [Vector3<f64>; DIMENSIONS - 1] {
    let (pair, side) = (wheel / 2, wheel % 2);
    let (rocker, bogie) = (side, 2 + side);
    let mirror = if side == 0 { 1.0 } else { -1.0 };
    let mut shifts = [Vector3::zeros(); DIMENSIONS - 1];
    // A vector of the dimensions is rotated with its part, and mirrored on the right.
    let mut add = |vector: usize, rotation: nalgebra::Matrix3<f64>| {
        shifts[3 * vector] = rotation.column(0).into();
        shifts[3 * vector + 1] = rotation.column(1) * mirror;
        shifts[3 * vector + 2] = rotation.column(2).into();
    };
    add(0, placed.rotation);
    if of.bogie.carries(pair) {
        let foremost = if of.bogie == Bogie::Behind { 1 } else { 0 };
        add(2, placed.part(rocker).0);
        add(3 + pair - foremost, placed.part(bogie).0);
    } else {
        add(1, placed.part(rocker).0);
    }
    shifts
}
