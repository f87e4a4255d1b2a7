//! `six_wheel.Limits` and `six_wheel.Controller`.

pub mod limits;
