//! Search of a maximum along a line.

/// Middle of the interval in which a function of one maximum has it, narrowed so many times by the golden section (Kiefer 1953).
///
/// ```
/// let at = haptical_linalg::golden_section([-1.0, 2.0], 60, |x| -(x - 0.3).abs());
/// assert!((at - 0.3).abs() < 1e-9);
/// ```
pub fn golden_section(
    [mut low, mut high]: [f64; 2],
    steps: usize,
    mut value: impl FnMut(f64) -> f64,
) -> f64 {
    let golden = 0.5 * (5.0_f64.sqrt() - 1.0);
    let (mut left, mut right) = (high - golden * (high - low), low + golden * (high - low));
    let (mut of_left, mut of_right) = (value(left), value(right));
    for step in 1..=steps {
        let is_left = of_left >= of_right;
        if is_left {
            (high, right, of_right) = (right, left, of_left);
            left = high - golden * (high - low);
        } else {
            (low, left, of_left) = (left, right, of_right);
            right = low + golden * (high - low);
        }
        match step < steps {
            true if is_left => of_left = value(left),
            true => of_right = value(right),
            false => {}
        }
    }
    0.5 * (low + high)
}
