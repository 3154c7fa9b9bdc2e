//! What the laws of a device's own effects leave: a spring hardens, a loop has no single form.

use haptical_calibration::{Weights, channel_residuals, channels};
use haptical_effects::device::bare;
use haptical_effects::{Absorbed, Context, Hook, spec};
use haptical_model::{Device, DeviceEffect, Recording};
use haptical_motion::is_moving_arm;

use crate::answer::{CauseAnswer, ChannelGap, Diagnosis, Gap, Verdict};
use crate::engine::Base;
use crate::force::examine;
use crate::moving::of_moving_arm;
use crate::thresholds::own_effects::LEFT_OF_CHANNEL;
use crate::{Options, Result};

/// The answer on a device with effects of its own: what is left is no gap where it is no more than what their laws get wrong,
/// and nothing explains it but numbers of the base model and other laws of what the effects are: a loop beside a play.
///
/// A law is right up to a share of the squares that its effect takes off a channel ([`haptical_effects::LawError`]).
/// A device without the effects leaves these squares more, fitted to the same recording and examined in the same way
/// (A240). A channel that was not examined so has no allowance. `device` and `recording` are without effects.
pub(crate) fn within_laws(
    found: Diagnosis,
    own_effects: &[DeviceEffect],
    (device, recording): (&Device, &Recording),
    options: &Options<'_>,
) -> Result<Diagnosis> {
    // links and drives are numbers of the base model
    let is_of_base = |name: &str| {
        spec(name).is_some_and(|spec| {
            spec.hook == Hook::BaseModel || spec.absorbed_by == Absorbed::ByTransmission
        })
    };
    // the same law with another size is no error of the law
    let is_known = |cause: &CauseAnswer| {
        let is_of_device =
            cause.earlier.is_empty() && own_effects.iter().any(|effect| is_kin(effect, cause));
        is_of_base(&cause.effect) || is_of_device
    };
    // which of several effects it is, and where, is open: one of the family of an effect of the device may be it
    let may_be_known = |cause: &CauseAnswer| {
        let rivals = cause.confusable_with.iter().map(String::as_str);
        let mut class = std::iter::once(cause.effect.as_str()).chain(rivals);
        class.any(|name| {
            is_of_base(name) || own_effects.iter().any(|effect| is_of_family(effect, name))
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
    // friction of a moving arm is a part of its base model
    let is_moving = is_moving_arm(options.model.unwrap_or(device), recording);
    let may_leave = |effect: &&DeviceEffect| !(is_moving && effect.is_friction());
    // torques and other channels each by themselves, if they have a gap: the laws of one leave nothing in the other
    let channels = found.gap.channels.clone();
    let (of_drives, others): (Vec<&ChannelGap>, Vec<&ChannelGap>) = (channels.iter())
        .filter(|channel| channel.rms_before.is_finite())
        .partition(|channel| is_of_drives(channel));
    let has_gap = |channels: &[&ChannelGap]| channels.iter().any(|channel| channel.has_gap);
    let by_drives = has_gap(&of_drives);
    let by_others = has_gap(&others) || (!by_drives && !others.is_empty());
    let mut share: Option<f64> = None;
    for (gaps, is_asked, is_on_drives) in [(of_drives, by_drives, true), (others, by_others, false)]
    {
        if !is_asked {
            continue;
        }
        let laws = own_effects.iter().filter(may_leave).filter(|effect| {
            spec(&effect.name).is_some_and(|spec| spec.hook.is_on_drives() == is_on_drives)
        });
        let laws: Vec<DeviceEffect> = laws.cloned().collect();
        let without = match is_on_drives {
            true if laws.is_empty() => return Ok(found),
            true => torques_without(device, recording, &laws, options)?,
            false => channels_without(device, recording, options)?,
        };
        let Some(left) = left_by_laws(&gaps, &without, &laws) else {
            return Ok(found);
        };
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
        not_in_file: Vec::new(),
        own_effects_leave: share,
        ..found
    })
}

/// Whether a channel is of the drives: a torque, alone or by the command that it follows.
fn is_of_drives(channel: &ChannelGap) -> bool {
    ["torque", "tracking"]
        .iter()
        .any(|name| channel.channel.starts_with(name))
}

/// What a device without the effects leaves of a channel.
struct Without {
    channel: String,
    /// Rows, as a share of those of the other channels.
    count: f64,
    rms: f64,
}

/// None where nothing but commands or torques shows the device.
fn channels_without(
    device: &Device,
    recording: &Recording,
    options: &Options<'_>,
) -> Result<Vec<Without>> {
    if channels(device, recording).is_err() {
        return Ok(Vec::new());
    }
    let base = Base::fit(device, recording, options.loss, &options.interrupt)?;
    let weights = Weights::stated(&base.device, &base.channels);
    let (own, model) = (&base.device, &base.channels);
    let residuals = channel_residuals(own, own, recording, model, &weights)?;
    let of_channel = |own: &haptical_calibration::ChannelResiduals| Without {
        channel: own.channel.name(),
        count: own.residuals.len() as f64,
        rms: own.rms().unwrap_or(0.0),
    };
    Ok(residuals.iter().map(of_channel).collect())
}

/// The same for torques, by the examination that gives the verdict; the base model has as many rows of each torque.
/// None where the examination finds a cause that is none of the effects.
fn torques_without(
    device: &Device,
    recording: &Recording,
    effects: &[DeviceEffect],
    options: &Options<'_>,
) -> Result<Vec<Without>> {
    let model = bare(options.model.unwrap_or(device));
    let of_motion = of_moving_arm(&model, recording, None, &options.without);
    let is_of_other = |cause: &CauseAnswer| !effects.iter().any(|effect| is_kin(effect, cause));
    let gaps = match of_motion {
        Some(found) if found.findings.iter().any(is_of_other) => return Ok(Vec::new()),
        Some(found) => found.channels,
        None => examine(&Context::new(&model, recording, &[])?, None, &[])?.channels,
    };
    let without = gaps.into_iter().map(|gap| Without {
        channel: gap.channel,
        count: 1.0,
        rms: gap.rms_before,
    });
    Ok(without.collect())
}

/// Share of the squares beyond noise that is left of what the device without the effects leaves; none where that is more than the laws may
/// leave of what they take off the channels that they act on (A240).
fn left_by_laws(gaps: &[&ChannelGap], without: &[Without], laws: &[DeviceEffect]) -> Option<f64> {
    let (mut left, mut kept, mut whole, mut allowed) = (0.0, 0.0, 0.0, 0.0);
    for gap in gaps {
        let beyond = |rms: f64| ((rms / gap.noise_floor).powi(2) - 1.0).max(0.0);
        let with_effects = beyond(gap.rms_before);
        let Some(bare) = without.iter().find(|bare| bare.channel == gap.channel) else {
            // nothing says what the effects take off a channel that was not examined without them
            if gap.has_gap {
                return None;
            }
            continue;
        };
        let acts = |effect: &&DeviceEffect| {
            let joint = effect.joint.filter(|_| is_of_drives(gap));
            joint.is_none_or(|joint| Some(joint + 1) == gap.joint)
        };
        let acting = laws
            .iter()
            .filter(acts)
            .filter_map(|effect| spec(&effect.name));
        let share = acting.map(|spec| spec.law_error.share).fold(0.0, f64::max);
        let of_effects = (beyond(bare.rms) - with_effects).max(0.0);
        let most = match share > 0.0 {
            true => LEFT_OF_CHANNEL.max(share),
            false => 0.0,
        };
        if gap.has_gap && with_effects > most * of_effects {
            return None;
        }
        kept += bare.count * if gap.has_gap { with_effects } else { 0.0 };
        left += bare.count * with_effects;
        whole += bare.count * (with_effects + of_effects);
        allowed += bare.count * share * of_effects;
    }
    (whole > 0.0 && kept <= allowed).then(|| left / whole)
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

    fn torque(joint: usize, rms_nm: f64) -> ChannelGap {
        ChannelGap {
            channel: format!("torque{joint}"),
            joint: Some(joint),
            has_gap: rms_nm > 1.1,
            held_out: false,
            rms_before: rms_nm,
            rms_after: rms_nm,
            rms_fit: None,
            noise_floor: 1.0,
            noise_floor_ci95: [0.95, 1.05],
            noise_source: crate::NoiseSource::Motion,
            unit: "N m".to_owned(),
            share_of_gap: 0.0,
            reduction_percent: None,
            reduction_ci95: None,
            no_reduction: None,
        }
    }

    fn without(joint: usize, rms: f64) -> Without {
        Without {
            channel: format!("torque{joint}"),
            count: 1.0,
            rms,
        }
    }

    /// Friction of the first joint, whose law is right up to 2 % of the squares.
    #[test]
    fn effects_leave_a_share_of_what_they_do_where_they_act() {
        let laws = [own("joint-friction", Some(0))];
        let left = |gaps: &[ChannelGap], bare: &[Without]| {
            let gaps: Vec<&ChannelGap> = gaps.iter().collect();
            left_by_laws(&gaps, bare, &laws)
        };
        // 100 noise's squares are taken off: two may be left
        let rms = |beyond: f64| f64::sqrt(1.0 + beyond);
        let bare = |beyond: f64| [without(1, rms(beyond))];
        let share = left(&[torque(1, rms(1.5))], &bare(100.0)).unwrap();
        assert!((share - 0.015).abs() < 1e-6, "{share}");
        assert_eq!(left(&[torque(1, rms(3.0))], &bare(100.0)), None);
        // of two joints that rub one may keep more, if both together do not
        let rub = [
            own("joint-friction", Some(0)),
            own("joint-friction", Some(1)),
        ];
        let of_both = |first: f64, second: f64| {
            let gaps = [torque(1, rms(first)), torque(2, rms(second))];
            let bare = [without(1, rms(400.0)), without(2, rms(100.0))];
            left_by_laws(&gaps.iter().collect::<Vec<_>>(), &bare, &rub)
        };
        assert!(of_both(1.0, 5.0).is_some());
        assert_eq!(of_both(1.0, 12.0), None);
        assert_eq!(of_both(7.0, 5.0), None);
        // a cause that both leave is none of the effects'
        assert_eq!(left(&[torque(1, rms(50.0))], &bare(52.0)), None);
        // nothing was examined without them
        assert_eq!(left(&[torque(1, 1e4)], &[]), None);
        // they do not act on the second joint
        let both = [without(1, rms(100.0)), without(2, 30.0)];
        assert_eq!(left(&[torque(1, 1.0), torque(2, 1.5)], &both), None);
        // a device without them leaves no more
        assert_eq!(left(&[torque(1, rms(1.5))], &[without(1, 0.95)]), None);
    }
}
