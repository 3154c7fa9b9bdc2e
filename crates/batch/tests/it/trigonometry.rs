//! Sines and cosines in lanes against libm.

use haptical_batch::sines_cosines;
use proptest::prelude::*;

/// One unit in the last place of numbers just below 1 is 1.1e-16, of libm's error half of that.
const TWO_UNITS: f64 = 2.3e-16;

fn worst(angles_rad: &[f64]) -> (f64, f64) {
    let mut sines = vec![0.0; angles_rad.len()];
    let mut cosines = sines.clone();
    sines_cosines(angles_rad, &mut sines, &mut cosines);
    let mut worst = (0.0, 0.0);
    for ((angle, sine), cosine) in angles_rad.iter().zip(&sines).zip(&cosines) {
        let (s, c) = libm::sincos(*angle);
        for (found, expected) in [(sine, s), (cosine, c)] {
            let difference = (found - expected).abs();
            if difference > worst.0 || difference.is_nan() {
                worst = (difference, *angle);
            }
        }
    }
    worst
}

#[test]
fn a_grid_over_the_whole_range() {
    let near: Vec<f64> = (-400_000..=400_000).map(|k| f64::from(k) * 1e-4).collect();
    let far: Vec<f64> = (-100_000..=100_000)
        .map(|k| f64::from(k) * 1.000_001)
        .collect();
    // multiples of pi/4, where the quadrant changes and where sines vanish
    let edges: Vec<f64> = (-1000..=1000)
        .flat_map(|k| {
            let edge = f64::from(k) * std::f64::consts::FRAC_PI_4;
            [edge.next_down(), edge, edge.next_up()]
        })
        .collect();
    for angles in [near, far, edges] {
        let (difference, angle) = worst(&angles);
        assert!(difference < TWO_UNITS, "{difference:e} at {angle}");
    }
}

#[test]
fn extremes() {
    let (difference, angle) = worst(&[0.0, -0.0, 1e-300, -1e-9, 1e5, -1e5, 1.1e5, 1e22, 1e300]);
    assert!(difference < TWO_UNITS, "{difference:e} at {angle}");
    let (mut sines, mut cosines) = ([0.0; 2], [0.0; 2]);
    sines_cosines(&[f64::NAN, f64::INFINITY], &mut sines, &mut cosines);
    assert!(sines.iter().chain(&cosines).all(|value| value.is_nan()));
}

proptest! {
    #[test]
    fn random_angles(angles in prop::collection::vec(-1.0e5..1.0e5_f64, 1..64)) {
        let (difference, angle) = worst(&angles);
        prop_assert!(difference < TWO_UNITS, "{difference:e} at {angle}");
    }
}
