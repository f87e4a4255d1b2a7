//! Parts of the rims that a search leaves out.

use std::sync::Arc;

use six_wheel_numerics::error::Error;
use six_wheel_numerics::simd::lanes::Lanes;
use six_wheel_numerics::simd::level::{Kernel, Level};
use six_wheel_numerics::simd::vector::Vector;
use six_wheel_numerics::threads::workers::never;
use six_wheel_terrain::ground::rims::circles::{RimLanes, spread};
use six_wheel_terrain::ground::rims::extent::{MARGIN, whole_interval};
use six_wheel_terrain::terrain::{Heights, Terrain};

use crate::random;

/// A circle over a grid, its axes times its radius, and the angle of its last contact.
#[derive(Clone, Copy)]
struct Case {
    centre: [f64; 3],
    forward: [f64; 3],
    up: [f64; 3],
    last: f64,
}

struct WholeInterval<'a>(&'a Terrain, Case);

impl Kernel for WholeInterval<'_> {
    type Output = ([f64; 2], bool);

    /// The angles at which the interval begins and ends, and whether it leaves out the upper half.
    #[inline(always)]
    fn run<S: Vector>(self, simd: S) -> Self::Output {
        let Case { centre, forward, up, last } = self.1;
        let all = |numbers: [f64; 3]| numbers.map(|number| Lanes::splat(simd, number));
        let rims = RimLanes { centre: all(centre), forward: all(forward), up: all(up) };
        let (sin, cos) = last.sin_cos();
        let last = [Lanes::splat(simd, sin), Lanes::splat(simd, cos)];
        let (interval, covers) = whole_interval(simd, self.0, &rims, last);
        let angle = |[sin, cos]: [Lanes<S>; 2]| spread(sin)[0].atan2(spread(cos)[0]);
        ([angle(interval.start), angle(interval.end)], covers.any())
    }
}

#[test]
fn what_is_left_out_is_higher_than_the_last_contact() -> Result<(), Error> {
    let mut random = random();
    let (mut cut, mut whole) = (0, 0);
    for _ in 0..3000 {
        let hole = random(-1.0, 1.0) > 0.0;
        let heights = (0..144).map(|_| match random(0.0, 1.0) {
            x if x < 0.03 && hole => f64::NAN,
            x if x < 0.2 => 0.5,
            x => 0.1 * x,
        });
        let heights = Heights::Double(Arc::new(heights.collect()));
        let ground = Terrain::new(heights, 12, [1.0, 1.0], [0.0, 0.0], 0.0)?;
        let ((sy, cy), (sp, cp)) = (random(-4.0, 4.0).sin_cos(), random(-0.9, 0.9).sin_cos());
        let (sr, cr) = random(-0.5, 0.5).sin_cos();
        let (across, radius) = (random(0.5, 3.0), 0.3);
        let axis = |x: f64, y: f64, z: f64| [across * x, across * y, radius * z];
        let case = Case {
            centre: [random(3.0, 8.0), random(3.0, 8.0), random(0.3, 1.2)],
            forward: axis(cy * cp, sy * cp, -sp),
            up: axis(cy * sp * cr + sy * sr, sy * sp * cr - cy * sr, cp * cr),
            last: random(-1.5, 1.5),
        };
        let gap = |angle: f64| {
            let (sin, cos) = angle.sin_cos();
            let [x, y, z] = [0, 1, 2].map(|k| case.centre[k] + case.forward[k] * sin - case.up[k] * cos);
            let cell = ground.cell(x as usize, y as usize);
            z - cell.height(x.fract(), y.fract())
        };
        let last = gap(case.last);
        if last > 0.0 {
            ground.pyramid(never)?;
        }
        for level in Level::available() {
            let ([start, end], covers) = level.run_any(WholeInterval(&ground, case));
            for k in -628..=628 {
                let angle = f64::from(k) * 0.005;
                let inside = start - 1e-9 <= angle && angle <= end + 1e-9;
                let upper = angle.cos() < 0.0;
                if inside || upper && !covers {
                    continue;
                }
                cut += 1;
                assert!(gap(angle) > last + MARGIN, "{start} {end} {angle}");
            }
            whole += usize::from(last.is_nan());
        }
    }
    assert!(cut > 100_000 && whole > 10);
    Ok(())
}
