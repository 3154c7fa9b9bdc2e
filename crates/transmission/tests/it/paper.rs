//! The printed polynomial of Table 2 in both forms, and the physical joint it was fitted to.

use crate::fixture::{assert_close, from_monomials};
use haptical_transmission::chebyshev::{basis, evaluate, to_monomials};
use haptical_transmission::{Capstan, CapstanError, CapstanParallelogram, Parallelogram};

/// Table 2, k0 .. k10, as printed.
const TABLE_2_POWERS: [f64; 11] = [
    0.000043, -0.005159, 0.040587, -0.100185, -0.391253, 0.508398, 1.436945, -0.983788, -2.185038,
    0.633845, 1.191804,
];

/// The joint's range, +-45 deg.
const RANGE_RAD: [f64; 2] = [-core::f64::consts::FRAC_PI_4, core::f64::consts::FRAC_PI_4];

/// The printed curve has a ripple `a [sin(12 theta + phase) - sin(phase)]` that an eccentricity of 2 um
/// over `D` cannot give; these two were found by others from the printed coefficients.
const RIPPLE_RAD: f64 = 0.77e-3;
const RIPPLE_PHASE_DEG: f64 = -50.0;

/// What a polynomial of degree 10 cannot follow of a ripple of 12 cycles per turn, and the uncertainty
/// of the ripple (0.03 mrad, 2 deg). A wrong sign of a length or of the ratio gives several mrad.
const TRUNCATION_RAD: f64 = 0.4e-3;
const TRUNCATION_RMS_RAD: f64 = 0.2e-3;

fn printed(theta_rad: f64) -> f64 {
    TABLE_2_POWERS
        .iter()
        .rev()
        .fold(0.0, |sum, power| sum * theta_rad + power)
}

#[test]
fn printed_powers_and_chebyshev_series_are_the_same_curve() {
    let coefficients = from_monomials(RANGE_RAD, &TABLE_2_POWERS);
    let mut terms = [0.0; 11];
    for step in -45..=45 {
        let theta_rad = f64::from(step)
            .to_radians()
            .clamp(RANGE_RAD[0], RANGE_RAD[1]);
        let (value_rad, _) = evaluate(RANGE_RAD, &coefficients, theta_rad);
        assert_close(value_rad, printed(theta_rad), 1e-15, "value");
        basis(RANGE_RAD, theta_rad, &mut terms);
        let sum: f64 = terms.iter().zip(&coefficients).map(|(t, c)| t * c).sum();
        assert_close(sum, printed(theta_rad), 1e-15, "sum over the basis");
    }
    let mut again = [0.0; 11];
    to_monomials(RANGE_RAD, &coefficients, &mut again).unwrap();
    for (k, (got, want)) in again.into_iter().zip(TABLE_2_POWERS).enumerate() {
        // half a unit of the last printed digit is 5e-7
        assert_close(got, want, 1e-12, &format!("k{k}"));
    }
}

#[test]
fn outside_the_range_the_printed_powers_explode_and_the_series_does_not() {
    let coefficients = from_monomials(RANGE_RAD, &TABLE_2_POWERS);
    for (degrees, end_rad) in [(-60f64, RANGE_RAD[0]), (60.0, RANGE_RAD[1])] {
        let (value_rad, slope) = evaluate(RANGE_RAD, &coefficients, degrees.to_radians());
        let end_slope = (1i32..)
            .zip(&TABLE_2_POWERS[1..])
            .map(|(k, power)| power * f64::from(k) * end_rad.powi(k - 1))
            .sum();
        assert_close(slope, end_slope, 1e-12, "slope of the powers at the end");
        let line_rad = printed(end_rad) + end_slope * (degrees.to_radians() - end_rad);
        assert_close(value_rad, line_rad, 1e-12, "tangent");
        assert!(value_rad.abs() < 0.05, "{value_rad} at {degrees} deg");
    }
    assert!(
        printed(60f64.to_radians()) > 0.3,
        "the printed powers at 60 deg"
    );
}

#[test]
fn the_corrected_loop_gives_the_printed_curve_up_to_its_ripple() {
    let joint = CapstanParallelogram {
        capstan: Capstan::new(12.0, 0.0975, 0.0975).unwrap(),
        parallelogram: Parallelogram::new([0.18, 0.076, 0.18, 0.076]).unwrap(),
    };
    let (beta_o, beta_i) = (-40f64.to_radians(), -120f64.to_radians());
    let p = CapstanError::from_polar(0.0, 0.02, 1e-4, beta_o, 2e-6, beta_i);
    let deviations_m = [-0.0005, -0.0007, 0.0, 0.0];
    let phase_rad = RIPPLE_PHASE_DEG.to_radians();
    let n_steps = 800;
    let (mut literal, mut rippled) = (Gap::default(), Gap::default());
    for step in 0..=n_steps {
        let theta_rad = (-40.0 + 80.0 * f64::from(step) / f64::from(n_steps)).to_radians();
        let gap_rad = printed(theta_rad) - joint.error(&p, &deviations_m, theta_rad).unwrap();
        let ripple_rad = RIPPLE_RAD * ((12.0 * theta_rad + phase_rad).sin() - phase_rad.sin());
        literal.add(gap_rad, theta_rad);
        rippled.add(gap_rad - ripple_rad, theta_rad);
    }
    println!("eq. (1) literal: {literal:?}\nwith the ripple: {rippled:?}");
    // The ripple is zero at home, so it reaches a (1 + sin 50 deg) = 1.36 mrad, not a.
    let ripple_peak_rad = RIPPLE_RAD * (1.0 - phase_rad.sin());
    assert!(literal.largest_rad < ripple_peak_rad, "{literal:?}");
    assert!(rippled.largest_rad < TRUNCATION_RAD, "{rippled:?}");
    assert!(
        (rippled.squares / f64::from(n_steps + 1)).sqrt() < TRUNCATION_RMS_RAD,
        "{rippled:?}"
    );
}

/// Differences of two curves: the largest, where it is, and the sum of squares.
#[derive(Debug, Default)]
struct Gap {
    largest_rad: f64,
    largest_at_rad: f64,
    squares: f64,
}

impl Gap {
    fn add(&mut self, gap_rad: f64, theta_rad: f64) {
        self.squares += gap_rad * gap_rad;
        if gap_rad.abs() > self.largest_rad {
            (self.largest_rad, self.largest_at_rad) = (gap_rad.abs(), theta_rad);
        }
    }
}
