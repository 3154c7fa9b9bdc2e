//! The inverse's search: where it looks, how often, and what it takes for rounding.

use core::cell::RefCell;
use haptical_transmission::{LawError, invert};

/// What the inverse promises, rad.
const PROMISED_RAD: f64 = 1e-12;

/// The angle found and every encoder angle that was evaluated, in turn.
fn watched(
    error: impl Fn(f64) -> (f64, f64),
    output_rad: f64,
    bracket_rad: [f64; 2],
) -> (f64, Vec<f64>) {
    let seen = RefCell::new(Vec::new());
    let law = |theta_rad| {
        seen.borrow_mut().push(theta_rad);
        Ok(error(theta_rad))
    };
    let found_rad = invert(law, output_rad, bracket_rad).unwrap();
    (found_rad, seen.into_inner())
}

#[test]
fn growth_is_checked_at_both_ends_and_at_eight_points_spread_evenly() {
    let (_, seen) = watched(|_| (0.0, 0.0), 1.3, [-2.0, 7.0]);
    let mut checked = seen[..10].to_vec();
    checked.sort_by(f64::total_cmp);
    for (got, want) in checked.iter().zip(-2..=7) {
        assert!((got - f64::from(want)).abs() < 1e-14, "{checked:?}");
    }
}

/// The wanted angle lies between two neighbours of those points: nothing beyond them is evaluated again.
#[test]
fn the_search_stays_between_two_neighbouring_points() {
    let steep = |t: f64| ((50.0 * t).atan() - t, 50.0 / (1.0 + 2500.0 * t * t) - 1.0);
    for want_rad in [-0.95_f64, -0.4, -0.02, 0.02, 0.3, 0.8] {
        let (found_rad, seen) = watched(steep, (50.0 * want_rad).atan(), [-1.0, 1.0]);
        assert!((found_rad - want_rad).abs() < PROMISED_RAD);
        let ninth = 2.0 / 9.0;
        let below = -1.0 + ninth * ((want_rad + 1.0) / ninth).floor();
        let between = below - 1e-14..below + ninth + 1e-14;
        assert!(
            seen[10..].iter().all(|t| between.contains(t)),
            "{want_rad}: {seen:?}"
        );
    }
}

/// On a line Newton's first step ends the search, wherever the bracket lies: it is as long as the distance to the
/// nearer of two neighbouring points, so never more than half of theirs.
#[test]
fn a_line_takes_one_step() {
    let line = |theta: f64| (0.25 * theta, 0.25);
    for (bracket_rad, want_rad) in [
        ([-1.0, 1.0], 0.02),
        ([-8.999, 0.001], -0.4),
        ([-0.001, 8.999], 0.4),
        ([20.0, 29.0], 23.45),
    ] {
        let (found_rad, seen) = watched(line, 1.25 * want_rad, bracket_rad);
        assert!((found_rad - want_rad).abs() < PROMISED_RAD);
        assert!(seen.len() <= 11, "{bracket_rad:?}: {seen:?}");
    }
}

/// Noise of the size of the rounding of a million rad, whichever of the three terms is as large: no fold.
#[test]
fn rounding_of_large_terms_is_no_fold() {
    let noise = |theta: f64| 2e-9 * (theta * 3.7e9).sin();
    for step in 0..200 {
        let want_rad = 0.4 + 0.001 * f64::from(step);
        let far = |theta: f64| (noise(theta), 0.0);
        let (found_rad, _) = watched(far, 1e6 + want_rad, [1e6 - 3.0, 1e6 + 5.0]);
        assert!((found_rad - 1e6 - want_rad).abs() < 1e-8, "{found_rad}");
        let offset = |theta: f64| (1e6 + noise(theta), 0.0);
        let (found_rad, _) = watched(offset, 1e6 + want_rad, [-3.0, 5.0]);
        assert!((found_rad - want_rad).abs() < 1e-8, "{found_rad}");
    }
}

/// A fall of half a milliradian is far beyond the rounding of a million rad: eight points in a bracket of nine
/// tenths show it.
#[test]
fn a_fall_beyond_rounding_is_a_fold() {
    let fall = |theta: f64, edge: f64| if theta > edge { -5e-4 } else { 0.0 };
    let refused = |result| matches!(result, Err(LawError::NotMonotone { .. }));
    let far = |theta: f64| Ok((fall(theta, 1e6), 0.0));
    assert!(refused(invert(
        far,
        1e6 - 2e-4,
        [1e6 - 3.5e-4, 1e6 + 5.5e-4]
    )));
    let offset = |theta: f64| Ok((1e6 + fall(theta, 0.0), 0.0));
    assert!(refused(invert(offset, 1e6 - 2e-4, [-3.5e-4, 5.5e-4])));
}

/// Between 1/9 and 1/3, two of the eight points, the output falls by 1 and rises by 2/9.
#[test]
fn a_fold_between_points_says_where_and_how_steep() {
    let jump = |theta: f64| Ok((if theta > 0.3 { -1.0 } else { 0.0 }, 0.0));
    let Err(LawError::NotMonotone { theta_rad, slope }) = invert(jump, 0.1, [-1.0, 1.0]) else {
        panic!("a fold was not seen")
    };
    assert!((theta_rad - 1.0 / 3.0).abs() < 1e-14, "{theta_rad}");
    assert!((slope + 3.5).abs() < 1e-13, "{slope}");
}
