//! Intervals of contact angles, and the least gap along them.

use super::circles::FAR;
use crate::interval::both;
use six_wheel_numerics::simd::lanes::{Lanes, Mask};
use six_wheel_numerics::simd::vector::Vector;

/// Minima nearer to each other than this are both kept [m].
pub const TIE: f64 = 2e-7;

/// A part of the lower halves of the rims.
#[derive(Clone, Copy)]
pub struct AngleInterval<S: Vector> {
    /// Sine and cosine of the contact angle at its start.
    pub start: [Lanes<S>; 2],
    /// Sine and cosine of the contact angle at its end.
    pub end: [Lanes<S>; 2],
    /// Height above the least gap up to which other minima are kept [m].
    pub margin: Lanes<S>,
    /// True if the ends count as minima where the gap falls towards them.
    pub is_closed: bool,
    /// True if arcs along which the curvature may change its sign are halved where they may hold the least gap.
    pub is_exact: bool,
}

impl<S: Vector> AngleInterval<S> {
    /// The lower halves.
    #[inline(always)]
    pub fn lower(simd: S) -> Self {
        let (zero, unit) = (Lanes::splat(simd, 0.0), Lanes::splat(simd, 1.0));
        let margin = Lanes::splat(simd, TIE);
        Self { start: [-unit, zero], end: [unit, zero], margin, is_closed: true, is_exact: true }
    }
}

/// The least gap of every rim along an interval.
#[derive(Clone, Copy)]
pub struct GapMinimum<S: Vector> {
    /// The gap [m]; [`FAR`] where there is no minimum.
    pub gap: Lanes<S>,
    /// Sine and cosine of its contact angle.
    pub at: [Lanes<S>; 2],
    /// Derivatives of the ground's height by columns and rows [m].
    pub slope: [Lanes<S>; 2],
    /// The next best minimum [m], if it is at most the margin above the least.
    pub next_gap: Lanes<S>,
    /// Sine and cosine of its contact angle.
    pub next_at: [Lanes<S>; 2],
    /// Lower bound of all other minima and of the ends of the interval, if it is at most the margin above the gap [m].
    pub others: Lanes<S>,
    /// Lower bound of the gap along arcs whose curvature may change its sign [m].
    pub(super) unresolved: Lanes<S>,
    /// True if the interval lies over unknown ground.
    pub unknown: Mask<S>,
    /// True if it leaves the map.
    pub outside: Mask<S>,
}

#[inline_always]
impl<S: Vector> GapMinimum<S> {
    /// No gap, over known ground.
    pub fn none(simd: S) -> Self {
        let (zero, unit, far) = (Lanes::splat(simd, 0.0), Lanes::splat(simd, 1.0), Lanes::splat(simd, FAR));
        let at = [zero, unit];
        Self {
            gap: far,
            at,
            slope: [zero; 2],
            next_gap: far,
            next_at: at,
            others: far,
            unresolved: far,
            unknown: unit.lt(zero),
            outside: unit.lt(zero),
        }
    }

    /// `yes` where true, `no` elsewhere.
    pub(super) fn pick(mask: Mask<S>, yes: &Self, no: &Self) -> Self {
        Self {
            gap: mask.select(yes.gap, no.gap),
            at: both!(k, mask.select(yes.at[k], no.at[k])),
            slope: both!(k, mask.select(yes.slope[k], no.slope[k])),
            next_gap: mask.select(yes.next_gap, no.next_gap),
            next_at: both!(k, mask.select(yes.next_at[k], no.next_at[k])),
            others: mask.select(yes.others, no.others),
            unresolved: mask.select(yes.unresolved, no.unresolved),
            unknown: (mask & yes.unknown) | (!mask & no.unknown),
            outside: (mask & yes.outside) | (!mask & no.outside),
        }
    }

    /// Adds a minimum in the lanes of `mask`; of an open interval, the angle of the next best one is not kept.
    pub(super) fn offer(
        &mut self,
        is_closed: bool,
        mask: Mask<S>,
        gap: Lanes<S>,
        at: [Lanes<S>; 2],
        slope: [Lanes<S>; 2],
    ) {
        let is_least = mask & gap.lt(self.gap);
        let is_next = mask & gap.lt(self.next_gap);
        self.next_gap = is_least.select(self.gap, is_next.select(gap, self.next_gap));
        if is_closed {
            self.next_at = both!(k, is_least.select(self.at[k], is_next.select(at[k], self.next_at[k])));
        }
        self.gap = is_least.select(gap, self.gap);
        self.at = both!(k, is_least.select(at[k], self.at[k]));
        self.slope = both!(k, is_least.select(slope[k], self.slope[k]));
    }
}
