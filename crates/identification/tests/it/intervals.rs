//! Standard deviations, intervals, correlations and refused values.

use haptical_identification::{
    IdentificationError, Matrix, NoiseScale, Reduction, Status, estimates, uncertainty,
};

use crate::support::{judge, named, reduce};

const ROUNDING: f64 = 1e-12;

/// y = a + b t at t = 0..4: the textbook line.
fn line() -> (Matrix, Vec<f64>) {
    let matrix = Matrix::from_fn(5, 2, |row, column| [1.0, row as f64][column]);
    (matrix, vec![1.0, 3.2, 4.9, 7.1, 8.8])
}

#[test]
fn line_through_five_points() {
    let (matrix, y) = line();
    let reduction = Reduction::new(&matrix, &y).unwrap();
    let step = reduction.solve(&[0, 1], 0.0, 1e-12).unwrap();
    // Mean of t 2, sum of squares 10, of products 19.5, of squared deviations of y 38.1.
    assert!((step.values[1] - 1.95).abs() < ROUNDING);
    assert!((step.values[0] - 1.1).abs() < ROUNDING);
    let cost = 0.075;
    assert!((step.residual_square - cost).abs() < ROUNDING);

    let stated = uncertainty(&reduction, &[0, 1], cost, NoiseScale::Stated).unwrap();
    assert!((stated.standard_deviation(1) - 0.1_f64.sqrt()).abs() < ROUNDING);
    assert!((stated.standard_deviation(0) - 0.6_f64.sqrt()).abs() < ROUNDING);
    // -mean / sqrt(mean^2 + 10/5)
    assert!((stated.correlation(0, 1) + (2.0 / 3.0_f64).sqrt()).abs() < ROUNDING);
    assert!((stated.half_width_95(NoiseScale::Stated) - 1.959_963_984_540_054).abs() < ROUNDING);

    let estimated = uncertainty(&reduction, &[1, 0], cost, NoiseScale::Estimated).unwrap();
    assert_eq!(estimated.degrees_of_freedom, 3);
    assert!((estimated.noise_factor - 0.025_f64.sqrt()).abs() < ROUNDING);
    assert!((estimated.standard_deviation(0) - 0.0025_f64.sqrt()).abs() < ROUNDING);
    // Student's t, 97.5 %, 3 degrees of freedom, from tables.
    let table = 3.182_446_305_284_263;
    assert!((estimated.half_width_95(NoiseScale::Estimated) - table).abs() < 1e-8);
}

#[test]
fn student_quantiles_agree_with_tables() {
    for (rows, table) in [
        (2, 12.706_204_736_432_1),
        (3, 4.302_652_729_911_28),
        (11, 2.228_138_851_964_94),
        (31, 2.042_272_456_301_24),
        (1001, 1.962_339_080_824_07),
    ] {
        let reduction = reduce(&Matrix::from_fn(rows, 1, |_, _| 1.0));
        let found = uncertainty(&reduction, &[0], 1.0, NoiseScale::Estimated).unwrap();
        let quantile = found.half_width_95(NoiseScale::Estimated);
        assert!((quantile - table).abs() < 1e-7, "{rows}: {quantile}");
    }
}

#[test]
fn an_exact_fit_still_has_correlations() {
    let (matrix, _) = line();
    let found = uncertainty(&reduce(&matrix), &[0, 1], 0.0, NoiseScale::Estimated).unwrap();
    assert_eq!(found.standard_deviation(0), 0.0);
    assert!((found.correlation(0, 1) + (2.0 / 3.0_f64).sqrt()).abs() < ROUNDING);
    assert_eq!(found.correlation(1, 1), 1.0);
}

#[test]
fn no_variance_without_warrant() {
    let deficient = Matrix::from_fn(6, 3, |row, column| {
        let t = row as f64 / 7.0;
        [1.0, t, 0.3 + 0.7 * t][column]
    });
    let reduction = reduce(&deficient);
    let refused = uncertainty(&reduction, &[0, 1, 2], 1.0, NoiseScale::Stated);
    assert!(matches!(
        refused,
        Err(IdentificationError::RankDeficient {
            rank: 2,
            parameters: 3
        })
    ));
    let square = reduce(&Matrix::from_fn(2, 2, |r, c| f64::from(u8::from(r == c))));
    assert!(matches!(
        uncertainty(&square, &[0, 1], 0.0, NoiseScale::Estimated),
        Err(IdentificationError::TooFewRows {
            rows: 2,
            parameters: 2
        })
    ));
    assert!(uncertainty(&square, &[0, 1], 0.0, NoiseScale::Stated).is_ok());
    for cost in [-1.0, f64::NAN, f64::INFINITY] {
        let refused = uncertainty(&square, &[0], cost, NoiseScale::Estimated);
        assert!(matches!(
            refused,
            Err(IdentificationError::Setting { name: "cost", .. })
        ));
    }
}

#[test]
fn dependent_and_invisible_parameters_get_no_value() {
    // 0 and 1 good, 2 = 0 + 1, 3 zero.
    let matrix = Matrix::from_fn(8, 4, |row, column| {
        let t = row as f64;
        [1.0, t, 1.0 + t, 0.0][column]
    });
    let judged = judge(&matrix, &[100.0; 4], &[0, 1, 2, 3]);
    let spread = uncertainty(
        &reduce(&matrix),
        &judged.independent,
        6.0,
        NoiseScale::Estimated,
    );
    let spread = spread.unwrap();
    let values = [5.0, 6.0, 7.0, 8.0];
    let table = estimates(
        &named(&[100.0; 4]),
        &values,
        &judged,
        &spread,
        NoiseScale::Estimated,
    );
    assert_eq!(table.len(), 4);
    for index in [0, 1] {
        let row = &table[index];
        assert_eq!(row.value, Some(values[index]));
        let sd = row.standard_deviation.unwrap();
        assert_eq!(sd, spread.standard_deviation(index));
        let [low, high] = row.ci95.unwrap();
        // 6 degrees of freedom: 2.446911851.
        assert!((high - low - 2.0 * 2.446_911_851 * sd).abs() < 1e-7);
        assert!((0.5 * (high + low) - values[index]).abs() < ROUNDING);
    }
    for index in [2, 3] {
        let row = &table[index];
        assert_eq!(
            (row.value, row.standard_deviation, row.ci95),
            (None, None, None)
        );
        assert_eq!(row.name, format!("p{index}"));
    }
    assert!(matches!(table[2].status, Status::Dependent { .. }));
    assert_eq!(table[3].status, Status::Invisible);

    // A variance that was asked for against the verdict does not bring the value back.
    let other = uncertainty(&reduce(&matrix), &[1, 2], 6.0, NoiseScale::Stated).unwrap();
    let table = estimates(
        &named(&[100.0; 4]),
        &values,
        &judged,
        &other,
        NoiseScale::Stated,
    );
    assert_eq!((table[2].value, table[0].value), (None, None));
    assert_eq!(table[1].value, Some(6.0));
}
