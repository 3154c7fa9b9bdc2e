//! Why torques, or effects on them, were not tested.

use haptical_effects::force::{GRIP_FORCE, PAYLOAD, UNBALANCED_GRAVITY};
use haptical_effects::{Follows, Hook};

use super::names::names;
use crate::force::assumed::assumed;
use crate::force::base::Base;
use crate::force::changes::carried::Carried;
use crate::force::effects::Effects;
use crate::force::grip;
use crate::force::recorded::Recorded;

/// Why torques say nothing while positions show an effect that is not in the model.
pub(super) const FALSIFIED: &str =
    "an effect on positions that is not in the model falsifies the geometry";

/// Torques whose noise exceeds what the links alone ask of the drive: a disturbance that is as fast as the noise cannot
/// be distinguished from it.
pub(super) fn drowned(recorded: &Recorded<'_>, base: &Base) -> Option<String> {
    let blocks = recorded.blocks.len().max(1);
    let by_model = base.torque_nm.chunks(blocks);
    let channels = recorded
        .channels
        .iter()
        .zip(&recorded.torque_sd)
        .zip(by_model);
    let mut loud = channels.filter_map(|((joint, &sd_nm), torque_nm)| {
        let square = torque_nm.iter().map(|torque| torque * torque).sum::<f64>();
        let rms_nm = (square / blocks as f64).sqrt();
        (sd_nm > rms_nm).then(|| {
            let (column, unit) = (recorded.column(*joint), recorded.context.device.joints[*joint].torque_unit());
            format!(
                "the noise of {column} ({sd_nm:.3} {unit}) is larger than the torque that the model predicts \
                 ({rms_nm:.3} {unit})"
            )
        })
    });
    loud.next()
}

/// Effects that need what this recording lacks, though others can be tested.
pub(super) fn untestable(
    effects: &Effects<'_, '_>,
    carried: &Carried,
    is_falsified: bool,
) -> Vec<(&'static str, String)> {
    let recorded = effects.along.recorded;
    let context = recorded.context;
    if is_falsified {
        return names().map(|name| (name, FALSIFIED.to_owned())).collect();
    }
    let mut untestable = Vec::new();
    let of_force = || haptical_effects::specs().filter(|spec| spec.hook == Hook::ForceSensor);
    let mut because = |name: &'static str, why: &str| {
        if !untestable.iter().any(|(other, _)| *other == name) {
            untestable.push((name, why.to_owned()));
        }
    };
    if recorded.force_n.is_none() {
        let why = match recorded.hand_is_unknown() {
            true => "no columns fx_n, fy_n, fz_n: a free force of the hand is allowed for",
            false => {
                "no columns fx_n, fy_n, fz_n, and none that sees the handle: nobody is taken to hold it"
            }
        };
        of_force().for_each(|spec| because(spec.name, why));
        because(GRIP_FORCE.name, why);
        if recorded.hand_is_unknown() {
            because(
                UNBALANCED_GRAVITY.name,
                "no columns fx_n, fy_n, fz_n: a hand may bear a weight",
            );
        }
    } else {
        if !recorded.force_varies() {
            let driven = of_force().filter(|spec| spec.follows == Follows::Force);
            driven.for_each(|spec| because(spec.name, "the hand's force is constant"));
        }
        if !grip::is_testable(recorded.channels.len()) {
            because(GRIP_FORCE.name, "fewer than five torques");
        }
    }
    if let Some(why) = &carried.changes.not_tested {
        because(PAYLOAD.name, why);
    }
    let columns = |is_wanted: &dyn Fn(usize) -> bool| -> Vec<String> {
        let joints = (0..context.device.joints.len()).filter(|&joint| is_wanted(joint));
        joints.map(|joint| recorded.column(joint)).collect()
    };
    let missing = columns(&|joint| context.recorded_torque_nm(joint).is_none());
    let constant = columns(&|joint| {
        context.recorded_torque_nm(joint).is_some() && recorded.channel(joint).is_none()
    });
    if let Some(first) = constant.first() {
        let why = format!("{first} has one value throughout: nothing was measured there");
        for effect in (effects.all.iter()).filter(|own| own.joint().is_some()) {
            because(effect.name(), &why);
        }
    }
    if !missing.is_empty() {
        let columns = if missing.len() == 1 {
            "column"
        } else {
            "columns"
        };
        let why = format!("no {columns} {}", missing.join(", "));
        for effect in &effects.all {
            if effect.joint().is_some() {
                because(effect.name(), &why);
            }
        }
    }
    if !assumed(effects.along).iter().any(|link| link.is_in_file) {
        let why = "no mass_kg and centre_of_mass_m in the device file";
        because(UNBALANCED_GRAVITY.name, why);
    }
    untestable
}
