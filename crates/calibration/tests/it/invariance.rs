//! What is pruned does not depend on units, on the order or mixing of the rows, or on the frame.

use haptical_identification::{
    Identifiability, IdentifiabilityRules, Matrix, ParameterInfo, Reduction, Status, analyse,
};
use haptical_model::kinematics::nalgebra::{Rotation3, Vector3};
use proptest::prelude::*;

use crate::chain::{
    Columns, RIGS, ROWS, Rig, columns, generic_chain, judge, measure, pseudo_random,
};

/// Standard deviations, over changes that leave them as they are: rounding times a condition
/// number of at most 1e6.
const DEVIATION_TOLERANCE: f64 = 1e-8;

fn verdict(jacobian: &Matrix, infos: &[ParameterInfo], order: &[usize]) -> Identifiability {
    let reduction = Reduction::new(jacobian, &vec![0.0; jacobian.rows()]).unwrap();
    analyse(&reduction, infos, order, &IdentifiabilityRules::default()).unwrap()
}

fn verdict_of(columns: &Columns, jacobian: &Matrix) -> Identifiability {
    verdict(jacobian, &columns.infos, &columns.order)
}

/// A verdict as one letter for each parameter.
fn letters(judged: &Identifiability) -> String {
    judged.statuses.iter().map(letter).collect()
}

fn letter(status: &Status) -> char {
    match status {
        Status::Identifiable { .. } => 'i',
        Status::Weak { .. } => 'w',
        Status::Invisible => '0',
        Status::Dependent { .. } => 'd',
    }
}

fn deviation(status: &Status) -> Option<f64> {
    match status {
        Status::Identifiable { standard_deviation } | Status::Weak { standard_deviation } => {
            Some(*standard_deviation)
        }
        _ => None,
    }
}

/// The same verdict, with standard deviations multiplied by `factor(parameter)`.
fn same(
    before: &Identifiability,
    after: &Identifiability,
    factor: impl Fn(usize) -> f64,
) -> Result<(), TestCaseError> {
    prop_assert_eq!(letters(before), letters(after));
    prop_assert_eq!(&before.independent, &after.independent);
    for (index, (a, b)) in before.statuses.iter().zip(&after.statuses).enumerate() {
        if let (Some(a), Some(b)) = (deviation(a), deviation(b)) {
            let expected = a * factor(index);
            prop_assert!(
                (b - expected).abs() < DEVIATION_TOLERANCE * expected,
                "{}: {} instead of {}",
                before.names[index],
                b,
                expected
            );
        }
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Other units: columns divided by what the sizes are multiplied with.
    #[test]
    fn units_do_not_matter(device in generic_chain(2..=5), rig in 0..3_usize, seed: u64) {
        let found = columns(&device, &measure(&device, RIGS[rig], ROWS, seed));
        let before = verdict_of(&found, &found.jacobian);
        let unit = |column: usize| 10.0_f64.powf(6.0 * pseudo_random(seed ^ 1, column as u64));
        let scaled = Matrix::from_fn(found.jacobian.rows(), found.jacobian.columns(), |row, column| {
            found.jacobian[(row, column)] / unit(column)
        });
        let infos: Vec<ParameterInfo> = found.infos.iter().enumerate()
            .map(|(column, info)| ParameterInfo::new(
                info.name.clone(), info.unit.clone(), info.plausible_size * unit(column)))
            .collect();
        same(&before, &verdict(&scaled, &infos, &found.order), unit)?;
    }

    #[test]
    fn the_order_of_the_rows_does_not_matter(device in generic_chain(2..=5), rig in 0..3_usize, seed: u64) {
        let recording = measure(&device, RIGS[rig], ROWS, seed);
        let mut order: Vec<usize> = (0..ROWS).collect();
        order.sort_by(|&a, &b| {
            pseudo_random(seed ^ 2, a as u64).total_cmp(&pseudo_random(seed ^ 2, b as u64))
        });
        same(&judge(&device, &recording), &judge(&device, &recording.select(&order)), |_| 1.0)?;
    }

    /// Random reflections of the rows.
    #[test]
    fn orthogonal_mixing_of_the_rows_does_not_matter(device in generic_chain(2..=5), rig in 0..3_usize, seed: u64) {
        let found = columns(&device, &measure(&device, RIGS[rig], ROWS, seed));
        let mut mixed = found.jacobian.clone();
        let rows = mixed.rows();
        for reflection in 0..3 {
            let normal: Vec<f64> = (0..rows)
                .map(|row| pseudo_random(seed ^ (3 + reflection), row as u64))
                .collect();
            let square: f64 = normal.iter().map(|x| x * x).sum();
            for column in 0..mixed.columns() {
                let column = mixed.column_mut(column);
                let share: f64 = column.iter().zip(&normal).map(|(a, b)| a * b).sum();
                for (entry, part) in column.iter_mut().zip(&normal) {
                    *entry -= 2.0 * share / square * part;
                }
            }
        }
        same(&verdict_of(&found, &found.jacobian), &verdict_of(&found, &mixed), |_| 1.0)?;
    }

    /// A turn of frame (-1) about its origin, which is where the cable leaves: with d_0 = 0 it is a
    /// change of theta_0 and alpha_0.
    #[test]
    fn turning_the_base_about_the_anchor_does_not_matter(
        device in generic_chain(2..=5), turn in -3.0..3.0_f64, tilt in 0.3..1.4_f64, seed: u64,
    ) {
        let mut device = device;
        device.links[0].d_m = 0.0;
        let recording = measure(&device, Rig::Cable, ROWS, seed);
        let before = judge(&device, &recording);
        device.links[0].theta_rad += turn;
        device.links[0].alpha_rad = tilt;
        let moved = measure(&device, Rig::Cable, ROWS, seed);
        for (a, b) in recording.cable_m[0].iter().flatten().zip(moved.cable_m[0].iter().flatten()) {
            // alpha_0 with d_0 = 0 turns all but the anchor about the line through it.
            prop_assert!((a - b).abs() < 1e-14, "{} and {}", a, b);
        }
        // d_0 itself acts along the turned axis: of it only the verdict on the others counts.
        let after = judge(&device, &moved);
        for (index, name) in before.names.iter().enumerate().filter(|(_, name)| *name != "d0") {
            let (a, b) = (&before.statuses[index], &after.statuses[index]);
            prop_assert_eq!(letter(a), letter(b), "{}", name);
            if let (Status::Identifiable { standard_deviation: a }, Status::Identifiable { standard_deviation: b }) = (a, b) {
                prop_assert!((a / b - 1.0).abs() < DEVIATION_TOLERANCE, "{}: {} and {}", name, a, b);
            }
        }
    }

    /// A rigid motion of the tracker's frame mixes each row's twist: v' = R v + p x R w, w' = R w.
    #[test]
    fn moving_the_measuring_frame_does_not_matter(
        device in generic_chain(2..=5), angles in prop::array::uniform3(-3.0..3.0_f64),
        offset in prop::array::uniform3(-0.5..0.5_f64), seed: u64,
    ) {
        let found = columns(&device, &measure(&device, Rig::Pose, ROWS, seed));
        let rotation = Rotation3::from_euler_angles(angles[0], angles[1], angles[2]);
        let offset = Vector3::from(offset);
        let mut moved = found.jacobian.clone();
        for column in 0..moved.columns() {
            let entries = moved.column_mut(column);
            for row in 0..ROWS {
                let (linear, angular) = (3 * row, 3 * (ROWS + row));
                let part = |first: usize| Vector3::from_column_slice(&entries[first..first + 3]);
                let w = rotation * part(angular);
                let v = rotation * part(linear) + offset.cross(&w);
                entries[linear..linear + 3].copy_from_slice(v.as_slice());
                entries[angular..angular + 3].copy_from_slice(w.as_slice());
            }
        }
        let before = verdict_of(&found, &found.jacobian);
        let after = verdict_of(&found, &moved);
        prop_assert_eq!(letters(&before), letters(&after));
        prop_assert_eq!(before.rank, 4 * device.joints.len() + 4);
    }

    /// More rows never raise a variance.
    #[test]
    fn more_data_never_raise_a_variance(
        device in generic_chain(2..=5), rig in 0..3_usize, more in 1..60_usize, seed: u64,
    ) {
        let recording = measure(&device, RIGS[rig], ROWS + more, seed);
        let fewer: Vec<usize> = (0..ROWS).collect();
        let (before, after) = (columns(&device, &recording.select(&fewer)), columns(&device, &recording));
        // The set must be the same on both sides: a parameter that more data free costs the others.
        let kept = verdict_of(&before, &before.jacobian).independent;
        let variances = |found: &Columns| {
            let zeros = vec![0.0; found.jacobian.rows()];
            let reduction = Reduction::new(&found.jacobian, &zeros).unwrap();
            let covariance = reduction.covariance(&kept, 1e-13).unwrap();
            (0..kept.len()).map(|k| covariance[(k, k)]).collect::<Vec<f64>>()
        };
        for (k, (a, b)) in variances(&before).into_iter().zip(variances(&after)).enumerate() {
            let name = &before.infos[kept[k]].name;
            prop_assert!(b <= a * (1.0 + 1e-9), "{}: variance {} before, {} after", name, a, b);
        }
    }
}
