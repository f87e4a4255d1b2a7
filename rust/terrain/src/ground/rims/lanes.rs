//! Eight rims at once: what [`super::rim`] does, with a circle in every lane.
//!
//! All lanes walk in lockstep from one end of the lower half of the rim to the other, each from cell to cell of
//! its own. An arc is classified by the same bounds. What takes more than that (an arc whose curvature may change
//! its sign and that may hold the least gap, a third candidate, two minima nearly alike, unknown ground, the end
//! of the map) makes a lane doubtful, and the plain walk decides. So a lane that is sure is as right as it.

use super::circle::Circle;
use super::circles::{RIMS, Rims, both, spread};
use super::rim::Minimum;
use super::search::{Stretch, TIE, search};
use crate::terrain::Terrain;
use six_wheel_kinematics::wheels::Direction;
use six_wheel_numerics::simd::lanes::Lanes;
use six_wheel_numerics::simd::level::{Kernel, Level};
use six_wheel_numerics::simd::vector::Vector;

/// The least gap of every circle; None in doubt.
pub(crate) fn walk(level: Level, ground: &Terrain, circles: &[Circle; RIMS], count: usize) -> [Option<Minimum>; RIMS] {
    let kernel = Walk { ground, circles, count };
    level.run(kernel).unwrap_or([None; RIMS])
}

struct Walk<'a> {
    ground: &'a Terrain,
    circles: &'a [Circle; RIMS],
    count: usize,
}

impl Kernel for Walk<'_> {
    type Output = [Option<Minimum>; RIMS];

    #[inline(always)]
    fn run<S: Vector>(self, simd: S) -> Self::Output {
        let mut found = [None; RIMS];
        let mut first = 0;
        while first < self.count {
            one(simd, self.ground, self.circles, first, &mut found);
            first += S::F64_LANES;
        }
        found
    }
}

/// One number of every circle.
#[inline(always)]
fn column<S: Vector>(simd: S, circles: &[Circle; RIMS], first: usize, number: impl Fn(&Circle) -> f64) -> Lanes<S> {
    let mut values = [0.0; RIMS];
    for lane in 0..S::F64_LANES {
        values[lane] = number(&circles[(first + lane).min(RIMS - 1)]);
    }
    Lanes::load(simd, S::as_simd_f64s(&values).0, 0)
}

#[inline(always)]
fn one<S: Vector>(
    simd: S,
    ground: &Terrain,
    circles: &[Circle; RIMS],
    first: usize,
    found: &mut [Option<Minimum>; RIMS],
) {
    let zero = Lanes::splat(simd, 0.0);
    let mut rims = Rims { centre: [zero; 3], forward: [zero; 3], up: [zero; 3] };
    for k in 0..3 {
        rims.centre[k] = column(simd, circles, first, |circle| circle.centre[k]);
        rims.forward[k] = column(simd, circles, first, |circle| circle.forward[k]);
        rims.up[k] = column(simd, circles, first, |circle| circle.up[k]);
    }
    let least = search(simd, ground, &rims, &Stretch::lower(simd));
    let sure = (least.gap + Lanes::splat(simd, TIE)).below(least.others);
    let sure = spread(sure.select(Lanes::splat(simd, 1.0), zero));
    let (gap, [sin, cos]) = (spread(least.gap), both!(k, spread(least.at[k])));
    let slope = both!(k, spread(least.slope[k]));
    for lane in 0..S::F64_LANES.min(RIMS - first) {
        if sure[lane] > 0.0 {
            found[first + lane] = Some(Minimum {
                gap: gap[lane],
                at: Direction { sin: sin[lane], cos: cos[lane] },
                slope: [slope[0][lane], slope[1][lane]],
            });
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::super::circles::FAR;
    use super::*;
    use crate::terrain::Heights;
    use six_wheel_numerics::error::Error;

    /// The gap that a stretch of one rim has, on every lane.
    struct Look<'a>(&'a Terrain, Circle, [f64; 2]);

    impl Kernel for Look<'_> {
        type Output = f64;

        #[inline(always)]
        fn run<S: Vector>(self, simd: S) -> f64 {
            let all = |numbers: [f64; 3]| numbers.map(|number| Lanes::splat(simd, number));
            let rims = Rims { centre: all(self.1.centre), forward: all(self.1.forward), up: all(self.1.up) };
            let [start, end] = self.2.map(|angle| {
                let (sin, cos) = angle.sin_cos();
                [Lanes::splat(simd, sin), Lanes::splat(simd, cos)]
            });
            let margin = Lanes::splat(simd, TIE);
            let stretch = Stretch { start, end, margin };
            spread(search(simd, self.0, &rims, &stretch).gap)[0]
        }
    }

    #[test]
    fn a_stretch_without_a_minimum_has_none() -> Result<(), Error> {
        // The first cell of the map, prolonged to the wheel, would be nearer than the ground there.
        let heights = (0..81).map(|k| if k % 9 < 2 && k < 18 { 0.5 } else { 0.0 });
        let heights = Heights::Double(Arc::new(heights.collect()));
        let ground = Terrain::new(heights, 9, [1.0, 1.0], [0.0, 0.0], 0.0)?;
        let circle = Circle { centre: [5.5, 5.5, 1.0], forward: [0.4, 0.0, 0.0], up: [0.0, 0.0, 0.4] };
        for level in Level::available() {
            assert_eq!(level.run_any(Look(&ground, circle, [0.2, 0.7])), FAR);
            let least = level.run_any(Look(&ground, circle, [-0.3, 0.7]));
            assert!((least - 0.6).abs() < 1e-15);
        }
        Ok(())
    }
}
