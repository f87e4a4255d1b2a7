//! A chain in lanes, a rover in each: where its wheels are in the body, and what its free angles do to them.
//!
//! What [`Chain::place`] does for one rover, in the axes of its body, for chains whose parts turn about the axes of
//! their parents and whose steered wheels are mounted on what steers them: every vehicle that has a name here.
//! Wheels are placed straight ahead, and steered afterwards.

use pulp::Simd;

use super::chain::{Chain, MAX_FREE, MAX_WHEELS, Turning};
use super::dimensions::Differential;
use crate::batch::machine::lanes::Lanes;
use crate::batch::machine::polynomials::direction;
use crate::batch::machine::vector::Vector;

/// A vector in every lane.
pub(crate) type Vectors<S> = [Lanes<S>; 3];

/// Sine and cosine.
pub(crate) type Turned<S> = (Lanes<S>, Lanes<S>);

/// Lanes of the widest level.
pub(crate) const MOST: usize = 8;

/// A number of as many rovers as there are lanes at most.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub(crate) struct Column(pub [f64; MOST]);

impl Column {
    pub const ZERO: Self = Self([0.0; MOST]);

    #[inline(always)]
    pub fn load<S: Simd>(&self, simd: S) -> Lanes<S> {
        Lanes::load(simd, S::as_simd_f64s(&self.0[..S::F64_LANES]).0, 0)
    }

    #[inline(always)]
    pub fn of<S: Simd>(lanes: Lanes<S>) -> Self {
        let mut column = Self::ZERO;
        lanes.store(S::as_mut_simd_f64s(&mut column.0[..S::F64_LANES]).0, 0);
        column
    }
}

/// Parts with free angles at most: one on either side for each of them.
const MOST_PARTS: usize = 2 * MAX_FREE;

/// Angles [rad] beyond which a lane is left to the plain way: a joint that has turned a hundred times.
pub(crate) const LARGEST_TURN: f64 = 600.0;

/// A part with a free angle that turns about an axis of its parent.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Part {
    /// Place of the parent among the frames: 0 is the body.
    parent: usize,
    origin: [f64; 3],
    axis: usize,
    joint: usize,
    /// Through a differential, of which the free angle is the left-hand side.
    across: Option<Differential>,
}

/// A wheel on its part.
#[derive(Clone, Debug, PartialEq)]
struct Wheel {
    frame: usize,
    /// Where it is steered about, and its centre from there [m].
    pivot: [f64; 3],
    offset: [f64; 3],
    radius: f64,
    steering: Option<usize>,
    /// Parts that carry it, innermost first.
    movers: Vec<usize>,
    /// Bits of the free angles that move it.
    moved: u32,
}

/// Where a part that steers is in its parent, and its joint.
type Knuckle = ([f64; 3], usize);

/// What lanes need to know of a chain.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Plan {
    parts: Vec<Part>,
    wheels: Vec<Wheel>,
    joints: usize,
    /// The free angles, those first that move few wheels.
    order: Vec<usize>,
    /// Bits of the steering joints whose wheels have their centres about the axis.
    centred: u32,
}

impl Plan {
    /// None for chains that are not for lanes.
    pub fn new(chain: &Chain) -> Option<Self> {
        let mut plan = Self {
            parts: Vec::new(),
            wheels: Vec::new(),
            joints: chain.joints().len(),
            order: (0..chain.joints().len()).collect(),
            centred: 0,
        };
        // The frame that a part is, or for one that steers that of its parent, with its origin there.
        let mut frames: Vec<(usize, Option<Knuckle>)> = Vec::new();
        for part in chain.parts() {
            let (parent, knuckle) = part.parent.map_or((0, None), |k| frames[k]);
            let unit = |axis: &usize| (0..3).all(|k| part.axis[k] == f64::from(k == *axis));
            let axis = (0..3).find(unit)?;
            let origin = part.origin.into();
            let (joint, across) = match part.turning {
                // Nothing hangs on what steers but wheels.
                _ if knuckle.is_some() => return None,
                Turning::Steering(joint) if axis == 2 => {
                    frames.push((parent, Some((origin, joint))));
                    continue;
                }
                Turning::Steering(_) => return None,
                Turning::Free(joint) => (joint, None),
                Turning::Across(joint, differential) => (joint, Some(differential)),
            };
            plan.parts.push(Part {
                parent,
                origin,
                axis,
                joint,
                across,
            });
            frames.push((plan.parts.len(), None));
        }
        if plan.parts.len() > MOST_PARTS {
            return None;
        }
        for wheel in chain.wheels() {
            let (frame, knuckle) = wheel.part.map_or((0, None), |k| frames[k]);
            let (pivot, offset, steering) = match knuckle {
                Some((pivot, joint)) => (pivot, wheel.centre.into(), Some(joint)),
                None => (wheel.centre.into(), [0.0; 3], None),
            };
            let parents = |&frame: &usize| Some(plan.parts[frame - 1].parent).filter(|&k| k > 0);
            let carriers = std::iter::successors(Some(frame).filter(|&k| k > 0), parents);
            let movers: Vec<usize> = carriers.map(|frame| frame - 1).collect();
            let bit = |part: &usize| 1 << plan.parts[*part].joint;
            plan.wheels.push(Wheel {
                frame,
                pivot,
                offset,
                radius: wheel.radius,
                steering,
                moved: movers.iter().map(bit).fold(0, std::ops::BitOr::bitor),
                movers,
            });
        }
        let moves = |joint: usize| move |wheel: &&Wheel| wheel.moved >> joint & 1 == 1;
        let wheels = &plan.wheels;
        plan.order
            .sort_by_key(|joint| wheels.iter().filter(moves(*joint)).count());
        for joint in 0..chain.steering().len() {
            let own = wheels.iter().filter(|wheel| wheel.steering == Some(joint));
            let [ahead, left] = own.fold([0.0; 2], |[ahead, left], wheel| {
                [ahead + wheel.offset[0], left + wheel.offset[1]]
            });
            plan.centred |= u32::from(ahead == 0.0 && left == 0.0) << joint;
        }
        Some(plan)
    }

    pub fn wheels(&self) -> usize {
        self.wheels.len()
    }

    pub fn joints(&self) -> usize {
        self.joints
    }

    pub fn radius(&self, wheel: usize) -> f64 {
        self.wheels[wheel].radius
    }

    pub fn steering(&self, wheel: usize) -> Option<usize> {
        self.wheels[wheel].steering
    }

    /// Bits of the free angles that move a wheel.
    pub fn moved(&self, wheel: usize) -> u32 {
        self.wheels[wheel].moved
    }

    /// The free angles, those first that move few wheels.
    pub fn order(&self) -> &[usize] {
        &self.order
    }

    /// The centre of a wheel from its steering axis, ahead and to the left where that is straight [m].
    pub fn offset(&self, wheel: usize) -> [f64; 2] {
        let [ahead, left, _] = self.wheels[wheel].offset;
        [ahead, left]
    }

    /// Whether the centres of a joint's wheels lie about its axis: then they go on average where the axis does.
    pub fn is_centred(&self, joint: usize) -> bool {
        self.centred >> joint & 1 == 1
    }
}

#[inline(always)]
pub(crate) fn all<S: Simd>(simd: S, value: f64) -> Lanes<S> {
    Lanes::splat(simd, value)
}

#[inline(always)]
pub(crate) fn dot<S: Simd>(a: Vectors<S>, b: Vectors<S>) -> Lanes<S> {
    a[2].mul_add(b[2], a[1].mul_add(b[1], a[0] * b[0]))
}

#[inline(always)]
pub(crate) fn cross<S: Simd>(a: Vectors<S>, b: Vectors<S>) -> Vectors<S> {
    [
        a[1].mul_add(b[2], -(a[2] * b[1])),
        a[2].mul_add(b[0], -(a[0] * b[2])),
        a[0].mul_add(b[1], -(a[1] * b[0])),
    ]
}

#[inline(always)]
pub(crate) fn less<S: Simd>(a: Vectors<S>, b: Vectors<S>) -> Vectors<S> {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// `a + length * b`.
#[inline(always)]
pub(crate) fn along<S: Simd>(a: Vectors<S>, length: Lanes<S>, b: Vectors<S>) -> Vectors<S> {
    [
        b[0].mul_add(length, a[0]),
        b[1].mul_add(length, a[1]),
        b[2].mul_add(length, a[2]),
    ]
}

#[inline(always)]
pub(crate) fn scaled<S: Simd>(a: Vectors<S>, by: Lanes<S>) -> Vectors<S> {
    [a[0] * by, a[1] * by, a[2] * by]
}

#[inline(always)]
pub(crate) fn sum<S: Simd>(a: Vectors<S>, b: Vectors<S>) -> Vectors<S> {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

/// `c a + s b`, and a quarter turn on.
#[inline(always)]
pub(crate) fn rotated<S: Simd>((s, c): Turned<S>, a: Vectors<S>, b: Vectors<S>) -> [Vectors<S>; 2] {
    let mut turned = [a, b];
    for k in 0..3 {
        turned[0][k] = a[k].mul_add(c, b[k] * s);
        turned[1][k] = b[k].mul_add(c, -(a[k] * s));
    }
    turned
}

/// Columns of a rotation, and a point that it carries [m].
#[derive(Clone, Copy)]
struct Frame<S: Simd> {
    columns: [Vectors<S>; 3],
    origin: Vectors<S>,
}

impl<S: Simd> Frame<S> {
    #[inline(always)]
    fn point(&self, simd: S, local: [f64; 3]) -> Vectors<S> {
        let mut point = self.origin;
        for (column, length) in self.columns.into_iter().zip(local) {
            point = along(point, all(simd, length), column);
        }
        point
    }
}

/// A wheel in lanes: see [`super::WheelFrame`].
#[derive(Clone, Copy)]
pub(crate) struct WheelAt<S: Simd> {
    pub centre: Vectors<S>,
    pub forward: Vectors<S>,
    pub axle: Vectors<S>,
    pub up: Vectors<S>,
}

/// A part's axis times the derivative of its angle by the free one, and a point of it.
#[derive(Clone, Copy)]
pub(crate) struct Axis<S: Simd> {
    pub joint: usize,
    pub axis: Vectors<S>,
    pub origin: Vectors<S>,
}

/// The chain in lanes, in the axes of the body.
pub(crate) struct Placing<'a, S: Simd> {
    plan: &'a Plan,
    /// Of the body, and of every part.
    frames: [Frame<S>; MOST_PARTS + 1],
    axes: [Axis<S>; MOST_PARTS],
    /// The wheels, straight ahead until somebody steers them.
    pub wheels: [WheelAt<S>; MAX_WHEELS],
    /// Where the wheels are steered about.
    pivots: [Vectors<S>; MAX_WHEELS],
    /// Of the body and every part, the velocity that a point at the body's origin would have with it [m/s], and how it turns
    /// [rad/s].
    flow: [[Vectors<S>; 2]; MOST_PARTS + 1],
}

/// Sine and cosine of the angle of a part's own, and its derivative by the free angle; NaN where a differential does
/// not reach.
#[inline(always)]
fn across<S: Vector>(
    simd: S,
    differential: Differential,
    left: Lanes<S>,
    turned: Turned<S>,
) -> (Turned<S>, Lanes<S>) {
    if differential == Differential::Gear {
        return ((-turned.0, turned.1), all(simd, -1.0));
    }
    let mut columns = [Column::of(left); 3];
    for lane in 0..S::F64_LANES {
        let reached = differential.right(columns[0].0[lane]);
        let [angle, slope] = reached.unwrap_or([f64::NAN; 2]);
        let (sin, cos) = angle.sin_cos();
        for (column, value) in columns.iter_mut().zip([sin, cos, slope]) {
            column.0[lane] = value;
        }
    }
    let turned = (columns[0].load(simd), columns[1].load(simd));
    (turned, columns[2].load(simd))
}

impl<'a, S: Vector> Placing<'a, S> {
    /// Room for a chain, which is nowhere yet.
    #[inline(always)]
    pub fn new(simd: S, plan: &'a Plan) -> Self {
        let (zero, one) = (all(simd, 0.0), all(simd, 1.0));
        let body = Frame {
            columns: [[one, zero, zero], [zero, one, zero], [zero, zero, one]],
            origin: [zero; 3],
        };
        let nowhere = WheelAt {
            centre: [zero; 3],
            forward: [zero; 3],
            axle: [zero; 3],
            up: [zero; 3],
        };
        Self {
            plan,
            frames: [body; MOST_PARTS + 1],
            axes: [Axis {
                joint: 0,
                axis: [zero; 3],
                origin: [zero; 3],
            }; MOST_PARTS],
            wheels: [nowhere; MAX_WHEELS],
            pivots: [[zero; 3]; MAX_WHEELS],
            flow: [[[zero; 3]; 2]; MOST_PARTS + 1],
        }
    }

    /// Places it at these free angles, of [`LARGEST_TURN`] at most.
    #[inline(always)]
    pub fn place(&mut self, simd: S, joints: &[Lanes<S>; MAX_FREE]) {
        let (zero, one) = (all(simd, 0.0), all(simd, 1.0));
        let mut free = [(zero, one); MAX_FREE];
        for (turned, angle) in free.iter_mut().zip(joints).take(self.plan.joints) {
            *turned = direction(simd, *angle);
        }
        for (k, part) in self.plan.parts.iter().enumerate().take(MOST_PARTS) {
            let parent = &self.frames[part.parent];
            let joint = part.joint % MAX_FREE;
            let (turned, slope) = match part.across {
                None => (free[joint], one),
                Some(by) => across(simd, by, joints[joint], free[joint]),
            };
            let (first, second) = ((part.axis + 1) % 3, (part.axis + 2) % 3);
            let [a, b] = rotated(turned, parent.columns[first], parent.columns[second]);
            let axis = parent.columns[part.axis];
            let origin = parent.point(simd, part.origin);
            let frame = &mut self.frames[k + 1];
            frame.columns[first] = a;
            frame.columns[second] = b;
            frame.columns[part.axis] = axis;
            frame.origin = origin;
            self.axes[k] = Axis {
                joint,
                axis: scaled(axis, slope),
                origin,
            };
        }
        for (k, wheel) in self.plan.wheels.iter().enumerate().take(MAX_WHEELS) {
            let frame = &self.frames[wheel.frame];
            let pivot = frame.point(simd, wheel.pivot);
            let [forward, axle, up] = frame.columns;
            let mut centre = pivot;
            if wheel.offset != [0.0; 3] {
                for (column, length) in frame.columns.into_iter().zip(wheel.offset) {
                    centre = along(centre, all(simd, length), column);
                }
            }
            self.pivots[k] = pivot;
            self.wheels[k] = WheelAt {
                centre,
                forward,
                axle,
                up,
            };
        }
    }

    /// A wheel turned about its steering axis.
    #[inline(always)]
    pub fn steered(&self, simd: S, wheel: usize, turned: Turned<S>) -> WheelAt<S> {
        let mut at = self.wheels[wheel];
        [at.forward, at.axle] = rotated(turned, at.forward, at.axle);
        let offset = self.plan.wheels[wheel].offset;
        if offset != [0.0; 3] {
            at.centre = self.pivots[wheel];
            for (column, length) in [at.forward, at.axle, at.up].into_iter().zip(offset) {
                at.centre = along(at.centre, all(simd, length), column);
            }
        }
        at
    }

    /// Where a wheel is steered about.
    pub fn pivot(&self, wheel: usize) -> Vectors<S> {
        self.pivots[wheel]
    }

    /// The axes of the free angles that move a wheel.
    #[inline(always)]
    pub fn axes(&self, wheel: usize) -> impl Iterator<Item = &Axis<S>> {
        let movers = &self.plan.wheels[wheel].movers;
        movers.iter().map(|&part| &self.axes[part])
    }

    /// Moves the parts at these rates of the body and the free angles.
    #[inline(always)]
    pub fn moves(&mut self, body: [Vectors<S>; 2], rates: &[Lanes<S>; MAX_FREE]) {
        self.flow[0] = body;
        for (k, part) in self.plan.parts.iter().enumerate().take(MOST_PARTS) {
            let Axis { axis, origin, .. } = self.axes[k];
            let turning = scaled(axis, rates[part.joint % MAX_FREE]);
            let [velocity, turn] = self.flow[part.parent];
            self.flow[k + 1] = [less(velocity, cross(turning, origin)), sum(turn, turning)];
        }
    }

    /// The velocity of a point of a wheel's carrier as the parts move [m/s], and how the carrier turns [rad/s]: see
    /// `moving::contact::carried`.
    #[inline(always)]
    pub fn carried(&self, wheel: usize, point: Vectors<S>) -> [Vectors<S>; 2] {
        let [velocity, turn] = self.flow[self.plan.wheels[wheel].frame];
        [sum(velocity, cross(turn, point)), turn]
    }
}
