//! Gaps between the directions of motion that are possible for a rover of two components.
//!
//! A direction is an angle whose tangent is the yaw rate times the rover's size over the speed; directions half a turn
//! apart are the same motion, forwards and backwards.

use std::f64::consts::PI;

use super::limits::{AT_AN_END, DirectionGap, ImmobileReason, RoverLimits};
use crate::numbers::squares::{ROUNDING, square};
use six_wheel_kinematics::rover::Rover;
use six_wheel_numerics::simd::vec3::inner_product;

impl RoverLimits {
    /// Finds the gaps between possible directions; sets `stuck` if none is possible.
    pub(super) fn directions(&mut self, rover: &Rover) {
        if self.stuck.is_some() {
            return;
        }
        if self.free == 3 {
            self.find_inside();
            return;
        }
        let size = rover.size;
        let angle = |row: &[f64]| (-row[0] * size).atan2(row[1]).rem_euclid(PI);
        let others: Vec<Vec<f64>> = rover.banks.iter().skip(1).map(|bank| self.row(bank.row.into())).collect();
        // A further side-slip row leaves at most one direction.
        if let Some(first) = others.iter().find(|row| row.iter().any(|part| part.abs() > ROUNDING)) {
            let only = direction(angle(first), size);
            let slides = |row: &Vec<f64>| inner_product(row, &only).abs() > AT_AN_END;
            if others.iter().any(slides) || self.beyond(&only) > AT_AN_END {
                self.stuck = Some(ImmobileReason::Rover);
            } else {
                self.gaps.push(self.gap([only, only.map(|part| -part)]));
            }
            return;
        }
        let mut ends: Vec<f64> = Vec::new();
        for joint in self.narrow_joints() {
            let (sin, cos) = joint.half.sin_cos();
            for side in [-1.0, 1.0] {
                let row: Vec<f64> = (0..2).map(|k| joint.across[k] * cos + side * joint.along[k] * sin).collect();
                ends.push(angle(&row));
            }
        }
        ends.sort_by(f64::total_cmp);
        ends.dedup_by(|b, a| (*b - *a).abs() <= AT_AN_END);
        if !ends.is_empty() {
            self.find_gaps(&ends, size);
        }
    }

    /// Finds the gaps between directions from the ends of all ranges, angles in ascending order.
    fn find_gaps(&mut self, ends: &[f64], size: f64) {
        let count = ends.len();
        let is_open = |k: usize| {
            let next = if k + 1 < count { ends[k + 1] } else { ends[0] + PI };
            self.beyond(&direction(f64::midpoint(ends[k], next), size)) <= 0.0
        };
        let open: Vec<bool> = (0..count).map(is_open).collect();
        // An end next to a possible interval, or possible by itself.
        let is_allowed = |&k: &usize| {
            open[k] || open[(k + count - 1) % count] || self.beyond(&direction(ends[k], size)) <= AT_AN_END
        };
        let allowed: Vec<usize> = (0..count).filter(is_allowed).collect();
        if allowed.is_empty() {
            self.stuck = Some(ImmobileReason::Rover);
            return;
        }
        for (place, &k) in allowed.iter().enumerate().filter(|(_, k)| !open[**k]) {
            let next = allowed.get(place + 1).map_or(ends[allowed[0]] + PI, |&next| ends[next]);
            self.gaps.push(self.gap([direction(ends[k], size), direction(next, size)]));
        }
    }

    fn gap(&self, ends: [[f64; 2]; 2]) -> DirectionGap {
        let metric = &self.metric;
        let square = ends.map(|end| square(metric, &end));
        let mut shares = [[0.0; 2]; 2];
        for (k, end) in ends.iter().enumerate() {
            shares[k] = [
                (metric[0] * end[0] + metric[1] / 2.0 * end[1]) / square[k],
                (metric[1] / 2.0 * end[0] + metric[2] * end[1]) / square[k],
            ];
        }
        DirectionGap { ends, shares, per_length: square.map(|square| 1.0 / square.sqrt()) }
    }
}

/// The motion (speed, yaw rate) of this direction.
fn direction(angle: f64, size: f64) -> [f64; 2] {
    [angle.cos(), angle.sin() / size]
}
