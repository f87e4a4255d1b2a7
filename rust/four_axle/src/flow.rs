//! Motion of body and free pivots over time at constant wheel speeds, by Gauss collocation with halved steps.

use nalgebra::{Rotation2, Vector2};

use super::{Axles, Brake, Brakes, Drives, FourAxle, Motion, State, Step};
use six_wheel_kinematics::geometry::{Pose, Twist};
use six_wheel_numerics::error::{Error, ErrorKind, finite, not_negative, number, positive};
use six_wheel_numerics::threads::workers::{BETWEEN_CHECKS, IsInterrupted};

/// Steps are halved until the result changes by less than this [rad, m]: well above the rounding of the velocities.
const SETTLED: f64 = 1e-12;

/// Halvings after which a step fails: the motion is not smooth.
const HALVINGS: usize = 24;

/// Change of an angle below which the fixed point of a step has converged [rad].
const ROUNDING: f64 = 1e-14;

/// Rounds of the fixed point of one step; each reduces the error by a factor of about rate times step.
const ROUNDS: usize = 40;

/// Most samples of one simulation.
const MOST_SAMPLES: f64 = 1e7;

/// A simulated drive: one row per sample.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Track {
    /// Time since the start [s].
    pub times: Vec<f64>,
    /// Poses x, y, yaw, `world_from_body` [m, m, rad].
    pub poses: Vec<[f64; 3]>,
    /// Axle angles [rad].
    pub angles: Vec<Axles>,
    /// Twists of the body at the end of the step that leads to the sample [m/s, m/s, rad/s].
    pub twists: Vec<[f64; 3]>,
    /// Speeds of all wheels, the following ones included [rad/s].
    pub speeds: Vec<Axles>,
    /// Speed at which each contact slides [m/s].
    pub residual: Vec<Axles>,
    /// Row in which each step ends.
    pub ends: Vec<usize>,
}

impl Track {
    /// An empty track with memory for this number of samples.
    fn with_room(samples: usize) -> Result<Self, Error> {
        let mut track = Self::default();
        let reserved = [
            track.times.try_reserve_exact(samples),
            track.poses.try_reserve_exact(samples),
            track.angles.try_reserve_exact(samples),
            track.twists.try_reserve_exact(samples),
            track.speeds.try_reserve_exact(samples),
            track.residual.try_reserve_exact(samples),
        ];
        if reserved.iter().all(Result::is_ok) {
            return Ok(track);
        }
        let error = Error::value("dt", "leave few enough samples for the memory", samples.to_string());
        Err(error.of_kind(ErrorKind::Memory))
    }

    fn push(&mut self, time: f64, state: &State, motion: &Motion) {
        self.times.push(time);
        self.poses.push(state.pose.into());
        self.angles.push(state.angles);
        self.twists.push(motion.twist.into());
        self.speeds.push(motion.speeds);
        self.residual.push(motion.residual);
    }
}

/// Nodes, weights and coefficients of Gauss collocation with three stages (E. Hairer, G. Wanner, Solving
/// Ordinary Differential Equations II, table IV.5.2). Order six, symmetric in time, and exact for constant
/// rates.
pub(super) struct Gauss {
    pub nodes: [f64; 3],
    pub weights: [f64; 3],
    inner: [[f64; 3]; 3],
}

pub(super) fn gauss() -> Gauss {
    let root = 15.0_f64.sqrt();
    let (outer, middle) = (5.0 / 36.0, 2.0 / 9.0);
    Gauss {
        nodes: [0.5 - root / 10.0, 0.5, 0.5 + root / 10.0],
        weights: [5.0 / 18.0, 4.0 / 9.0, 5.0 / 18.0],
        inner: [
            [outer, middle - root / 15.0, outer - root / 30.0],
            [outer + root / 24.0, middle, outer - root / 24.0],
            [outer + root / 30.0, middle + root / 15.0, outer],
        ],
    }
}

/// Inputs that are constant during a step.
#[derive(Clone, Copy)]
struct FixedInputs<'a> {
    speeds: &'a Drives,
    lasting: bool,
}

impl FourAxle {
    /// Simulates a sequence of steps, sampled at least every `dt` [s]. Returns the track and the final state.
    ///
    /// Of the steps only brakes, durations and speeds are used. Fails with the step's row where a brake may not change.
    /// `is_interrupted` is called between samples.
    pub fn simulate(
        &self,
        start: State,
        sequence: &[Step],
        dt: f64,
        is_interrupted: IsInterrupted,
    ) -> Result<(Track, State), Error> {
        let samples = self.check_sequence(start, sequence, dt)?;
        let mut track = Track::with_room(samples)?;
        let mut state = start;
        let mut time = 0.0;
        for (row, step) in sequence.iter().enumerate() {
            let here =
                |error: Error| Error { argument: format!("sequence[{row}]: {}", error.argument).into(), ..error };
            state.brakes = self.switch(&state.angles, state.brakes, step.brakes).map_err(here)?;
            if step.duration > 0.0 {
                let lasting = self.must_last(&state.angles, state.brakes, &step.speeds);
                let motion = self.velocities(&state.angles, state.brakes, &step.speeds, lasting).map_err(here)?;
                if track.times.is_empty() {
                    track.push(time, &state, &motion);
                }
                let count = (step.duration / dt).ceil().max(1.0);
                let begin = time;
                for k in 1..=count as usize {
                    if k % BETWEEN_CHECKS == 0 && is_interrupted() {
                        return Err(Error::interrupted());
                    }
                    state = self.advance(state, &step.speeds, step.duration / count).map_err(here)?;
                    time = begin + step.duration * (k as f64 / count);
                    let motion = self.velocities(&state.angles, state.brakes, &step.speeds, lasting).map_err(here)?;
                    track.push(time, &state, &motion);
                }
            }
            track.ends.push(track.times.len().saturating_sub(1));
        }
        if track.times.is_empty() {
            let still = self.velocities(&state.angles, Brakes::LOCKED, &[Some(0.0); 4], false)?;
            track.push(time, &state, &still);
        }
        Ok((track, state))
    }

    /// Checks the arguments of a simulation and returns an upper bound of its number of samples.
    fn check_sequence(&self, start: State, sequence: &[Step], dt: f64) -> Result<usize, Error> {
        self.check_angles(&start.angles)?;
        finite("pose", &<[f64; 3]>::from(start.pose))?;
        positive("dt", dt)?;
        let mut samples = 0.0;
        for (row, step) in sequence.iter().enumerate() {
            not_negative("duration", step.duration).map_err(|error| error.at_row(row))?;
            self.check_speeds(&step.speeds).map_err(|error| error.at_row(row))?;
            samples += (step.duration / dt).ceil().max(1.0);
        }
        if samples > MOST_SAMPLES {
            let rule = format!("give at most {MOST_SAMPLES:e} samples");
            return Err(Error::value("dt", rule, number(dt)));
        }
        Ok(samples as usize + 1)
    }

    /// The state after holding these wheel speeds for `dt` [s].
    pub(super) fn advance(&self, state: State, speeds: &Drives, dt: f64) -> Result<State, Error> {
        if state.brakes.both(Brake::Locked) {
            let motion = self.velocities(&state.angles, state.brakes, speeds, false)?;
            let pose = state.pose.compose(motion.twist.exp(dt));
            return Ok(State { pose, ..state });
        }
        // Decided once per step: at its stages the axle lines share a point only up to rounding.
        let lasting = self.must_last(&state.angles, state.brakes, speeds);
        let held = FixedInputs { speeds, lasting };
        // Relative to the pose at the start: far from the origin, rounding of the position would exceed the tolerance.
        let here = State { pose: Pose::default(), ..state };
        let whole = self.collocate(here, held, dt)?;
        let end = self.refine(here, whole, held, dt, HALVINGS)?;
        Ok(State { pose: state.pose.compose(end.pose), ..end })
    }

    /// The state after a step, which is halved until both halves agree with the whole.
    fn refine(
        &self,
        state: State,
        whole: Option<State>,
        held: FixedInputs<'_>,
        dt: f64,
        left: usize,
    ) -> Result<State, Error> {
        let half = self.collocate(state, held, dt / 2.0)?;
        let end = match half {
            Some(middle) => self.collocate(middle, held, dt / 2.0)?,
            None => None,
        };
        if let (Some(whole), Some(end)) = (whole, end)
            && max_difference(whole, end) <= SETTLED
        {
            self.check_angles(&end.angles)?;
            return Ok(end);
        }
        if left == 0 {
            let rule = "keep the motion smooth (axles that come to share a point, or cease to, do not)";
            return Err(Error::value("wheel_speeds", rule, format!("{:?}", held.speeds)));
        }
        let middle = self.refine(state, half, held, dt / 2.0, left - 1)?;
        let second = self.collocate(middle, held, dt / 2.0)?;
        self.refine(middle, second, held, dt / 2.0, left - 1)
    }

    /// One step of Gauss collocation; None if its fixed point does not converge.
    ///
    /// The rates are functions of the angles alone: the angles are solved for first, yaw and position follow by
    /// quadrature.
    fn collocate(&self, state: State, held: FixedInputs<'_>, dt: f64) -> Result<Option<State>, Error> {
        let Gauss { weights, inner, .. } = gauss();
        let rates = |angles: &Axles| self.velocities(angles, state.brakes, held.speeds, held.lasting);
        let mut motions = [rates(&state.angles)?; 3];
        let mut stages = [state.angles; 3];
        let mut settled = false;
        for _ in 0..ROUNDS {
            let mut change: f64 = 0.0;
            for (stage, row) in stages.iter_mut().zip(&inner) {
                for (axle, angle) in stage.iter_mut().enumerate() {
                    let turned = |k: usize| row[k] * motions[k].pivot_rates[axle];
                    let next = state.angles[axle] + dt * (turned(0) + turned(1) + turned(2));
                    change = change.max((next - *angle).abs());
                    *angle = next;
                }
            }
            for (motion, stage) in motions.iter_mut().zip(&stages) {
                *motion = rates(stage)?;
            }
            settled = change <= ROUNDING;
            if settled {
                break;
            }
        }
        if !settled {
            return Ok(None);
        }
        let sum = |row: &[f64; 3], value: &dyn Fn(usize) -> f64| {
            dt * (row[0] * value(0) + row[1] * value(1) + row[2] * value(2))
        };
        let yaw = |row: &[f64; 3]| sum(row, &|k| motions[k].twist.omega);
        let moved: [Vector2<f64>; 3] =
            std::array::from_fn(|k| Rotation2::new(yaw(&inner[k])) * Twist::linear(motions[k].twist));
        let moved_by =
            Pose { x: sum(&weights, &|k| moved[k].x), y: sum(&weights, &|k| moved[k].y), yaw: yaw(&weights) };
        let angles = std::array::from_fn(|axle| state.angles[axle] + sum(&weights, &|k| motions[k].pivot_rates[axle]));
        Ok(Some(State { angles, pose: state.pose.compose(moved_by), ..state }))
    }
}

/// Largest difference between two states [rad, m].
fn max_difference(one: State, two: State) -> f64 {
    let (p, q) = (<[f64; 3]>::from(one.pose), <[f64; 3]>::from(two.pose));
    let pairs = one.angles.iter().zip(&two.angles).chain(p.iter().zip(&q));
    pairs.fold(0.0, |most, (a, b)| most.max((a - b).abs()))
}
