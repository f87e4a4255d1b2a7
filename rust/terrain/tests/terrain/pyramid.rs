//! Extremes of the ground over boxes of cells.

use six_wheel_kinematics::geometry::GridPlacement;
use six_wheel_numerics::error::Error;
use six_wheel_numerics::simd::lanes::{Lanes, Mask};
use six_wheel_numerics::simd::level::{Kernel, Level};
use six_wheel_numerics::simd::vector::Vector;
use six_wheel_numerics::threads::workers::never;
use six_wheel_terrain::pyramid::{Boxes, Pyramid, nothing};
use six_wheel_terrain::terrain::Heights;

/// Extremes over one box, in every lane.
struct Look<'a>(&'a Pyramid, [[f64; 2]; 2]);

impl Kernel for Look<'_> {
    type Output = [f64; 2];

    #[inline(always)]
    fn run<S: Vector>(self, simd: S) -> [f64; 2] {
        let Self(pyramid, ends) = self;
        let [first, last] = ends.map(|end| end.map(|cell| Lanes::splat(simd, cell)));
        let boxes = Boxes { first, last, on_map: Mask::splat(simd, true) };
        // SAFETY: the test asks for boxes of the map.
        let span = unsafe { pyramid.spans(&boxes, nothing(simd)) };
        span.deinterleave2().map(|end| end.last(simd))
    }
}

/// The largest single that is not above a height.
fn rounded_down(height: f64) -> f32 {
    let near = height as f32;
    if f64::from(near) > height { near.next_down() } else { near }
}

#[test]
fn boxes_have_the_extremes_of_their_nodes() -> Result<(), Error> {
    const SHAPE: [usize; 2] = [75, 141];
    let mut seed = 1_u32;
    let mut draw = |below: usize| {
        seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (seed >> 8) as usize % below
    };
    let mut heights: Vec<f64> = (0..SHAPE[0] * SHAPE[1]).map(|_| draw(1000) as f64 / 7.0 - 60.0).collect();
    heights[40 * SHAPE[1] + 77] = f64::NAN;
    let grid = Heights::Double(heights.clone().into());
    let pyramid = Pyramid::new(&grid, SHAPE, GridPlacement::new([1.0; 2], [0.0; 2], 0.0)?, never)?;
    for _ in 0..3000 {
        let longest = [1, 3, 8, 40, 140][draw(5)];
        let ends = [SHAPE[1] - 1, SHAPE[0] - 1].map(|cells| {
            let first = draw(cells);
            [first, (first + draw(longest)).min(cells - 1)]
        });
        let [[left, right], [low, high]] = ends;
        let nodes = (low..=high + 1)
            .flat_map(|row| (left..=right + 1).map(move |column| row * SHAPE[1] + column))
            .map(|k| heights[k]);
        let known = nodes.clone().all(|height| !height.is_nan());
        let least = nodes.clone().fold(f64::INFINITY, f64::min);
        let most = nodes.fold(f64::NEG_INFINITY, f64::max);
        let expected =
            if known { [rounded_down(least), rounded_down(-most)].map(f64::from) } else { [f64::NEG_INFINITY; 2] };
        let look = || Look(&pyramid, [[left, low], [right, high]].map(|end| end.map(|k| k as f64)));
        for level in Level::available() {
            let found = level.run_any(look());
            assert_eq!(found, expected, "{level:?} {ends:?}");
        }
    }
    Ok(())
}
