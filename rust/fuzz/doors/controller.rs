//! Any commands, times and measured angles: no panic, finite outputs, and once inside their ranges joints stay there.

use six_wheel_control::controller::Limits;
use six_wheel_control::controller::{AlignmentPolicy, Controller, Mode, Options};
use six_wheel_kinematics::geometry::Twist;

use super::bytes::Bytes;

/// One input.
pub fn one(data: &[u8]) {
    let mut bytes = Bytes(data);
    let Some(rover) = bytes.rover() else { return };
    let mut values = [None; Limits::NAMES.len()];
    for value in &mut values {
        *value = (bytes.byte() % 2 == 0).then(|| bytes.number().abs());
    }
    let Ok(limits) = Limits::new(values) else {
        return;
    };
    let options = Options {
        mode: [Mode::Free, Mode::Crab, Mode::FrontOnly, Mode::Spin][usize::from(bytes.byte() % 4)],
        align: [None, Some(AlignmentPolicy::Hold), Some(AlignmentPolicy::Cosine)][usize::from(bytes.byte() % 3)],
        ..Options::default()
    };
    let Ok(mut controller) = Controller::new(&rover, limits, options, None) else {
        return;
    };
    let mut now = 0.0;
    while bytes.any() {
        let kind = bytes.byte();
        if kind % 3 == 0 {
            let twist = Twist::from([bytes.number(), bytes.number(), bytes.number()]);
            let _ = controller.command(twist, now, None);
        }
        now += if kind & 128 == 0 { 0.02 } else { bytes.number() };
        let measured = (kind % 5 == 0).then(|| bytes.numbers(rover.steered().len()));
        let before = controller.steering().to_vec();
        if controller.step(now, measured.as_deref()).is_err() {
            assert_eq!(before, controller.steering());
        }
        let numbers = [controller.steering(), controller.speeds(), controller.steering_rates()];
        assert!(
            numbers.concat().iter().all(|value| value.is_finite()),
            "{numbers:?} at {now}, measured {measured:?}, {controller:?}"
        );
    }
}
