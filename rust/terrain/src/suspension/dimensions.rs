//! Dimensions of a rocker-bogie: lengths, steered wheels, ranges of joints, coupling of the rockers.

use six_wheel_kinematics::steering::SteeringRange;
use six_wheel_numerics::error::{Error, finite, number, numbers, positive};

/// The steered wheels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Steered {
    /// The front pair.
    Front,
    /// The front and the rear pair.
    Corners,
    /// All six.
    All,
}

impl Steered {
    /// Indices of the steered wheels.
    #[inline]
    pub fn wheels(self) -> &'static [usize] {
        match self {
            Self::Front => &[0, 1],
            Self::Corners => &[0, 1, 4, 5],
            Self::All => &[0, 1, 2, 3, 4, 5],
        }
    }
}

named_values! { Steered as "steered": "front" => Front, "corners" => Corners, "all" => All }

/// End of the bogies: they carry the middle wheels and those of this end, the rockers those of the other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bogie {
    /// Behind the rocker axis, as on Curiosity: middle and rear wheels.
    Behind,
    /// In front of it, as on the Open Source Rover: front and middle wheels.
    InFront,
}

impl Bogie {
    /// Names of the five vectors of [`Dimensions`], in their order.
    pub fn names(self) -> [&'static str; 5] {
        match self {
            Self::Behind => ["rocker_pivot", "rocker_to_front", "rocker_to_bogie", "bogie_to_middle", "bogie_to_rear"],
            Self::InFront => ["rocker_pivot", "rocker_to_rear", "rocker_to_bogie", "bogie_to_front", "bogie_to_middle"],
        }
    }

    /// True if a pair of wheels, counted from the front, is carried by the bogies.
    pub fn carries(self, pair: usize) -> bool {
        match self {
            Self::Behind => pair > 0,
            Self::InFront => pair < 2,
        }
    }
}

/// Mechanism that couples the rockers: their angles have opposite signs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Differential {
    /// A gear in the body: opposite angles.
    Gear,
    /// A bar across the body, pivoted about the vertical in its middle, each end joined by a rod to an upright lever on
    /// a rocker. At angles 0 bar and levers are orthogonal to the rods, which are ahead of the bar.
    Bar {
        /// Middle of the bar to its ends [m].
        half_length: f64,
        /// Axis of the rockers to the rods [m].
        lever: f64,
        /// Length of the rods [m].
        rod: f64,
    },
}

impl Differential {
    /// Angle of the right rocker about +y at this angle of the left one [rad], and its derivative; None where the
    /// linkage has no solution.
    #[inline]
    pub fn right(self, left: f64) -> Option<[f64; 2]> {
        let Self::Bar { half_length: b, lever: h, rod: l } = self else {
            return Some([-left, -1.0]);
        };
        // Closure of a rod: (l + h sin q + s b sin d)^2 + b^2 (1 - cos d)^2 + h^2 (1 - cos q)^2 = l^2, with s = 1 on
        // the left and -1 on the right: once for the bar's angle d, once for the right rocker.
        let (sin, cos) = left.sin_cos();
        let ahead = l + h * sin;
        let bar = root(2.0 * ahead * b, -2.0 * b * b, l * l - ahead * ahead - 2.0 * b * b - (h * (1.0 - cos)).powi(2))?;
        let (sin_bar, cos_bar) = bar.sin_cos();
        let back = l - b * sin_bar;
        let right =
            root(2.0 * back * h, -2.0 * h * h, l * l - back * back - 2.0 * h * h - (b * (1.0 - cos_bar)).powi(2))?;
        // Half the derivatives of the closures by the angles of the rockers and of the bar.
        let by = |q: f64, s: f64| {
            let x = l + h * q.sin() + s * b * sin_bar;
            let rocker = x * h * q.cos() + h * h * (1.0 - q.cos()) * q.sin();
            let bar = s * x * b * cos_bar + b * b * (1.0 - cos_bar) * sin_bar;
            rocker / bar
        };
        Some([right, by(left, 1.0) / by(right, -1.0)])
    }

    fn check(self) -> Result<(), Error> {
        let Self::Bar { half_length, lever, rod } = self else {
            return Ok(());
        };
        let lengths = [half_length, lever, rod];
        if lengths.iter().all(|length| length.is_finite() && *length > 0.0) {
            return Ok(());
        }
        let rule = "hold three lengths, finite and positive";
        Err(Error::value("differential_bar", rule, numbers(&lengths)))
    }
}

/// The solution of `a sin t + b cos t = c` nearest to 0.
fn root(a: f64, b: f64, c: f64) -> Option<f64> {
    let size = a.hypot(b);
    let reaches = c.abs() <= size;
    if !reaches {
        return None;
    }
    let (middle, half) = (a.atan2(b), (c / size).acos());
    let nearest = [middle - half, middle + half].map(|t| t.sin().atan2(t.cos()));
    Some(if nearest[0].abs() < nearest[1].abs() { nearest[0] } else { nearest[1] })
}

/// Smallest and largest angle of a joint [rad].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointRange {
    /// Smallest angle [rad].
    pub lower: f64,
    /// Largest angle [rad].
    pub upper: f64,
}

impl Default for JointRange {
    /// No stops.
    fn default() -> Self {
        Self { lower: f64::NEG_INFINITY, upper: f64::INFINITY }
    }
}

impl JointRange {
    /// True if there are no stops.
    pub fn is_open(self) -> bool {
        self == Self::default()
    }

    /// Fails unless the ends are in order and 0, the angle of the dimensions, is between them.
    pub fn check(self, argument: &'static str) -> Result<(), Error> {
        if self.lower <= 0.0 && self.upper >= 0.0 && self.lower < self.upper {
            return Ok(());
        }
        let rule = "hold the lower angle below the upper, and 0 between them";
        Err(Error::value(argument, rule, numbers(&[self.lower, self.upper])))
    }
}

/// The left-hand side of a suspension at joint angles 0, in the axes of the rover; the right mirrors it.
///
/// Vectors `[x, y, z]` [m]. A wheel's vector ends at its centre, on its steering axis if it has one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dimensions {
    /// Origin of the rover's frame R to the axis of the rocker.
    pub rocker_pivot: [f64; 3],
    /// Axis of the rocker to the wheel it carries itself: the front one, or with bogies in front the rear one.
    pub rocker_to_wheel: [f64; 3],
    /// Axis of the rocker to the axis of the bogie.
    pub rocker_to_bogie: [f64; 3],
    /// Axis of the bogie to its two wheels, the one further to the front first.
    pub bogie_to_wheels: [[f64; 3]; 2],
    /// End of the rover at which the bogies are.
    pub bogie: Bogie,
    /// Hub to ground [m].
    pub wheel_radius: f64,
    /// The steered wheels.
    pub steered: Steered,
    /// Range of the steering angles [rad].
    pub steering: SteeringRange,
    /// Range of the left rocker.
    pub rocker_limit: JointRange,
    /// Range of each bogie against its rocker.
    pub bogie_limit: JointRange,
    /// Coupling of the rockers.
    pub differential: Differential,
}

impl Dimensions {
    /// The vectors with their names.
    pub fn vectors(&self) -> [(&'static str, [f64; 3]); 5] {
        let [first, second] = self.bogie_to_wheels;
        let vectors = [self.rocker_pivot, self.rocker_to_wheel, self.rocker_to_bogie, first, second];
        let names = self.bogie.names();
        std::array::from_fn(|i| (names[i], vectors[i]))
    }

    /// From the axis that carries it to the wheel of a pair, counted from the front.
    pub fn to_wheel(&self, pair: usize) -> [f64; 3] {
        match self.bogie {
            Bogie::Behind if pair == 0 => self.rocker_to_wheel,
            Bogie::Behind => self.bogie_to_wheels[pair - 1],
            Bogie::InFront if pair == 2 => self.rocker_to_wheel,
            Bogie::InFront => self.bogie_to_wheels[pair],
        }
    }

    /// Centre of the left wheel of a pair, counted from the front, in the rover's frame at joint angles 0 [m].
    pub fn level_place(&self, pair: usize) -> [f64; 3] {
        let joint = if self.bogie.carries(pair) { self.rocker_to_bogie } else { [0.0; 3] };
        let to_wheel = self.to_wheel(pair);
        std::array::from_fn(|k| self.rocker_pivot[k] + joint[k] + to_wheel[k])
    }

    /// Fails unless every number is finite and the left wheels are on the left.
    pub(super) fn check(&self) -> Result<(), Error> {
        let vectors = self.vectors();
        for (argument, vector) in &vectors {
            finite(argument, vector)?;
        }
        let reach: f64 = vectors.iter().flat_map(|(_, v)| v).map(|x| x.abs()).sum();
        if !(reach * reach).is_finite() {
            let rule = "reach a finite distance with the vectors after it";
            return Err(Error::value("rocker_pivot", rule, number(reach)));
        }
        positive("wheel_radius", self.wheel_radius)?;
        self.steering.check()?;
        self.rocker_limit.check("rocker_limit")?;
        self.bogie_limit.check("bogie_limit")?;
        self.differential.check()?;
        let [pivot, wheel, bogie, first, second] = vectors.map(|(_, [_, y, _])| y);
        let wheels = [
            (vectors[1].0, pivot + wheel),
            (vectors[3].0, pivot + bogie + first),
            (vectors[4].0, pivot + bogie + second),
        ];
        for (argument, y) in wheels {
            if y <= 0.0 {
                let rule = "end at a wheel of the left-hand side, y > 0 in all";
                return Err(Error::value(argument, rule, number(y)));
            }
        }
        Ok(())
    }
}
