//! The first-order formula for the transverse force, S dp, compared with the simulation with the same errors.

use anyhow::Result;
use haptical_metrics::rms;
use haptical_model::kinematics::nalgebra::Vector2;
use haptical_model::{Device, ParameterId};

use super::sample::{in_each, measured_n, poses};
use crate::scenario::Scenario;

/// Share of a parameter's error by which it is moved to find its slope.
const STEP: f64 = 1e-3;

/// Transverse forces of a controller whose errors are a share of the nominal one's, without a loop.
#[derive(Debug, Clone, Copy)]
pub(crate) struct FirstOrder {
    /// RMS over the poses as S dp predicts it \[N\].
    pub(crate) predicted_n: f64,
    /// RMS that the simulation finds \[N\].
    pub(crate) simulated_n: f64,
    /// RMS of the vectors' difference over the simulated RMS.
    pub(crate) difference: f64,
}

/// Every parameter of the true device that has an error under the nominal controller, with that error: nominal
/// minus true. A nominal transmission has no error, which is zero in every parameter of the true one's form.
fn errors(scenario: &Scenario) -> Vec<(ParameterId, f64)> {
    let (truth, nominal) = (&scenario.truth, &scenario.nominal);
    let links = truth.link_parameters(true).into_iter();
    let links = links.map(|id| (id, id.value(nominal) - id.value(truth)));
    let joints = 0..truth.joints.len();
    let transmissions = joints.flat_map(|joint| truth.transmission_parameters(joint));
    let transmissions = transmissions.map(|id| (id, -id.value(truth)));
    links
        .chain(transmissions)
        .filter(|(_, error)| *error != 0.0)
        .collect()
}

/// The true device with some parameters moved by a share of their errors.
fn moved(truth: &Device, errors: &[(ParameterId, f64)], share: f64) -> Device {
    let mut device = truth.clone();
    for (id, error) in errors {
        id.set(&mut device, id.value(truth) + share * error);
    }
    device
}

/// Prediction and simulation over the poses of one seed, for a controller with `share` of the nominal one's
/// errors.
///
/// S by central differences, parameter by parameter. Source: docs/equations.md, Force through the transposed
/// Jacobian.
pub(crate) fn first_order(scenario: &Scenario, seed: u64, share: f64) -> Result<FirstOrder> {
    let truth = &scenario.truth;
    let errors = errors(scenario);
    let recording = poses(scenario, seed)?;
    let forces = |controller: &Device| -> Result<Vec<Option<Vector2<f64>>>> {
        in_each(truth, controller, &recording, |truth, at| {
            let force = measured_n(truth, at, 0.0)?;
            Ok(force.map(|force| Vector2::new(force.x, force.y)))
        })
    };
    let simulated = forces(&moved(truth, &errors, share))?;
    let mut predicted = vec![Vector2::zeros(); simulated.len()];
    for error in &errors {
        let after = forces(&moved(truth, &[*error], STEP))?;
        let before = forces(&moved(truth, &[*error], -STEP))?;
        for ((sum, after), before) in predicted.iter_mut().zip(after).zip(before) {
            if let (Some(after), Some(before)) = (after, before) {
                *sum += (after - before) * (share / (2.0 * STEP));
            }
        }
    }
    let sizes = |size: &dyn Fn(&Vector2<f64>, &Vector2<f64>) -> f64| -> Result<f64> {
        let pairs = simulated.iter().zip(&predicted);
        let sizes: Vec<f64> = pairs
            .filter_map(|(simulated, predicted)| Some(size(&(*simulated)?, predicted)))
            .collect();
        Ok(rms(&sizes)?)
    };
    let simulated_n = sizes(&|simulated, _| simulated.norm())?;
    Ok(FirstOrder {
        predicted_n: sizes(&|_, predicted| predicted.norm())?,
        simulated_n,
        difference: sizes(&|simulated, predicted| (simulated - predicted).norm())? / simulated_n,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::truth;
    use crate::published::Paper;
    use crate::scenario::nominal_device;

    /// What first order leaves out is of second order: a tenth of the errors, a tenth of the relative
    /// difference; and the whole of them is the nominal controller.
    #[test]
    fn the_remainder_is_of_second_order() {
        let paper = Paper::load().unwrap();
        let nominal = truth::nominal(nominal_device(None).unwrap());
        let mut scenario = Scenario::paper(nominal, &paper, false).unwrap();
        scenario.truth = truth::true_device(&scenario.nominal, &paper).unwrap();
        let at = |share: f64| first_order(&scenario, 1, share).unwrap();
        let (tenth, hundredth) = (at(0.1), at(0.01));
        assert!(tenth.difference < 0.1, "{tenth:?}");
        let fall = tenth.difference / hundredth.difference;
        assert!((7.0..14.0).contains(&fall), "{tenth:?} {hundredth:?}");
        let whole = moved(&scenario.truth, &errors(&scenario), 1.0);
        let recording = poses(&scenario, 1).unwrap();
        let controllers = [&whole, &scenario.nominal];
        let (forces, _) = crate::experiment::force::sample::transverse_n(
            &scenario.truth,
            &controllers,
            &recording,
            0.0,
        )
        .unwrap();
        for (whole, nominal) in forces[0].iter().zip(&forces[1]) {
            assert!((whole - nominal).abs() < 1e-10, "{whole} {nominal}");
        }
    }
}
