//! Zeros of joints that the recording does not tell from the place of a sensor or a tool, and so are no numbers of the base
//! model: against an earlier model, which has all of them, they may be what changed (docs/diagnosis.md, "Earlier model").

use haptical_effects::catalogue;
use haptical_effects::motor_encoder::ZERO_CHANGED;
use haptical_model::ParameterId;

use super::groups::{is_zero, term_name, zero_of};
use crate::engine::Engine;

/// The zero of a joint.
#[derive(Debug, Clone)]
pub(crate) struct Zero {
    /// Joint, from 0.
    pub(crate) joint: usize,
    pub(crate) parameter: ParameterId,
    /// Whitened column, per rad or m.
    pub(crate) column: Vec<f64>,
}

/// The zeros that are not among the free numbers, but those of joints whose drive has a free zero.
pub(crate) fn zeros(engine: &Engine<'_>) -> Vec<Zero> {
    let (context, base) = (&engine.context, &engine.base);
    let device = context.device;
    let is_free = |joint: usize, parameter: ParameterId| {
        base.free
            .iter()
            .any(|&position| match base.parameters[position] {
                ParameterId::Transmission { joint: of, index } if of == joint => {
                    is_zero(term_name(device, joint, index))
                }
                own => own == parameter,
            })
    };
    let effects = catalogue(device).into_iter();
    let effects = effects.filter(|effect| effect.name() == ZERO_CHANGED.name);
    let found = effects.filter_map(|effect| {
        let joint = effect.joint()?;
        let parameter = ParameterId::Link {
            row: device.own_row(joint)?,
            parameter: zero_of(device, joint)?,
        };
        if is_free(joint, parameter) {
            return None;
        }
        // from the first run on
        let signals = effect.derivative(context, &[0.0], 0.0);
        let column = engine.whole.blocks.dense(signals.first()?);
        let is_shown = column.iter().any(|entry| *entry != 0.0);
        is_shown.then_some(Zero {
            joint,
            parameter,
            column,
        })
    });
    found.collect()
}
