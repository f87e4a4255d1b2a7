//! Least squares of the wheels in a step whose equations are no constants of the rover: wheels with scrub, trail or without
//! a reading, weights by the residuals, readings of rates, and derivatives by the dimensions.

use nalgebra::{Matrix3, Vector3};

use super::constants::{StepConstants, set};
use crate::motion::Motion;
use crate::settings::Settings;
use crate::settings::dimensions::Deviations;
use crate::uncertainty::COLUMNS;
use six_wheel_kinematics::estimate::sensitivity::{LinearisedFit, Quantity};
use six_wheel_kinematics::estimate::{Measured, Method, Reading, Unseen};
use six_wheel_kinematics::geometry::sinc;
use six_wheel_kinematics::kernels::wheel_lanes::GROUP;
use six_wheel_kinematics::rover::Rover;
use six_wheel_kinematics::rover_data::RoverData;
use six_wheel_numerics::error::Error;

/// Number of readings whose errors two steps share: steering angles, wheel rates and, last, the gyroscope. Those of
/// joints and of wheels are padded to whole registers.
pub(crate) fn shared_readings(rover: &Rover, from_rates: bool) -> usize {
    let wheels = if from_rates { rover.wheels().len().next_multiple_of(COLUMNS) } else { 0 };
    joint_columns(rover) + wheels + 1
}

/// Number of columns of the steering joints; those beyond the last joint are zero.
fn joint_columns(rover: &RoverData) -> usize {
    rover.steered().len().next_multiple_of(COLUMNS)
}

/// The fit of one step, and its memory.
#[derive(Clone, Debug)]
pub(crate) struct WheelFit {
    /// Rows of the wheels with the distances along chords.
    readings: Vec<Reading>,
    /// Steering angles in the middle of the step, and their increments [rad].
    middle: Vec<f64>,
    increments: Vec<f64>,
    /// Rotations of wheels, and increments of joints, along the chords of their arcs [rad].
    chord_turned: Vec<f64>,
    chord_increments: Vec<f64>,
    /// Weight of every wheel, 0 to 1.
    pub weights: Vec<f64>,
    /// Inverse of the normal equations about the centre of the pivots.
    solution: Matrix3<f64>,
    /// Displacement by the wheels [m, m, rad].
    pub displacement: Vector3<f64>,
    /// Per shared reading: error of the displacement by its deviation at the start of the step, and at the end.
    pub old: Vec<[f64; 3]>,
    pub new: Vec<[f64; 3]>,
    deviations: Deviations,
    /// Error of the displacement by each error that is constant over the run; 0 for a gyroscope's scale.
    pub constant_errors: Vec<[f64; 3]>,
}

impl WheelFit {
    pub fn new(rover: &Rover, settings: &Settings, shared: usize) -> Self {
        let (wheels, joints) = (rover.wheels().len(), rover.steered().len());
        Self {
            readings: vec![Reading::NONE; wheels],
            middle: vec![0.0; joints],
            increments: vec![0.0; joints],
            chord_turned: vec![0.0; wheels],
            chord_increments: vec![0.0; joints],
            weights: vec![1.0; wheels],
            solution: Matrix3::zeros(),
            displacement: Vector3::zeros(),
            old: vec![[0.0; 3]; shared],
            new: vec![[0.0; 3]; shared],
            deviations: settings.dimensions.clone(),
            constant_errors: vec![[0.0; 3]; settings.constant_error_count()],
        }
    }

    /// Fits the displacement, and writes the rows of the wheels to the memory of the kernels.
    pub fn solve(
        &mut self,
        rover: &Rover,
        settings: &Settings,
        motion: Motion<'_>,
        constants: &mut StepConstants,
    ) -> Result<(), Error> {
        self.read(rover, motion);
        let measured =
            Measured { steering: &self.middle, speeds: motion.turned, steering_rates: Some(&self.increments) };
        let method = settings.method;
        let twist = rover.estimate(&self.readings, measured, method, Unseen::Refuse, &mut self.weights, &mut [])?;
        self.displacement = twist.into();
        self.solution = if method == Method::LeastSquares {
            rover.solution_for(&self.readings, measured, Unseen::Refuse)?
        } else {
            rover.solution(rover.normal(&self.readings, |i| self.weights[i]), Unseen::Refuse)?
        };
        let inverse = rover.inverse_at_origin(&self.solution);
        self.write_rows(&inverse, constants);
        self.find_columns(rover, settings, motion, &inverse);
        if !self.deviations.is_empty() {
            let mut errors = std::mem::take(&mut self.constant_errors);
            self.deviations.displacement_errors(&self.linearised(rover, method), &mut errors);
            self.constant_errors = errors;
        }
        Ok(())
    }

    /// Reads the rows of the wheels in the middle of the step. The pivot of a wheel that steers by d in the step moves
    /// along an arc in body axes, whose chord is `sin(d/2) / (d/2)` times the distance that the wheel rolled.
    fn read(&mut self, rover: &Rover, motion: Motion<'_>) {
        let [before, after] = motion.steering;
        for (joint, (before, after)) in before.iter().zip(after).enumerate() {
            self.middle[joint] = f64::midpoint(*before, *after);
            self.increments[joint] = after - before;
        }
        let measured =
            Measured { steering: &self.middle, speeds: motion.turned, steering_rates: Some(&self.increments) };
        rover.read(measured, &mut self.readings);
        self.chord_turned.copy_from_slice(motion.turned);
        for (joint, &wheel) in rover.steered().iter().enumerate() {
            let chord = sinc(self.increments[joint] / 2.0);
            self.readings[wheel].rolled *= chord;
            self.readings[wheel].slipped *= chord;
            self.chord_turned[wheel] *= chord;
            self.chord_increments[joint] = self.increments[joint] * chord;
        }
    }

    /// The linearised fit, for derivatives at constant weights.
    pub fn linearised<'a>(&'a self, rover: &'a Rover, method: Method) -> LinearisedFit<'a> {
        LinearisedFit {
            rover,
            readings: &self.readings,
            measured: Measured {
                steering: &self.middle,
                speeds: &self.chord_turned,
                steering_rates: Some(&self.chord_increments),
            },
            solution: self.solution,
            twist: self.displacement,
            weights: (method != Method::LeastSquares).then_some(self.weights.as_slice()),
        }
    }

    fn write_rows(&self, inverse: &Matrix3<f64>, constants: &mut StepConstants) {
        let memory = constants.groups.iter().zip(&mut constants.fitted).zip(&mut constants.scratch);
        for ((group, rows), scratch) in memory {
            for (lane, &i) in group.wheels.iter().enumerate().take(group.count.min(GROUP)) {
                let (reading, weight) = (&self.readings[i], self.weights[i]);
                for (which, row) in [&reading.rolling, &reading.side_slip].into_iter().enumerate() {
                    rows.set(which, lane, row);
                    set(&mut scratch.shares[which], lane, &(inverse * row * weight));
                }
                scratch.rolled[lane] = reading.rolled;
                (scratch.measured[0][lane], scratch.measured[1][lane]) = (reading.rolled, reading.slipped);
            }
        }
    }

    /// Computes the errors of the displacement by readings that two steps share. A reading at one end counts for half
    /// the step.
    fn find_columns(&mut self, rover: &Rover, settings: &Settings, motion: Motion<'_>, inverse: &Matrix3<f64>) {
        let (noise, dt) = (&settings.noise, motion.dt);
        let sharing = noise.sharing(dt).sqrt();
        let steering_deviation = sharing * noise.steering;
        for (joint, &wheel) in rover.steered().iter().enumerate() {
            let linearised = self.linearised(rover, settings.method);
            let half = inverse * linearised.gradient(wheel, Quantity::Steering) * (steering_deviation / 2.0);
            let change = match rover.wheels()[wheel].is_centred() {
                true => Vector3::zeros(),
                false => inverse * linearised.gradient(wheel, Quantity::SteeringRate) * steering_deviation,
            };
            (self.old[joint], self.new[joint]) = ((half - change).into(), (half + change).into());
        }
        // Without rates as readings, their columns are 0.
        let half_deviation = if motion.from_rates { sharing * noise.speed * dt / 2.0 } else { 0.0 };
        let rates = joint_columns(rover)..self.old.len() - 1;
        let columns = self.old[rates.clone()].iter_mut().zip(&mut self.new[rates]);
        for ((reading, weight), (old, new)) in self.readings.iter().zip(&self.weights).zip(columns) {
            let half = inverse * reading.rolling * (weight * half_deviation);
            (*old, *new) = (half.into(), half.into());
        }
    }
}
