//! The displacement over one step, from the rotations of the wheels, and its errors.

mod arc;

use nalgebra::{Matrix3, Vector3};

use super::motion::{Fusion, Motion, ROUNDING, SUSPICIOUS};
use super::settings::dimensions::Deviations;
use super::settings::noise::Noise;
use super::settings::{Readings, Rules, Settings};
use super::spread::Covariance3;
use super::uncertainty::{COLUMNS, StepNoise};
pub use arc::chord;
pub(crate) use arc::{SMALL_TURN, bend, small_bend, step_jacobian};
use six_wheel_kinematics::estimate::sensitivity::{Linearised, Quantity};
use six_wheel_kinematics::estimate::{Measured, Method, Reading, Unseen};
use six_wheel_kinematics::geometry::Twist;
use six_wheel_kinematics::rover::Rover;
use six_wheel_kinematics::rover_data::RoverData;
use six_wheel_numerics::error::{Error, HUGE, numbers};

/// Memory of a step, so that none is asked for while driving.
#[derive(Clone, Debug)]
pub(crate) struct Workspace {
    readings: Vec<Reading>,
    /// Inverse of the normal equations, where it is the same for all readings.
    inverse: Option<Matrix3<f64>>,
    middle: Vec<f64>,
    steered_by: Vec<f64>,
    pub weights: Vec<f64>,
    /// Distance each wheel's contact slid [m].
    pub slid: Vec<f64>,
    pub noise: StepNoise,
    deviations: Deviations,
    /// Deviation of the scale of a gyroscope, a share of its turns.
    scale_noise: f64,
    /// Factor of the slip variance of each wheel.
    shares: Vec<f64>,
    /// True if a wheel slid further than the noise explains.
    pub slips: bool,
    /// The displacement before a gyroscope had its say, and what that say made of it.
    by_wheels: Vector3<f64>,
    fusion: Fusion,
    /// Turns of wheels and joints along the chords of their arcs, for derivatives.
    chorded: Vec<f64>,
    chorded_by: Vec<f64>,
}

/// Number of readings whose errors two steps may share: steering angles, wheel rates and the gyroscope.
pub(crate) fn shared_readings(rover: &Rover, from_rates: bool) -> usize {
    let wheels = if from_rates { rover.wheels().len() } else { 0 };
    joint_columns(rover) + wheels + 1
}

/// Columns of the steering joints: those beyond the last joint are always zero.
fn joint_columns(rover: &RoverData) -> usize {
    rover.steered().len().next_multiple_of(COLUMNS)
}

impl Workspace {
    pub fn new(rover: &Rover, settings: &Settings) -> Self {
        let (wheels, joints) = (rover.wheels().len(), rover.steered().len());
        let from_rates = settings.readings == Readings::Speeds;
        let shared = vec![Vector3::zeros(); shared_readings(rover, from_rates)];
        let mut shares = vec![1.0; wheels];
        for (share, times) in shares.iter_mut().zip(&settings.wheel_noise) {
            *share = times * times;
        }
        Self {
            readings: vec![Reading::NONE; wheels],
            inverse: rover.solution.map(|solution| rover.unshifted_inverse(&solution)),
            middle: vec![0.0; joints],
            steered_by: vec![0.0; joints],
            weights: vec![1.0; wheels],
            slid: vec![0.0; wheels],
            noise: StepNoise {
                own: Covariance3::default(),
                ends: Covariance3::default(),
                old: shared.clone(),
                new: shared,
                lasting: vec![Vector3::zeros(); settings.lasting()],
            },
            deviations: settings.dimensions.clone(),
            scale_noise: settings.scale_noise(),
            shares,
            slips: false,
            by_wheels: Vector3::zeros(),
            fusion: Fusion::none(),
            chorded: vec![0.0; wheels],
            chorded_by: vec![0.0; joints],
        }
    }

    /// The displacement in body axes over one step: its exponential takes the start to the end.
    ///
    /// Angles are taken in the middle of the step. A pivot whose wheel turns by `d` meanwhile goes along an arc
    /// in body axes, whose chord is `sin(d/2) / (d/2)` of the way the wheel rolled.
    pub fn displacement(&mut self, rover: &Rover, motion: Motion<'_>, rules: &Rules) -> Result<Twist, Error> {
        let [before, after] = motion.steering;
        for (joint, (before, after)) in before.iter().zip(after).enumerate() {
            self.middle[joint] = f64::midpoint(*before, *after);
            self.steered_by[joint] = after - before;
        }
        let measured =
            Measured { steering: &self.middle, speeds: motion.turned, steering_rates: Some(&self.steered_by) };
        let mut read = motion.turned.iter().chain(&self.steered_by);
        if !read.all(|value| value.abs() < HUGE || value.is_nan()) {
            let rule = "be small enough for a finite pose and covariance";
            return Err(Error::value("wheel_angles", rule, numbers(motion.turned)));
        }
        rover.read(measured, &mut self.readings);
        for (steered_by, &wheel) in self.steered_by.iter().zip(rover.steered()) {
            let chord = chord(*steered_by);
            self.readings[wheel].rolled *= chord;
            self.readings[wheel].slipped *= chord;
        }
        let by_wheels = rover.estimate(&self.readings, measured, rules.method, Unseen::Refuse, &mut self.weights)?;
        let is_plain = rules.method == Method::LeastSquares;
        let solution = if is_plain {
            rover.solution_for(&self.readings, measured, Unseen::Refuse)?
        } else {
            let normal = rover.normal(&self.readings, |i| self.weights[i]);
            rover.solution(normal, Unseen::Refuse)?
        };
        let inverse = match self.inverse.filter(|_| is_plain && measured.is_complete()) {
            Some(inverse) => inverse,
            None => rover.unshifted_inverse(&solution),
        };
        let displacement = Vector3::from(by_wheels);
        for (reading, slid) in self.readings.iter().zip(&mut self.slid) {
            let along = reading.rolling.dot(&displacement) - reading.rolled;
            let across = reading.side_slip.dot(&displacement) - reading.slipped;
            *slid = (along * along + across * across).sqrt();
        }
        let linearised = Linearised {
            rover,
            readings: &self.readings,
            measured,
            solution,
            twist: displacement,
            weights: (!is_plain).then_some(self.weights.as_slice()),
        };
        self.slips = errors(&linearised, &inverse, motion, rules, [&self.slid, &self.shares], &mut self.noise);
        self.by_wheels = displacement;
        self.fusion = Fusion::none();
        Ok(match motion.gyro_turn {
            Some(turn) => self.fuse(displacement, turn, motion.dt, &rules.noise, motion.bias_variance).into(),
            None => by_wheels,
        })
    }

    /// Asks for derivatives of the displacement of the last step by the wheels alone, given its motion, and how a
    /// gyroscope shared it. Weights are held.
    pub fn derivatives(
        &mut self,
        rover: &Rover,
        motion: Motion<'_>,
        method: Method,
        ask: impl FnOnce(&Linearised<'_>, &Fusion),
    ) -> Result<(), Error> {
        self.chorded.copy_from_slice(motion.turned);
        let joints = self.steered_by.iter().zip(rover.steered());
        for ((steered_by, &wheel), chorded_by) in joints.zip(&mut self.chorded_by) {
            let chord = chord(*steered_by);
            self.chorded[wheel] *= chord;
            *chorded_by = steered_by * chord;
        }
        let measured =
            Measured { steering: &self.middle, speeds: &self.chorded, steering_rates: Some(&self.chorded_by) };
        let is_plain = method == Method::LeastSquares;
        let solution = if is_plain {
            rover.solution_for(&self.readings, measured, Unseen::Refuse)?
        } else {
            let normal = rover.normal(&self.readings, |i| self.weights[i]);
            rover.solution(normal, Unseen::Refuse)?
        };
        let linearised = Linearised {
            rover,
            readings: &self.readings,
            measured,
            solution,
            twist: self.by_wheels,
            weights: (!is_plain).then_some(self.weights.as_slice()),
        };
        ask(&linearised, &self.fusion);
        Ok(())
    }

    /// Finds the change of the displacement of the last step, given its motion, by each deviation of the dimensions and
    /// of a gyroscope's scale.
    pub fn find_lasting(&mut self, rover: &Rover, motion: Motion<'_>, method: Method) -> Result<(), Error> {
        if self.scale_noise > 0.0
            && let Some(of_scale) = self.noise.lasting.last_mut()
        {
            let turned = motion.gyro_turn.unwrap_or(0.0);
            *of_scale = self.fusion.gain * (turned * self.scale_noise);
        }
        if self.deviations.is_empty() {
            return Ok(());
        }
        let deviations = std::mem::take(&mut self.deviations);
        let mut found = std::mem::take(&mut self.noise.lasting);
        let of_dimensions = deviations.len();
        let asked = self.derivatives(rover, motion, method, |linearised, fusion| {
            deviations.of_step(linearised, fusion, motion.dt, &mut found[..of_dimensions]);
        });
        self.noise.lasting = found;
        self.deviations = deviations;
        asked
    }

    /// Gains of wheels and gyroscope in the last step.
    pub fn fusion(&self) -> &Fusion {
        &self.fusion
    }

    /// The displacement that wheels and a gyroscope agree on, each by its noise.
    fn fuse(
        &mut self,
        displacement: Vector3<f64>,
        turn: f64,
        dt: f64,
        noise: &Noise,
        bias_variance: f64,
    ) -> Vector3<f64> {
        // The reading at each end counts for half the step.
        let deviation = noise.yaw_rate * noise.sharing(dt).sqrt() * dt / 2.0;
        let total = self.noise.total();
        let by_bias = bias_variance * dt * dt;
        let spread = total.zz() + 2.0 * deviation * deviation + by_bias;
        let gain = if spread > 0.0 { total.with_z() / spread } else { Vector3::z() };
        let rest = Matrix3::identity() - gain * Vector3::z().transpose();
        self.fusion = Fusion { gain, rest };
        self.noise.multiply(&rest);
        let ends = [&mut self.noise.old, &mut self.noise.new];
        for column in ends.into_iter().filter_map(|columns| columns.last_mut()) {
            *column = gain * deviation;
            self.noise.ends.add(column, 1.0);
        }
        displacement + gain * (turn - displacement.z)
    }
}

/// Writes the errors of the displacement. Returns true if a wheel slid further than the noise explains.
fn errors(
    linearised: &Linearised<'_>,
    inverse: &Matrix3<f64>,
    motion: Motion<'_>,
    rules: &Rules,
    [slid, shares]: [&[f64]; 2],
    into: &mut StepNoise,
) -> bool {
    let (rover, noise, dt) = (linearised.rover, &rules.noise, motion.dt);
    let sharing = noise.sharing(dt);
    let reading_variance = sharing * (noise.speed * dt).powi(2);
    let steering_deviation = sharing.sqrt() * noise.steering;
    let steering_variance = steering_deviation * steering_deviation;
    let displacement = Twist::from(linearised.twist);
    let mut gradients = Covariance3::default();
    let mut slips = false;
    let (mut seen, mut explained, mut rows) = (0.0, 0.0, 0.0);
    // Of any wheel: the sides of one that reads nothing slide by the rounding of the others' fit.
    let furthest = linearised.readings.iter().fold(0.0_f64, |most, reading| most.max(reading.rolled.abs()));
    let shares_wheels = |i: usize| {
        let joints = joint_columns(rover);
        motion.from_rates.then_some(joints + i)
    };
    for (i, (wheel, reading)) in rover.wheels().iter().zip(linearised.readings).enumerate() {
        let distance =
            if noise.slip == 0.0 && noise.side_slip == 0.0 { 0.0 } else { displacement.at(wheel.x, wheel.y).norm() };
        let weight = linearised.weights.map_or(1.0, |weights| weights[i]);
        let distance = shares[i] * distance;
        let across = noise.side_slip * noise.side_slip * distance;
        let passed_on = wheel.passed_on().map_or(0.0, |share| share * share);
        let along = noise.slip * noise.slip * distance + passed_on * across;
        let (rolling, side_slip) = (reading.rolling * weight, reading.side_slip * weight);
        let own = match shares_wheels(i) {
            Some(column) => {
                let half = inverse * rolling * (reading_variance.sqrt() / 2.0);
                (into.old[column], into.new[column]) = (half, half);
                along
            }
            None => along + reading_variance,
        };
        gradients.add(&rolling, own);
        gradients.add(&side_slip, across);
        let steering =
            if wheel.steering().is_some() { steering_variance * reading.rolled * reading.rolled } else { 0.0 };
        let (has_rolling, has_side_slip) = (
            reading.rolling.x != 0.0 || reading.rolling.y != 0.0,
            reading.side_slip.x != 0.0 || reading.side_slip.y != 0.0,
        );
        let variance = if has_rolling { along + reading_variance } else { 0.0 }
            + if has_side_slip { across + steering } else { 0.0 };
        seen += weight * slid[i] * slid[i];
        explained += weight * variance;
        rows += f64::from(u8::from(has_rolling)) + f64::from(u8::from(has_side_slip));
        let bound = match rules.slip_threshold {
            Some(threshold) => threshold * dt,
            None => SUSPICIOUS * variance.sqrt() + ROUNDING * furthest,
        };
        slips |= slid[i] > bound;
    }
    if rules.inflate && rows > 3.0 {
        let excess = (seen / (rows - 3.0) - explained / rows).max(0.0);
        for (i, reading) in linearised.readings.iter().enumerate() {
            let weight = linearised.weights.map_or(1.0, |weights| weights[i]);
            let (rolling, side_slip) = (reading.rolling * weight, reading.side_slip * weight);
            gradients.add(&rolling, excess);
            gradients.add(&side_slip, excess);
        }
    }
    into.own = gradients.image(inverse);
    for (joint, &wheel) in rover.steered().iter().enumerate() {
        let by_angle = linearised.gradient(wheel, Quantity::Steering);
        let half = inverse * by_angle * (steering_deviation / 2.0);
        (into.old[joint], into.new[joint]) = (half, half);
        if !rover.wheels()[wheel].is_centred() {
            let by_change = linearised.gradient(wheel, Quantity::SteeringRate);
            let change = inverse * by_change * steering_deviation;
            into.old[joint] -= change;
            into.new[joint] += change;
        }
    }
    for columns in [&mut into.old, &mut into.new] {
        if let Some(gyro) = columns.last_mut() {
            *gyro = Vector3::zeros();
        }
    }
    into.sum_ends();
    slips
}
