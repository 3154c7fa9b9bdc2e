//! Joints' answers as one diagnosis.

use haptical_effects::Effect;
use haptical_judge::Evidence;
use haptical_judge::{Admission, Check};
use haptical_model::{Device, Recording};
use haptical_servo::{Finding, NAMES, Untested};

use super::Asked;
use super::causes::{cause, changed, is_of_torque, of_torque};
use super::channel::{Joint, channel, gap, noise, of_second, predictions, trace};
use crate::Options;
use crate::answer::{
    CauseAnswer, Diagnosis, Gap, Place, Provenance, SECOND_RECORDING, SecondAnswer, Untestable,
    Verdict,
};
use crate::judge::on_unseen;
use crate::thresholds::servo::{ALL_CLOSED, LEAST_FLOOR};

/// What is said of joints, and why not of others.
#[derive(Default)]
struct Tested {
    joints: Vec<Joint>,
    untested: Vec<(usize, String)>,
    /// Of them those that do not do what their command asks at all, in words.
    foreign: Vec<String>,
    /// Channels whose command stands still.
    silent: Vec<String>,
    /// Changes of torques' scales.
    scales: Vec<(usize, Finding)>,
    /// Why a second recording says nothing of a joint.
    unseen: Vec<String>,
}

impl Tested {
    /// Without the effects that are left out.
    fn new(asked: Vec<Asked>, options: &Options<'_>) -> Self {
        let mut tested = Self::default();
        let is_left_out = |name: &str| options.without.iter().any(|other| other == name);
        for own in asked {
            let index = own.joint;
            let torque = own.torque.filter(|found| !is_left_out(found.effect));
            tested.scales.extend(torque.map(|found| (index, found)));
            let answer = match own.answer {
                Ok(answer) => answer,
                Err(why) => {
                    if why.is_foreign() {
                        tested.foreign.push(format!("joint {}: {why}", index + 1));
                    }
                    if why == Untested::Still {
                        tested.silent.push(channel(index));
                    }
                    tested.untested.push((index, why.to_string()));
                    continue;
                }
            };
            let kept = answer.without(&options.without);
            let mut say = |why: String| tested.unseen.push(format!("joint {}: {why}", index + 1));
            let second = own.second.and_then(|second| {
                let why = match second {
                    // without some of its causes there is no fit to predict with
                    _ if kept.causes.len() < answer.causes.len() => {
                        "a cause is left out".to_owned()
                    }
                    Ok(second) => return Some(second),
                    Err(why) => why.to_string(),
                };
                say(format!("the second recording was not used: {why}"));
                None
            });
            let left_out = second.as_ref().map_or(0, |second| second.left_out);
            if left_out > 0 {
                say(format!(
                    "{left_out} rows of the second recording are not predicted and left out: the first one does not determine what the joint \
                     does there"
                ));
            }
            tested.joints.push(Joint {
                answer: kept,
                index,
                weight: 0.0,
                second,
            });
        }
        tested
    }
}

/// Puts the joints together.
pub(super) fn answer(
    device: &Device,
    recording: &Recording,
    effects: &[Box<dyn Effect>],
    options: &Options<'_>,
    asked: Vec<Asked>,
) -> Diagnosis {
    let Tested {
        mut joints,
        untested,
        foreign,
        silent,
        scales,
        unseen,
    } = Tested::new(asked, options);
    let energy = |joint: &Joint| match joint.answer.verdict {
        Verdict::NoGap => 0.0,
        _ => (joint.answer.rms_before / joint.answer.noise_floor.max(LEAST_FLOOR)).powi(2),
    };
    let total: f64 = joints.iter().map(energy).sum();
    for joint in &mut joints {
        joint.weight = energy(joint) / total.max(1e-300);
    }
    joints.sort_by(|a, b| b.weight.total_cmp(&a.weight));
    let (mut causes, words) = causes(device, &joints, &scales);
    let by_log = verdict(&joints, &causes);
    let (verdict, candidates, refused) = on_unseen(by_log, &mut causes);
    let located = located(&joints, &causes);
    let name = located.map(|joint| channel(joint.index));
    let channels = joints.iter().map(|joint| gap(device, joint)).collect();
    let gap = Gap::new(verdict, name.as_deref(), channels);
    let place = located.filter(|_| verdict != Verdict::NoGap);
    let place = place.map(|joint| place_of(joint, &words));
    let place = scaled(&causes, &words).or(place);
    let left: f64 = joints
        .iter()
        .map(|joint| joint.weight * (1.0 - joint.answer.closed).clamp(0.0, 1.0))
        .sum();
    let second = options.validation.map(|_| SecondAnswer {
        channels: joints
            .iter()
            .filter_map(|joint| of_second(device, joint))
            .collect(),
        not_predicted: unseen,
        is_gap_of_it_alone: false,
    });
    let is_explained = verdict.has_causes();
    let tested = joints.iter().map(|joint| joint.answer.tried).sum();
    let provenance = Provenance::new(recording.len(), 0, tested, options);
    let model = options.model.unwrap_or(device).clone();
    Diagnosis {
        admission: admission(device, &joints, (recording.len(), &foreign), verdict),
        silent,
        next_experiment: located.and_then(|joint| {
            let next = joint.answer.next.as_ref();
            next.map(|next| format!("joint {}: {next}", joint.index + 1))
        }),
        traces: joints
            .iter()
            .filter_map(|joint| trace(device, joint))
            .collect(),
        unexplained_share: left,
        closed_unseen_share: Some(1.0 - left).filter(|closed| is_explained && *closed < ALL_CLOSED),
        second,
        not_in_file: not_in_file(verdict, &causes),
        untestable: untestable(effects, &untested, &causes),
        noise: joints.iter().map(noise).collect(),
        candidates,
        warnings: [warnings(&joints, &untested, words, options), refused].concat(),
        // where a second recording says nothing of a joint, the log's parts do
        held_out: match joints.iter().any(|joint| joint.second.is_some()) {
            true => SECOND_RECORDING.to_owned(),
            false => "an eighth of the log in turn".to_owned(),
        },
        predictions: joints.iter().flat_map(predictions).collect(),
        place,
        ..Diagnosis::of_causes(verdict, gap, causes, model, provenance)
    }
}

/// What admits a verdict on loops. Joints that do not follow their command, and those of too few rows, were left out already.
fn admission(
    device: &Device,
    joints: &[Joint],
    (rows, foreign): (usize, &[String]),
    verdict: Verdict,
) -> Admission {
    let named = |say: &dyn Fn(&Joint) -> String| -> String {
        let words: Vec<String> = joints.iter().map(say).collect();
        words.join(", ")
    };
    let numbers = named(&|joint| (joint.index + 1).to_string());
    let floors = named(&|joint| {
        let unit = device.joints[joint.index].unit();
        format!(
            "joint {} {:.3e} {unit}",
            joint.index + 1,
            joint.answer.noise_floor
        )
    });
    let belongs = match (foreign, verdict) {
        ([], _) => Check::yes(format!("joints {numbers} follow their commands")),
        // what the other joints show has its cause at them
        (_, Verdict::Named | Verdict::Ambiguous) => Check::unknown(foreign.join("; ")),
        _ => Check::no(
            foreign.join("; "),
            "check the command, the sign and the drive of these joints, or leave their commands out of the log",
        ),
    };
    Admission {
        belongs,
        credible_base: Check::yes("nothing but the answer to commands is fitted"),
        known_noise: Check::yes(format!(
            "by rows that follow each other, and counts: {floors}"
        )),
        enough: Check::yes(format!("{rows} rows")),
    }
}

/// What a device file does not hold: how a joint follows its command is no part of a device.
fn not_in_file(verdict: Verdict, causes: &[CauseAnswer]) -> Vec<String> {
    let is_on_answer = |cause: &&CauseAnswer| NAMES.contains(&cause.effect.as_str());
    let named = causes
        .iter()
        .filter(|_| verdict.has_causes())
        .filter(is_on_answer);
    let words = |cause: &CauseAnswer| {
        let place = cause.place();
        format!("{} at {place}: it is an answer to commands", cause.effect)
    };
    named.map(words).collect()
}

/// Changes first, then what holds all along, by share of the gap; and the changes in words.
fn causes(
    device: &Device,
    joints: &[Joint],
    scales: &[(usize, Finding)],
) -> (Vec<CauseAnswer>, Vec<(usize, String)>) {
    let mut found: Vec<(bool, CauseAnswer)> = Vec::new();
    let mut words = Vec::new();
    let with_gap = joints
        .iter()
        .filter(|joint| joint.answer.verdict.has_causes());
    for joint in with_gap {
        for finding in &joint.answer.causes {
            let held_out = gap(device, joint).as_held_out();
            let cause = cause(device, joint.index, finding, joint.weight, held_out);
            found.push((finding.since.is_some(), cause));
            words.extend(changed(joint.index, finding).map(|word| (joint.index, word)));
        }
    }
    for (joint, finding) in scales {
        found.push((true, of_torque(*joint, finding)));
        words.extend(changed(*joint, finding).map(|word| (*joint, word)));
    }
    found.sort_by(|a, b| b.0.cmp(&a.0).then(b.1.share.total_cmp(&a.1.share)));
    (found.into_iter().map(|(_, cause)| cause).collect(), words)
}

fn verdict(joints: &[Joint], causes: &[CauseAnswer]) -> Verdict {
    let has_gap = |joint: &Joint| joint.answer.verdict != Verdict::NoGap;
    haptical_judge::verdict(Evidence {
        has_gap: !causes.is_empty() || joints.iter().any(has_gap),
        is_supported: true,
        probability: causes.first().map(|first| first.probability),
    })
}

/// The joint of the first cause, else the one with most of the gap.
fn located<'j>(joints: &'j [Joint], causes: &[CauseAnswer]) -> Option<&'j Joint> {
    let first = causes.first().and_then(|cause| cause.joint);
    let of_first = joints.iter().find(|joint| Some(joint.index + 1) == first);
    of_first.or(joints.first())
}

fn place_of(joint: &Joint, words: &[(usize, String)]) -> Place {
    let number = joint.index + 1;
    let own = words.iter().find(|(index, _)| *index == joint.index);
    let (column, region) = match own {
        Some((_, words)) => ("t_s".to_owned(), words.clone()),
        None => (
            format!("command{number}_rad"),
            format!("joint {number} beside its command"),
        ),
    };
    let on = [(column, joint.answer.closed)];
    Place::new(channel(joint.index), Some(joint.index), region, on)
}

/// Where the first cause is one of a torque's scale: that torque, since then.
fn scaled(causes: &[CauseAnswer], words: &[(usize, String)]) -> Option<Place> {
    let first = causes.first().filter(|first| is_of_torque(&first.effect))?;
    let joint = first.joint?;
    let own = words.iter().rfind(|(index, _)| index + 1 == joint)?;
    let on = [("t_s".to_owned(), 1.0)];
    Some(Place::new(
        format!("torque{joint}"),
        Some(joint - 1),
        own.1.clone(),
        on,
    ))
}

/// Why effects on positions are not tested.
const POSITIONS: &str =
    "the log has joints and their commands alone: no second sensor or position shows it";

fn untestable(
    effects: &[Box<dyn Effect>],
    untested: &[(usize, String)],
    causes: &[CauseAnswer],
) -> Vec<Untestable> {
    let is_said = |name: &str| {
        let mut names = causes
            .iter()
            .flat_map(|cause| std::iter::once(&cause.effect).chain(&cause.confusable_with));
        names.any(|said| said == name)
    };
    let mut found: Vec<Untestable> = Vec::new();
    for name in NAMES {
        for (joint, why) in untested {
            Untestable::add(&mut found, name, Some(*joint), why.clone());
        }
    }
    for effect in effects {
        let name = effect.name();
        let is_new = found.iter().all(|entry| entry.effect != name);
        if is_new && !NAMES.contains(&name) && !is_said(name) {
            found.push(Untestable::new(name, POSITIONS));
        }
    }
    found
}

fn warnings(
    joints: &[Joint],
    untested: &[(usize, String)],
    words: Vec<(usize, String)>,
    options: &Options<'_>,
) -> Vec<String> {
    let mut said: Vec<String> = match words.len() {
        0 | 1 => Vec::new(),
        _ => words.into_iter().map(|(_, words)| words).collect(),
    };
    // one sentence for all joints that it is said of
    let mut of_joints: Vec<(String, Vec<usize>)> = Vec::new();
    let own = joints.iter().flat_map(|joint| {
        let texts = joint.answer.warnings.iter().cloned();
        texts.map(|text| (joint.index, text))
    });
    let not_tested = untested
        .iter()
        .map(|(joint, why)| (*joint, format!("not tested: {why}")));
    for (joint, text) in own.chain(not_tested) {
        match of_joints.iter_mut().find(|(known, _)| *known == text) {
            Some((_, numbers)) => numbers.push(joint + 1),
            None => of_joints.push((text, vec![joint + 1])),
        }
    }
    for (text, mut numbers) in of_joints {
        numbers.sort_unstable();
        let listed: Vec<String> = numbers.iter().map(usize::to_string).collect();
        let plural = if listed.len() > 1 { "s" } else { "" };
        said.push(format!("joint{plural} {}: {text}", listed.join(", ")));
    }
    let has_changed = joints.iter().any(|joint| {
        let mut causes = joint.answer.causes.iter();
        causes.any(|cause| cause.since.is_some())
    });
    if options.validation.is_some() && has_changed {
        said.push("the second recording is taken as one of after the change".to_owned());
    }
    said
}
