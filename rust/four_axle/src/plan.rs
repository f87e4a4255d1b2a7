//! Sequences of steps from one turn to another: the order in which pairs are freed, and the wheel speeds that turn
//! them.
//!
//! Driving on is possible where the axle lines share a point throughout. With one pair locked that point
//! stays on the lines of the locked axles: on a line if they are in line (a rigid axle always is, those on two
//! pivots at angle 0), else where they meet. In the first case the centre of rotation moves along that
//! line, and the wheels of the free pair make it move; in the second nothing can turn but standing axles.

use nalgebra::Vector3;

use super::glide::PivotTransition;
use super::{Axles, Brake, Brakes, Drives, FourAxle, Pair, State, Step};
use six_wheel_kinematics::admissible::SLIP_TOLERANCE;
use six_wheel_kinematics::geometry::Twist;
use six_wheel_numerics::error::{Error, finite, not_negative, number, numbers, positive};

/// Angles nearer to each other than this are one [rad].
const SAME_ANGLE: f64 = 1e-12;

/// The axles that turn for a curve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Steer {
    /// Front and rear against each other: the centre of rotation lies abreast of the body's origin.
    Both,
    /// The front axles alone: it lies abreast of the rear pivots.
    Front,
    /// The rear axles alone: it lies abreast of the front pivots.
    Rear,
}

named_values! { Steer as "steer": "both" => Both, "front" => Front, "rear" => Rear }

/// Speeds of a sequence.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pace {
    /// Root mean square speed of the pivots at the begin [m/s]; 0 to re-aim standing.
    pub speed: f64,
    /// Rate of the faster axle where the pair turns slowest [rad/s].
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
    /// In order; each was checked at the angles where it begins.
    pub steps: Vec<Step>,
    /// True if the robot has to stand in between.
    pub stops: bool,
    /// Reason of a stop or a detour; empty without either.
    pub reason: String,
}

/// A sequence that grows by one step at a time.
struct SequenceBuilder<'a> {
    car: &'a FourAxle,
    state: State,
    twist: Twist,
    steps: Vec<Step>,
}

impl FourAxle {
    /// Re-aims the axles for a curve [1/m]; 0 is straight ahead.
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

    /// Re-aims the axles at a point [m], standing if need be: (0, 0) to spin in place.
    pub fn aim_sequence(&self, start: State, icr: [f64; 2], pace: Pace) -> Result<Sequence, Error> {
        let named = |error: Error| Error { argument: "icr".into(), value: numbers(&icr), ..error };
        let goal = self.aim(super::turn_about(icr)?, &start.angles).map_err(named)?;
        self.plan(start, goal, pace)
    }

    /// Drives on with both pairs locked, at a root mean square speed of the pivots [m/s], for a time [s].
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
        draft.go_on("drive", brakes, duration)?;
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

    /// Six steps for every leg: free, turn, lock the one pair, then the other. Pairs that stay are left out.
    fn under_way(&self, start: State, legs: &[Axles], first: Pair, pace: Pace) -> Result<Vec<Step>, String> {
        let mobility = self.judge(&start.angles);
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
                let glide = self.glide(draft.state.angles, draft.twist, pair, leg, pace.pivot_rate)?;
                draft.turn(pair, leg, &glide, pace).map_err(|error| error.to_string())?;
            }
        }
        Ok(draft.steps)
    }

    /// Stop, turn one axle pair about its pivots while the other pair and its wheels hold the body, then the
    /// other.
    fn standing(&self, start: State, goal: Axles, pace: Pace) -> Result<Vec<Step>, Error> {
        let mut draft = SequenceBuilder { car: self, state: start, twist: Twist::ZERO, steps: Vec::new() };
        draft.set("stop", start.brakes)?;
        let turning: Vec<Pair> =
            [Pair::Rear, Pair::Front].into_iter().filter(|pair| differ(&start.angles, &goal, *pair)).collect();
        for pair in &turning {
            let free = draft.state.brakes.with(*pair, Brake::Free);
            if *pair == Pair::Front && turning.len() == 2 {
                // Handing over: where both pairs locked would be frozen, both free are held by their own
                // axles.
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
            draft.swing(*pair, &goal, pace.pivot_rate)?;
        }
        if let Some(pair) = turning.last() {
            draft.set(&format!("lock {}", pair.name()), Brakes::LOCKED)?;
        }
        Ok(draft.steps)
    }
}

impl SequenceBuilder<'_> {
    /// Changes brakes, in no time.
    fn set(&mut self, action: &str, brakes: Brakes) -> Result<(), Error> {
        self.go_on(action, brakes, 0.0)
    }

    /// Sets brakes and goes on as before.
    fn go_on(&mut self, action: &str, brakes: Brakes, duration: f64) -> Result<(), Error> {
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

    /// Frees a pair, lets its wheels turn it under way, and locks it.
    fn turn(&mut self, pair: Pair, goal: &Axles, glide: &PivotTransition, pace: Pace) -> Result<(), Error> {
        let free = self.state.brakes.with(pair, Brake::Free);
        self.set(&format!("free {}", pair.name()), free)?;
        self.state = self.car.advance(self.state, &glide.speeds, glide.duration)?;
        self.arrive(pair, goal);
        self.record(&format!("turn {}", pair.name()), glide.duration, glide.speeds);
        self.twist = glide.twist;
        let locked = free.with(pair, Brake::Locked);
        self.go_on(&format!("lock {}", pair.name()), locked, pace.brake_time)
    }

    /// Turns the free pair about its pivots while the robot stands.
    fn swing(&mut self, pair: Pair, goal: &Axles, rate: f64) -> Result<(), Error> {
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

    /// Replaces integrated angles by the ones they stand for.
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
