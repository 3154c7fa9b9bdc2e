//! The virtual device: the one that the authors identified on their hardware, Tables 4 and 5.

use std::f64::consts::PI;

use anyhow::{Context, Result};
use haptical_model::{Device, TransmissionError};
use haptical_simulator::apply_deviations;

use crate::published::{Paper, capstan};
use crate::scenario::Scenario;

/// Joint 4 moves within this: beyond it the printed polynomial, even with its sign mended, has no
/// meaning (docs/assumptions.md).
pub(crate) const FOURTH_JOINT_RAD: f64 = 40.0 * PI / 180.0;

/// A nominal device whose fourth joint stays where the polynomial holds.
pub(crate) fn nominal(mut device: Device) -> Device {
    if let Some(joint) = device.joints.get_mut(3) {
        joint.lower_rad = -FOURTH_JOINT_RAD;
        joint.upper_rad = FOURTH_JOINT_RAD;
    }
    device
}

/// The nominal device with the errors of Tables 4 and 5; alpha0, alpha7, theta0 and d0 have none.
pub(crate) fn true_device(nominal: &Device, paper: &Paper) -> Result<Device> {
    let deviations = paper.table5.iter();
    let deviations = deviations.map(|(name, value)| (name.as_str(), *value));
    let deviations: Vec<(&str, f64)> = deviations.collect();
    let mut truth = apply_deviations(nominal, &deviations).context("assigning Table 5")?;
    let table = &paper.table4;
    for joint in 0..3 {
        let radii = [table.ro_mm[joint], table.ri_mm[joint]];
        let angles = [table.beta_o_deg[joint], table.beta_i_deg[joint]];
        let ratio = table.ratio_deviation[joint];
        let error = capstan([ratio, radii[0], angles[0], radii[1], angles[1]]);
        truth.joints[joint].transmission_error = TransmissionError::Capstan(error);
    }
    let range_rad = [-FOURTH_JOINT_RAD, FOURTH_JOINT_RAD];
    let printed = |angle| Ok(power_series(&table.k0_to_k10, angle));
    truth.joints[3].transmission_error = TransmissionError::Chebyshev {
        range_rad,
        coefficients: chebyshev(range_rad, table.k0_to_k10.len(), printed)?,
    };
    Ok(truth)
}

/// The experiment with the motor-side encoders' counts of the device file: a recording has them, the paper's
/// simulation does not.
pub(crate) fn recorded(nominal: &Device, paper: &Paper) -> Result<Scenario> {
    let mut scenario = Scenario::paper(nominal.clone(), paper, false)?;
    for (joint, from) in scenario.nominal.joints.iter_mut().zip(&nominal.joints) {
        joint.encoder_counts_per_rev = from.encoder_counts_per_rev;
    }
    scenario.truth = true_device(&scenario.nominal, paper)?;
    Ok(scenario)
}

/// Coefficients of the Chebyshev series over a range that equals a function at as many Chebyshev nodes: exact for a
/// polynomial (Press et al., Numerical Recipes, 3rd ed., eq. 5.8.7).
pub fn chebyshev(
    [low, high]: [f64; 2],
    count: usize,
    of: impl FnMut(f64) -> Result<f64>,
) -> Result<Vec<f64>> {
    let (middle, half) = ((low + high) / 2.0, (high - low) / 2.0);
    let angle = |index: usize| PI * (index as f64 + 0.5) / count as f64;
    let nodes = (0..count).map(|index| middle + half * angle(index).cos());
    let values = nodes.map(of).collect::<Result<Vec<f64>>>()?;
    let coefficient = |order: usize| {
        let terms = values.iter().enumerate();
        let terms = terms.map(|(index, value)| value * (order as f64 * angle(index)).cos());
        let share = if order == 0 { 1.0 } else { 2.0 };
        share * terms.sum::<f64>() / count as f64
    };
    Ok((0..count).map(coefficient).collect())
}

/// Value of a power series, lowest power first.
pub(crate) fn power_series(powers: &[f64], x: f64) -> f64 {
    powers.iter().rev().fold(0.0, |sum, power| sum * x + power)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenario::nominal_device;

    #[test]
    fn the_series_is_the_printed_polynomial() {
        let paper = Paper::load().unwrap();
        let nominal = nominal(nominal_device(None).unwrap());
        let truth = true_device(&nominal, &paper).unwrap();
        for step in -40..=40 {
            let angle = f64::from(step).to_radians();
            let error = truth.joints[3].error_rad(angle).unwrap();
            let printed = power_series(&paper.table4.k0_to_k10, angle);
            assert!((error - printed).abs() < 1e-14, "{step}: {error} {printed}");
        }
        // the mended sign: 21 mrad at -40 degrees, -31.5 at +40 (design study, section 2.6)
        let at = |degrees: f64| truth.joints[3].error_rad(degrees.to_radians()).unwrap();
        assert!((at(-40.0) - 0.021).abs() < 1e-3 && (at(40.0) + 0.0315).abs() < 1e-3);
    }

    #[test]
    fn a_recording_has_counts_and_a_simulation_none() {
        let paper = Paper::load().unwrap();
        let nominal = nominal(nominal_device(None).unwrap());
        let scenario = recorded(&nominal, &paper).unwrap();
        for device in [&scenario.nominal, &scenario.truth] {
            let counts = |joint: usize| device.joints[joint].encoder_counts_per_rev;
            assert!((0..7).all(|joint| counts(joint) == Some(20_000.0)));
        }
        let simulated = Scenario::paper(nominal, &paper, false).unwrap();
        assert_eq!(simulated.truth.joints[0].encoder_counts_per_rev, None);
    }

    #[test]
    fn table_5_stands_in_the_links() {
        let paper = Paper::load().unwrap();
        let nominal = nominal(nominal_device(None).unwrap());
        let truth = true_device(&nominal, &paper).unwrap();
        assert_eq!(paper.table5.len(), 28);
        assert!((truth.links[0].a_m - nominal.links[0].a_m + 4.195e-3).abs() < 1e-15);
        for parameter in ["alpha0", "alpha7", "theta0", "d0"] {
            let id = nominal.parameter(parameter).unwrap();
            assert_eq!(id.value(&truth), id.value(&nominal), "{parameter}");
        }
    }
}
