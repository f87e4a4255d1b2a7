//! The fast path of `Rover.inverse`, `forward`, `admissible` and `project`: one twist, or the readings of one instant.

use pyo3::prelude::*;
use six_wheel_kinematics::admissible::Keep;
use six_wheel_kinematics::estimate::{Measured, Unseen};
use six_wheel_kinematics::geometry::Twist;
use six_wheel_kinematics::rover::Inputs;

use super::Rover;
use crate::fastcall::{self, Answer, Arguments, Numbers, Object, Row, fresh, pair, three, truth};

fast_methods! {
    Inverse<3>: Rover, c"inverse", [c"twist", c"out", c"previous"], 1, inverse;
    Forward<3>: Rover, c"forward", [c"steering", c"wheel_speeds", c"out"], 2, forward;
    Admissible<1>: Rover, c"admissible", [c"twist"], 1, admissible;
    Project<2>: Rover, c"project", [c"twist", c"out"], 1, project;
}

#[inline(always)]
fn inverse<'py>(this: Borrowed<'_, 'py, Rover>, [twist, out, previous]: Arguments<'_, 'py, 3>) -> Answer<'py> {
    let (py, rover) = (this.py(), &this.get().core);
    let (joints, wheels) = (rover.steered().len(), rover.wheels().len());
    let twist = twist?;
    let numbers = three(twist)?;
    let solve = |previous: Option<&[f64]>, [steering, speeds]: [Row<'_>; 2]| {
        let inputs = Inputs { previous, ..Inputs::default() };
        // SAFETY: the two are apart from each other and from what is read: `previous`, see below.
        let targets = unsafe { (steering.numbers_mut(), speeds.numbers_mut()) };
        let twist = Twist::from(numbers);
        rover.inverse(twist, inputs, targets.0, targets.1).ok()
    };
    let mut room = Numbers::new();
    let Some(out) = out else {
        let (steering, angles) = fresh(py, joints)?;
        let (speeds, rotations) = fresh(py, wheels)?;
        let previous = match previous {
            // SAFETY: the targets are new, and nobody else's.
            Some(previous) => Some(unsafe { room.read(previous, joints) }?),
            None => None,
        };
        solve(previous, [angles, rotations])?;
        return pair(py, steering, speeds);
    };
    let targets = out_rows(out, [joints, wheels])?;
    let [angles, rotations] = targets;
    if Row::read(twist, 3).is_some_and(|twist| targets.iter().any(|row| row.overlaps(twist))) {
        return None;
    }
    let previous = match previous {
        None => None,
        Some(previous) => Some(match Row::read(previous, joints) {
            Some(row) if row.is(angles) => room.copy(row)?,
            Some(row) if row.overlaps(angles) || row.overlaps(rotations) => return None,
            // SAFETY: apart from the targets, as the line above has made sure.
            _ => unsafe { room.read(previous, joints) }?,
        }),
    };
    solve(previous, targets)?;
    Some(out.to_owned())
}

/// The two arrays of `out=`, in a tuple, apart from each other.
#[inline(always)]
fn out_rows<'a>(out: Object<'a, '_>, [joints, wheels]: [usize; 2]) -> Option<[Row<'a>; 2]> {
    let [first, second] = fastcall::two(out)?;
    let (steering, speeds) = (Row::target(first, joints)?, Row::target(second, wheels)?);
    (!steering.overlaps(speeds)).then_some([steering, speeds])
}

/// The array of a twist: that of `out=`, apart from what is read, each with its length, or a new one.
#[inline(always)]
fn twist_row<'a, 'py: 'a, const N: usize>(
    py: Python<'py>,
    out: Option<Object<'a, 'py>>,
    inputs: [(Option<Object<'a, 'py>>, usize); N],
) -> Option<(Bound<'py, PyAny>, Row<'a>)> {
    let Some(out) = out else { return fresh(py, 3) };
    let target = Row::target(out, 3)?;
    let mut rows = inputs.into_iter().filter_map(|(input, length)| Row::read(input?, length));
    (!rows.any(|row| row.overlaps(target))).then(|| (out.to_owned(), target))
}

#[inline(always)]
fn forward<'py>(this: Borrowed<'_, 'py, Rover>, [steering, speeds, out]: Arguments<'_, 'py, 3>) -> Answer<'py> {
    let (py, rover) = (this.py(), &this.get().core);
    let (joints, wheels) = (rover.steered().len(), rover.wheels().len());
    let mut rooms = [Numbers::new(), Numbers::new()];
    let [room, other] = &mut rooms;
    // SAFETY: nothing is written before the twist is known.
    let measured = unsafe {
        Measured {
            steering: match steering {
                Some(steering) => room.read(steering, joints)?,
                None if joints == 0 => &[],
                None => return None,
            },
            speeds: other.read(speeds?, wheels)?,
            steering_rates: None,
        }
    };
    if !rover.are_plain(measured.steering) {
        return None;
    }
    let (array, target) = twist_row(py, out, [(steering, joints), (speeds, wheels)])?;
    let twist = rover.forward(measured, Unseen::Refuse).ok()?;
    // SAFETY: what has been read is not used any more.
    unsafe { target.numbers_mut() }.copy_from_slice(&<[f64; 3]>::from(twist));
    Some(array)
}

#[inline(always)]
fn admissible<'py>(this: Borrowed<'_, 'py, Rover>, [twist]: Arguments<'_, 'py, 1>) -> Answer<'py> {
    let twist = Twist::from(three(twist?)?);
    let answer = this.get().core.admissible(twist).ok()?;
    Some(truth(this.py(), answer))
}

#[inline(always)]
fn project<'py>(this: Borrowed<'_, 'py, Rover>, [twist, out]: Arguments<'_, 'py, 2>) -> Answer<'py> {
    let (py, twist) = (this.py(), twist?);
    let wanted = Twist::from(three(twist)?);
    let (array, target) = twist_row(py, out, [(Some(twist), 3)])?;
    let found = this.get().core.project(wanted, Keep::Curvature).ok()?;
    // SAFETY: the twist has been copied, and nothing else is at work.
    unsafe { target.numbers_mut() }.copy_from_slice(&<[f64; 3]>::from(found));
    Some(array)
}
