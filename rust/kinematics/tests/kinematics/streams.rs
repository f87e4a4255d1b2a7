//! Results are the same whether they are stored past the caches or not.

use six_wheel_kinematics::estimate::Unseen;
use six_wheel_kinematics::geometry::Steps;
use six_wheel_kinematics::kernels::normal_equations::ForwardConstants;
use six_wheel_kinematics::pose_logs::integrate::IntegrateLogs;
use six_wheel_kinematics::pose_logs::logs::Logs;
use six_wheel_kinematics::presets::preset;
use six_wheel_kinematics::rover::Inputs;
use six_wheel_kinematics::table::Log;
use six_wheel_numerics::error::Error;
use six_wheel_numerics::simd::level::Level;
use six_wheel_numerics::stream::LINE;

/// Numbers between -1 and 1, the same every time, and a few zeros.
fn numbers(count: usize) -> Vec<f64> {
    let number = |k: usize| ((k * 2_654_435_761) % 2001) as f64 / 1000.0 - 1.0;
    (0..count).map(|k| if k % 97 < 3 { 0.0 } else { number(k) }).collect()
}

/// Asserts that `write` writes the same bits past the caches and not, for every place in a line the output may begin
/// at; nothing beside it is touched.
fn is_the_same(count: usize, mut write: impl FnMut(&mut [f64], bool)) {
    for first in 0..LINE {
        let [mut direct, mut non_temporal] = [vec![f64::MAX; count + 2 * LINE], vec![f64::MAX; count + 2 * LINE]];
        // Both at the same place of a line.
        let place = |values: &[f64]| (LINE - values.as_ptr().addr() / size_of::<f64>() % LINE) % LINE + first;
        let (from, to) = (place(&direct), place(&non_temporal));
        let margin = |values: &[f64], at: usize| {
            let beside = values.iter().enumerate().filter(|(k, _)| !(at..at + count).contains(k));
            beside.filter(|(_, value)| **value == f64::MAX).count()
        };
        write(&mut direct[from..from + count], false);
        write(&mut non_temporal[to..to + count], true);
        assert_eq!(margin(&non_temporal, to), 2 * LINE, "beside");
        let bits = |values: &[f64]| values.iter().map(|value| value.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(&direct[from..from + count]), bits(&non_temporal[to..to + count]), "{first}");
    }
}

const COUNTS: [usize; 7] = [1, 2, 63, 64, 65, 333, 2048];

#[test]
fn rows_are_the_same_past_the_caches() -> Result<(), Error> {
    for (name, count) in COUNTS.into_iter().flat_map(|n| [("perseverance", n), ("husky", n)]) {
        let rover = preset(name, None)?;
        let (joints, wheels) = (rover.steered().len(), rover.wheels().len());
        let mut twists = numbers(3 * count);
        for twist in twists.as_chunks_mut::<3>().0 {
            // Twists that fixed wheels in the middle allow, some at rest and some so slow that squares lose digits.
            *twist = [twist[0], 0.0, twist[2] * if twist[1] < 0.0 { 1e-120 } else { 0.3 }];
        }
        let readings = numbers(wheels * count);
        let forward_constants = ForwardConstants::new(&rover);
        let log = Log { steering: &readings[..joints * count], speeds: &readings, steering_rates: None };
        for level in Level::available().into_iter() {
            let (rows, inputs) = (twists.as_chunks().0, Inputs::default());
            let mut others = vec![0.0; wheels * count];
            is_the_same(joints * count, |steering, non_temporal| {
                rover.inverse_constants.solve_rows(level, rows, inputs, steering, &mut others, non_temporal);
            });
            is_the_same(wheels * count, |speeds, non_temporal| {
                rover.inverse_constants.solve_rows(
                    level,
                    rows,
                    inputs,
                    &mut others[..joints * count],
                    speeds,
                    non_temporal,
                );
            });
            is_the_same(3 * count, |twists, non_temporal| {
                let (twists, unseen) = (twists.as_chunks_mut().0, Unseen::Refuse);
                let solved = forward_constants.solve_rows(level, &rover, log, unseen, twists, non_temporal);
                assert!(solved.is_ok());
            });
        }
    }
    Ok(())
}

#[test]
fn poses_are_the_same_past_the_caches() {
    for count in COUNTS {
        let twists = numbers(3 * count);
        let (twists, steps) = (twists.as_chunks().0, Steps::Constant(0.7));
        for level in Level::available().into_iter() {
            is_the_same(3 * (count + 1), |poses, non_temporal| {
                let logs = Logs { twists, count, steps, starts: &[[1.0, 2.0, 3.0]] };
                level.run_any(IntegrateLogs { logs, poses: poses.as_chunks_mut().0, non_temporal });
            });
        }
    }
}
