//! Sequences of steps from one curve to another: the order in which pairs are freed, and the wheel speeds that turn
//! them.
//!
//! A pair can turn in motion where the axle lines share a point throughout. With one pair locked that point lies on the
//! lines of the locked axles: on one line if they are in line (a rigid axle always is, axles on two pivots at angle 0),
//! else at their intersection. In the first case the wheels of the free pair move the centre of rotation along that
//! line; in the second the other pair can turn at rest only.

use nalgebra::Vector3;

use super::pivot_transition::PivotTransition;
use super::{Axles, Brake, Brakes, Drives, FourAxle, Pair, State, Step};
use six_wheel_kinematics::admissible::SLIP_TOLERANCE;
use six_wheel_kinematics::geometry::Twist;
use six_wheel_numerics::error::{Error, finite, not_negative, number, numbers, positive};

/// Difference below which angles count as equal [rad].
const SAME_ANGLE: f64 = 1e-12;

/// The axles that turn for a curve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Steer {
    /// Front and rear by opposite angles: the centre of rotation lies on the body's y axis.
    Both,
    /// The front axles alone: it lies on the line through the rear pivots.
    Front,
    /// The rear axles alone: it lies on the line through the front pivots.
    Rear,
}

named_values! { Steer as "steer": "both" => Both, "front" => Front, "rear" => Rear }

/// Speeds of a sequence.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pace {
    /// Root mean square speed of the pivots at the start [m/s]; 0 to turn the axles at rest.
    pub speed: f64,
    /// Rate of the faster axle of a pair at the point of its turn where that rate is least [rad/s].
    pub pivot_rate: f64,
    /// Time with both pairs locked after locking one [s].
    pub brake_time: f64,
}

impl Pace {
    fn check(self) -> Result<(), Error> {
        finite("speed", &[self.speed])?;
        positive("pivot_rate", self.pivot_rate)?;
        not_negative("brake_time", self.brake_time)
    }
}

/// Steps from one turn to another.
#[derive(Clone, Debug, PartialEq)]
pub struct Sequence {
    /// Steps in order; each is possible at the angles at its start.
    pub steps: Vec<Step>,
    /// True if the robot has to stop in between.
    pub stops: bool,
    /// Reason of a stop or a detour; empty without either.
    pub reason: String,
}

/// A sequence under construction: its steps, and the state and twist at their end.
struct SequenceBuilder<'a> {
    car: &'a FourAxle,
    state: State,
    twist: Twist,
    steps: Vec<Step>,
}

impl FourAxle {
    /// Sequence that turns the axles for a curvature [1/m]; 0 is straight ahead.
    pub fn turn_sequence(&self, start: State, curvature: f64, steer: Steer, pace: Pace) -> Result<Sequence, Error> {
        finite("curvature", &[curvature])?;
        let abreast = match steer {
            Steer::Both => 0.0,
            Steer::Front => -self.pivots()[0],
            Steer::Rear => self.pivots()[0],
        };
        let size = curvature.abs().max(1.0);
        let target = Twist::from([1.0, -curvature * abreast, curvature].map(|value| value / size));
        let named = |error: Error| Error { argument: "curvature".into(), value: number(curvature), ..error };
        let goal = self.aim(target, &start.angles).map_err(named)?;
        self.plan(start, goal, pace)
    }

    /// Sequence that turns the axles for a centre of rotation [m], at rest where necessary: (0, 0) to spin in place.
    pub fn aim_sequence(&self, start: State, icr: [f64; 2], pace: Pace) -> Result<Sequence, Error> {
        let named = |error: Error| Error { argument: "icr".into(), value: numbers(&icr), ..error };
        let goal = self.aim(super::turn_about(icr)?, &start.angles).map_err(named)?;
        self.plan(start, goal, pace)
    }

    /// Step with both pairs locked, at a root mean square speed of the pivots [m/s], for a time [s].
    pub fn drive(&self, start: State, speed: f64, duration: f64) -> Result<Step, Error> {
        finite("speed", &[speed])?;
        positive("duration", duration)?;
        let brakes = self.switch(&start.angles, start.brakes, Brakes::LOCKED)?;
        self.check_free(&start.angles, Pair::Rear)?;
        let mobility = self.mobility(&start.angles)?;
        if mobility.degree() > 1 {
            let rule = "leave one motion (rover.inverse gives wheel speeds for any of several)";
            return Err(Error::value("steering", rule, numbers(&start.angles)));
        }
        let twist = times(mobility.least(), speed);
        let mut draft = SequenceBuilder { car: self, state: start, twist, steps: Vec::new() };
        draft.keep_twist("drive", brakes, duration)?;
        draft.steps.pop().ok_or_else(|| Error::value("duration", "make a step", number(duration)))
    }

    fn plan(&self, start: State, goal: Axles, pace: Pace) -> Result<Sequence, Error> {
        pace.check()?;
        self.check_angles(&start.angles)?;
        finite("pose", &<[f64; 3]>::from(start.pose))?;
        if start.brakes != Brakes::LOCKED {
            let rule = "have both pairs locked";
            return Err(Error::value("state", rule, format!("{:?}", start.brakes)));
        }
        let mut reason = String::from("asked for at speed 0");
        if pace.speed != 0.0 {
            reason.clear();
            let straight = [0.0; 4];
            let detour = self.check_angles(&straight).is_ok();
            for via in [vec![goal], vec![straight, goal]] {
                if via.len() > 1 && !detour {
                    continue;
                }
                let mut refusals = Vec::new();
                for first in [Pair::Rear, Pair::Front] {
                    match self.under_way(start, &via, first, pace) {
                        Ok(steps) => {
                            return Ok(Sequence { steps, stops: false, reason });
                        }
                        Err(refusal) => refusals.push(refusal),
                    }
                }
                refusals.dedup();
                if via.len() == 1 {
                    reason = refusals.join("; ");
                }
            }
        }
        Ok(Sequence { steps: self.standing(start, goal, pace)?, stops: true, reason })
    }

    /// Steps in motion: for every leg, free, turn and lock one pair, then the other. Pairs that keep their angles are
    /// left out.
    fn under_way(&self, start: State, legs: &[Axles], first: Pair, pace: Pace) -> Result<Vec<Step>, String> {
        let mobility = self.mobility_unchecked(&start.angles);
        if mobility.degree() != 1 || mobility.slip > SLIP_TOLERANCE {
            return Err("the axle lines do not share one point to begin with".into());
        }
        let mut draft =
            SequenceBuilder { car: self, state: start, twist: times(mobility.least(), pace.speed), steps: Vec::new() };
        for leg in legs {
            for pair in [first, first.other()] {
                if !differ(&draft.state.angles, leg, pair) {
                    continue;
                }
                let transition = self.pivot_transition(draft.state.angles, draft.twist, pair, leg, pace.pivot_rate)?;
                draft.turn(pair, leg, &transition, pace).map_err(|error| error.to_string())?;
            }
        }
        Ok(draft.steps)
    }

    /// Steps with a stop: turn one pair about its pivots at rest while the other pair and its wheels hold the body,
    /// then the other.
    fn standing(&self, start: State, goal: Axles, pace: Pace) -> Result<Vec<Step>, Error> {
        let mut draft = SequenceBuilder { car: self, state: start, twist: Twist::ZERO, steps: Vec::new() };
        draft.set("stop", start.brakes)?;
        let turning: Vec<Pair> =
            [Pair::Rear, Pair::Front].into_iter().filter(|pair| differ(&start.angles, &goal, *pair)).collect();
        for pair in &turning {
            let free = draft.state.brakes.with(*pair, Brake::Free);
            if *pair == Pair::Front && turning.len() == 2 {
                // Change of the free pair. Where both pairs may not be locked the axle lines share no point: both may
                // be free.
                let locked = draft.state.brakes.with(Pair::Rear, Brake::Locked);
                if self.lock(&draft.state.angles, draft.state.brakes, Pair::Rear).is_ok() {
                    draft.set("lock rear", locked)?;
                    draft.set("free front", locked.with(Pair::Front, Brake::Free))?;
                } else {
                    draft.set("free front", free)?;
                    draft.set("lock rear", free.with(Pair::Rear, Brake::Locked))?;
                }
            } else {
                draft.set(&format!("free {}", pair.name()), free)?;
            }
            draft.turn_at_rest(*pair, &goal, pace.pivot_rate)?;
        }
        if let Some(pair) = turning.last() {
            draft.set(&format!("lock {}", pair.name()), Brakes::LOCKED)?;
        }
        Ok(draft.steps)
    }
}

impl SequenceBuilder<'_> {
    /// Appends a step of duration 0 that changes brakes.
    fn set(&mut self, action: &str, brakes: Brakes) -> Result<(), Error> {
        self.keep_twist(action, brakes, 0.0)
    }

    /// Appends a step that sets brakes and keeps the twist.
    fn keep_twist(&mut self, action: &str, brakes: Brakes, duration: f64) -> Result<(), Error> {
        let rows = self.car.rows(&self.state.angles);
        let wheels = self.car.rover().wheels();
        let twist = Vector3::from(self.twist);
        let speeds = std::array::from_fn(|i| Some(rows[i].rolling.dot(&twist) / wheels[i].radius));
        self.state.brakes = self.car.switch(&self.state.angles, self.state.brakes, brakes)?;
        if duration > 0.0 {
            self.state = self.car.advance(self.state, &speeds, duration)?;
        }
        self.record(action, duration, speeds);
        Ok(())
    }

    fn record(&mut self, action: &str, duration: f64, speeds: Drives) {
        self.steps.push(Step { action: action.into(), duration, brakes: self.state.brakes, speeds, end: self.state });
    }

    /// Appends the steps that free a pair, turn it by its wheels in motion, and lock it.
    fn turn(&mut self, pair: Pair, goal: &Axles, transition: &PivotTransition, pace: Pace) -> Result<(), Error> {
        let free = self.state.brakes.with(pair, Brake::Free);
        self.set(&format!("free {}", pair.name()), free)?;
        self.state = self.car.advance(self.state, &transition.speeds, transition.duration)?;
        self.arrive(pair, goal);
        self.record(&format!("turn {}", pair.name()), transition.duration, transition.speeds);
        self.twist = transition.twist;
        let locked = free.with(pair, Brake::Locked);
        self.keep_twist(&format!("lock {}", pair.name()), locked, pace.brake_time)
    }

    /// Appends a step that turns the free pair about its pivots while the robot is at rest.
    fn turn_at_rest(&mut self, pair: Pair, goal: &Axles, rate: f64) -> Result<(), Error> {
        let wheels = self.car.rover().wheels();
        let way = |i: usize| goal[i] - self.state.angles[i];
        let longest = pair.axles().map(|i| way(i).abs()).into_iter().fold(0.0, f64::max);
        let duration = longest / rate;
        let mut speeds = [Some(0.0); 4];
        for i in pair.axles() {
            speeds[i] = Some(-wheels[i].scrub * way(i) / duration / wheels[i].radius);
        }
        self.arrive(pair, goal);
        self.record(&format!("turn {}", pair.name()), duration, speeds);
        Ok(())
    }

    /// Replaces the integrated angles of a pair by those of the goal.
    fn arrive(&mut self, pair: Pair, goal: &Axles) {
        for i in pair.axles() {
            self.state.angles[i] = goal[i];
        }
    }
}

fn differ(from: &Axles, to: &Axles, pair: Pair) -> bool {
    pair.axles().iter().any(|&i| (from[i] - to[i]).abs() > SAME_ANGLE)
}

fn times(twist: Twist, factor: f64) -> Twist {
    Twist::from(Vector3::from(twist) * factor)
}
