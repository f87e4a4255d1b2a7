//! A rover and its limits in one precision, the constants of the kernels.

use super::limits::{DirectionGap, RoverLimits};
use super::steered_joint::SteeredJoint;
use crate::numbers::squares::Form;
use six_wheel_control::controller::limits::rest_to_rest;
use six_wheel_numerics::simd::float::Float;
use six_wheel_numerics::simd::vec3::inner_product;

pub(crate) struct Wheel<R, const M: usize> {
    pub along: [R; M],
    pub across: [R; M],
}

impl<R: Float, const M: usize> Wheel<R, M> {
    fn of(joint: &SteeredJoint) -> Self {
        Self { along: scaled(&joint.along, 1.0), across: scaled(&joint.across, 1.0) }
    }
}

/// Range of a joint, and the margin of the motion `inside` from its ends.
pub(crate) struct Range<R, const M: usize> {
    pub wheel: Wheel<R, M>,
    pub sin: R,
    pub cos: R,
    pub sense: R,
    pub per_margin: R,
}

/// A gap as its ends, their shares and one over their lengths: see [`DirectionGap`].
pub(crate) type Ends<R> = ([[R; 2]; 2], [[R; 2]; 2], [R; 2]);

/// The motion towards which impossible motions are moved where no wheel is fixed, and the ranges that decide.
pub(crate) struct ProjectionDirection<R, const M: usize> {
    pub inside: [R; M],
    pub ranges: Vec<Range<R, M>>,
}

/// A rover in one precision.
pub(crate) struct Model<R, const M: usize> {
    joints: Vec<Wheel<R, M>>,
    /// The joints with different sizes of angle: a wheel and its mirror image need the same time.
    pub(crate) turning: Vec<Wheel<R, M>>,
    /// Middle of the range of every joint [rad].
    middles: Vec<f64>,
    /// One over the tangent of a joint's largest turn in a step; None if joints turn in no time.
    pub(crate) per_turn: Option<R>,
    pub(crate) gaps: Vec<Ends<R>>,
    pub(crate) projection: Option<ProjectionDirection<R, M>>,
    pub(crate) metric: [R; 6],
    pub(crate) lengths: [R; M],
    pub(crate) scaling: Vec<[R; 6]>,
    pub(crate) lateral: Option<R>,
    pub(crate) speeding: Vec<[R; 6]>,
    /// Limits of slowing down, if they differ from those of speeding up.
    pub(crate) slowing: Option<Vec<[R; 6]>>,
    pub(crate) slips: Vec<[R; 6]>,
    pub(crate) sideways: R,
    pub(crate) rate: f64,
    pub(crate) acceleration: f64,
    pub(crate) dt: f64,
}

/// Numbers in this precision, times a factor; 0 beyond their end.
fn scaled<R: Float, const N: usize>(from: &[f64], factor: f64) -> [R; N] {
    let mut numbers = [R::default(); N];
    for (to, from) in numbers.iter_mut().zip(from) {
        *to = R::from_f64(from * factor);
    }
    numbers
}

impl<R: Float, const M: usize> Model<R, M> {
    pub fn new(bounds: &RoverLimits, dt: f64) -> Self {
        let limits = &bounds.limits;
        let forms = |forms: &[Form], factor: f64| forms.iter().map(|one| scaled(one, factor)).collect();
        let speeding: Vec<[R; 6]> = forms(&bounds.speeding, 1.0 / (dt * dt));
        let turn = limits.steering_rate * dt;
        let per_turn = (turn.is_finite() && !bounds.joints.is_empty())
            .then(|| R::from_f64(if turn < std::f64::consts::FRAC_PI_2 { 1.0 / turn.tan() } else { 0.0 }));
        let pair = |ends: [[f64; 2]; 2]| ends.map(|end| end.map(R::from_f64));
        let gap = |gap: &DirectionGap| (pair(gap.ends), pair(gap.shares), gap.per_length.map(R::from_f64));
        let projection = bounds.inside.as_ref().map(|inside| ProjectionDirection {
            inside: scaled(inside, 1.0),
            ranges: bounds
                .joints
                .iter()
                .map(|joint| {
                    let (sin, cos) = joint.half.sin_cos();
                    let along = inner_product(&joint.along, inside);
                    let margin = along.abs() * sin - inner_product(&joint.across, inside).abs() * cos;
                    Range {
                        wheel: Wheel::of(joint),
                        sin: R::from_f64(sin),
                        cos: R::from_f64(cos),
                        sense: R::from_f64(along.signum()),
                        per_margin: R::from_f64(1.0 / margin),
                    }
                })
                .collect(),
        });
        let same = bounds.speeding == bounds.slowing;
        Self {
            joints: bounds.joints.iter().map(Wheel::of).collect(),
            turning: distinct_joints(&bounds.joints).map(Wheel::of).collect(),
            middles: bounds.joints.iter().map(|joint| joint.middle).collect(),
            per_turn,
            gaps: bounds.gaps.iter().map(gap).collect(),
            projection,
            metric: scaled(&bounds.metric, 1.0),
            lengths: scaled(&bounds.lengths, 1.0),
            scaling: forms(&bounds.scaling, 1.0),
            lateral: limits.lateral_acceleration.is_finite().then(|| R::from_f64(1.0 / limits.lateral_acceleration)),
            speeding,
            slowing: (!same).then(|| forms(&bounds.slowing, 1.0 / (dt * dt))),
            slips: forms(&bounds.slips, 1.0),
            sideways: R::from_f64(bounds.sideways),
            rate: limits.steering_rate,
            acceleration: limits.steering_acceleration,
            dt,
        }
    }

    /// Time in which the joints turn from one setpoint, or from the angles `start` [rad], to another setpoint [s].
    pub fn steering_time(&self, from: [R; M], start: Option<&[f64]>, to: [R; M]) -> f64 {
        let steering_angle = |joint: &Wheel<R, M>, motion: [R; M]| {
            let part = |row: &[R; M]| row.iter().zip(motion).map(|(a, b)| a.to_f64() * b.to_f64()).sum::<f64>();
            let (along, across) = (part(&joint.along), part(&joint.across));
            (across / along).atan()
        };
        let mut worst: f64 = 0.0;
        for (k, joint) in self.joints.iter().enumerate() {
            let now = match start {
                Some(angles) => angles[k] - self.middles[k],
                None => steering_angle(joint, from),
            };
            let turn = (steering_angle(joint, to) - now).abs();
            // The wheel of a pivot at rest does not turn.
            worst = if turn > worst { turn } else { worst };
        }
        rest_to_rest(worst, self.rate, self.acceleration)
    }
}

/// The joints, without those that have the same angles as an earlier one or the mirrored ones.
fn distinct_joints(joints: &[SteeredJoint]) -> impl Iterator<Item = &SteeredJoint> {
    let alike = |a: &[f64], b: &[f64]| {
        let pairs = || a.iter().zip(b);
        pairs().all(|(a, b)| a == b) || pairs().all(|(a, b)| *a == -b)
    };
    joints.iter().enumerate().filter_map(move |(k, joint)| {
        let same = |other: &SteeredJoint| alike(&joint.along, &other.along) && alike(&joint.across, &other.across);
        (!joints[..k].iter().any(same)).then_some(joint)
    })
}
