//! Profiles of a given shape in a given time.

use super::{Axis, Derivatives, Piece, Profile};
use six_wheel_numerics::error::{Error, finite, number, positive};

/// A shape by its name, with its default ramps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Shape {
    /// [`linear`].
    Linear,
    /// [`trapezoid`] with ramps of a third of the duration each.
    Trapezoid,
    /// [`s_curve`] with ramps of half the duration: the least peak jerk.
    #[default]
    SCurve,
}

named_values! { Shape as "shape": "linear" => Linear, "trapezoid" => Trapezoid, "s_curve" => SCurve }

impl Shape {
    /// A profile of this shape.
    pub fn between(self, start: &[f64], end: &[f64], duration: f64) -> Result<Profile, Error> {
        match self {
            Self::Linear => linear(start, end, duration),
            Self::Trapezoid => trapezoid(start, end, duration, duration / 3.0),
            Self::SCurve => s_curve(start, end, duration, duration / 2.0),
        }
    }
}

/// From start to end at constant velocity.
pub fn linear(start: &[f64], end: &[f64], duration: f64) -> Result<Profile, Error> {
    shape(start, end, duration, |change| vec![([change / duration, 0.0, 0.0], duration)])
}

/// Constant acceleration for the time `ramp` [s], constant velocity, and the mirror image of the start.
pub fn trapezoid(start: &[f64], end: &[f64], duration: f64, ramp: f64) -> Result<Profile, Error> {
    check_ramp(duration, ramp)?;
    shape(start, end, duration, |change| {
        let velocity = change / (duration - ramp);
        let acceleration = velocity / ramp;
        vec![
            ([0.0, acceleration, 0.0], ramp),
            ([velocity, 0.0, 0.0], duration - 2.0 * ramp),
            ([velocity, -acceleration, 0.0], ramp),
        ]
    })
}

/// Double S: constant jerk up and down again during the time `ramp` [s], constant velocity, and the mirror
/// image of the start.
///
/// Without cruising, at a ramp of half the duration, the peak jerk is the least possible in that time.
pub fn s_curve(start: &[f64], end: &[f64], duration: f64, ramp: f64) -> Result<Profile, Error> {
    check_ramp(duration, ramp)?;
    shape(start, end, duration, |change| {
        let velocity = change / (duration - ramp);
        let acceleration = 2.0 * velocity / ramp;
        let half = ramp / 2.0;
        let jerk = acceleration / half;
        vec![
            ([0.0, 0.0, jerk], half),
            ([velocity / 2.0, acceleration, -jerk], half),
            ([velocity, 0.0, 0.0], duration - 2.0 * ramp),
            ([velocity, 0.0, -jerk], half),
            ([velocity / 2.0, -acceleration, jerk], half),
        ]
    })
}

fn check_ramp(duration: f64, ramp: f64) -> Result<(), Error> {
    positive("duration", duration)?;
    if ramp > 0.0 && ramp <= duration / 2.0 {
        return Ok(());
    }
    let rule = format!("be positive and at most half the duration of {} s", number(duration));
    Err(Error::value("ramp", rule, number(ramp)))
}

/// Velocity, acceleration and jerk at the start of a piece, and its duration [s].
type Stretch = ([f64; 3], f64);

/// A profile of every axis by `recipe`, the pieces for a change of value. Recipes are point-symmetric about the middle:
/// values before it are integrated from the start and the others from the end, so that both ends are exact.
fn shape(start: &[f64], end: &[f64], duration: f64, recipe: impl Fn(f64) -> Vec<Stretch>) -> Result<Profile, Error> {
    finite("start", start)?;
    finite("end", end)?;
    positive("duration", duration)?;
    let axis = |(&start, &end): (&f64, &f64)| {
        let stretches = recipe(end - start);
        let axis = chain(start, end, duration, &stretches);
        axis.check().map(|()| axis)
    };
    let axes = start.iter().zip(end).map(axis).collect::<Result<_, _>>()?;
    Ok(Profile::new(axes))
}

fn chain(start: f64, end: f64, duration: f64, stretches: &[Stretch]) -> Axis {
    let rest = |&(moving, time): &Stretch| (state(0.0, moving), time);
    let mut pieces: Vec<Piece> = Vec::with_capacity(stretches.len());
    let (mut time, mut value) = (0.0, start);
    for (state, length) in stretches.iter().map(rest) {
        pieces.push(Piece { start: time, state: [value, state[1], state[2], state[3]] });
        time += length;
        value += super::constant_jerk_state(state, length)[0];
    }
    // The second half, integrated backwards from the end.
    let (mut time, mut value) = (duration, end);
    for (i, (state, length)) in stretches.iter().map(rest).enumerate().rev() {
        time -= length;
        value -= super::constant_jerk_state(state, length)[0];
        if 2 * i > stretches.len() - 1 {
            pieces[i].start = time;
            pieces[i].state[0] = value;
        }
    }
    let last = stretches.last().map_or([0.0; 4], |stretch| {
        let (state, length) = rest(stretch);
        super::constant_jerk_state(state, length)
    });
    // A final velocity or acceleration that differs from 0 is rounding.
    let ends = |i: usize| {
        let largest = stretches.iter().fold(0.0, |a: f64, (moving, _)| a.max(moving[i - 1].abs()));
        if last[i].abs() <= 1e-14 * largest { 0.0 } else { last[i] }
    };
    Axis {
        pieces: pieces.into_iter().filter(|piece| piece.start < duration).collect(),
        duration,
        end: [end, ends(1), ends(2), last[3]],
    }
}

fn state(value: f64, [velocity, acceleration, jerk]: [f64; 3]) -> Derivatives {
    [value, velocity, acceleration, jerk]
}
