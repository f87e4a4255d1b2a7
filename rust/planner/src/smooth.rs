//! Smoothing of a new mean.

/// Replaces every value by that of the quadratic through it and two neighbours on either side.
///
/// Source: A. Savitzky & M. Golay, Analytical Chemistry 36(8), 1964.
pub(crate) fn smooth(mean: &mut [f64], free: usize, fixed: usize) {
    const TAPS: [f64; 5] = [-3.0 / 35.0, 12.0 / 35.0, 17.0 / 35.0, 12.0 / 35.0, -3.0 / 35.0];
    let steps = mean.len() / free;
    for k in 0..free {
        let at = |t: usize| t.min(steps - 1) * free + k;
        // The two values before, unsmoothed.
        let mut before = [mean[at(fixed)]; 2];
        for t in fixed..steps {
            let now = mean[at(t)];
            let window = [before[0], before[1], now, mean[at(t + 1)], mean[at(t + 2)]];
            let smoothed = window.iter().zip(TAPS).map(|(value, tap)| value * tap).sum();
            before = [before[1], now];
            mean[at(t)] = smoothed;
        }
    }
}
