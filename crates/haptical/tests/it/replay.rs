//! A recorded motion through a model.

use haptical::data::Cells;
use haptical::prelude::*;
use haptical::replay;

const DEVICE: &str = "[[joint]]\ntransmission = \"capstan\"\ntransmission_ratio = 8.0\ndrum_distance_m = 0.0675\n\
    encoder_counts_per_rev = 20000\nexternal_encoder_counts_per_rev = 20000\n\
    [joint.transmission_error]\nchebyshev = [0.01, 0.02]\nrange_rad = [-1.0, 1.0]\n";

/// A measured value in the place of a prediction would make the model look right where it says nothing.
#[test]
fn where_nothing_is_predicted_no_measured_value_stands() {
    let device = Device::from_toml(DEVICE, "capstan.toml").unwrap();
    let read = [-0.5, 0.0, 0.5, 1.5];
    let measured = [7.0, 7.0, 7.0, 7.0];
    let columns = [
        ("theta1_rad", Cells::Numbers(&read)),
        ("out1_rad", Cells::Numbers(&measured)),
    ];
    let log = Log::from_columns(&columns, "a sweep", &device).unwrap();
    let replayed = replay(&device, &log).unwrap();
    let predicted = replayed.predicted.output[0].as_ref().unwrap();
    for (theta, own) in read[..3].iter().zip(predicted) {
        assert!((own - (theta + 0.01 + 0.02 * theta)).abs() < 1e-12, "{own}");
    }
    assert!(predicted[3].is_nan(), "{predicted:?}");
    assert!(
        replayed.warnings[0].contains("1 readings lie outside"),
        "{:?}",
        replayed.warnings
    );
    assert_eq!(replayed.residuals_csv(&log).lines().count(), 4);
}
