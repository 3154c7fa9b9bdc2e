//! What the laws of a device's own effects leave: a spring hardens, a loop has no single form.

use haptical_calibration::{Weights, channel_residuals};
use haptical_effects::base_model::{JOINT_OFFSET, LINK_GEOMETRY, PARALLELOGRAM_ERROR};
use haptical_effects::transmission::{DRUM_ECCENTRICITY, RATIO_ERROR};
use haptical_effects::{Context, spec};
use haptical_model::{Device, DeviceEffect, Recording};

use crate::answer::{CauseAnswer, ChannelGap, Diagnosis, Gap, Verdict};
use crate::engine::base::Base;
use crate::force::examine;
use crate::{DiagnosisError, Options};

/// The answer on a device with effects of its own: what is left is no gap where it is no more than what their laws get wrong,
/// and nothing explains it but numbers of the base model and other laws of what the effects are: a loop beside a play.
///
/// A law is right up to a share of the squares that its effect has beyond noise ([`haptical_effects::LawError`]); these are what a
/// device without the effects, fitted to the same recording, leaves. `device` and `recording` are without effects.
///
/// # Errors
/// [`DiagnosisError`] where the device without effects cannot be fitted.
pub(crate) fn within_laws(
    found: Diagnosis,
    own_effects: &[DeviceEffect],
    (device, recording): (&Device, &Recording),
    options: &Options<'_>,
) -> Result<Diagnosis, DiagnosisError> {
    let of_base = [
        LINK_GEOMETRY.name,
        JOINT_OFFSET.name,
        PARALLELOGRAM_ERROR.name,
        DRUM_ECCENTRICITY.name,
        RATIO_ERROR.name,
    ];
    // the same law with another size is no error of the law
    let is_known = |cause: &CauseAnswer| {
        let is_own = cause.earlier.is_empty() && own_effects.iter().any(|own| is_kin(own, cause));
        of_base.contains(&cause.effect.as_str()) || is_own
    };
    // which of several effects it is, and where, is open: one of the family of an effect of the device may be it
    let may_be_known = |cause: &CauseAnswer| {
        let rivals = cause.confusable_with.iter().map(String::as_str);
        let mut class = std::iter::once(cause.effect.as_str()).chain(rivals);
        class.any(|name| {
            of_base.contains(&name) || own_effects.iter().any(|own| is_of_family(own, name))
        })
    };
    let is_open = match found.verdict {
        Verdict::NoGap => false,
        Verdict::Unknown => true,
        Verdict::Ambiguous => found.causes.first().is_none_or(may_be_known),
        Verdict::Named => found.causes.iter().all(is_known),
    };
    if !is_open || own_effects.is_empty() {
        return Ok(found);
    }
    // torques and other channels each by themselves, if they have a gap: the laws of one leave nothing in the other
    let channels = found.gap.channels.clone();
    let (torques, others): (Vec<&ChannelGap>, Vec<&ChannelGap>) = (channels.iter())
        .filter(|channel| channel.rms_before.is_finite())
        .partition(|channel| channel.channel.starts_with("torque"));
    let has_gap = |channels: &[&ChannelGap]| channels.iter().any(|channel| channel.has_gap);
    let by_torques = has_gap(&torques);
    let by_others = has_gap(&others) || (!by_torques && !others.is_empty());
    let mut share: Option<f64> = None;
    for (own, is_asked, is_on_drives) in [(torques, by_torques, true), (others, by_others, false)] {
        if !is_asked {
            continue;
        }
        let without = match is_on_drives {
            true => torques_without(device, recording)?,
            false => channels_without(device, recording, options)?,
        };
        let left = share_left(&own, &without);
        let laws = own_effects.iter().filter_map(|own| spec(&own.name));
        let laws = laws.filter(|spec| spec.hook.is_on_drives() == is_on_drives);
        let allowed = laws.map(|spec| spec.law_error.share).fold(0.0, f64::max);
        if left > allowed {
            return Ok(found);
        }
        share = Some(share.unwrap_or(0.0).max(left));
    }
    if share.is_none() {
        return Ok(found);
    }
    Ok(Diagnosis {
        verdict: Verdict::NoGap,
        gap: Gap::new(Verdict::NoGap, None, channels),
        place: None,
        causes: Vec::new(),
        absorbed: None,
        unexplained_share: 0.0,
        closed_unseen_share: None,
        probability_unknown: 0.0,
        candidates: Vec::new(),
        next_experiment: None,
        traces: Vec::new(),
        steps: Vec::new(),
        correction: None,
        correction_refused: None,
        corrected: None,
        own_effects_leave: share,
        ..found
    })
}

/// Name, rows and root mean square of what a device without the effects leaves of a channel.
type Without = (String, f64, f64);

fn channels_without(
    device: &Device,
    recording: &Recording,
    options: &Options<'_>,
) -> Result<Vec<Without>, DiagnosisError> {
    let base = Base::fit(device, recording, options.loss, &options.interrupt)?;
    let weights = Weights::stated(&base.device, &base.channels);
    let (own, model) = (&base.device, &base.channels);
    let residuals = channel_residuals(own, own, recording, model, &weights)?;
    let of_channel = |own: &haptical_calibration::ChannelResiduals| {
        let rms = own.rms().unwrap_or(0.0);
        (own.channel.name(), own.residuals.len() as f64, rms)
    };
    Ok(residuals.iter().map(of_channel).collect())
}

/// The same of torques, whose base model has as many blocks of each.
fn torques_without(device: &Device, recording: &Recording) -> Result<Vec<Without>, DiagnosisError> {
    let context = Context::new(device, recording, &[])?;
    let found = examine(&context, &[])?.channels.into_iter();
    Ok(found
        .map(|own| (own.channel, 1.0, own.rms_before))
        .collect())
}

/// Share of the squares beyond noise that is left of what the device without the effects leaves.
fn share_left(channels: &[&ChannelGap], without: &[Without]) -> f64 {
    let (mut left, mut whole) = (0.0, 0.0);
    for channel in channels {
        let mut own = without.iter().filter(|(name, ..)| *name == channel.channel);
        let Some((_, count, rms)) = own.next() else {
            continue;
        };
        let beyond = |rms: f64| count * ((rms / channel.noise_floor).powi(2) - 1.0).max(0.0);
        left += beyond(channel.rms_before);
        whole += beyond(*rms);
    }
    left / f64::max(whole, 1e-300)
}

/// Whether an effect is of the family of one of the device.
fn is_of_family(own: &DeviceEffect, name: &str) -> bool {
    let (Some(mine), Some(theirs)) = (spec(&own.name), spec(name)) else {
        return false;
    };
    mine.family == theirs.family
}

/// Whether a cause is another law of what an effect of the device is: of the same kind at the same place.
fn is_kin(own: &DeviceEffect, cause: &CauseAnswer) -> bool {
    let joint = own.joint.map(|joint| joint + 1);
    let (Some(mine), Some(theirs)) = (spec(&own.name), spec(&cause.effect)) else {
        return false;
    };
    joint == cause.joint && (mine.is_kin_of(theirs) || mine.name == theirs.name)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn own(name: &str, joint: Option<usize>) -> DeviceEffect {
        DeviceEffect {
            name: name.to_owned(),
            joint,
            ..DeviceEffect::default()
        }
    }

    #[test]
    fn a_delay_of_all_encoders_may_be_one_of_a_joint_and_no_spring() {
        let late = own("encoder-latency", None);
        assert!(is_of_family(&late, "viscous-lag"));
        assert!(!is_of_family(&late, "capstan-compliance"));
        assert!(!is_of_family(&late, "no-such-effect"));
    }

    /// Of one kind at one place are a play and a loop, two bends of a cable, two slow changes of one cable, and a spring that
    /// is another one; not a joint's and its neighbour's, nor a delay beside a play.
    #[test]
    fn another_law_of_an_effect_is_kin_to_it() {
        for (mine, joint, theirs, at, is_one) in [
            ("hysteresis", Some(1), "backlash", Some(1), true),
            ("hysteresis", Some(1), "backlash", Some(2), false),
            ("cable-twist", None, "cable-zero-offset", None, true),
            ("cable-drift", None, "thermal-drift", None, true),
            (
                "joint-compliance",
                Some(0),
                "joint-compliance",
                Some(0),
                true,
            ),
            (
                "joint-compliance",
                Some(0),
                "joint-compliance",
                Some(1),
                false,
            ),
            ("backlash", Some(1), "viscous-lag", Some(1), false),
            (
                "cross-coupling",
                Some(1),
                "coupled-backlash",
                Some(1),
                false,
            ),
        ] {
            let cause = CauseAnswer::named(theirs, at, 1.0);
            assert_eq!(is_kin(&own(mine, joint), &cause), is_one, "{mine} {theirs}");
        }
    }
}
