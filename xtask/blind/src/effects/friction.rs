//! Hysteresis: play with a soft contact, bristles, Bouc-Wen and Maxwell-slip loops.

use crate::effects::{Draw, Effect, Facts, Info, Stage, fixed};
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

/// A loop of an amplitude, a width and a shape; the truth calls the amplitude by a name, times a factor.
fn looped(
    info: Info,
    stage: Stage,
    (amplitude, width): (f64, f64),
    shape: Shape,
    (name, factor): (&'static str, f64),
) -> Effect {
    let law = move |_: &Scene<'_>, signal: &[f64]| {
        let mut values = match &shape {
            Shape::MaxwellSlip(elements) => {
                maxwell_slip(signal, &SlipElement::widened(elements, width))
            }
            Shape::Dahl => dahl(signal, width),
            Shape::BoucWen(exponent, share) => bouc_wen(signal, width, *exponent, *share),
        };
        values.iter_mut().for_each(|value| *value *= amplitude);
        values
    };
    let facts = Facts::default()
        .laws(named!(amplitude, width))
        .with(name, factor * amplitude);
    Effect::added(info, stage, fixed(facts), law)
}

/// Weights and relative widths of three slip elements around 1.
fn three_elements(draw: &mut Draw<'_>) -> Shape {
    let weights = [(); 3].map(|()| draw.random.uniform(0.5, 1.5));
    let spread = draw.random.uniform(1.5, 2.5);
    Shape::MaxwellSlip(SlipElement::three(weights, spread))
}

/// Play of a total width: the contact is soft, so that the crossing takes a little longer on some
/// flanks than on others (slip elements), or is rounded (bristles).
pub(crate) fn backlash(draw: &mut Draw<'_>) -> Effect {
    let strong_rad = draw.coarseness() * draw.random.around(1.2e-3, 3.0);
    let shape = match draw.random.unit() < 0.6 {
        true => three_elements(draw),
        false => Shape::Dahl,
    };
    let amplitude = 0.5 * strong_rad * draw.size;
    let width = 0.5 * strong_rad * draw.random.uniform(1.0, 3.0);
    let info = draw.at_joint("backlash", &LOOPS);
    let size = (amplitude, width);
    looped(info, Stage::Upstream, size, shape, ("width_rad", 2.0))
}

/// A smooth loop of rolling contacts with transitions of 0.05 to 0.3 rad.
pub(crate) fn hysteresis(draw: &mut Draw<'_>) -> Effect {
    let amplitude = draw.coarseness() * draw.amplitude(0.8e-3);
    let width = draw.random.around(0.12, 4.0);
    let shape = match draw.random.unit() < 0.5 {
        true => Shape::BoucWen(draw.random.uniform(1.0, 1.8), draw.random.uniform(0.5, 0.9)),
        false => three_elements(draw),
    };
    let info = draw.at_joint("hysteresis", &LOOPS);
    let size = (amplitude, width);
    looped(info, Stage::Upstream, size, shape, ("amplitude_rad", 1.0))
}

/// Wind-up of the external encoder's coupling: its shaft stays behind.
pub(crate) fn external_windup(draw: &mut Draw<'_>) -> Effect {
    let amplitude = -draw.amplitude(0.8e-3);
    let width = draw.random.around(0.02, 5.0);
    let shape = three_elements(draw);
    let info = draw.at_joint("external-encoder-windup", &["external-encoder-windup"]);
    let size = (amplitude, width);
    looped(info, Stage::External, size, shape, ("amplitude_rad", -1.0))
}

/// Friction of the measuring cable: its drum reads less while the cable is drawn out.
pub(crate) fn cable_hysteresis(draw: &mut Draw<'_>) -> Effect {
    let amplitude = -draw.amplitude(120e-6);
    let width = draw.random.around(3e-3, 5.0);
    let shape = three_elements(draw);
    let info = draw.anywhere("cable-hysteresis", &["cable-hysteresis"]);
    let size = (amplitude, width);
    looped(info, Stage::Cable, size, shape, ("amplitude_m", -1.0))
}
