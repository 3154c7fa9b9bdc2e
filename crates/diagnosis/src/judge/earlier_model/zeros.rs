//! Zeros of joints that the recording does not tell from the place of a sensor or a tool, and so are no numbers of the base
//! model: against an earlier model, which has all of them, they may be what changed (docs/diagnosis.md, "Earlier model").

use haptical_effects::{Effect, catalogue};
use haptical_model::kinematics::Parameter;
use haptical_model::{Device, JointType, ParameterId, TransmissionKind};

use crate::engine::Engine;
use crate::engine::part::dense;

/// The effect whose law a zero that is another one throughout the recording has.
const LAW: &str = "zero-changed";

/// The zero of a joint.
#[derive(Debug, Clone)]
pub(crate) struct Zero {
    /// Joint, from 0.
    pub(crate) joint: usize,
    pub(crate) parameter: ParameterId,
    /// Whitened column, per rad or m.
    pub(crate) column: Vec<f64>,
}

/// Whether a number is the zero of a joint's drive.
fn is_zero_of_drive(device: &Device, parameter: ParameterId, joint: usize) -> bool {
    let is_parallelogram = device.joints[joint].transmission == TransmissionKind::Parallelogram;
    matches!(parameter, ParameterId::Transmission { joint: of, index: 0 } if of == joint)
        && !is_parallelogram
}

/// The zeros that are not among the free numbers, but those of joints whose drive has a free zero.
pub(crate) fn zeros(engine: &Engine<'_>) -> Vec<Zero> {
    let (context, base) = (&engine.context, &engine.base);
    let device = context.device;
    let is_free = |joint: usize, parameter: ParameterId| {
        base.free.iter().any(|&position| {
            let own = base.parameters[position];
            own == parameter || is_zero_of_drive(device, own, joint)
        })
    };
    let effects = catalogue(device).into_iter();
    let effects = effects.filter(|effect| effect.name() == LAW);
    let found = effects.filter_map(|effect: Box<dyn Effect>| {
        let joint = effect.joint()?;
        let parameter = match device.joints.get(joint)?.joint_type {
            JointType::Revolute => Parameter::Theta,
            JointType::Prismatic => Parameter::D,
        };
        let parameter = ParameterId::Link {
            row: device.own_row(joint)?,
            parameter,
        };
        if is_free(joint, parameter) {
            return None;
        }
        // from the first run on
        let signals = effect.derivative(context, &[0.0], 0.0);
        let column = dense(&engine.whole, signals.first()?);
        let is_shown = column.iter().any(|entry| *entry != 0.0);
        is_shown.then_some(Zero {
            joint,
            parameter,
            column,
        })
    });
    found.collect()
}
