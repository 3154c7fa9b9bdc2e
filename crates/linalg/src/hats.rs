//! Piecewise linear functions of a value.

/// Hat functions over `knots` equal intervals from `low` to `high`, `knots + 1` of them with a row for each value; values outside count as
/// the nearest end, and `low` is less than `high`. Their sum is 1 at every value. Source: de Boor, *A Practical Guide to Splines*, 2001, chapter III.
///
/// ```
/// let hats = haptical_linalg::hat_functions(&[0.0, 0.25, 1.5], [0.0, 1.0], 2);
/// assert_eq!(hats, [[1.0, 0.5, 0.0], [0.0, 0.5, 0.0], [0.0, 0.0, 1.0]]);
/// ```
pub fn hat_functions(values: &[f64], [low, high]: [f64; 2], knots: usize) -> Vec<Vec<f64>> {
    let width = (high - low) / knots as f64;
    let hats = (0..=knots).map(|knot| {
        let centre = low + width * knot as f64;
        let hat = |value: &f64| (1.0 - ((value.clamp(low, high) - centre) / width).abs()).max(0.0);
        values.iter().map(hat).collect()
    });
    hats.collect()
}
