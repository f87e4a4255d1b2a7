//! Poses along logs at every level.

use std::f64::consts::TAU;

use six_wheel_kinematics::batch;
use six_wheel_kinematics::geometry::Steps;
use six_wheel_numerics::error::Error;
use six_wheel_numerics::simd::level::Level;
use six_wheel_numerics::threads::workers::Workers;

/// The poses after every step from the origin on, with these instructions.
fn integrate(level: Level, twists: &[[f64; 3]], dt: f64) -> Result<Vec<[f64; 3]>, Error> {
    let mut poses = vec![[0.0; 3]; twists.len() + 1];
    let workers = Workers { level, ..Workers::PLAIN };
    batch::integrate(twists, twists.len(), Steps::Constant(dt), &[[0.0; 3]], &mut poses, workers)?;
    Ok(poses.split_off(1))
}

#[test]
fn the_closed_circle_ends_where_it_began() -> Result<(), Error> {
    let count = 1_000_000;
    let twists = vec![[1.0, 0.0, TAU / (count as f64 * 1e-3)]; count];
    for level in Level::available() {
        let [x, y, yaw] = integrate(level, &twists, 1e-3)?[count - 1];
        // 1 km of path; yaw carries the rounding of its own increments, 1e6 half ulps at worst.
        assert!(x.hypot(y) < 1e-8, "{x} {y}");
        assert!((yaw - TAU).abs() < 1e-12, "{yaw}");
    }
    Ok(())
}

#[test]
fn steps_of_many_turns_lead_where_their_chords_do() -> Result<(), Error> {
    // Steps of up to hundreds of turns among short ones.
    let twist = |k: usize| [1.0, -0.5, [0.1, 2.9, -7.0, 1e3, 0.0, -1e9, 1.7][k % 7]];
    let twists: Vec<_> = (0..200).map(twist).collect();
    for level in Level::available() {
        let poses = integrate(level, &twists, 1.0)?;
        let (mut x, mut y, mut heading) = (0.0, 0.0, 0.0_f64);
        for (k, [vx, vy, omega]) in twists.iter().enumerate() {
            let half = omega / 2.0;
            let chord = if half == 0.0 { 1.0 } else { half.sin() / half };
            let (sin, cos) = (
                heading.sin() * half.cos() + heading.cos() * half.sin(),
                heading.cos() * half.cos() - heading.sin() * half.sin(),
            );
            x += chord * (cos * vx - sin * vy);
            y += chord * (sin * vx + cos * vy);
            heading = (heading.sin() * omega.cos() + heading.cos() * omega.sin())
                .atan2(heading.cos() * omega.cos() - heading.sin() * omega.sin());
            let off = (poses[k][0] - x).abs().max((poses[k][1] - y).abs());
            assert!(off < 1e-12, "{level:?} step {k}: {off}");
        }
    }
    Ok(())
}
