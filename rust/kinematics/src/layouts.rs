//! The named layouts: each only fills a list of wheels.

use std::f64::consts::FRAC_PI_2;

use crate::rover::{MAX_WHEELS, Rover};
use crate::steering::SteeringRange;
use crate::wheels::{Pivot, Wheel};
use six_wheel_numerics::error::{Error, finite, not_negative, numbers, positive};

/// Sides of a vehicle, left before right.
const SIDES: [(&str, f64); 2] = [("left", 1.0), ("right", -1.0)];

/// Driven wheels of a car or tricycle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Drive {
    /// The front wheels.
    Front,
    /// The rear wheels.
    Rear,
    /// All of them.
    All,
}

named_values! { Drive as "driven": "front" => Front, "rear" => Rear, "all" => All }

/// Centres of rotation of the treads of a skidding vehicle, in body axes [m].
///
/// J. L. Martinez et al., Approximating kinematics for tracked mobile robots, IJRR 24(10), 2005.
#[derive(Clone, Copy, Debug, Default)]
pub struct SkidCentres {
    /// Lateral position for the left side; `None` where the tread is.
    pub left: Option<f64>,
    /// Lateral position for the right side; `None` where the tread is.
    pub right: Option<f64>,
    /// Longitudinal position of both, forward of the origin.
    pub forward: f64,
}

impl Rover {
    /// The six-wheel rover with four steered corners: the unsteered middle wheels at x = 0.
    ///
    /// `d1` half track of the corners, `d2` centre to rear axle, `d3` centre to front axle, `d4` half track
    /// of the middle wheels [m].
    pub fn six_wheel([d1, d2, d3, d4]: [f64; 4], wheel_radius: f64, steering: SteeringRange) -> Result<Self, Error> {
        positive("front_to_middle", d3)?;
        positive("middle_to_rear", d2)?;
        positive("track_width", 2.0 * d1)?;
        not_negative("middle_track_width", 2.0 * d4)?;
        positive("wheel_radius", wheel_radius)?;
        steering.check()?;
        let corner = |name: &str, x, y| Wheel::new(name, x, y, wheel_radius).steered(steering);
        let middle = |name: &str, y| Wheel::new(name, 0.0, y, wheel_radius);
        Self::new(vec![
            corner("front_left", d3, d1),
            corner("front_right", d3, -d1),
            middle("middle_left", d4),
            middle("middle_right", -d4),
            corner("rear_left", -d2, d1),
            corner("rear_right", -d2, -d1),
        ])
    }

    /// The arguments of [`Self::six_wheel`] that make an equal rover, if any do.
    pub fn as_six_wheel(&self) -> Option<([f64; 4], f64, SteeringRange)> {
        let [front, _, middle, _, rear, _] = self.wheels() else {
            return None;
        };
        let dimensions = [front.y, -rear.x, front.x, middle.y];
        let range = front.steering()?;
        let rebuilt = Self::six_wheel(dimensions, front.radius, range).ok()?;
        (rebuilt == *self).then_some((dimensions, front.radius, range))
    }

    /// A vehicle whose wheels are all steered, at these pivots `[x, y]`, named `module_0`, `module_1`, ...
    pub fn swerve(
        positions: &[[f64; 2]],
        names: Option<Vec<String>>,
        wheel_radius: f64,
        steering: SteeringRange,
    ) -> Result<Self, Error> {
        positive("wheel_radius", wheel_radius)?;
        steering.check()?;
        let names = spread_names(positions, names, "module", 2)?;
        let same = |i: usize| (0..i).find(|&j| positions[i] == positions[j]);
        if let Some((j, i)) = (0..names.len()).find_map(|i| same(i).map(|j| (j, i))) {
            let got = format!("{:?} and {:?} both at {}", names[j], names[i], numbers(&positions[i]));
            return Err(Error::value("positions", "differ from module to module", got));
        }
        let module = |(name, [x, y]): (String, &[f64; 2])| Wheel::new(name, *x, *y, wheel_radius).steered(steering);
        Self::new(names.into_iter().zip(positions).map(module).collect())
    }

    /// Wheels on two sides, none of them steered: differential, skid-steered or tracked drive.
    ///
    /// `radii` left and right; `per_side` wheels spread over `wheelbase`, front to rear.
    #[inline]
    pub fn differential(
        track_width: f64,
        radii: [f64; 2],
        per_side: usize,
        wheelbase: f64,
        skid: SkidCentres,
    ) -> Result<Self, Error> {
        positive("track_width", track_width)?;
        radii.into_iter().try_for_each(|radius| positive("wheel_radius", radius))?;
        let axles = axles(per_side, wheelbase)?;
        let half = track_width / 2.0;
        let centres = [skid.left.unwrap_or(half), skid.right.unwrap_or(-half)];
        finite("icr_left", &centres[..1])?;
        finite("icr_right", &centres[1..])?;
        finite("icr_forward", &[skid.forward])?;
        if centres[0] <= centres[1] {
            return Err(Error::value("icr_left", "lie to the left of icr_right", numbers(&centres)));
        }
        let mut wheels = Vec::new();
        for (axle, x) in axles {
            for (((side, sign), radius), centre) in SIDES.into_iter().zip(radii).zip(centres) {
                let name = if axle.is_empty() { side.into() } else { format!("{axle}_{side}") };
                // The instantaneous centre of the track lies `scrub` beside the pivot and `trail` behind it.
                wheels.push(Wheel {
                    scrub: centre - sign * half,
                    trail: -skid.forward,
                    ..Wheel::new(name, x, sign * half, radius)
                });
            }
        }
        Self::new(wheels)
    }

    /// A car: two steered front wheels, two fixed rear wheels, origin between the rear wheels.
    pub fn ackermann(
        wheelbase: f64,
        track_width: f64,
        wheel_radius: f64,
        steering: SteeringRange,
        drive: Drive,
    ) -> Result<Self, Error> {
        let tracks = [Some(track_width); 2];
        Self::car(wheelbase, tracks, wheel_radius, steering, drive)
    }

    /// A tricycle: one steered front wheel, two fixed rear wheels, origin between the rear wheels.
    pub fn tricycle(
        wheelbase: f64,
        track_width: f64,
        wheel_radius: f64,
        steering: SteeringRange,
        drive: Drive,
    ) -> Result<Self, Error> {
        let tracks = [None, Some(track_width)];
        Self::car(wheelbase, tracks, wheel_radius, steering, drive)
    }

    /// A bicycle: a steered front wheel and a fixed rear wheel, origin at the rear wheel.
    pub fn bicycle(wheelbase: f64, wheel_radius: f64, steering: SteeringRange, drive: Drive) -> Result<Self, Error> {
        Self::car(wheelbase, [None; 2], wheel_radius, steering, drive)
    }

    /// A steered front axle and a fixed rear axle, each with a track or with one wheel in the middle.
    fn car(
        wheelbase: f64,
        tracks: [Option<f64>; 2],
        wheel_radius: f64,
        steering: SteeringRange,
        drive: Drive,
    ) -> Result<Self, Error> {
        positive("wheelbase", wheelbase)?;
        tracks.iter().flatten().try_for_each(|track| positive("track_width", *track))?;
        positive("wheel_radius", wheel_radius)?;
        steering.check()?;
        let axles =
            [("front", wheelbase, Pivot::Steered(steering), Drive::Front), ("rear", 0.0, Pivot::Fixed, Drive::Rear)];
        let mut wheels = Vec::new();
        for ((axle, x, pivot, drives), track) in axles.into_iter().zip(tracks) {
            let wheel = |name: String, y| Wheel {
                pivot,
                driven: drive == Drive::All || drive == drives,
                ..Wheel::new(name, x, y, wheel_radius)
            };
            match track {
                None => wheels.push(wheel(axle.into(), 0.0)),
                Some(track) => {
                    wheels.extend(SIDES.map(|(side, sign)| wheel(format!("{axle}_{side}"), sign * track / 2.0)))
                }
            }
        }
        Self::new(wheels)
    }

    /// Four mecanum wheels with rollers at `roller_angle` to their axles: seen from above, the rollers on top form a
    /// cross, those on the ground a diamond about the middle.
    pub fn mecanum(wheelbase: f64, track_width: f64, wheel_radius: f64, roller_angle: f64) -> Result<Self, Error> {
        positive("wheelbase", wheelbase)?;
        positive("track_width", track_width)?;
        positive("wheel_radius", wheel_radius)?;
        let mut wheels = Vec::new();
        for (axle, ahead) in [("front", 1.0), ("rear", -1.0)] {
            for (side, left) in SIDES {
                let (x, y) = (ahead * wheelbase / 2.0, left * track_width / 2.0);
                wheels.push(Wheel {
                    roller_angle: Some(-ahead * left * roller_angle),
                    ..Wheel::new(format!("{axle}_{side}"), x, y, wheel_radius)
                });
            }
        }
        Self::new(wheels)
    }

    /// Fixed wheels with rollers at `roller_angle` to their axles, a quarter turn for omni wheels, at these
    /// positions `[x, y]` and headings, named `wheel_0`, `wheel_1`, ...
    pub fn omni(
        positions: &[[f64; 2]],
        headings: &[f64],
        names: Option<Vec<String>>,
        wheel_radius: f64,
        roller_angle: Option<f64>,
    ) -> Result<Self, Error> {
        positive("wheel_radius", wheel_radius)?;
        let names = spread_names(positions, names, "wheel", 1)?;
        if headings.len() != names.len() {
            let rule = format!("hold {} values, one per wheel", names.len());
            return Err(Error::value("headings", rule, headings.len()));
        }
        let wheel = |((name, [x, y]), heading): ((String, &[f64; 2]), &f64)| Wheel {
            heading: *heading,
            roller_angle: Some(roller_angle.unwrap_or(FRAC_PI_2)),
            ..Wheel::new(name, *x, *y, wheel_radius)
        };
        Self::new(names.into_iter().zip(positions).zip(headings).map(wheel).collect())
    }
}

/// The given names or default ones, one for each of at least `least` finite positions.
fn spread_names(
    positions: &[[f64; 2]],
    names: Option<Vec<String>>,
    stem: &str,
    least: usize,
) -> Result<Vec<String>, Error> {
    if positions.len() < least {
        return Err(Error::value("positions", format!("hold at least {least}"), positions.len()));
    }
    for (row, position) in positions.iter().enumerate() {
        finite("positions", position).map_err(|error| error.at_row(row))?;
    }
    let numbered = |i: usize| format!("{stem}_{i}");
    let names = names.unwrap_or_else(|| (0..positions.len()).map(numbered).collect());
    if names.len() == positions.len() {
        return Ok(names);
    }
    Err(Error::value("names", format!("hold {} names, one per position", positions.len()), names.len()))
}

/// Names and positions of the axles of a vehicle with so many wheels per side, front to rear.
fn axles(per_side: usize, wheelbase: f64) -> Result<Vec<(String, f64)>, Error> {
    if !(1..=MAX_WHEELS / 2).contains(&per_side) {
        return Err(Error::value("wheels_per_side", format!("be 1 to {}", MAX_WHEELS / 2), per_side));
    }
    if per_side == 1 {
        return Ok(vec![(String::new(), 0.0)]);
    }
    positive("wheelbase", wheelbase)?;
    let step = wheelbase / (per_side - 1) as f64;
    let name = |i: usize| match (per_side, i) {
        (2 | 3, 0) => "front".into(),
        (2, 1) | (3, 2) => "rear".into(),
        (3, 1) => "middle".into(),
        _ => format!("axle_{i}"),
    };
    Ok((0..per_side).map(|i| (name(i), wheelbase / 2.0 - step * i as f64)).collect())
}
