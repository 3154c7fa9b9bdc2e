//! Each error variant once with its data, and finite answers or errors for any finite input.

use haptical_transmission::{Capstan, CapstanError, CapstanParallelogram, LawError, Parallelogram};
use proptest::prelude::*;

fn drive() -> Capstan {
    Capstan::new(8.0, 0.1, 0.02).unwrap()
}

#[test]
fn capstan_constructor() {
    let refused = Capstan::new(0.0, 0.1, 0.1).unwrap_err();
    assert!(matches!(refused, LawError::OutOfRange { value: 0.0, .. }));
    for (distance_m, denominator_m) in [(0.0, 0.1), (0.1, -0.1)] {
        let refused = Capstan::new(8.0, distance_m, denominator_m).unwrap_err();
        assert!(matches!(refused, LawError::OutOfRange { .. }), "{refused}");
    }
    for at in 0..3 {
        let mut numbers = [8.0, 0.1, 0.1];
        numbers[at] = f64::NAN;
        let [ratio, distance_m, denominator_m] = numbers;
        let refused = Capstan::new(ratio, distance_m, denominator_m).unwrap_err();
        assert!(matches!(refused, LawError::NonFinite { .. }), "{refused}");
    }
    let capstan = drive();
    assert_eq!(capstan.transmission_ratio(), 8.0);
    assert_eq!(capstan.drum_distance_m(), 0.1);
    assert_eq!(capstan.input_drum_denominator_m(), 0.02);
}

#[test]
fn cancelled_ratio() {
    let p = CapstanError {
        ratio_deviation: -8.0,
        ..CapstanError::default()
    };
    assert_eq!(
        drive().error(&p, 0.1),
        Err(LawError::SingularRatio {
            transmission_ratio: 8.0,
            ratio_deviation: -8.0
        })
    );
}

#[test]
fn eccentricity_up_to_its_own_denominator() {
    let output = CapstanError {
        output_drum_xy_m: [0.06, 0.08],
        ..CapstanError::default()
    };
    assert_eq!(
        drive().error(&output, 0.1),
        Err(LawError::EccentricityTooLarge {
            drum: "output",
            eccentricity_m: 0.1,
            denominator_m: 0.1
        })
    );
    // less than the drum distance, but not than the input drum's denominator
    let input = CapstanError {
        input_drum_xy_m: [0.0, -0.05],
        ..CapstanError::default()
    };
    assert_eq!(
        drive().error(&input, 0.1),
        Err(LawError::EccentricityTooLarge {
            drum: "input",
            eccentricity_m: 0.05,
            denominator_m: 0.02
        })
    );
    let inside = CapstanError {
        output_drum_xy_m: [0.06, 0.079],
        ..CapstanError::default()
    };
    assert!(drive().error(&inside, 0.1).is_ok());
}

#[test]
fn numbers_that_are_not_finite() {
    for at in 0..6 {
        let mut parameters = [0.0; 6];
        parameters[at] = f64::INFINITY;
        let refused = drive()
            .error(&CapstanError::from_array(parameters), 0.1)
            .unwrap_err();
        let LawError::NonFinite { quantity, .. } = refused else {
            panic!("{refused}")
        };
        assert_eq!(quantity, CapstanError::PARAMETER_NAMES[at]);
    }
    assert!(drive().error(&CapstanError::default(), f64::NAN).is_err());
    // R theta overflows
    assert!(drive().error(&CapstanError::default(), f64::MAX).is_err());
}

#[test]
fn loops_that_do_not_exist() {
    for lengths_m in [[0.18, 0.0, 0.18, 0.076], [0.18, 0.076, -0.18, 0.076]] {
        let refused = Parallelogram::new(lengths_m).unwrap_err();
        assert!(matches!(refused, LawError::OutOfRange { .. }), "{refused}");
    }
    assert!(Parallelogram::new([f64::NAN, 0.1, 0.1, 0.1]).is_err());
    // AC = 0.195 at home, longer than both other bars together
    let short_m = [0.18, 0.076, 0.09, 0.076];
    assert_eq!(
        Parallelogram::new(short_m),
        Err(LawError::OpenLoop {
            lengths_m: short_m,
            theta_a_rad: 0.0
        })
    );
    // 3-4-5: AC = 0.5 = 0.3 + 0.2, a line
    let line_m = [0.3, 0.4, 0.3, 0.2];
    assert_eq!(
        Parallelogram::new(line_m),
        Err(LawError::SingularLoop {
            lengths_m: line_m,
            theta_a_rad: 0.0
        })
    );
}

#[test]
fn loops_that_open_or_fold_on_the_way() {
    let joint = Parallelogram::new([0.18, 0.076, 0.18, 0.076]).unwrap();
    let deviations_m = [0.0, 0.0, 0.0, -0.05];
    let lengths_m = [0.18, 0.076, 0.18, 0.076 - 0.05];
    // towards +pi/2 AC shrinks to L1 - L2 = 0.104, less than L3 - L4 = 0.154
    assert_eq!(
        joint.error(&deviations_m, 1.2),
        Err(LawError::OpenLoop {
            lengths_m,
            theta_a_rad: 1.2
        })
    );
    for theta_a_rad in [core::f64::consts::FRAC_PI_2, -1.6, 6.3] {
        let refused = joint.error(&[0.0; 4], theta_a_rad).unwrap_err();
        assert!(
            matches!(refused, LawError::SingularLoop { .. }),
            "{refused}"
        );
    }
    let negative = joint.error(&[0.0, -0.08, 0.0, 0.0], 0.1).unwrap_err();
    assert!(
        matches!(negative, LawError::OutOfRange { .. }),
        "{negative}"
    );
}

#[test]
fn errors_can_cross_threads_and_say_what_was_wrong() {
    fn check<T: core::error::Error + Send + Sync + 'static>(error: &T) -> String {
        error.to_string()
    }
    let p = CapstanError {
        ratio_deviation: -8.0,
        ..CapstanError::default()
    };
    assert_eq!(
        check(&drive().error(&p, 0.1).unwrap_err()),
        "ratio deviation -8 cancels the transmission ratio 8"
    );
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn finite_input_gives_finite_output_or_an_error(
        device in [prop::num::f64::NORMAL; 3],
        parameters in [prop::num::f64::NORMAL; 6],
        lengths_m in [prop::num::f64::NORMAL; 4],
        deviations_m in [prop::num::f64::NORMAL; 4],
        theta in prop_oneof![prop::num::f64::NORMAL, -2.0..2.0f64],
        sane in any::<[bool; 3]>(),
    ) {
        // each group is either any number at all or one that passes the first checks
        let device = if sane[0] { [12.0, 0.0975, 0.0975] } else { device.map(f64::abs) };
        let parameters = if sane[1] { [1e-3, 0.1, 1e-4, 0.0, 0.0, 1e-6] } else { parameters };
        let (lengths_m, deviations_m) =
            if sane[2] { ([0.18, 0.076, 0.18, 0.076], [1e-3; 4]) } else { (lengths_m, deviations_m) };
        let p = CapstanError::from_array(parameters);
        let finite = |value: f64, slope: f64, derivatives: &[f64]| {
            value.is_finite() && slope.is_finite() && derivatives.iter().all(|d| d.is_finite())
        };
        let capstan = Capstan::new(device[0], device[1], device[2]);
        let parallelogram = Parallelogram::new(lengths_m);
        if let Ok(e) = capstan.and_then(|c| c.evaluate(&p, theta)) {
            prop_assert!(finite(e.value_rad, e.slope, &e.derivatives));
        }
        if let Ok(e) = parallelogram.and_then(|l| l.evaluate(&deviations_m, theta)) {
            prop_assert!(finite(e.value_rad, e.slope, &e.derivatives));
        }
        if let (Ok(capstan), Ok(parallelogram)) = (capstan, parallelogram) {
            let joint = CapstanParallelogram { capstan, parallelogram };
            if let Ok(e) = joint.evaluate(&p, &deviations_m, theta) {
                prop_assert!(finite(e.value_rad, e.slope, &e.derivatives));
            }
        }
    }
}
