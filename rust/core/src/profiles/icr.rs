//! Transitions along which all wheels keep one centre of rotation at every instant.
//!
//! The way is a chord between the twists, or two where the wheels cannot follow one; where they can follow neither,
//! the rover stops, turns its wheels at rest and drives on, and the plan says why.

use nalgebra::{Complex, Vector3};

use super::chord::{Chord, Way};
use super::laws::{IcrLimits, laws, swing};
use super::optimal::{Bounds, Moving, Synchronise, time_optimal};
use super::timing::{Smoothness, Timing};
use super::{Derivatives, Profile, Wheels};
use crate::error::{Error, ErrorKind, finite, number, numbers};
use crate::geometry::Twist;
use crate::rover::{Inputs, Rover};

/// Angles that differ by less are the same [rad].
const SAME_ANGLE: f64 = 1e-12;

/// Velocities whose squares are still numbers.
const SIZES: std::ops::RangeInclusive<f64> = 1e-100..=1e100;

/// How far aside a detour's corner lies, as shares of the larger twist.
const DETOURS: [f64; 6] = [0.3, -0.3, 0.7, -0.7, 1.4, -1.4];

/// A chord that takes longer than this many times what its wheels need at rest is worth a detour.
const LONG: f64 = 1.5;

/// What happens in a phase of a transition.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Action {
    /// Drive along the path of the centre of rotation.
    Drive,
    /// Come to rest, steering angles held.
    Stop,
    /// Turn wheels whose pivots rest.
    Align,
}

impl Action {
    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Drive => "drive",
            Self::Stop => "stop",
            Self::Align => "align",
        }
    }
}

/// A part of a transition.
#[derive(Clone, Debug, PartialEq)]
pub struct Phase {
    /// What happens.
    pub action: Action,
    /// Why.
    pub reason: String,
    /// When it begins [s].
    pub start: f64,
    /// How long it takes [s].
    pub duration: f64,
    motion: Motion,
}

#[derive(Clone, Debug, PartialEq)]
enum Motion {
    Along(Chord, Timing),
    Turning(Twist, Profile),
}

/// From one twist to another with one centre of rotation at every instant.
#[derive(Clone, Debug, PartialEq)]
pub struct IcrTransition {
    rover: Rover,
    phases: Vec<Phase>,
    duration: f64,
}

/// Phases in the making.
#[derive(Clone, Default)]
struct Plan {
    phases: Vec<Phase>,
    angles: Vec<f64>,
    duration: f64,
}

impl Plan {
    fn push(&mut self, action: Action, reason: impl Into<String>, duration: f64, motion: Motion) {
        self.phases.push(Phase {
            action,
            reason: reason.into(),
            start: self.duration,
            duration,
            motion,
        });
        self.duration += duration;
    }
}

struct Planner<'a> {
    rover: &'a Rover,
    limits: &'a IcrLimits,
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
        super::led::check_trail(rover)?;
        let inputs = Inputs {
            previous,
            ..Inputs::default()
        };
        inputs.check()?;
        let planner = Planner { rover, limits };
        planner.check_speed("start_twist", start)?;
        planner.check_speed("end_twist", end)?;
        let mut angles = vec![0.0; rover.steered().len()];
        rover.solve(
            start,
            inputs,
            &mut angles,
            &mut vec![0.0; rover.wheels().len()],
        );
        let plan = Plan {
            angles,
            ..Plan::default()
        };
        let plan = planner.plan(plan, start, end)?;
        Ok(Self {
            rover: rover.clone(),
            phases: plan.phases,
            duration: plan.duration,
        })
    }

    /// How long it takes [s].
    pub fn duration(&self) -> f64 {
        self.duration
    }

    /// What happens when, and why.
    pub fn phases(&self) -> &[Phase] {
        &self.phases
    }

    /// How often the rover has to come to rest on the way.
    pub fn stops(&self) -> usize {
        let is_stop = |phase: &&Phase| phase.action == Action::Stop;
        self.phases.iter().filter(is_stop).count()
    }

    /// The rover it is for.
    pub fn rover(&self) -> &Rover {
        &self.rover
    }

    /// Twist and wheels at a time [s]: before the start those of the start, after the end those of the end.
    pub fn at(&self, time: f64, wheels: &mut Wheels<'_>) -> Twist {
        let before = time < 0.0;
        let next = self.phases.partition_point(|phase| phase.start <= time);
        let index = if before { 0 } else { next.saturating_sub(1) };
        let Some(phase) = self.phases.get(index) else {
            return Twist::ZERO;
        };
        // The end exactly, however the sum of the phases was rounded.
        let over = time >= self.duration;
        let local = if over {
            phase.duration
        } else {
            time - phase.start
        };
        let twist = match &phase.motion {
            Motion::Along(chord, timing) => {
                // A chord that takes no time is over when it begins, but not before.
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
        wheels.spin(&self.rover, twist);
        twist
    }
}

/// Steering at a place of a chord, given with its derivatives.
fn along(chord: &Chord, [s, pace, second, _]: Derivatives, wheels: &mut Wheels<'_>) -> Twist {
    for (j, joint) in chord.joints.iter().enumerate() {
        let [slope, bend, _] = joint.swing(s);
        wheels.steering[j] = joint.angle + joint.swept(s);
        // A joint that does not turn has no rate, however fast the chord goes.
        let turns = slope != 0.0;
        wheels.rates[j] = if turns { slope * pace } else { 0.0 };
        wheels.accelerations[j] = if turns {
            bend * pace * pace + slope * second
        } else {
            0.0
        };
    }
    chord.twist(s)
}

fn check_twist(rover: &Rover, argument: &'static str, twist: Twist) -> Result<(), Error> {
    let parts = <[f64; 3]>::from(twist);
    finite(argument, &parts)?;
    if parts
        .iter()
        .any(|part| *part != 0.0 && !SIZES.contains(&part.abs()))
    {
        let rule = format!(
            "have parts between {:?} and {:?}, or 0",
            SIZES.start(),
            SIZES.end()
        );
        return Err(Error::value(argument, rule, numbers(&parts)));
    }
    rover.check(twist, None).map_err(|error| Error {
        argument: argument.into(),
        ..error
    })
}

impl Planner<'_> {
    /// Fails if a driven wheel would be too fast.
    fn check_speed(&self, argument: &'static str, twist: Twist) -> Result<(), Error> {
        let fastest = self.fastest(twist);
        if fastest <= self.limits.wheel_speed * (1.0 + 1e-12) {
            return Ok(());
        }
        let rule = format!(
            "keep every wheel within wheel_speed, {} rad/s (the fastest would turn at {} rad/s)",
            number(self.limits.wheel_speed),
            number(fastest)
        );
        let value = numbers(&<[f64; 3]>::from(twist));
        Err(Error::value(argument, rule, value).of_kind(ErrorKind::Infeasible))
    }

    /// Speed of the fastest driven wheel [rad/s].
    fn fastest(&self, twist: Twist) -> f64 {
        let mut speeds = vec![0.0; self.rover.wheels().len()];
        let mut angles = vec![0.0; self.rover.steered().len()];
        self.rover
            .solve(twist, Inputs::default(), &mut angles, &mut speeds);
        let driven = (0..speeds.len()).filter(|&i| super::chord::is_driven(self.rover, i));
        driven.fold(0.0, |most: f64, i| most.max(speeds[i].abs()))
    }

    fn plan(&self, plan: Plan, start: Twist, end: Twist) -> Result<Plan, Error> {
        let direct = self.drive(plan.clone(), start, end, "on one chord");
        let least = self.least_turning(&plan.angles, end) / self.limits.steering_rate;
        let good = |found: &Plan| found.duration - plan.duration <= LONG * least;
        let why = match direct {
            Ok(found) if good(&found) || !self.rover.banks().is_empty() => return Ok(found),
            Ok(found) => {
                let around = self.detour(&plan, start, end);
                let faster = around.filter(|around| around.duration < found.duration);
                return Ok(faster.unwrap_or(found));
            }
            Err(Failure::Refused(error)) => return Err(error),
            Err(Failure::Closed(why)) => why,
        };
        if let Some(found) = self.detour(&plan, start, end) {
            return Ok(found);
        }
        let closed = |failure| match failure {
            Failure::Refused(error) => error,
            // To and from rest no wheel turns: not met.
            Failure::Closed(why) => infeasible(end, &why),
        };
        let mut stopped = self
            .drive(plan, start, Twist::ZERO, &format!("{why} on the way"))
            .map_err(closed)?;
        if let Some(last) = stopped.phases.last_mut() {
            last.action = Action::Stop;
        }
        self.drive(stopped, Twist::ZERO, end, "from rest")
            .map_err(closed)
    }

    /// Largest angle by which a wheel has to turn in any case [rad].
    fn least_turning(&self, angles: &[f64], end: Twist) -> f64 {
        let aligned = self.aligned(angles, end);
        let turns = angles.iter().zip(&aligned).map(|(a, b)| (a - b).abs());
        turns.fold(0.0, f64::max)
    }

    fn aligned(&self, angles: &[f64], twist: Twist) -> Vec<f64> {
        let mut aligned = angles.to_vec();
        let inputs = Inputs {
            previous: Some(angles),
            ..Inputs::default()
        };
        let mut speeds = vec![0.0; self.rover.wheels().len()];
        self.rover.solve(twist, inputs, &mut aligned, &mut speeds);
        aligned
    }

    /// Two chords where one will not do, for a rover whose centre of rotation may be anywhere.
    fn detour(&self, plan: &Plan, start: Twist, end: Twist) -> Option<Plan> {
        if !self.rover.banks().is_empty() {
            return None;
        }
        let size = Vector3::new(1.0, 1.0, self.rover.size);
        let [a, b] = [start, end].map(|twist| Vector3::from(twist).component_mul(&size));
        let across = a.cross(&b);
        let largest = a.norm().max(b.norm());
        let normal = if across.norm() > 1e-9 * largest * largest {
            across
        } else {
            // Opposite or equal directions: any way across both will do.
            let axis = if a.z.abs() < a.xy().norm() {
                Vector3::z()
            } else {
                Vector3::x()
            };
            (if a.norm() > 0.0 { a } else { b }).cross(&axis)
        };
        let normal = normal.try_normalize(0.0)?;
        let corner = |share: f64| {
            let corner: Twist = ((a + b) / 2.0 + normal * (share * largest))
                .component_div(&size)
                .into();
            let excess = (self.fastest(corner) / self.limits.wheel_speed).max(1.0);
            Twist::from(Vector3::from(corner) / excess)
        };
        let around = |planner: &Planner<'_>, corner: Twist, why: &str| {
            self.rover.check(corner, None).ok()?;
            let half = planner.drive(plan.clone(), start, corner, why).ok()?;
            planner.drive(half, corner, end, why).ok()
        };
        // Which corner is best shows without the limits that take long to plan for.
        let firm = IcrLimits {
            steering_acceleration: f64::INFINITY,
            steering_jerk: f64::INFINITY,
            ..*self.limits
        };
        let quick = Planner {
            rover: self.rover,
            limits: &firm,
        };
        let tried = |corner: Twist, why: String| {
            let duration = around(&quick, corner, &why)?.duration;
            Some((duration, corner, why))
        };
        let beside = DETOURS.iter().filter_map(|&share| {
            tried(
                corner(share),
                "around what stands in the way of one chord".into(),
            )
        });
        // Right over a pivot its wheel comes to rest, and rolls away again however it is turned there.
        let over = self.rover.steered().iter().filter_map(|&i| {
            let wheel = &self.rover.wheels()[i];
            let [from, to] = [start, end].map(|twist| twist.at(wheel.x, wheel.y));
            let change = to - from;
            let nearest = -from.dot(&change) / change.norm_squared();
            let omega = start.omega + nearest * (end.omega - start.omega);
            let about = Twist {
                vx: omega * wheel.y,
                vy: -omega * wheel.x,
                omega,
            };
            let name = &wheel.name;
            let why = format!("right over the pivot of {name:?}, past which no wheel turns");
            (nearest > 0.0 && nearest < 1.0).then(|| tried(about, why))?
        });
        let (_, corner, why) = beside.chain(over).min_by(|a, b| a.0.total_cmp(&b.0))?;
        around(self, corner, &why)
    }

    /// Appends one chord, and before it what aligns the wheels whose pivots rest at its start.
    fn drive(&self, mut plan: Plan, start: Twist, end: Twist, why: &str) -> Result<Plan, Failure> {
        if start == end {
            return self.hold(plan, start, end);
        }
        let chord = match Chord::between(self.rover, start, end, &plan.angles) {
            Way::Open(chord) => chord,
            Way::Closed(why) => return Err(Failure::Closed(why.into_owned())),
        };
        let aligned: Vec<f64> = chord.joints.iter().map(|joint| joint.angle).collect();
        let turn = |(a, b): (&f64, &f64)| (a - b).abs() > SAME_ANGLE;
        if plan.angles.iter().zip(&aligned).any(turn) {
            let profile = self
                .align(&plan.angles, &aligned)
                .map_err(Failure::Refused)?;
            let reason = if start == Twist::ZERO {
                "the wheels turn at rest to where the motion begins"
            } else {
                "the pivot under the centre of rotation turns to where its motion begins"
            };
            let motion = Motion::Turning(start, profile.clone());
            plan.push(Action::Align, reason, profile.duration(), motion);
        }
        let smooth = self.smoothness();
        let timing = Timing::new(&chord, &laws(self.rover, &chord, self.limits), &smooth)
            .ok_or_else(|| Failure::Refused(infeasible(end, "a limit leaves no room to move")))?;
        plan.angles = chord
            .joints
            .iter()
            .map(|joint| joint.angle + joint.swept(1.0))
            .collect();
        plan.push(
            Action::Drive,
            why,
            timing.duration(),
            Motion::Along(chord, timing),
        );
        Ok(plan)
    }

    /// Nothing to do.
    fn hold(&self, mut plan: Plan, start: Twist, end: Twist) -> Result<Plan, Failure> {
        if let Way::Open(chord) = Chord::between(self.rover, start, end, &plan.angles) {
            let timing = Timing::Binding {
                bounds: Vec::new(),
                duration: 0.0,
            };
            plan.push(
                Action::Drive,
                "there already",
                0.0,
                Motion::Along(chord, timing),
            );
        }
        Ok(plan)
    }

    fn smoothness(&self) -> Smoothness {
        let limit = |&i: &usize| {
            let wheel = &self.rover.wheels()[i];
            self.limits.acceleration_of(wheel.scrub, wheel.radius)
        };
        Smoothness {
            accelerations: self.rover.steered().iter().map(limit).collect(),
            jerk: self.limits.steering_jerk,
        }
    }

    /// All joints in proportion, as fast as the slowest allows.
    fn align(&self, from: &[f64], to: &[f64]) -> Result<Profile, Error> {
        let smooth = self.smoothness();
        let mut share = Bounds::symmetric(f64::INFINITY, f64::INFINITY, f64::INFINITY);
        for (j, &i) in self.rover.steered().iter().enumerate() {
            let wheel = &self.rover.wheels()[i];
            // A contact beside its pivot rolls around it.
            let rolling = self.limits.wheel_speed * wheel.radius / wheel.scrub.abs();
            let turn = (to[j] - from[j]).abs();
            let rate = self.limits.steering_rate.min(rolling);
            share.velocity = share.velocity.min(rate / turn);
            share.acceleration = share.acceleration.min(smooth.accelerations[j] / turn);
            share.jerk = share.jerk.min(smooth.jerk / turn);
        }
        // Above this acceleration the jerk alone decides.
        share.acceleration = share.acceleration.min((share.velocity * share.jerk).sqrt());
        let share = Bounds::symmetric(share.velocity, share.acceleration, share.jerk);
        let whole = [Moving::resting(&[0.0]), Moving::resting(&[1.0])];
        let profile = time_optimal(&whole[0], &whole[1], &[share], Synchronise::None, None)?;
        Ok(profile.spread(from, to))
    }
}

/// Why a chord is not in the plan.
enum Failure {
    /// The wheels cannot follow: another way may do.
    Closed(String),
    /// Nothing will.
    Refused(Error),
}

fn infeasible(end: Twist, why: &str) -> Error {
    let rule = format!("be within reach ({why})");
    Error::value("end_twist", rule, numbers(&<[f64; 3]>::from(end))).of_kind(ErrorKind::Infeasible)
}

/// Rate and acceleration of the direction in which a pivot moves.
pub(crate) fn pivot_swing(rover: &Rover, i: usize, twist: [Vector3<f64>; 3]) -> [f64; 2] {
    let wheel = &rover.wheels()[i];
    let velocity = |twist: Vector3<f64>| {
        let u = Twist::from(twist).at(wheel.x, wheel.y);
        Complex::new(u.x, u.y)
    };
    let [u, first, second] = twist.map(velocity);
    if u.norm() == 0.0 {
        return [0.0; 2];
    }
    let [rate, acceleration, _] = swing([u, first, second, Complex::default()]);
    [rate, acceleration]
}
