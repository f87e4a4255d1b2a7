//! Contacts of rims with the ground, against dense sampling.

use std::sync::Arc;

use six_wheel_numerics::error::Error;
use six_wheel_numerics::simd::lanes::Lanes;
use six_wheel_numerics::simd::level::{Kernel, Level};
use six_wheel_numerics::simd::vector::Vector;
use six_wheel_terrain::ground::rims::circles::{FAR, RIMS, RimLanes, WheelCircle, spread};
use six_wheel_terrain::ground::rims::contact::{RimContact, RimSegment, find_contacts};
use six_wheel_terrain::ground::rims::interval::{AngleInterval, TIE};
use six_wheel_terrain::ground::rims::walk::find_min_gap;
use six_wheel_terrain::terrain::{Heights, Terrain};

use crate::random;

/// The gap that an interval of one rim has, on every lane.
struct Look<'a>(&'a Terrain, WheelCircle, [f64; 2]);

impl Kernel for Look<'_> {
    type Output = f64;

    #[inline(always)]
    fn run<S: Vector>(self, simd: S) -> f64 {
        let rims = RimLanes::load(simd, &[self.1; RIMS], 0);
        let [start, end] = self.2.map(|angle| {
            let (sin, cos) = angle.sin_cos();
            [Lanes::splat(simd, sin), Lanes::splat(simd, cos)]
        });
        let margin = Lanes::splat(simd, TIE);
        let interval = AngleInterval { start, end, margin, is_closed: false, is_exact: false };
        spread(find_min_gap(simd, self.0, &rims, &interval).gap)[0]
    }
}

#[test]
fn an_interval_without_a_minimum_has_none() -> Result<(), Error> {
    // The first cell of the map, prolonged to the wheel, would be nearer than the ground there.
    let heights = (0..81).map(|k| if k % 9 < 2 && k < 18 { 0.5 } else { 0.0 });
    let heights = Heights::Double(Arc::new(heights.collect()));
    let ground = Terrain::new(heights, 9, [1.0, 1.0], [0.0, 0.0], 0.0)?;
    let circle = WheelCircle { centre: [5.5, 5.5, 1.0], forward: [0.4, 0.0, 0.0], up: [0.0, 0.0, 0.4] };
    for level in Level::available() {
        assert_eq!(level.run_any(Look(&ground, circle, [0.2, 0.7])), FAR);
        let least = level.run_any(Look(&ground, circle, [-0.3, 0.7]));
        assert!((least - 0.6).abs() < 1e-15);
    }
    Ok(())
}

/// The contacts of the lower halves of circles.
struct LowerContacts<'a>(&'a Terrain, &'a [WheelCircle; RIMS]);

impl Kernel for LowerContacts<'_> {
    type Output = [RimContact; RIMS];

    #[inline(always)]
    fn run<S: Vector>(self, simd: S) -> Self::Output {
        find_contacts(simd, self.0, self.1, RIMS, RimSegment::Lower)
    }
}

#[test]
fn contacts_are_those_of_dense_sampling_at_every_level() -> Result<(), Error> {
    let mut random = random();
    let heights = (0..400).map(|_| if random(0.0, 1.0) < 0.01 { f64::NAN } else { random(0.0, 0.4) });
    let heights = Heights::Double(Arc::new(heights.collect()));
    let ground = Terrain::new(heights, 20, [1.0, 1.0], [0.0, 0.0], 0.0)?;
    let mut halved = 0;
    for _ in 0..300 {
        let across = random(0.3, 3.0);
        let circles: [WheelCircle; RIMS] = std::array::from_fn(|_| {
            let ((sy, cy), (sp, cp)) = (random(-4.0, 4.0).sin_cos(), random(-0.5, 0.5).sin_cos());
            let (sr, cr) = random(-0.5, 0.5).sin_cos();
            let axis = |x: f64, y: f64, z: f64| [across * x, across * y, 0.3 * z];
            WheelCircle {
                centre: [random(2.0, 17.0), random(2.0, 17.0), random(0.3, 0.8)],
                forward: axis(cy * cp, sy * cp, -sp),
                up: axis(cy * sp * cr + sy * sr, sy * sp * cr - cy * sr, cp * cr),
            }
        });
        let at = |circle: &WheelCircle, angle: f64| {
            let (sin, cos) = angle.sin_cos();
            let [x, y, z] = [0, 1, 2].map(|k| circle.centre[k] + circle.forward[k] * sin - circle.up[k] * cos);
            let inside = ground.on_grid(x, y) && x < 19.0 && y < 19.0;
            let height = |x: f64, y: f64| ground.cell(x as usize, y as usize).height(x.fract(), y.fract());
            (inside, z - if inside { height(x, y) } else { f64::NAN })
        };
        let scalar = Level::Scalar.run_any(LowerContacts(&ground, &circles));
        for level in Level::available() {
            let contacts = level.run_any(LowerContacts(&ground, &circles));
            assert_eq!(format!("{contacts:?}"), format!("{scalar:?}"), "{level:?}");
        }
        for (circle, contact) in circles.iter().zip(&scalar) {
            let half = std::f64::consts::FRAC_PI_2;
            let (mut least, mut unknown, mut outside) = (f64::INFINITY, false, false);
            for k in -4000..=4000 {
                let (inside, gap) = at(circle, half * f64::from(k) / 4000.0);
                outside |= !inside;
                unknown |= inside && gap.is_nan();
                least = least.min(gap);
            }
            assert!(contact.outside || !outside);
            assert!(contact.unknown || !unknown);
            let Some(found) = contact.least else {
                assert!(unknown || outside);
                continue;
            };
            halved += usize::from(found.gap < least - 1e-5);
            assert!(found.gap <= least + 1e-12 && found.gap > least - 2e-3, "{} {least}", found.gap);
            let (_, gap) = at(circle, found.at.sin.atan2(found.at.cos));
            // On a line of the grid rounding may take the cell beside it, which may not be known.
            assert!(gap.is_nan() || (gap - found.gap).abs() < 1e-9, "{} {gap}", found.gap);
        }
    }
    assert!(halved > 0);
    Ok(())
}
