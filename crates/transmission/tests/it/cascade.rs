//! The capstan that drives a parallelogram: 60-digit numbers, order of the cascade, zero at home.

use crate::fixture::{assert_all_close, assert_close, rows, take};
use haptical_transmission::{Capstan, CapstanError, CapstanParallelogram, Parallelogram};

/// Roundings of angles of order 1.
const ROUNDING_RAD: f64 = 5e-15;

fn joint(ratio: f64) -> CapstanParallelogram {
    CapstanParallelogram {
        capstan: Capstan::new(ratio, 0.0975, 0.0975).unwrap(),
        parallelogram: Parallelogram::new([0.18, 0.076, 0.18, 0.076]).unwrap(),
    }
}

#[test]
fn agrees_with_sixty_digit_numbers() {
    for row in rows(include_str!("../fixtures/cascade.csv")) {
        let [ratio, distance_m, denominator_m] = take(&row, 0);
        let joint = CapstanParallelogram {
            capstan: Capstan::new(ratio, distance_m, denominator_m).unwrap(),
            parallelogram: Parallelogram::new(take(&row, 9)).unwrap(),
        };
        let p = CapstanError::from_array(take(&row, 3));
        let all = joint.evaluate(&p, &take(&row, 13), row[17]).unwrap();
        assert_close(all.value_rad, row[18], ROUNDING_RAD, "value");
        assert_close(all.slope, row[19], 1e-13, "slope");
        let smallest = 1.0 / denominator_m;
        assert_all_close(
            &all.derivatives,
            &take::<10>(&row, 20),
            1e-13,
            smallest,
            "derivatives",
        );
        assert_eq!(
            joint.error(&p, &take(&row, 13), row[17]).unwrap(),
            all.value_rad
        );
    }
}

#[test]
fn the_loop_is_driven_by_the_capstans_output() {
    // A ratio that is wrong by half makes the order visible: e_c(0.6) = -0.2, so the loop sees 0.4.
    let p = CapstanError {
        ratio_deviation: 6.0,
        ..CapstanError::default()
    };
    let deviations_m = [0.0, -0.004, 0.0, 0.0];
    let joint = joint(12.0);
    let at_output = joint.parallelogram.error(&deviations_m, 0.4).unwrap();
    let got = joint.error(&p, &deviations_m, 0.6).unwrap();
    assert_close(got, -0.2 + at_output, ROUNDING_RAD, "cascade");
    let at_encoder = joint.parallelogram.error(&deviations_m, 0.6).unwrap();
    assert!(
        (at_encoder - at_output).abs() > 0.01,
        "the test must tell the orders apart"
    );
}

#[test]
fn home_has_no_error_but_the_offset() {
    let deviations_m = [-0.0005, -0.0007, 0.0003, 0.0];
    let mut p = CapstanError::from_polar(0.0, 0.02, 1e-4, -0.7, 2e-6, -2.1);
    assert_eq!(joint(12.0).error(&p, &deviations_m, 0.0).unwrap(), 0.0);
    p.offset_rad = 0.004;
    let par = joint(12.0)
        .parallelogram
        .error(&deviations_m, 0.004)
        .unwrap();
    assert_eq!(
        joint(12.0).error(&p, &deviations_m, 0.0).unwrap(),
        0.004 + par
    );
}
