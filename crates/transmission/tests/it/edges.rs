//! Where a transmission stops having an answer: the last argument served and the first refused.

use core::f64::consts::{FRAC_PI_2, PI};
use haptical_transmission::{Capstan, CapstanError, LawError, Parallelogram, chebyshev};

/// The direction lies within (-pi, pi]: zeros of either sign give the same one.
#[test]
fn directions_of_drums_do_not_depend_on_the_sign_of_zero() {
    let cases = [
        ([2e-4, 0.0], 0.0),
        ([2e-4, -0.0], 0.0),
        ([-2e-4, 0.0], PI),
        ([-2e-4, -0.0], PI),
        ([0.0, 2e-4], FRAC_PI_2),
        ([-0.0, -2e-4], -FRAC_PI_2),
    ];
    for (xy_m, direction_rad) in cases {
        let p = CapstanError {
            output_drum_xy_m: xy_m,
            input_drum_xy_m: xy_m,
            ..CapstanError::default()
        };
        assert_eq!(p.output_drum_polar(), (2e-4, direction_rad), "{xy_m:?}");
        assert_eq!(p.input_drum_polar(), (2e-4, direction_rad), "{xy_m:?}");
    }
    for xy_m in [[0.0, 0.0], [-0.0, 0.0], [0.0, -0.0], [-0.0, -0.0]] {
        let p = CapstanError {
            output_drum_xy_m: xy_m,
            ..CapstanError::default()
        };
        assert_eq!(p.output_drum_polar(), (0.0, 0.0), "{xy_m:?}");
    }
}

/// R + R_e of one spacing of the numbers near R has a sign by chance; of a few it has not.
#[test]
fn a_ratio_cancelled_up_to_rounding_is_refused_whatever_its_size() {
    for ratio in [1e-3, 0.3, 8.0, -8.0, 1e5_f64] {
        let drive = Capstan::new(ratio, 0.1, 0.1).unwrap();
        let error = |left: f64| {
            let p = CapstanError {
                ratio_deviation: -ratio * (1.0 - left),
                ..CapstanError::default()
            };
            drive.error(&p, 0.1)
        };
        for left in [0.0, 1.2e-16] {
            let refused = error(left);
            assert!(
                matches!(refused, Err(LawError::SingularRatio { .. })),
                "{ratio}, {left:e}: {refused:?}"
            );
        }
        assert!(error(1e-14).is_ok(), "{ratio}");
    }
}

/// An end may be as large as a number can be, but the width must be a number.
#[test]
fn ranges_are_refused_for_their_width_alone() {
    assert!(chebyshev::check([1e308, 1.7e308], &[0.1]).is_ok());
    assert!(chebyshev::check([-1.7e308, -1e308], &[0.1]).is_ok());
    for range_rad in [[-1e308, 1e308], [0.0, 0.0], [1.0, 0.5], [f64::NAN, 1.0]] {
        assert!(
            matches!(
                chebyshev::check(range_rad, &[0.1]),
                Err(LawError::InvalidRange { .. })
            ),
            "{range_rad:?}"
        );
    }
}

/// AC is 0.5 m at home, as long as the other two bars but for an excess; the three add up to 1 m. An excess of
/// 1e-9 of that is refused.
#[test]
fn a_stretched_triangle_is_refused_by_its_part_of_the_perimeter() {
    for scale in [1e-3, 1.0, 1e3] {
        let home = |excess_m: f64| {
            Parallelogram::new([0.3, 0.4, 0.3 + excess_m, 0.2].map(|length_m| length_m * scale))
        };
        assert!(home(2e-9).is_ok(), "{scale}");
        let refused = home(0.5e-9);
        assert!(
            matches!(refused, Err(LawError::SingularLoop { .. })),
            "{scale}: {refused:?}"
        );
    }
}
