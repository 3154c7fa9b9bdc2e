//! Why torques, or effects on them, were not tested.

use haptical_effects::force::{GRIP_FORCE, PAYLOAD, UNBALANCED_GRAVITY};
use haptical_effects::{Follows, Hook, Need, spec};

use crate::answer::Untestable;
use crate::force::assumed::assumed;
use crate::force::{Model, grip};

/// Names of all effects on torques and forces, except those that need the motors' currents.
pub(crate) fn names() -> impl Iterator<Item = &'static str> {
    let is_on_drives = |name: &&str| {
        spec(name)
            .is_some_and(|spec| spec.hook.is_on_drives() && !spec.needs.contains(&Need::Current))
    };
    haptical_effects::names().into_iter().filter(is_on_drives)
}

/// Why torques say nothing while positions show an effect that is not in the model.
pub(super) const FALSIFIED: &str =
    "an effect on positions that is not in the model falsifies the geometry";

impl Model<'_> {
    /// Why a torque was not tested: its noise exceeds what the links alone ask of the drive. A disturbance as fast as
    /// the noise cannot be distinguished from it.
    pub(super) fn drowned(&self) -> Option<String> {
        let recorded = &self.effects.along.recorded;
        let torques = self.base.torque_nm.column_iter();
        let mut channels = recorded.noise.iter().zip(torques).enumerate();
        channels.find_map(|(channel, (noise, torque_nm))| {
            let (sd_nm, (_, unit)) = (noise.sd, recorded.named(channel));
            let rms_nm = (torque_nm.norm_squared() / torque_nm.len().max(1) as f64).sqrt();
            let column = recorded.column(recorded.channels[channel]);
            (sd_nm > rms_nm).then(|| {
                format!(
                    "the noise of {column} ({sd_nm:.3} {unit}) is larger than the torque that the model predicts \
                     ({rms_nm:.3} {unit})"
                )
            })
        })
    }

    /// Effects that need what this recording lacks, each with the reason; others can be tested.
    pub(super) fn untestable(&self) -> Vec<Untestable> {
        let recorded = &self.effects.along.recorded;
        let context = recorded.context;
        let mut untestable: Vec<Untestable> = Vec::new();
        let mut because = |name: &'static str, why: &str| {
            if !untestable.iter().any(|other| other.effect == name) {
                untestable.push(Untestable::new(name, why));
            }
        };
        let of_force = || haptical_effects::specs().filter(|spec| spec.hook == Hook::ForceSensor);
        if recorded.force_n.is_none() {
            let why = match recorded.is_held {
                true => "no columns fx_n, fy_n, fz_n: a free force of the hand is allowed for",
                false => {
                    "no columns fx_n, fy_n, fz_n, and none that sees the handle: nobody is taken to hold it"
                }
            };
            of_force().for_each(|spec| because(spec.name, why));
            because(GRIP_FORCE.name, why);
            if recorded.is_held {
                let why = "no columns fx_n, fy_n, fz_n: a hand may bear a weight";
                because(UNBALANCED_GRAVITY.name, why);
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
        if let Some(why) = &self.carried.not_tested {
            because(PAYLOAD.name, why);
        }
        let joints = 0..context.device.joints.len();
        let unseen = joints.filter(|&joint| recorded.channel(joint).is_none());
        let is_read = |joint: &usize| context.recorded_torque_nm(*joint).is_some();
        let (constant, missing): (Vec<usize>, Vec<usize>) = unseen.partition(is_read);
        let at_joints = self
            .effects
            .all
            .iter()
            .filter(|effect| effect.joint().is_some());
        if let Some(first) = constant.first() {
            let column = recorded.column(*first);
            let why = format!("{column} has one value throughout: nothing was measured there");
            at_joints
                .clone()
                .for_each(|effect| because(effect.name(), &why));
        }
        if !missing.is_empty() {
            let columns = if missing.len() == 1 {
                "column"
            } else {
                "columns"
            };
            let names: Vec<String> = missing
                .iter()
                .map(|joint| recorded.column(*joint))
                .collect();
            let why = format!("no {columns} {}", names.join(", "));
            at_joints.for_each(|effect| because(effect.name(), &why));
        }
        if !assumed(&self.effects.along)
            .iter()
            .any(|link| link.is_in_file)
        {
            let why = "no mass_kg and centre_of_mass_m in the device file";
            because(UNBALANCED_GRAVITY.name, why);
        }
        untestable
    }
}
