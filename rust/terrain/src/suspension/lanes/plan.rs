//! Constants of a chain for lanes.

use crate::suspension::chain::{Chain, MAX_FREE, Mount, Turning};
use crate::suspension::dimensions::Differential;

/// Parts with free angles at most: one on either side for each of them.
pub(super) const MOST_PARTS: usize = 2 * MAX_FREE;

/// A part with a free angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Link {
    /// Place of the parent among the limbs: 0 is the body.
    pub parent: usize,
    pub origin: [f64; 3],
    /// See [`super::Limb`].
    pub plane: usize,
    pub joint: usize,
    /// Through a differential, of which the free angle is the left-hand side.
    pub across: Option<Differential>,
}

/// A wheel on its part.
#[derive(Clone, Debug, PartialEq)]
pub struct Wheel {
    pub limb: usize,
    /// A point of its steering axis, and its centre from there [m].
    pub pivot: [f64; 3],
    pub offset: [f64; 3],
    pub radius: f64,
    pub steering: Option<usize>,
    /// Parts that carry it, innermost first.
    pub movers: Vec<usize>,
    /// Bits of the free angles that move it.
    moved: u32,
}

/// Origin of a steered part in its parent [m], and its joint.
type Knuckle = ([f64; 3], usize);

/// Constants of a chain for lanes.
#[derive(Clone, Debug, PartialEq)]
pub struct ChainConstants {
    /// Links of the chain.
    pub parts: Vec<Link>,
    /// Wheels of the chain.
    pub wheels: Vec<Wheel>,
    joints: usize,
    /// The free angles, those first that move few wheels.
    order: Vec<usize>,
    /// Bits of the steering joints whose wheels have their centres about the axis.
    centred: u32,
}

impl ChainConstants {
    /// None for chains that are not for lanes.
    pub fn new(chain: &Chain) -> Option<Self> {
        let mut plan = Self {
            parts: Vec::new(),
            wheels: Vec::new(),
            joints: chain.joints().len(),
            order: (0..chain.joints().len()).collect(),
            centred: 0,
        };
        let frames = plan.add_links(chain)?;
        for wheel in chain.wheels() {
            let (limb, knuckle) = wheel.part.map_or((0, None), |k| frames[k]);
            plan.add_wheel(wheel, limb, knuckle);
        }
        let moves = |joint: usize| move |wheel: &&Wheel| wheel.moved >> joint & 1 == 1;
        let wheels = &plan.wheels;
        plan.order.sort_by_key(|joint| wheels.iter().filter(moves(*joint)).count());
        for joint in 0..chain.steering().len() {
            let own = wheels.iter().filter(|wheel| wheel.steering == Some(joint));
            let [ahead, left] =
                own.fold([0.0; 2], |[ahead, left], wheel| [ahead + wheel.offset[0], left + wheel.offset[1]]);
            plan.centred |= u32::from(ahead == 0.0 && left == 0.0) << joint;
        }
        Some(plan)
    }

    /// Adds the links with free angles. Returns the frame that every part is, or for one that steers that of its parent, with
    /// its origin there.
    fn add_links(&mut self, chain: &Chain) -> Option<Vec<(usize, Option<Knuckle>)>> {
        let mut frames: Vec<(usize, Option<Knuckle>)> = Vec::new();
        for part in chain.parts() {
            let (parent, knuckle) = part.parent.map_or((0, None), |k| frames[k]);
            let unit = |axis: &usize| (0..3).all(|k| part.axis[k] == f64::from(k == *axis));
            let axis = (0..3).find(unit)?;
            let plane = 1_usize.wrapping_sub(axis);
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
            let carrier = parent.checked_sub(1).map(|k: usize| self.parts[k].plane);
            if plane > 1 || carrier.is_some_and(|its| its != plane) {
                return None;
            }
            self.parts.push(Link { parent, origin, plane, joint, across });
            frames.push((self.parts.len(), None));
        }
        (self.parts.len() <= MOST_PARTS).then_some(frames)
    }

    /// Adds a wheel.
    fn add_wheel(&mut self, wheel: &Mount, limb: usize, knuckle: Option<Knuckle>) {
        let (pivot, offset, steering) = match knuckle {
            Some((pivot, joint)) => (pivot, wheel.centre.into(), Some(joint)),
            None => (wheel.centre.into(), [0.0; 3], None),
        };
        let parents = |&limb: &usize| Some(self.parts[limb - 1].parent).filter(|&k| k > 0);
        let carriers = std::iter::successors(Some(limb).filter(|&k| k > 0), parents);
        let movers: Vec<usize> = carriers.map(|limb| limb - 1).collect();
        let moved = movers.iter().fold(0, |bits, part| bits | 1 << self.parts[*part].joint);
        self.wheels.push(Wheel { limb, pivot, offset, radius: wheel.radius, steering, moved, movers });
    }

    /// Number of wheels.
    #[inline]
    pub fn wheels(&self) -> usize {
        self.wheels.len()
    }

    /// Number of joints.
    #[inline]
    pub fn joints(&self) -> usize {
        self.joints
    }

    /// Radius of a wheel [m].
    #[inline]
    pub fn radius(&self, wheel: usize) -> f64 {
        self.wheels[wheel].radius
    }

    /// Steering joint of a wheel.
    #[inline]
    pub fn steering(&self, wheel: usize) -> Option<usize> {
        self.wheels[wheel].steering
    }

    /// Bits of the free angles that move a wheel.
    #[inline]
    pub fn moved(&self, wheel: usize) -> u32 {
        self.wheels[wheel].moved
    }

    /// The free angles, those first that move few wheels.
    #[inline]
    pub fn order(&self) -> &[usize] {
        &self.order
    }

    /// Vertical velocity of a wheel over level ground, all angles 0, per free angle in their order, then per the body's
    /// vz, wx and wy.
    #[inline]
    pub fn rise(&self, wheel: usize) -> [f64; MAX_FREE + 3] {
        let Wheel { pivot, offset, .. } = &self.wheels[wheel];
        let movers = &self.wheels[wheel].movers;
        let mut rise = [0.0; MAX_FREE + 3];
        let mut point: [f64; 3] = std::array::from_fn(|k| pivot[k] + offset[k]);
        for part in movers.iter().map(|&part| &self.parts[part]) {
            let place = self.order.iter().position(|&joint| joint == part.joint);
            let side = if part.across.is_some() { -1.0 } else { 1.0 };
            rise[place.unwrap_or(0)] += side * [-point[0], point[1]][part.plane];
            for (to, from) in point.iter_mut().zip(part.origin) {
                *to += from;
            }
        }
        rise[self.joints..][..3].copy_from_slice(&[1.0, point[1], -point[0]]);
        rise
    }

    /// Bits of those rates that move a wheel, in the same order.
    #[inline]
    pub fn parts_in(&self, wheel: usize) -> u32 {
        let mut bits = 0b111 << self.joints;
        for (k, joint) in self.order.iter().enumerate() {
            bits |= (self.wheels[wheel].moved >> joint & 1) << k;
        }
        bits
    }

    /// The centre of a wheel from its steering axis, ahead and to the left where that is straight [m].
    #[inline]
    pub fn offset(&self, wheel: usize) -> [f64; 2] {
        let [ahead, left, _] = self.wheels[wheel].offset;
        [ahead, left]
    }

    /// True if the centres of a joint's wheels lie about its axis: then their mean moves as the axis does.
    #[inline]
    pub fn is_centred(&self, joint: usize) -> bool {
        self.centred >> joint & 1 == 1
    }
}
