//! Hysteresis: play with a soft contact, bristles, Bouc-Wen and Maxwell-slip loops.

use crate::effects::added::{Added, Law, Place};
use crate::effects::{Draw, Effect, Facts};
use crate::laws::{SlipElement, bouc_wen, dahl, maxwell_slip};
use crate::rig::scene::Scene;

/// Names of play and of a loop: with a soft contact one passes into the other.
const LOOPS: [&str; 2] = ["backlash", "hysteresis"];

/// The shape of a loop from -1 to 1 over the travel since reversal.
#[derive(Debug, Clone)]
enum Shape {
    /// Slip elements (weights sum to 1), widths relative to the loop's.
    MaxwellSlip(Vec<SlipElement>),
    /// Bristles.
    Dahl,
    /// Bouc-Wen with exponent and share.
    BoucWen(f64, f64),
}

/// A loop of an amplitude and a width.
#[derive(Debug)]
struct Loop {
    amplitude: f64,
    width: f64,
    shape: Shape,
    /// Names of the parameters: amplitude (times the factor), width.
    names: [(&'static str, f64); 2],
}

impl Law for Loop {
    fn deviation(&self, _scene: &Scene<'_>, _place: Place, signal: &[f64]) -> Vec<f64> {
        let mut values = match &self.shape {
            Shape::MaxwellSlip(elements) => {
                let scaled: Vec<SlipElement> = elements
                    .iter()
                    .map(|element| SlipElement {
                        width: element.width * self.width,
                        ..*element
                    })
                    .collect();
                maxwell_slip(signal, &scaled)
            }
            Shape::Dahl => dahl(signal, self.width),
            Shape::BoucWen(exponent, share) => bouc_wen(signal, self.width, *exponent, *share),
        };
        values.iter_mut().for_each(|value| *value *= self.amplitude);
        values
    }

    fn facts(&self, _scene: &Scene<'_>, _place: Place) -> Facts {
        let mut facts = Facts::default()
            .law("amplitude", self.amplitude)
            .law("width", self.width);
        for ((name, factor), value) in self.names.iter().zip([self.amplitude, self.width]) {
            if *factor != 0.0 {
                facts = facts.with(name, factor * value);
            }
        }
        facts
    }
}

/// Weights and relative widths of three slip elements around 1.
fn three_elements(draw: &mut Draw<'_>) -> Vec<SlipElement> {
    let weights = [(); 3].map(|()| draw.random.uniform(0.5, 1.5));
    let sum: f64 = weights.iter().sum();
    let spread = draw.random.uniform(1.5, 2.5);
    weights
        .iter()
        .zip([1.0 / spread, 1.0, spread])
        .map(|(weight, width)| SlipElement {
            weight: weight / sum,
            width,
        })
        .collect()
}

/// Play of a total width: the contact is soft, so that the crossing takes a little longer on some
/// flanks than on others (slip elements), or is rounded (bristles).
pub(crate) fn backlash(draw: &mut Draw<'_>) -> Box<dyn Effect> {
    let strong_rad = draw.coarseness() * draw.random.around(1.2e-3, 3.0);
    let shape = if draw.random.unit() < 0.6 {
        Shape::MaxwellSlip(three_elements(draw))
    } else {
        Shape::Dahl
    };
    let law = Loop {
        amplitude: 0.5 * strong_rad * draw.size,
        width: 0.5 * strong_rad * draw.random.uniform(1.0, 3.0),
        shape,
        names: [("width_rad", 2.0), ("", 0.0)],
    };
    let info = draw.at_joint("backlash", &LOOPS);
    Added::boxed(info, Place::Upstream(draw.joint), law)
}

/// A smooth loop of rolling contacts with transitions of 0.05 to 0.3 rad.
pub(crate) fn hysteresis(draw: &mut Draw<'_>) -> Box<dyn Effect> {
    let amplitude = draw.coarseness() * draw.amplitude(0.8e-3);
    let width = draw.random.around(0.12, 4.0);
    let shape = if draw.random.unit() < 0.5 {
        Shape::BoucWen(draw.random.uniform(1.0, 1.8), draw.random.uniform(0.5, 0.9))
    } else {
        Shape::MaxwellSlip(three_elements(draw))
    };
    let law = Loop {
        amplitude,
        width,
        shape,
        names: [("amplitude_rad", 1.0), ("", 0.0)],
    };
    let info = draw.at_joint("hysteresis", &LOOPS);
    Added::boxed(info, Place::Upstream(draw.joint), law)
}

/// Wind-up of the external encoder's coupling: its shaft stays behind.
pub(crate) fn external_windup(draw: &mut Draw<'_>) -> Box<dyn Effect> {
    let law = Loop {
        amplitude: -draw.amplitude(0.8e-3),
        width: draw.random.around(0.02, 5.0),
        shape: Shape::MaxwellSlip(three_elements(draw)),
        names: [("amplitude_rad", -1.0), ("", 0.0)],
    };
    let info = draw.at_joint("external-encoder-windup", &["external-encoder-windup"]);
    Added::boxed(info, Place::External(draw.joint), law)
}

/// Friction of the measuring cable: its drum reads less while the cable is drawn out.
pub(crate) fn cable_hysteresis(draw: &mut Draw<'_>) -> Box<dyn Effect> {
    let law = Loop {
        amplitude: -draw.amplitude(120e-6),
        width: draw.random.around(3e-3, 5.0),
        shape: Shape::MaxwellSlip(three_elements(draw)),
        names: [("amplitude_m", -1.0), ("", 0.0)],
    };
    let info = draw.anywhere("cable-hysteresis", &["cable-hysteresis"]);
    Added::boxed(info, Place::Cable, law)
}
