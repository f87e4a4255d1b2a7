//! The constants of a rover for the inverse kinematics.

use crate::kernels::safe_range::has_safe_lengths;
use crate::kernels::steered::constants::{Features, SteeredConstants, SteeredWheel};
use crate::kernels::wheel_lanes::{Eight, GROUP, level, order};
use crate::rover_data::{Mount, RoverData};
use crate::steering::SteeringRange;
use crate::wheels::{REST, Wheel};
use pulp::Simd;
use six_wheel_numerics::simd::lanes::Lanes;
use six_wheel_numerics::simd::level::Level;

/// Constants of one wheel, by its kind.
#[derive(Clone, Copy, Debug)]
pub enum WheelKind {
    /// Rolling row of a fixed wheel.
    Fixed([f64; 3]),
    /// A castor.
    Castor(SteeredConstants),
    /// A steered wheel.
    Steered(SteeredConstants),
}

/// Constants of a rover for the inverse kernels.
#[derive(Clone, Debug)]
pub struct InverseConstants {
    /// Every wheel with one over its radius.
    pub wheels: Vec<(WheelKind, f64)>,
    /// Number of steering joints.
    pub joints: usize,
    /// Level at which one row is solved.
    pub(crate) level: Level,
    /// Twice the bound of the rounding error of pivot velocities: factors of `|vx| + |vy|` [1] and of `|omega|` [m];
    /// infinite if lengths are so extreme that squares may overflow or lose digits.
    pub(crate) rounding: [f64; 2],
    /// The wheels in the lanes of registers, eight per group.
    pub(crate) groups: Vec<WheelGroup>,
    /// Index of the wheel of every lane.
    pub(crate) order: Vec<usize>,
}

impl InverseConstants {
    /// The constants of a rover.
    pub fn new(rover: &RoverData) -> Self {
        let kind = |(wheel, mount): (&Wheel, &Mount)| {
            let kind = match (*mount, SteeredConstants::new(wheel, *mount)) {
                (Mount::Castor(_), Some(castor)) => WheelKind::Castor(castor),
                (_, Some(steered)) => WheelKind::Steered(steered),
                (Mount::Fixed(rows), None) => WheelKind::Fixed(rows.rolling.into()),
                (_, None) => WheelKind::Fixed([0.0; 3]), // the other kinds have constants
            };
            (kind, 1.0 / wheel.radius)
        };
        let wheels: Vec<_> = rover.wheels().iter().zip(&rover.mounts).map(kind).collect();
        let arm = |wheel: &Wheel| wheel.x.abs() + wheel.y.abs();
        let longest = rover.wheels().iter().map(arm).fold(0.0, f64::max);
        let share = if rover.wheels().iter().all(has_safe_lengths) { 2.0 * REST } else { f64::INFINITY };
        let order = order(rover);
        let groups = order.chunks(GROUP).map(|wheels_of| WheelGroup::new(&wheels, wheels_of)).collect();
        Self {
            joints: rover.steered().len(),
            level: level(),
            rounding: [share, share * longest.max(f64::MIN_POSITIVE)],
            groups,
            order,
            wheels,
        }
    }
}

/// Eight wheels, one in each lane.
///
/// There are no branches on the kind of wheel: every lane takes the operations of all kinds, with neutral numbers for
/// those of the other kinds. A lane that is not steered has its pivot at 0 and a range of a whole turn; its speed is
/// its constant row times the twist. A steered lane has a row of zeros. A lane without a wheel has both, and its
/// results are not copied out.
#[derive(Clone, Debug, Default)]
pub(crate) struct WheelGroup {
    /// Number of steered wheels among them.
    pub steered: usize,
    /// 1 for a steered wheel, 0 for another.
    pub is_steered: Eight,
    pivot: [Eight; 2],
    heading: [Eight; 2],
    range: [Eight; 2],
    single_range: [Eight; 2],
    near_range: [Eight; 2],
    scrub: Eight,
    trail: Eight,
    features: Features,
    /// The rolling row of a wheel that is not steered.
    pub row: [Eight; 3],
    /// One over the radii.
    pub per_radius: Eight,
    /// Castors, by lane.
    pub castors: Vec<(usize, SteeredConstants)>,
}

impl WheelGroup {
    fn new(wheels: &[(WheelKind, f64)], lanes: &[usize]) -> Self {
        let mut group = Self::default();
        group.heading[1] = [1.0; GROUP];
        let SteeringRange { lower, upper } = SteeringRange::WHOLE_TURN;
        for range in [&mut group.range, &mut group.single_range, &mut group.near_range] {
            *range = [[lower; GROUP], [upper; GROUP]];
        }
        for (lane, &i) in lanes.iter().enumerate() {
            let (kind, per_radius) = wheels[i];
            group.per_radius[lane] = per_radius;
            match kind {
                WheelKind::Castor(castor) => group.castors.push((lane, castor)),
                WheelKind::Fixed(row) => {
                    for (place, number) in group.row.iter_mut().zip(row) {
                        place[lane] = number;
                    }
                }
                WheelKind::Steered(wheel) => group.fill(lane, &wheel),
            }
        }
        group
    }

    /// Writes the constants of a steered wheel to a lane.
    fn fill(&mut self, lane: usize, wheel: &SteeredConstants) {
        self.steered += 1;
        self.is_steered[lane] = 1.0;
        let pairs = [
            (&mut self.pivot, [wheel.x, wheel.y]),
            (&mut self.heading, [wheel.heading.sin, wheel.heading.cos]),
            (&mut self.range, [wheel.range.lower, wheel.range.upper]),
            (&mut self.single_range, wheel.single_range()),
            (&mut self.near_range, wheel.near_range()),
        ];
        for (places, numbers) in pairs {
            for (place, number) in places.iter_mut().zip(numbers) {
                place[lane] = number;
            }
        }
        (self.scrub[lane], self.trail[lane]) = (wheel.scrub, wheel.trail);
        let features = &mut self.features;
        features.is_turned |= wheel.is_turned;
        features.is_narrow |= wheel.is_narrow;
        features.has_scrub |= wheel.scrub != 0.0;
        features.has_trail |= wheel.trail != 0.0;
    }

    /// Constants of the wheels of register `k`.
    #[inline(always)]
    pub fn load<S: Simd>(&self, simd: S, k: usize) -> SteeredWheel<S> {
        let load = |numbers: &Eight| Lanes::load(simd, S::as_simd_f64s(numbers).0, k);
        let pair = |numbers: &[Eight; 2]| [load(&numbers[0]), load(&numbers[1])];
        SteeredWheel {
            pivot: pair(&self.pivot),
            heading: pair(&self.heading),
            range: pair(&self.range),
            single_range: pair(&self.single_range),
            near_range: pair(&self.near_range),
            scrub: load(&self.scrub),
            trail: load(&self.trail),
            features: self.features,
        }
    }
}
