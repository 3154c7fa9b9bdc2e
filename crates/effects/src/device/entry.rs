//! An effect of a device from a law with its numbers.

use haptical_model::DeviceEffect;

use crate::{Context, Effect};

/// The effect that a law with these amplitudes is, as a device file has it.
pub fn entry(
    effect: &dyn Effect,
    context: &Context<'_>,
    amplitudes: &[f64],
    shape: f64,
) -> DeviceEffect {
    let spec = effect.spec();
    let names = spec.parameters.iter().map(|own| own.name);
    let names = names.chain(spec.further.iter().map(|own| own.name));
    let values = effect.values(context, amplitudes, shape);
    let values = values
        .into_iter()
        .chain(effect.further(context, amplitudes, shape));
    DeviceEffect {
        name: spec.name.to_owned(),
        joint: effect.joint(),
        numbers: names.map(str::to_owned).zip(values).collect(),
        ..DeviceEffect::default()
    }
}
