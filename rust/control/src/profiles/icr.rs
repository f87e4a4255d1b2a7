//! Transitions along which all wheels keep one centre of rotation at every instant.
//!
//! The path is a chord between the twists, or two chords where the wheels cannot follow one; where they cannot follow
//! two, the rover stops, turns its wheels at rest and drives on, and the phases carry the reason.

use super::Derivatives;
use super::chord::Chord;
use super::constraints::IcrLimits;
use super::phase::{Action, Motion, Phase};
use super::plan::{PhaseList, TransitionPlanner};
use super::sampling::{Wheels, check_trail};
use six_wheel_kinematics::geometry::Twist;
use six_wheel_kinematics::rover::{Inputs, Rover};
use six_wheel_numerics::error::{Error, finite, numbers};

/// Velocities whose squares neither overflow nor underflow.
const SIZES: std::ops::RangeInclusive<f64> = 1e-100..=1e100;

/// From one twist to another with one centre of rotation at every instant.
#[derive(Clone, Debug, PartialEq)]
pub struct IcrTransition {
    rover: Rover,
    phases: Vec<Phase>,
    duration: f64,
}

getters! {
    IcrTransition:
    /// Duration [s].
    duration: f64;
    /// The phases in the order of time, each with its reason.
    phases: &[Phase];
    /// The rover it is for.
    rover: &Rover;
}

impl IcrTransition {
    /// Plans the transition; `previous` are the steering angles at the start, default the nearest to 0.
    pub fn new(
        rover: &Rover,
        start: Twist,
        end: Twist,
        limits: &IcrLimits,
        previous: Option<&[f64]>,
    ) -> Result<Self, Error> {
        limits.check()?;
        check_twist(rover, "start_twist", start)?;
        check_twist(rover, "end_twist", end)?;
        check_trail(rover)?;
        let inputs = Inputs { previous, ..Inputs::default() };
        inputs.check()?;
        let planner = TransitionPlanner { rover, limits };
        planner.check_speed("start_twist", start)?;
        planner.check_speed("end_twist", end)?;
        let mut angles = vec![0.0; rover.steered().len()];
        rover.solve(start, inputs, &mut angles, &mut vec![0.0; rover.wheels().len()]);
        let plan = PhaseList { angles, ..PhaseList::default() };
        let plan = planner.plan(plan, start, end)?;
        Ok(Self { rover: rover.clone(), phases: plan.phases, duration: plan.duration })
    }

    /// Number of phases that bring the rover to rest.
    pub fn stops(&self) -> usize {
        let is_stop = |phase: &&Phase| phase.action == Action::Stop;
        self.phases.iter().filter(is_stop).count()
    }

    /// Twist and wheels at a time [s]: before the start those of the start, after the end those of the end.
    pub fn at(&self, time: f64, wheels: &mut Wheels<'_>) -> Twist {
        let before = time < 0.0;
        let next = self.phases.partition_point(|phase| phase.start <= time);
        let index = if before { 0 } else { next.saturating_sub(1) };
        let Some(phase) = self.phases.get(index) else {
            return Twist::ZERO;
        };
        // The exact end state, independent of the rounding of the phases' sum.
        let over = time >= self.duration;
        let local = if over { phase.duration } else { time - phase.start };
        let twist = match &phase.motion {
            Motion::Along(chord, timing) => {
                // A chord of duration 0 is at its end from its start on.
                let place = if before { [0.0; 4] } else { timing.at(local) };
                along(chord, place, wheels)
            }
            Motion::Turning(twist, profile) => {
                wheels.follow(profile, local);
                *twist
            }
        };
        if before || time > self.duration {
            wheels.rates.fill(0.0);
            wheels.accelerations.fill(0.0);
        }
        wheels.roll_at_angles(&self.rover, twist);
        twist
    }
}

/// Writes the steering at a share of a chord, given with its derivatives by time.
fn along(chord: &Chord, [s, pace, second, _]: Derivatives, wheels: &mut Wheels<'_>) -> Twist {
    for (j, joint) in chord.joints.iter().enumerate() {
        let [slope, bend, _] = joint.angle_derivatives(s);
        wheels.steering[j] = joint.angle + joint.swept(s);
        // A joint that does not turn has rate 0, also where the pace is infinite.
        let turns = slope != 0.0;
        wheels.rates[j] = if turns { slope * pace } else { 0.0 };
        wheels.accelerations[j] = if turns { bend * pace * pace + slope * second } else { 0.0 };
    }
    chord.twist(s)
}

fn check_twist(rover: &Rover, argument: &'static str, twist: Twist) -> Result<(), Error> {
    let parts = <[f64; 3]>::from(twist);
    finite(argument, &parts)?;
    if parts.iter().any(|part| *part != 0.0 && !SIZES.contains(&part.abs())) {
        let rule = format!("have parts between {:?} and {:?}, or 0", SIZES.start(), SIZES.end());
        return Err(Error::value(argument, rule, numbers(&parts)));
    }
    rover.check(twist, None).map_err(|error| Error { argument: argument.into(), ..error })
}
