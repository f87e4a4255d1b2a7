//! Poses along logs of twists, in registers: one log after the other, or one in every lane.

pub mod integrate;
pub mod logs;
pub mod tile;
