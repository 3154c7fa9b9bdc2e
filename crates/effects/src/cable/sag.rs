//! The cable hangs through by its weight w under the tension T: (w cos(elevation) / T)^2 L^3 / 24, the amplitude being
//! (w / T)^2. Physically negligible (docs/diagnosis.md): a fit that needs it is a warning. A cable of 1e-2 N/m under
//! 3 N has 1e-5 per m^2; ten times that is no cable.

use nalgebra::Vector3;

use crate::cable::EXIT;
use crate::laws::{Input, Law};
use crate::{Need, Parameter, Spec};

pub(crate) const SPEC: Spec = Spec {
    name: "cable-sag",
    meaning: "the measuring cable hangs through",
    inspect: "the spring's force; a real cable of this length sags far less than it shows",
    adds: "see above",
    source: "C3",
    needs: &[Need::Cable, Need::Gravity],
    parameters: &[Parameter::size("weight_n_per_m_over_tension", 0.0, 0.05)],
    is_positive: true,
    log_prior: -4.0,
    ..EXIT
};

pub(crate) const LAW: Sag = Sag;

#[derive(Debug)]
pub(crate) struct Sag;

impl Law for Sag {
    fn columns(&self, input: Input<'_, '_>, _: &[f64], _: f64) -> Option<Vec<Vec<f64>>> {
        let cable = input.context.cable.as_ref()?;
        let gravity = input.context.device.gravity_mps2.map(Vector3::from);
        let down = gravity
            .and_then(|gravity| gravity.try_normalize(1e-12))
            .unwrap_or(Vector3::zeros());
        let sags = (0..input.context.rows()).map(|row| {
            let level = 1.0 - cable.direction[row].dot(&down).powi(2);
            level * cable.length_m[row].powi(3) / 24.0
        });
        Some(vec![sags.collect()])
    }

    fn values(&self, _: Input<'_, '_>, amplitudes: &[f64], _: f64) -> Vec<f64> {
        vec![amplitudes[0].max(0.0).sqrt()]
    }

    fn amplitudes(&self, _: Input<'_, '_>, values: &[f64]) -> (Vec<f64>, f64) {
        (vec![values[0] * values[0]], 0.0)
    }
}
