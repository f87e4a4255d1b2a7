//! Rovers with published planar geometry, and the source of the numbers.

use crate::layouts::SkidCentres;
use crate::rover::Rover;
use crate::steering::SteeringRange;
use crate::wheels::Wheel;
use six_wheel_numerics::error::Error;

/// A published rover.
#[derive(Clone, Copy, Debug)]
pub struct Preset {
    /// Its name in [`preset`].
    pub name: &'static str,
    /// Source of the numbers.
    pub source: &'static str,
    /// Published steering limit [rad]; None: the default range.
    pub steering_limit: Option<f64>,
    layout: Layout,
}

#[derive(Clone, Copy, Debug)]
enum Layout {
    /// `[d1, d2, d3, d4]` and the wheel radius [m].
    SixWheel([f64; 4], f64),
    /// `[x, y]` of the left of two steered front wheels, x of two axles of fixed wheels on the same track, wheel radius
    /// [m].
    FrontSteered([f64; 2], [f64; 2], f64),
    /// Half wheelbase, half track and radius of two axles that each pivot about their middle [m].
    PivotingAxles(f64, f64, f64),
    /// Half wheelbase, half track and radius of four fixed wheels [m].
    SkidSteer(f64, f64, f64),
    /// Half track and radius of one fixed pair [m].
    Pair(f64, f64),
}

/// x of the Rocky 7 bogie joint [m]: the differential, then a link of 0.16 m at 139 degrees.
const ROCKY7_BOGIE: f64 = 0.12075 - 0.16 * 0.754_709_580_222_771_9;

/// Every preset, by name.
pub const PRESETS: [Preset; 9] = [
    Preset {
        name: "perseverance",
        source: "nasa-jpl/m2020-urdf-models, rover/m2020.urdf (c422fc6)",
        steering_limit: None,
        layout: Layout::SixWheel([1.0625, 1.07498, 1.18502, 1.1845], 0.26288),
    },
    Preset {
        name: "curiosity",
        source: "Project Chrono Curiosity model (BSD-3-Clause), read off a 3D model to about 1 cm; \
                 origin moved from the chassis to the middle axle",
        steering_limit: None,
        layout: Layout::SixWheel([1.063, 1.074, 1.184, 1.194], 0.25),
    },
    Preset {
        name: "rocky7",
        source: "nealseegmiller/wmrde, Rocky 7 model after Tarokh and McDermott (da081e4); \
                 origin moved by 3.5 um from frame R to between the bogie joints",
        steering_limit: Some(std::f64::consts::FRAC_PI_3),
        layout: Layout::FrontSteered([0.12075 + 0.288 - ROCKY7_BOGIE, 0.2], [0.069, -0.069], 0.065),
    },
    Preset {
        name: "zoe",
        source: "nealseegmiller/wmrde, Zoe model: two passively steered axles",
        steering_limit: None,
        layout: Layout::PivotingAxles(1.91 / 2.0, 1.64 / 2.0, 0.325),
    },
    Preset {
        name: "open_source_rover",
        source: "nasa-jpl/osr-rover-code, osr_params.yaml (e7c9e87)",
        steering_limit: None,
        layout: Layout::SixWheel([0.177, 0.310, 0.274, 0.253], 0.075),
    },
    Preset {
        name: "curio_sawppy",
        source: "srmainwaring/curio, base_controller.yaml and URDF (baec5d6), BSD-3-Clause",
        steering_limit: None,
        layout: Layout::SixWheel([0.235, 0.25, 0.28, 0.26], 0.06),
    },
    Preset {
        name: "exoter",
        source: "exoter-rover/bundles-exoter locomotion_control (ae4709a), \
                 esa-prl/rover_config exoter.xacro (9d4e8de)",
        steering_limit: Some(std::f64::consts::FRAC_PI_2),
        layout: Layout::SixWheel([0.305, 0.265, 0.265, 0.305], 0.072703),
    },
    Preset {
        name: "husky",
        source: "utiasSTARS/enav-planetary-dataset, rover_main.urdf.xacro (b8167cc)",
        steering_limit: None,
        layout: Layout::SkidSteer(0.512 / 2.0, 0.5708 / 2.0, 0.1651),
    },
    Preset {
        name: "optiodom_diff",
        source: "sousarbarb/optiodom (8e025fd), nominal dimensions; doi 10.1007/s10846-022-01630-3",
        steering_limit: None,
        layout: Layout::Pair(0.1, 0.042),
    },
];

/// The rover of a preset, with the published steering range or the given one.
pub fn preset(name: &str, steering: Option<SteeringRange>) -> Result<Rover, Error> {
    let Some(preset) = PRESETS.iter().find(|preset| preset.name == name) else {
        let names: Vec<_> = PRESETS.iter().map(|preset| preset.name).collect();
        return Err(Error::value("name", format!("be one of {}", names.join(", ")), format!("{name:?}")));
    };
    let published = preset.steering_limit.map(SteeringRange::symmetric).transpose()?;
    let range = steering.or(published).unwrap_or_default();
    let pairs = |name: &str, x: f64, y: f64, radius: f64| {
        ["left", "right"].map(|side| {
            let y = if side == "left" { y } else { -y };
            Wheel::new(format!("{name}_{side}"), x, y, radius)
        })
    };
    let rover = match preset.layout {
        Layout::SixWheel(dimensions, radius) => Rover::six_wheel(dimensions, radius, range),
        Layout::FrontSteered([x, y], [middle, rear], radius) => {
            let front = pairs("front", x, y, radius).map(|wheel| wheel.steered(range));
            let fixed = [pairs("middle", middle, y, radius), pairs("rear", rear, y, radius)];
            Rover::new(front.into_iter().chain(fixed.into_iter().flatten()).collect())
        }
        Layout::PivotingAxles(x, half_track, radius) => {
            let axle = |name, x| {
                pairs(name, x, half_track, radius).map(|wheel| {
                    let scrub = wheel.y;
                    Wheel { y: 0.0, scrub, ..wheel }.steered(range)
                })
            };
            Rover::new([axle("front", x), axle("rear", -x)].into_iter().flatten().collect())
        }
        Layout::SkidSteer(x, y, radius) => {
            let skid = SkidCentres::default();
            Rover::differential(2.0 * y, [radius; 2], 2, 2.0 * x, skid)
        }
        Layout::Pair(y, radius) => Rover::differential(2.0 * y, [radius; 2], 1, 0.0, SkidCentres::default()),
    }?;
    match steering {
        Some(range) if rover.steered().is_empty() => {
            Err(Error::value("steering_limit", "be left out for a rover that does not steer", range))
        }
        _ => Ok(rover),
    }
}

impl Preset {
    /// The preset that a rover equals, and the steering range where it is not the published one.
    pub fn of(rover: &Rover) -> Option<(&'static str, Option<SteeringRange>)> {
        let steering = rover.steered().first().and_then(|&wheel| rover.wheels()[wheel].steering());
        let calls = PRESETS.iter().flat_map(|published| [(published.name, None), (published.name, steering)]);
        calls.into_iter().find(|&(name, range)| preset(name, range).is_ok_and(|made| made == *rover))
    }
}
