//! Flags of one sample, and the refusal of one.

use std::ops::{BitOr, BitOrAssign};

use six_wheel_numerics::error::{Error, number};

/// Flags of one sample.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Health(pub u32);

impl Health {
    /// No flag.
    pub const GOOD: Self = Self(0);
    /// It is the first one: the reference of the next step.
    pub const FIRST: Self = Self(1);
    /// It came after more than the longest gap; the motion in between is one arc.
    pub const GAP: Self = Self(2);
    /// A counter started over.
    pub const WRAPPED: Self = Self(4);
    /// A wheel contradicts the others by more than the noise explains.
    pub const SLIP: Self = Self(8);
    /// Left out: a reading is not a finite number.
    pub const NOT_FINITE: Self = Self(16);
    /// Left out: its stamp equals that of the sample before.
    pub const DUPLICATE: Self = Self(32);
    /// Left out: its stamp is less than that of the sample before.
    pub const BACKWARDS: Self = Self(64);
    /// Left out: its step exceeds the largest speed or steering rate of the rover.
    pub const JUMP: Self = Self(128);
    /// Left out: its wheels do not determine the motion.
    pub const UNDETERMINED: Self = Self(256);
    /// A counter restarted at zero; or the clock or the counters changed their zero, and this sample is consistent with
    /// the one left out before.
    pub const RESTARTED: Self = Self(512);
    /// Left out: the attitude is that of an overturned rover.
    pub const OVERTURNED: Self = Self(1024);
    /// The rover does not settle on the ground there; the pose is integrated by joints and attitude, or by the last
    /// attitude.
    pub const UNSETTLED: Self = Self(2048);
    /// Left out: the rover does not settle on the ground there, and no other reading gives its attitude.
    pub const OFF_GROUND: Self = Self(4096);

    /// Flags of samples that were left out.
    const LEFT_OUT: Self = Self(16 | 32 | 64 | 128 | 256 | 1024 | 4096);

    /// True if the sample was left out.
    #[inline]
    pub fn is_left_out(self) -> bool {
        self.0 & Self::LEFT_OUT.0 != 0
    }

    /// True if this flag is raised.
    pub fn has(self, flag: Self) -> bool {
        self.0 & flag.0 != 0
    }

    /// The flag, if it applies.
    #[inline]
    pub fn when(self, applies: bool) -> Self {
        if applies { self } else { Self::GOOD }
    }
}

impl BitOr for Health {
    type Output = Self;

    fn bitor(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }
}

impl BitOrAssign for Health {
    fn bitor_assign(&mut self, other: Self) {
        self.0 |= other.0;
    }
}

/// Refusal of a sample with its reason.
pub struct Refusal {
    /// The reason as a flag.
    pub flag: Health,
    /// The reason in words.
    pub error: Error,
}

impl Refusal {
    /// A refusal with its reason.
    #[inline]
    pub fn new(flag: Health, error: Error) -> Self {
        Self { flag, error }
    }

    /// Refuses a step of this duration [s], from the stamp of the `last` sample to a stamp, that is not positive.
    #[inline]
    pub fn unless_later(dt: f64, stamp: f64, last: f64) -> Result<(), Self> {
        if dt > 0.0 || dt.is_nan() {
            return Ok(());
        }
        let flag = if dt == 0.0 { Health::DUPLICATE } else { Health::BACKWARDS };
        let rule = format!("be later than the last one, {}", number(last));
        Err(Self::new(flag, Error::value("stamp", rule, number(stamp))))
    }
}
