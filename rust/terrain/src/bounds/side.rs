//! One side of a rocker-bogie in its own plane: from the heights of three wheels to those of the axes.
//!
//! Divided by cos(g), with g the inclination of the body's y axis, and less the share of their lateral positions,
//! heights are those of a planar chain. With `h(v, t) = v_z cos(t) - v_x sin(t)` the height of a vector rotated by
//! `Ry(t)`, `a` and `b` the wheels of the bogie ahead of and behind its axis B, `s` the wheel of the rocker:
//!
//! ```text
//! h(a - b, t) = L sin(phi - t), so   t_bogie  = phi_b - asin((e_a - e_b) / L_b),  e_B = e_a - h(a, t_bogie)
//! bogie behind                       t_rocker = phi_r - asin((e_s - e_B) / L_r),  e_D = e_s - h(s, t_rocker)
//! bogie in front                     t_rocker = phi_r - asin((e_B - e_s) / L_r),  e_D = e_s - h(s, t_rocker)
//! ```
//!
//! Both angles are 0 if the joints are at 0 and the body is level. e_B increases with e_a and with e_b while B is,
//! along the plane, between its wheels: `de_B = (-X_b de_a + X_a de_b) / (X_a - X_b)`, X the distances ahead of B.
//! Likewise e_D while D is between B and s. So over a box of heights all extremes are at corners while the angles are
//! inside the ranges of [`Lever::range`]; outside of these nothing is proved.

use crate::suspension::{Bogie, Dimensions};
use six_wheel_numerics::error::{Error, number};

/// A bar with two supports and an axis: a bogie with its wheels, or a rocker with its wheel and its bogie.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lever {
    /// Inverse distance of the supports [1/m].
    pub inverse_length: f64,
    /// Angle of the line from the support behind to the one ahead, at angle 0 [rad].
    pub phi: f64,
    /// Coefficients of the height of the chosen support above the axis: `along sin(phi - t) + off cos(phi - t)` [m].
    pub along: f64,
    pub off: f64,
    /// Range of `sin(phi - t)` in which the axis is between the supports.
    pub range: [f64; 2],
}

impl Lever {
    /// `ahead` and `behind` from the axis to the supports; `chosen` is one of them.
    fn new(ahead: [f64; 3], behind: [f64; 3], chosen: [f64; 3]) -> Self {
        let (x, z) = (ahead[0] - behind[0], ahead[2] - behind[2]);
        let (length, phi) = (x.hypot(z), z.atan2(x));
        let (sin, cos) = phi.sin_cos();
        let split = |[x, _, z]: [f64; 3]| (x * cos + z * sin, z * cos - x * sin);
        // Ahead of the axis by `along cos(w) - off sin(w)`, w = phi - t: not negative within a quarter turn.
        let quarter = std::f64::consts::FRAC_PI_2;
        let mut range = [-quarter, quarter];
        for ((along, off), sign) in [(split(ahead), 1.0), (split(behind), -1.0)] {
            let turn = (sign * off).atan2(sign * along);
            range = [range[0].max(-quarter - turn), range[1].min(quarter - turn)];
        }
        let (along, off) = split(chosen);
        Self {
            inverse_length: 1.0 / length,
            phi,
            along,
            off,
            range: if range[0] < range[1] { range.map(f64::sin) } else { [f64::INFINITY, f64::NEG_INFINITY] },
        }
    }
}

/// Constants of a side for the kernel.
#[derive(Clone, Copy, Debug)]
pub(super) struct Side {
    pub bogie: Lever,
    pub rocker: Lever,
    /// True if the bogie is in front of the rocker's axis.
    pub in_front: bool,
    /// True if the bogie's angle against the rocker has its extremes at the corners of the bogie's own heights: these
    /// turn the rocker by less than the bogie.
    pub coupled: bool,
}

impl Side {
    pub fn new(dimensions: &Dimensions) -> Result<Self, Error> {
        let [ahead, behind] = dimensions.bogie_to_wheels;
        let (wheel, joint) = (dimensions.rocker_to_wheel, dimensions.rocker_to_bogie);
        let in_front = dimensions.bogie == Bogie::InFront;
        let bogie = Lever::new(ahead, behind, ahead);
        let mut rocker = if in_front { Lever::new(joint, wheel, wheel) } else { Lever::new(wheel, joint, wheel) };
        let names = dimensions.vectors().map(|(name, _)| name);
        for (lever, name) in [(bogie, names[3]), (rocker, names[1])] {
            if !lever.inverse_length.is_finite() {
                let rule = "end elsewhere than the vector it is paired with, seen from the side";
                return Err(Error::value(name, rule, number(0.0)));
            }
        }
        // d(beta) by the wheel in question has one sign while its lever arm, at most its distance from B, is
        // less than the rocker's span along the plane, `L_r cos(phi - t)`.
        let arm = if in_front { behind } else { ahead };
        let share = arm[0].hypot(arm[2]) * rocker.inverse_length;
        let coupled = share < 0.9;
        if coupled {
            let largest = (1.0 - share * share).sqrt();
            rocker.range = [rocker.range[0].max(-largest), rocker.range[1].min(largest)];
        }
        Ok(Self { bogie, rocker, in_front, coupled })
    }
}
