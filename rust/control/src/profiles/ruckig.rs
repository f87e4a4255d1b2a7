//! The library behind [`super::optimal`]: its input, the choice of units, and the check of its result.

use std::panic::{AssertUnwindSafe, catch_unwind};

use rsruckig::prelude::{DataArrayOrVec, InputParameter, Ruckig, Synchronization, ThrowErrorHandler, Trajectory};
use rsruckig::profile::Profile as RuckigResult;

use super::limits::{AxisState, Bounds, Synchronise};
use super::{Axis, Piece, Profile, constant_jerk_state};
use six_wheel_numerics::error::{Error, numbers};

/// Relative excess over a limit, or error of the end, that a profile may have: Ruckig's tolerance and rounding.
const TOLERANCE: f64 = 1e-7;

/// The profile; unsynchronised axes are solved one by one.
pub(super) fn solve(
    start: &[AxisState],
    end: &[AxisState],
    bounds: &[Bounds],
    synchronise: Synchronise,
    duration: Option<f64>,
) -> Result<Profile, Error> {
    let axes = if synchronise == Synchronise::None {
        (0..start.len())
            .map(|i| call_ruckig(&start[i..=i], &end[i..=i], &bounds[i..=i], synchronise, duration)?.pop())
            .collect::<Option<Vec<_>>>()
    } else {
        call_ruckig(start, end, bounds, synchronise, duration).map(join_arrivals)
    };
    axes.map(Profile::new).ok_or_else(|| {
        let rule = "be a few orders of magnitude from the start at most, as measured by the limits";
        let values: Vec<f64> = end.iter().map(|state| state.value).collect();
        Error::value("end", rule, numbers(&values))
    })
}

/// Sets the durations of axes that are equal up to rounding to the longest one.
fn join_arrivals(mut axes: Vec<Axis>) -> Vec<Axis> {
    let last = axes.iter().fold(0.0, |last, axis| axis.duration.max(last));
    for axis in &mut axes {
        axis.duration = last;
    }
    axes
}

/// Calls the library in the caller's units; if it fails by its fixed tolerances or its largest duration, in scaled
/// units.
fn call_ruckig(
    start: &[AxisState],
    end: &[AxisState],
    bounds: &[Bounds],
    synchronise: Synchronise,
    duration: Option<f64>,
) -> Option<Vec<Axis>> {
    let natural = Units::of(start, end, bounds, duration);
    let short = natural.shortened(start, end);
    let plain = Units { time: 1.0, lengths: vec![1.0; start.len()] };
    [plain, short, natural].iter().find_map(|units| call_in_units(units, start, end, bounds, synchronise, duration))
}

/// Calls the library in these units; None if its result does not pass [`is_sound`].
fn call_in_units(
    units: &Units,
    start: &[AxisState],
    end: &[AxisState],
    bounds: &[Bounds],
    synchronise: Synchronise,
    duration: Option<f64>,
) -> Option<Vec<Axis>> {
    let count = start.len();
    let mut input = InputParameter::<0>::new(Some(count));
    // Derivatives of this order in these units.
    let scaled = |order: i32, part: &dyn Fn(usize) -> f64| {
        let values = (0..count).map(|i| part(i) * units.factor(i, order)).collect();
        DataArrayOrVec::<f64, 0>::Heap(values)
    };
    input.current_position = scaled(0, &|_| 0.0);
    input.current_velocity = scaled(1, &|i| start[i].velocity);
    input.current_acceleration = scaled(2, &|i| start[i].acceleration);
    input.target_position = scaled(0, &|i| end[i].value - start[i].value);
    input.target_velocity = scaled(1, &|i| end[i].velocity);
    input.target_acceleration = scaled(2, &|i| end[i].acceleration);
    input.max_velocity = scaled(1, &|i| bounds[i].velocity);
    input.min_velocity = Some(scaled(1, &|i| bounds[i].min_velocity));
    input.max_acceleration = scaled(2, &|i| bounds[i].acceleration);
    input.min_acceleration = Some(scaled(2, &|i| bounds[i].min_acceleration));
    input.max_jerk = scaled(3, &|i| bounds[i].jerk);
    input.minimum_duration = duration.map(|duration| duration / units.time);
    input.synchronization = match synchronise {
        Synchronise::Time => Synchronization::Time,
        Synchronise::Phase => Synchronization::Phase,
        Synchronise::None => Synchronization::None,
    };
    // The library panics where it sorts NaN: no result.
    let calculate = AssertUnwindSafe(|| {
        let mut trajectory = Trajectory::<0>::new(Some(count));
        let mut library = Ruckig::<0, ThrowErrorHandler>::new(Some(count), 0.0);
        let done = library.calculate(&input, &mut trajectory).is_ok();
        done.then_some(trajectory)
    });
    let trajectory = catch_unwind(calculate).ok().flatten()?;
    let profiles = trajectory.profiles.first()?;
    let axis = |i: usize| {
        let axis = read(&profiles[i], units, i, &start[i], &end[i], &bounds[i]);
        is_sound(&axis, units, i, &start[i], &end[i], &bounds[i]).then_some(axis)
    };
    (0..count).map(axis).collect()
}

/// Units in which the numbers of a profile are about 1, so that the library's fixed tolerances and its largest
/// duration have no effect. They are powers of two: the conversion is exact.
struct Units {
    time: f64,
    lengths: Vec<f64>,
}

impl Units {
    fn of(start: &[AxisState], end: &[AxisState], bounds: &[Bounds], duration: Option<f64>) -> Self {
        let mut time = duration.unwrap_or(0.0);
        for ((start, end), bounds) in start.iter().zip(end).zip(bounds) {
            let velocity = bounds.velocity.min(-bounds.min_velocity);
            let acceleration = bounds.acceleration.min(-bounds.min_acceleration);
            let jerk = bounds.jerk;
            let distance = (end.value - start.value).abs();
            let strong = start.acceleration.abs().max(end.acceleration.abs());
            let gain = strong * strong / jerk;
            let fast = start.velocity.abs().max(end.velocity.abs()) + gain;
            let stop = fast * fast / acceleration;
            for length in [distance, stop] {
                time = time.max(length / velocity);
                time = time.max((length / acceleration).sqrt());
                time = time.max((length / jerk).cbrt());
            }
            time = time.max(fast / acceleration).max((fast / jerk).sqrt());
            time = time.max(strong / jerk);
        }
        let time = power_of_two(time);
        let length = |(start, end): (&AxisState, &AxisState)| {
            let fast = start.velocity.abs().max(end.velocity.abs()) * time;
            let strong = start.acceleration.abs().max(end.acceleration.abs()) * time * time;
            power_of_two((end.value - start.value).abs().max(fast).max(strong))
        };
        Self { time, lengths: start.iter().zip(end).map(length).collect() }
    }

    /// Units of length by the distances alone, where these are not 0.
    fn shortened(&self, start: &[AxisState], end: &[AxisState]) -> Self {
        let length = |((start, end), &whole): ((&AxisState, &AxisState), &f64)| {
            let distance = (end.value - start.value).abs();
            if distance > 0.0 { power_of_two(distance) } else { whole }
        };
        let lengths = start.iter().zip(end).zip(&self.lengths).map(length);
        Self { time: self.time, lengths: lengths.collect() }
    }

    /// Factor that converts a derivative of this order to the units.
    fn factor(&self, axis: usize, order: i32) -> f64 {
        self.time.powi(order) / self.lengths[axis]
    }
}

fn power_of_two(size: f64) -> f64 {
    if size > 0.0 && size.is_finite() {
        // Powers of these units neither overflow nor underflow.
        size.log2().round().clamp(-200.0, 200.0).exp2()
    } else {
        1.0
    }
}

/// The pieces of one axis.
fn read(found: &RuckigResult, units: &Units, axis: usize, start: &AxisState, end: &AxisState, bounds: &Bounds) -> Axis {
    let back = |[value, velocity, acceleration, jerk]: [f64; 4]| {
        let factor = |order| units.factor(axis, order);
        [start.value + value / factor(0), velocity / factor(1), acceleration / factor(2), jerk / factor(3)]
    };
    let brake = &found.brake;
    let braking = brake.duration > 0.0;
    let before = (0..2)
        .filter(|&i| braking && brake.t[i] > 0.0)
        .map(|i| (brake.t[i], [brake.p[i], brake.v[i], brake.a[i], brake.j[i]]));
    let after =
        (0..7).filter(|&i| found.t[i] > 0.0).map(|i| (found.t[i], [found.p[i], found.v[i], found.a[i], found.j[i]]));
    let mut pieces = Vec::with_capacity(9);
    let mut duration = 0.0;
    let mut last = [end.value, end.velocity, end.acceleration, 0.0];
    for (length, state) in before.chain(after) {
        let (length, state) = (length * units.time, back(state));
        pieces.push(Piece { start: duration, state });
        last = constant_jerk_state(state, length);
        duration += length;
    }
    if pieces.is_empty() {
        pieces.push(Piece { start: 0.0, state: [start.value, end.velocity, 0.0, 0.0] });
    }
    let [velocity, acceleration] = match (bounds.acceleration, bounds.jerk) {
        (f64::INFINITY, f64::INFINITY) => [last[1], 0.0],
        (_, f64::INFINITY) => [end.velocity, last[2]],
        _ => [end.velocity, end.acceleration],
    };
    Axis { pieces, duration, end: [end.value, velocity, acceleration, last[3]] }
}

/// True if the pieces are continuous, reach the end and are within the limits.
fn is_sound(axis: &Axis, units: &Units, i: usize, start: &AxisState, end: &AxisState, bounds: &Bounds) -> bool {
    if !axis.duration.is_finite() || axis.check().is_err() {
        return false;
    }
    let ways = axis.pieces.iter().map(|piece| (piece.state[0] - start.value).abs());
    let extent = ways.fold((end.value - start.value).abs(), f64::max);
    let size = extent + f64::EPSILON / TOLERANCE * (start.value.abs() + end.value.abs());
    let mut value = start.value;
    for (k, piece) in axis.pieces.iter().enumerate() {
        if (piece.state[0] - value).abs() > TOLERANCE * size {
            return false;
        }
        let next = axis.pieces.get(k + 1).map_or(axis.duration, |next| next.start);
        value = constant_jerk_state(piece.state, next - piece.start)[0];
    }
    let [velocity, acceleration, jerk] = axis.peaks();
    let fastest = bounds.velocity.max(-bounds.min_velocity);
    let strongest = bounds.acceleration.max(-bounds.min_acceleration);
    let within = |peak: f64, limit: f64, order| peak <= limit * (1.0 + TOLERANCE) + TOLERANCE / units.factor(i, order);
    // A start beyond the limits is outside until it has been brought within them.
    let start_velocity = start.velocity.abs() + start.acceleration.powi(2) / bounds.jerk;
    (value - end.value).abs() <= TOLERANCE * size
        && within(velocity, fastest.max(start_velocity), 1)
        && within(acceleration, strongest.max(start.acceleration.abs()), 2)
        && within(jerk, bounds.jerk, 3)
}
