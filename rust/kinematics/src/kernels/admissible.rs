//! Admissibility of twists, and the nearest admissible ones, block by block.

use super::cone::Cone;
use super::steered::load;
use crate::admissible::Keep;
use crate::admissible::faces::Faces;
use crate::geometry::Twist;
use crate::rover_data::RoverData;
use six_wheel_numerics::error::Error;
use six_wheel_numerics::simd::lanes::Lanes;
use six_wheel_numerics::simd::level::Kernel;
use six_wheel_numerics::simd::vector::Vector;
use six_wheel_numerics::weave::{BLOCK, Column, unweave, weave};

/// Decides for each twist if it is possible; the plain core decides those in doubt.
pub(crate) struct Admissible<'a> {
    pub rover: &'a RoverData,
    pub cone: &'a Cone,
    pub twists: &'a [[f64; 3]],
    pub answers: &'a mut [bool],
}

impl Kernel for Admissible<'_> {
    type Output = Result<(), Error>;

    #[inline(always)]
    fn run<S: Vector>(self, simd: S) -> Self::Output {
        let (zero, one) = (Lanes::splat(simd, 0.0), Lanes::splat(simd, 1.0));
        let mut twists = [Column::ZERO; 3];
        let [mut yes, mut doubts] = [Column::ZERO; 2];
        let blocks = self.twists.chunks(BLOCK).zip(self.answers.chunks_mut(BLOCK));
        for (block, (rows, answers)) in blocks.enumerate() {
            unweave(simd, rows.as_flattened(), &mut twists);
            let mut doubt = zero.below(zero);
            for k in 0..BLOCK / S::F64_LANES {
                let verdict = self.cone.judge(simd, load(simd, &twists, k));
                let open = !(verdict.yes | verdict.no);
                doubt = doubt | open;
                yes.store(k, verdict.yes.select(one, zero));
                doubts.store(k, open.select(one, zero));
            }
            for (answer, yes) in answers.iter_mut().zip(yes.0) {
                *answer = yes != 0.0;
            }
            if doubt.any() {
                for (k, answer) in answers.iter_mut().enumerate() {
                    if doubts.0[k] != 0.0 {
                        let answered = self.rover.admissible(rows[k].into());
                        *answer = answered.map_err(|error| error.at_row(block * BLOCK + k))?;
                    }
                }
            }
        }
        Ok(())
    }
}

/// The nearest possible twists; those in doubt by the plain core.
pub(crate) struct Project<'a> {
    pub rover: &'a RoverData,
    pub cone: &'a Cone,
    pub faces: &'a Faces,
    pub keep: Keep,
    pub twists: &'a [[f64; 3]],
    pub projected: &'a mut [[f64; 3]],
}

impl Kernel for Project<'_> {
    type Output = Result<(), Error>;

    #[inline(always)]
    fn run<S: Vector>(self, simd: S) -> Self::Output {
        let (zero, one) = (Lanes::splat(simd, 0.0), Lanes::splat(simd, 1.0));
        let [mut wanted, mut found] = [[Column::ZERO; 3]; 2];
        let mut doubts = Column::ZERO;
        let blocks = self.twists.chunks(BLOCK).zip(self.projected.chunks_mut(BLOCK));
        for (block, (rows, targets)) in blocks.enumerate() {
            unweave(simd, rows.as_flattened(), &mut wanted);
            let mut doubt = zero.below(zero);
            for k in 0..BLOCK / S::F64_LANES {
                let wanted = load(simd, &wanted, k);
                let (point, sure) = self.cone.project(simd, self.faces, self.keep, wanted);
                doubt = doubt | !sure;
                for (column, part) in found.iter_mut().zip(point) {
                    column.store(k, part);
                }
                doubts.store(k, sure.select(zero, one));
            }
            weave(simd, &found, targets.as_flattened_mut());
            if doubt.any() {
                for (k, target) in targets.iter_mut().enumerate() {
                    if doubts.0[k] != 0.0 {
                        let point = self.rover.project_by(|| self.faces, rows[k].into(), self.keep);
                        *target = point.map_err(|error| error.at_row(block * BLOCK + k))?.into();
                    }
                }
            }
        }
        Ok(())
    }
}

/// One twist, in every lane. Nothing where the plain core has to decide.
pub(crate) struct ProjectOne<'a> {
    pub cone: &'a Cone,
    pub faces: &'a Faces,
    pub keep: Keep,
    pub twist: Twist,
}

impl Kernel for ProjectOne<'_> {
    type Output = Option<Twist>;

    #[inline(always)]
    fn run<S: Vector>(self, simd: S) -> Self::Output {
        let wanted = <[f64; 3]>::from(self.twist).map(|part| Lanes::splat(simd, part));
        let (found, sure) = self.cone.project(simd, self.faces, self.keep, wanted);
        let found = found.map(|part| part.last(simd));
        (!(!sure).any()).then(|| found.into())
    }
}

/// Decides if one twist is possible. `None` where the plain core has to decide.
pub(crate) struct JudgeOne<'a> {
    pub cone: &'a Cone,
    pub twist: Twist,
}

impl Kernel for JudgeOne<'_> {
    type Output = Option<bool>;

    #[inline(always)]
    fn run<S: Vector>(self, simd: S) -> Self::Output {
        let twist = <[f64; 3]>::from(self.twist).map(|part| Lanes::splat(simd, part));
        let verdict = self.cone.judge(simd, twist);
        if verdict.yes.any() { Some(true) } else { verdict.no.any().then_some(false) }
    }
}
