//! Distributions against closed forms and published tables.

use haptical_metrics::{
    MetricsError, chi_square_p_value, normal_two_sided_p, student_t_quantile, wilson_interval,
};

/// What the special functions behind the distributions promise, relative.
const SPECIAL_FUNCTION: f64 = 1e-9;
/// Published tables carry four to six digits.
const TABLE: f64 = 6e-4;

fn assert_relative(found: f64, expected: f64, tolerance: f64) {
    assert!(
        (found / expected - 1.0).abs() < tolerance,
        "{found} / {expected}"
    );
}

#[test]
fn chi_square_tail_matches_closed_forms_for_even_degrees() {
    for x in [0.1_f64, 1.0, 5.0, 40.0, 200.0] {
        let half = 0.5 * x;
        let two = (-half).exp();
        let six = two * (1.0 + half + 0.5 * half * half);
        assert_relative(chi_square_p_value(x, 2.0).unwrap(), two, SPECIAL_FUNCTION);
        assert_relative(chi_square_p_value(x, 6.0).unwrap(), six, SPECIAL_FUNCTION);
    }
    assert_eq!(chi_square_p_value(0.0, 3.0).unwrap(), 1.0);
    // Critical values of the 0.05 column of printed tables.
    for (dof, critical) in [
        (1.0, 3.841),
        (5.0, 11.070),
        (30.0, 43.773),
        (100.0, 124.342),
    ] {
        assert_relative(chi_square_p_value(critical, dof).unwrap(), 0.05, TABLE);
    }
    // Wilson and Hilferty's cube root for many residuals, good to a few per mil here.
    for dof in [20_000.0_f64, 300_000.0, 2e6] {
        let statistic = dof + 2.0 * (2.0 * dof).sqrt();
        let variance = 2.0 / (9.0 * dof);
        let z = ((statistic / dof).cbrt() - (1.0 - variance)) / variance.sqrt();
        let expected = 0.5 * normal_two_sided_p(z).unwrap();
        assert_relative(chi_square_p_value(statistic, dof).unwrap(), expected, 5e-3);
    }
}

#[test]
fn normal_tail_matches_tables_in_the_centre_and_far_out() {
    assert_eq!(normal_two_sided_p(0.0).unwrap(), 1.0);
    assert_relative(
        normal_two_sided_p(1.0).unwrap(),
        0.317_310_507_862_914,
        SPECIAL_FUNCTION,
    );
    assert_relative(
        normal_two_sided_p(-3.0).unwrap(),
        0.002_699_796_063_260,
        SPECIAL_FUNCTION,
    );
    assert_relative(
        normal_two_sided_p(8.0).unwrap(),
        1.244_192_114_854_36e-15,
        SPECIAL_FUNCTION,
    );
    assert!(normal_two_sided_p(f64::NAN).is_err());
}

#[test]
fn student_quantile_matches_closed_forms_for_one_and_two_degrees() {
    for level in [0.1_f64, 0.5, 0.9, 0.95, 0.999] {
        let one = (std::f64::consts::FRAC_PI_2 * level).tan();
        let two = level * (2.0 / (1.0 - level * level)).sqrt();
        assert_relative(
            student_t_quantile(level, 1.0).unwrap(),
            one,
            SPECIAL_FUNCTION,
        );
        assert_relative(
            student_t_quantile(level, 2.0).unwrap(),
            two,
            SPECIAL_FUNCTION,
        );
    }
    for (dof, expected) in [(5.0, 2.5706), (30.0, 2.0423), (172.0, 1.9739)] {
        assert_relative(student_t_quantile(0.95, dof).unwrap(), expected, 5e-5);
    }
    assert_relative(
        student_t_quantile(0.95, 1e12).unwrap(),
        1.959_963_984_540_054,
        1e-11,
    );
}

/// `P(|T| <= t)` by Simpson's rule: with `t = sqrt(dof) tan u` the density is `cos^(dof - 1) u`.
fn student_probability(t: f64, dof: f64) -> f64 {
    let integral = |end: f64| -> f64 {
        let steps = 20_000;
        let width = end / f64::from(steps);
        let weight = |k| {
            if k == 0 || k == steps {
                1.0
            } else {
                2.0 + 2.0 * f64::from(k % 2)
            }
        };
        let value = |k| (f64::from(k) * width).cos().powf(dof - 1.0);
        (0..=steps).map(|k| weight(k) * value(k)).sum::<f64>() * width / 3.0
    };
    // For many degrees the density is a narrow peak; beyond 30 standard deviations nothing is left.
    let whole = std::f64::consts::FRAC_PI_2.min(30.0 / dof.sqrt());
    integral((t / dof.sqrt()).atan()) / integral(whole)
}

#[test]
fn student_quantile_inverts_an_independent_integral() {
    // The two methods meet at 1000 degrees of freedom: a wrong coefficient shows as a step.
    for level in [0.5, 0.95, 0.999] {
        let below = student_t_quantile(level, 1000.0 - 1e-9).unwrap();
        assert_relative(student_t_quantile(level, 1000.0).unwrap(), below, 1e-11);
    }
    for dof in [3.0, 10.0, 172.0, 999.0, 1000.0, 5e3, 1e5] {
        for level in [0.5, 0.95, 0.999] {
            let t = student_t_quantile(level, dof).unwrap();
            let tail = 1.0 - student_probability(t, dof);
            assert_relative(tail, 1.0 - level, 1e-7);
        }
    }
}

#[test]
fn wilson_interval_matches_its_published_example() {
    // Newcombe 1998, table I: 81 of 263, 15 of 148, 0 of 20, 1 of 29, level 0.95.
    let rows = [
        (81, 263, 0.2553, 0.3662),
        (15, 148, 0.0624, 0.1605),
        (0, 20, 0.0, 0.1611),
        (1, 29, 0.0061, 0.1718),
    ];
    for (successes, n, low, high) in rows {
        let found = wilson_interval(successes, n, 0.95).unwrap();
        assert!(
            (found.low - low).abs() < 6e-5 && (found.high - high).abs() < 6e-5,
            "{found:?}"
        );
    }
    let (few, many) = (
        wilson_interval(3, 10, 0.9).unwrap(),
        wilson_interval(7, 10, 0.9).unwrap(),
    );
    assert!((few.low + many.high - 1.0).abs() < 1e-14);
    assert_eq!(wilson_interval(5, 5, 0.95).unwrap().high, 1.0);
}

#[test]
fn distributions_refuse_bad_arguments() {
    assert!(matches!(
        chi_square_p_value(-1.0, 2.0),
        Err(MetricsError::OutOfRange { .. })
    ));
    assert!(matches!(
        chi_square_p_value(1.0, 0.0),
        Err(MetricsError::OutOfRange { .. })
    ));
    assert!(chi_square_p_value(f64::INFINITY, 2.0).is_err());
    assert!(chi_square_p_value(1.0, f64::NAN).is_err());
    for level in [0.0, 1.0, f64::NAN] {
        assert!(student_t_quantile(level, 3.0).is_err());
        assert!(wilson_interval(1, 2, level).is_err());
    }
    assert!(student_t_quantile(0.95, -1.0).is_err());
    assert!(matches!(
        wilson_interval(0, 0, 0.95),
        Err(MetricsError::TooFew { .. })
    ));
    assert!(matches!(
        wilson_interval(3, 2, 0.95),
        Err(MetricsError::OutOfRange { .. })
    ));
}
