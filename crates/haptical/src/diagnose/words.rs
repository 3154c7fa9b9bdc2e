//! A diagnosis in sentences: verdict, place, causes.

use haptical_diagnosis::{
    CauseAnswer, ChannelGap, Diagnosis, HeldOutAnswer, IN_NO_CATALOGUE, MovedNumber, NoReduction,
    Over, Refusal, TORQUES_NOT_TESTED, Verdict,
};
use haptical_report::Tone;

use crate::diagnose::kept::{kept_by_second, not_judged, of_second_alone, said_of_second};
use crate::diagnose::quantity::Quantity;
use crate::diagnose::rest::{kept_by_channels, of_change};
use crate::units::Shown;

/// `capstan-compliance at joint 2`, `cable-latency`.
pub(crate) fn named_at(effect: &str, joint: Option<usize>) -> String {
    match joint {
        Some(joint) => format!("{effect} at joint {joint}"),
        None => effect.to_owned(),
    }
}

/// A cause with its place: `backlash at joint 2`, `cable-scale of cable 3`, `tracker-moved from run 2`.
pub(crate) fn placed(cause: &CauseAnswer) -> String {
    let name = named_at(&cause.effect, cause.joint);
    let number = |name: &str| cause.parameters.get(name).map(|number| number.value);
    match (number("cable"), number("from_run")) {
        (Some(cable), _) => format!("{name} of cable {cable:.0}"),
        (None, Some(run)) => format!("{name} from run {run:.0}"),
        (None, None) => name,
    }
}

/// Head of a joint's column; none is the device as a whole.
pub(crate) fn column(joint: Option<usize>) -> String {
    joint.map_or_else(|| "device".to_owned(), |joint| format!("joint {joint}"))
}

/// The joints that columns are for; the device as a whole comes last.
pub(crate) fn joints(all: impl Iterator<Item = Option<usize>>) -> Vec<Option<usize>> {
    let mut joints: Vec<Option<usize>> = all.collect();
    joints.sort_unstable_by_key(|joint| joint.unwrap_or(usize::MAX));
    joints.dedup();
    joints
}

/// A probability in whole percent; none is certain.
pub(crate) fn probability(probability: f64) -> String {
    percent(probability.clamp(0.0, 0.999))
}

/// A share in whole percent; what is not nothing or all is not rounded to it.
pub(crate) fn percent(share: f64) -> String {
    match share {
        _ if share > 0.995 && share < 1.0 => "> 99 %".to_owned(),
        _ if share > 0.0 && share < 0.005 => "< 1 %".to_owned(),
        _ => format!("{:.0} %", 100.0 * share),
    }
}

/// Colour and word of a verdict.
pub(crate) fn verdict_mark(verdict: Verdict) -> (Tone, &'static str) {
    match verdict {
        Verdict::NoGap => (Tone::Good, "No gap."),
        Verdict::Named => (Tone::Good, "Named."),
        Verdict::Ambiguous => (Tone::Neutral, "Ambiguous."),
        Verdict::Unknown => (Tone::Bad, "Unknown."),
    }
}

/// The channel that shows most of the gap.
pub(crate) fn main_channel(diagnosis: &Diagnosis) -> Option<&ChannelGap> {
    let place = diagnosis.place.as_ref();
    let channel = place.map(|place| place.channel.as_str());
    diagnosis.gap.main(channel)
}

/// How much of a channel's gap closes, or why that is not known.
pub(crate) fn closed(channel: &ChannelGap) -> String {
    let share = reduction(channel.reduction_percent, channel.reduction_ci95);
    let why = channel.no_reduction.map_or("not known", NoReduction::words);
    share.unwrap_or_else(|| why.to_owned())
}

/// The verdict in a sentence or two.
pub(crate) fn verdict_sentence(diagnosis: &Diagnosis) -> String {
    let causes = &diagnosis.causes;
    let mut sentence = match (diagnosis.verdict, causes.first()) {
        (Verdict::NoGap, _) => no_gap(diagnosis),
        (Verdict::Named, Some(_)) => {
            let (of_data, of_device): (Vec<&CauseAnswer>, Vec<&CauseAnswer>) =
                causes.iter().partition(|cause| is_of_data(cause));
            // readings that are none may be all that there is
            let (of_data, of_device) = match of_device.is_empty() {
                true => (of_device, of_data),
                false => (of_data, of_device),
            };
            let names: Vec<String> = of_device.into_iter().map(with_probability).collect();
            // dropouts and outliers are several
            let are_many = causes.iter().all(is_of_data);
            let verb = match names.len() {
                1 if !are_many => "explains",
                _ => "explain",
            };
            let gap = match diagnosis.closed_unseen_share {
                Some(_) if is_of_runs(diagnosis) => "what changed between the runs",
                Some(_) => "a part of the gap",
                None if !kept_by_second(diagnosis).is_empty() => "the gap of the log alone",
                None if is_undetermined(causes) => "the gap of the rows of its fit",
                None if !kept_by_channels(diagnosis).is_empty() => "a part of the gap",
                None => "the gap",
            };
            format!("{} {verb} {gap}.{}", listed(&names), besides(&of_data))
        }
        (Verdict::Ambiguous, Some(first)) => ambiguous(diagnosis, first),
        _ => unknown(diagnosis),
    };
    if diagnosis.verdict.has_causes()
        && let Some(closing) = closing(diagnosis)
    {
        sentence += &format!(" {closing}");
    }
    if diagnosis.verdict == Verdict::Named && diagnosis.closed_unseen_share.is_none() {
        sentence += &kept_by_channels(diagnosis);
    }
    sentence += &not_judged(diagnosis);
    sentence += &said_of_second(diagnosis);
    if let Some(closed) = diagnosis
        .closed_unseen_share
        .filter(|_| !is_of_runs(diagnosis))
    {
        sentence += &format!(
            " No effect of the catalogue explains the rest: of the squares beyond noise, rows that the fit did not \
             see lose {}, and the log keeps {}.",
            percent(closed),
            percent(diagnosis.unexplained_share)
        );
    }
    if !diagnosis.provenance.without.is_empty() {
        let names = diagnosis.provenance.without.join(", ");
        sentence += &format!(" Left out of the catalogue on request: {names}.");
    }
    sentence
}

/// Whether the first cause came about between two runs of the log.
fn is_of_runs(diagnosis: &Diagnosis) -> bool {
    diagnosis
        .causes
        .first()
        .is_some_and(CauseAnswer::is_of_runs)
}

/// Whether no row that the fit did not see says whether the first cause closes anything.
fn is_undetermined(causes: &[CauseAnswer]) -> bool {
    let held_out = causes.first().and_then(|first| first.held_out.as_ref());
    held_out.is_some_and(|own| own.no_reduction == Some(NoReduction::Undetermined))
}

/// What the model leaves passes for noise, by which tests.
fn no_gap(diagnosis: &Diagnosis) -> String {
    if let Some(share) = diagnosis.own_effects_leave {
        return format!(
            "What the model's own effects leave, {:.1} % of the squares beyond noise that a device without them does, is no \
             more than their laws may get wrong.",
            100.0 * share
        );
    }
    let tested = &diagnosis.whiteness.over;
    let names = |are_tested: bool| -> Vec<String> {
        let all = [
            (Over::Frequency, "frequency"),
            (Over::Time, "time"),
            (Over::Posture, "posture"),
            (Over::Approach, "direction of approach"),
        ];
        let all = all.into_iter();
        let names = all.filter(|(over, _)| tested.contains(over) == are_tested);
        names.map(|(_, name)| name.to_owned()).collect()
    };
    let (tested, mut untested) = (names(true), names(false));
    let of_torques = |own: &String| own.starts_with(TORQUES_NOT_TESTED);
    if diagnosis.warnings.iter().any(of_torques) {
        untested.insert(0, "the torques".to_owned());
    }
    let beyond = beyond_the_log(diagnosis);
    let of_what = if beyond.is_empty() { "" } else { " of the log" };
    let mut said =
        format!("What the model leaves{of_what} is no larger than noise in every channel");
    if !tested.is_empty() {
        said.push_str(&format!(" and depends on no {}", joined(&tested, "or")));
    }
    if !untested.is_empty() {
        said.push_str(&format!("; not tested: {}", listed(&untested)));
    }
    said = format!(
        "{said} ({} effects at their places were tested).",
        diagnosis.provenance.tested
    );
    if !diagnosis.silent.is_empty() {
        said.push_str(&format!(
            " Next to nothing is said of {}: constant, or no larger than noise.",
            listed(&diagnosis.silent)
        ));
    }
    if !beyond.is_empty() {
        said.push_str(&format!(
            " Of rows that the fit did not see it leaves more than noise in {}: the log fixes the model only where it went.",
            listed(&beyond)
        ));
        said.push_str(match diagnosis.second {
            Some(_) => " Diagnose both recordings together: `--log A --log B`.",
            None => " Record longer, and everywhere where the joints go.",
        });
    }
    said
}

/// Channels without a gap that show more than noise on rows that the fit did not see.
fn beyond_the_log(diagnosis: &Diagnosis) -> Vec<String> {
    let channels = diagnosis.gap.channels.iter();
    let channels = channels.filter(|gap| gap.held_out && gap.rms_before > gap.noise_floor_ci95[1]);
    channels.map(|gap| gap.channel.clone()).collect()
}

/// Whether a finding is one on the data: it explains no gap.
fn is_of_data(cause: &CauseAnswer) -> bool {
    let spec = haptical_effects::spec(&cause.effect);
    spec.is_some_and(|spec| spec.hook == haptical_effects::Hook::Readings)
}

/// A further sentence on other findings; empty without any.
fn besides(causes: &[&CauseAnswer]) -> String {
    named_after(" The data show besides", causes.iter().copied())
}

/// A further sentence with causes after some words; empty without any.
fn named_after<'c>(words: &str, causes: impl Iterator<Item = &'c CauseAnswer>) -> String {
    let names: Vec<String> = causes.map(with_probability).collect();
    match names.as_slice() {
        [] => String::new(),
        names => format!("{words}: {}.", listed(names)),
    }
}

fn with_probability(cause: &CauseAnswer) -> String {
    let name = placed(cause);
    format!("{name} (probability {})", probability(cause.probability))
}

fn ambiguous(diagnosis: &Diagnosis, first: &CauseAnswer) -> String {
    let others = diagnosis.causes[1..].iter();
    let others = named_after(" In addition", others.filter(|cause| !is_of_data(cause)));
    let rivals: Vec<String> = rivals(first).collect();
    let (first, rivals) = (with_probability(first), joined(&rivals, "or"));
    format!("The data cannot tell {first} from {rivals}.{others}")
}

/// The effects that are confusable with a cause, in words.
pub(crate) fn rivals(cause: &CauseAnswer) -> impl Iterator<Item = String> {
    let names = cause.confusable_with.iter().map(String::as_str);
    names.map(|name| match name {
        IN_NO_CATALOGUE => "an effect in no catalogue".to_owned(),
        known => known.to_owned(),
    })
}

/// Unexplained share that is reported as none.
const NOTHING_LEFT: f64 = 0.005;

fn unknown(diagnosis: &Diagnosis) -> String {
    let second = diagnosis.second.as_ref();
    if let Some(second) = second.filter(|own| own.is_gap_of_it_alone) {
        return of_second_alone(second);
    }
    if let Some(refusal) = diagnosis.admission.refusal() {
        let dot = if refusal.why.ends_with('?') { "" } else { "." };
        return format!("No verdict is given: {}{dot}", refusal.why);
    }
    let place = main_channel(diagnosis).map(|channel| match channel.joint {
        Some(joint) => format!(" in {} (joint {joint})", channel.channel),
        None => format!(" in {}", channel.channel),
    });
    let mut sentence = format!(
        "There is a gap{} that no effect of the catalogue explains",
        place.unwrap_or_default()
    );
    if let Some(place) = &diagnosis.place
        && !place.depends_on.is_empty()
    {
        sentence.push_str(&format!("; it depends on {}", listed(&place.depends_on)));
    }
    sentence.push('.');
    let (surely, in_part): (Vec<&CauseAnswer>, Vec<&CauseAnswer>) =
        (diagnosis.causes.iter()).partition(|cause| cause.probability > 0.5);
    if !in_part.is_empty() {
        // no probability: the name of a part reads as a finding with it
        let names = in_part.iter().map(|cause| placed(cause));
        let part = listed(&names.collect::<Vec<_>>());
        sentence.push_str(&match diagnosis.unexplained_share {
            share if share < NOTHING_LEFT => format!(
                " It looks like {part}, but a size of none fits too, or data that the fit did not see are predicted no \
                 better with it."
            ),
            share => format!(
                " A part of it has the course of {part}, which is no finding: {} of it is left, and what is left is \
                 no noise.",
                percent(share)
            ),
        });
    }
    sentence + &besides(&surely) + &corrected_by(diagnosis)
}

/// Further sentences on the curve in the place of a cause, written or refused; empty without one.
fn corrected_by(diagnosis: &Diagnosis) -> String {
    let curve = |over: &str, joint: usize, share: f64| {
        let share = percent(share.min(0.999));
        format!(
            "a curve over {over} at joint {joint} closes {share} of the gap's squares on unseen rows"
        )
    };
    let kept = diagnosis.correction.as_ref().map(|own| {
        let curve = curve(&own.over, own.joint, own.closed_unseen_share);
        let second = own.on_second.as_ref().map(held_out_sizes);
        let second = second.map(|own| format!(" It predicts the second recording better: {own}."));
        format!(
            " corrected.toml has a correction, which is no cause: {curve}.{}",
            second.unwrap_or_default()
        )
    });
    let refused = diagnosis.correction_refused.as_ref().map(|own| {
        let curve = curve(&own.over, own.joint, own.closed_unseen_share) + " of the log";
        match own.why {
            Refusal::CourseOfTime => format!(
                " Nothing is corrected: {curve}, but the course of one recording is no property of the device, and no other \
                 recording has it."
            ),
            Refusal::SecondRecording => {
                let second = own.on_second.as_ref().map(held_out_sizes);
                let second = second.map(|own| format!(" ({own})")).unwrap_or_default();
                format!(
                    " Nothing is corrected: {curve}, but does not predict the second recording better{second}."
                )
            }
        }
    });
    kept.or(refused).unwrap_or_default()
}

/// The check of the first cause that has one on unseen data.
pub(crate) fn held_out_answer(diagnosis: &Diagnosis) -> Option<&HeldOutAnswer> {
    let mut causes = diagnosis.causes.iter();
    causes.find_map(|cause| cause.held_out.as_ref())
}

/// How much of the gap closes: on unseen data, else on the rows of the fit.
fn closing(diagnosis: &Diagnosis) -> Option<String> {
    let share = |channel: &ChannelGap| {
        reduction(channel.reduction_percent, channel.reduction_ci95).filter(|_| channel.has_gap)
    };
    let held_out = held_out_answer(diagnosis);
    if diagnosis.closed_unseen_share.is_some() && is_of_runs(diagnosis) {
        return Some(of_change(held_out?));
    }
    if let Some(held_out) = held_out
        && held_out.no_reduction == Some(NoReduction::Undetermined)
    {
        return Some(format!(
            "No share of the gap of {} can be given on data that the fit did not see: no other rows predict those that show it.",
            held_out.channel
        ));
    }
    let unseen = held_out.and_then(|own| record(diagnosis, &own.channel));
    let unseen = unseen.and_then(|own| Some((share(own)?, &own.channel, true)));
    let (text, channel, is_unseen) = match unseen {
        Some(unseen) => unseen,
        None => {
            let main = main_channel(diagnosis)?;
            (share(main)?, &main.channel, main.held_out)
        }
    };
    let rows = match is_unseen {
        true => "On data that the fit did not see",
        false => "On the log itself",
    };
    Some(format!("{rows}, {text} of the gap of {channel} closes."))
}

/// The gap's record of a channel.
pub(crate) fn record<'d>(diagnosis: &'d Diagnosis, name: &str) -> Option<&'d ChannelGap> {
    let mut channels = diagnosis.gap.channels.iter();
    channels.find(|channel| channel.channel == name)
}

/// `97.3 % (95 % interval 96.1 to 98.0 %)`.
pub(crate) fn reduction(percent: Option<f64>, ci95: Option<[f64; 2]>) -> Option<String> {
    let ci95 = ci95.map(|[low, high]| format!(" (95 % interval {low:.1} to {high:.1} %)"));
    percent.map(|percent| format!("{percent:.1} %{}", ci95.unwrap_or_default()))
}

/// Before, after and floor on unseen data.
pub(crate) fn held_out_sizes(held_out: &HeldOutAnswer) -> String {
    let sizes = [
        held_out.rms_before,
        held_out.rms_after,
        held_out.noise_floor,
    ];
    let [before, after, noise] = sizes.map(|own| Shown::fine(&held_out.unit).text(own));
    let channel = &held_out.channel;
    format!("{channel} {before} before, {after} after, noise {noise}")
}

/// What the gap depends on and where it lies; none without a gap.
pub(crate) fn place_sentence(diagnosis: &Diagnosis) -> Option<String> {
    let place = diagnosis.place.as_ref()?;
    let mut text = place.channel.clone();
    if let Some(joint) = place.joint {
        text.push_str(&format!(", joint {joint}"));
    }
    let column = |(index, column): (usize, &String)| match place.explained.get(index) {
        Some(share) => format!("{column} (explains {} alone)", percent(*share)),
        None => column.clone(),
    };
    let columns: Vec<String> = place.depends_on.iter().enumerate().map(column).collect();
    if !columns.is_empty() {
        text.push_str(&format!("; depends on {}", listed(&columns)));
    }
    if !place.region.is_empty() {
        text.push_str(&format!("; {}", place.region));
    }
    Some(text)
}

/// What the earlier model had taken up of the cause, and what moves with it; none where its numbers hold.
///
/// What no file of a device holds of the answer; none where it holds all.
pub(super) fn not_in_file(diagnosis: &Diagnosis) -> Option<String> {
    let words = diagnosis.not_in_file.join("; ");
    let file = match diagnosis.corrected {
        Some(_) => "corrected.toml does",
        None => "a device file would",
    };
    (!words.is_empty()).then(|| format!("{file} not hold {words}"))
}

/// The parameters of a cause: `stiffness 258 [243, 273] N m/rad`.
///
/// Of numbers that changed since an earlier model what they changed by: `theta3 changed by -3.00 mrad [-3.02, -2.98]`.
pub(crate) fn parameters(cause: &CauseAnswer) -> String {
    if !cause.changed.is_empty() {
        let changes: Vec<String> = cause.changed.iter().map(changed_number).collect();
        return format!("since the earlier model {}", listed(&changes));
    }
    let texts = cause.parameters.iter().map(|(name, parameter)| {
        let quantity = Quantity::new(&cause.effect, name, parameter.value);
        let value = quantity.text(parameter.value, parameter.ci95);
        format!("{} {value}{}", quantity.words, earlier(cause, name))
    });
    texts.collect::<Vec<_>>().join(", ")
}

fn changed_number(number: &MovedNumber) -> String {
    let step = number.value.value - number.earlier;
    let ci95 = number.value.ci95.map(|end| end - number.earlier);
    let size = Quantity::of_unit(&number.unit, step).text(step, ci95);
    format!("{} changed by {size}", number.parameter)
}

/// What the earlier model has in the place of a number of an effect that it knows: `(1.4 mrad more than the 1.8 mrad of
/// the earlier model)`.
pub(crate) fn earlier(cause: &CauseAnswer, name: &str) -> String {
    let number = cause.parameters.get(name).zip(cause.earlier.get(name));
    number.map_or_else(String::new, |(parameter, earlier)| {
        let quantity = |value: f64| Quantity::new(&cause.effect, name, value).short(value);
        let step = parameter.value - earlier;
        let than = if step < 0.0 { "less" } else { "more" };
        let (step, earlier) = (quantity(step.abs()), quantity(*earlier));
        format!(" ({step} {than} than the {earlier} of the earlier model)")
    })
}

/// `a`, `a and b`, `a, b and c`.
pub(crate) fn listed(names: &[String]) -> String {
    joined(names, "and")
}

fn joined(names: &[String], word: &str) -> String {
    match names {
        [] => String::new(),
        [only] => only.clone(),
        [first @ .., last] => format!("{} {word} {last}", first.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::example_tests::{named, no_gap, unknown as unknown_example};

    #[test]
    fn what_explains_a_part_reads_as_no_finding() {
        let mut diagnosis = unknown_example();
        let mut part = named().causes.remove(0);
        part.probability = 0.05;
        diagnosis.causes = vec![part];
        diagnosis.unexplained_share = 0.62;
        let said = verdict_sentence(&diagnosis);
        assert!(
            said.contains("which is no finding: 62 % of it is left"),
            "{said}"
        );
        assert!(!said.contains("probability"), "{said}");
    }

    #[test]
    fn findings_on_the_data_explain_no_gap() {
        let mut diagnosis = named();
        let mut level = diagnosis.causes[0].clone();
        "noise-level".clone_into(&mut level.effect);
        diagnosis.causes.push(level);
        let said = verdict_sentence(&diagnosis);
        let (gap, besides) = said.split_once("explains the gap.").unwrap();
        assert!(
            !gap.contains("noise-level") && besides.contains("noise-level"),
            "{said}"
        );
    }

    #[test]
    fn a_named_verdict_says_what_how_sure_and_how_much() {
        let said = verdict_sentence(&named());
        assert_eq!(
            said,
            "capstan-compliance at joint 2 (probability 98 %) explains the gap. On data that the \
             fit did not see, 97.3 % (95 % interval 96.1 to 98.0 %) of the gap of out2 closes."
        );
        assert_eq!(
            parameters(&named().causes[0]),
            "stiffness 258 [243, 273] N m/rad"
        );
    }

    #[test]
    fn several_causes_are_all_named() {
        let mut diagnosis = named();
        let mut second = diagnosis.causes[0].clone();
        second.effect = "cable-latency".to_owned();
        second.joint = None;
        second.probability = 0.999;
        diagnosis.causes.push(second);
        let said = verdict_sentence(&diagnosis);
        let wanted = "capstan-compliance at joint 2 (probability 98 %) and cable-latency \
                      (probability > 99 %) explain the gap.";
        assert!(said.starts_with(wanted), "{said}");
    }

    #[test]
    fn an_ambiguous_verdict_names_the_rivals() {
        let mut diagnosis = named();
        diagnosis.verdict = Verdict::Ambiguous;
        diagnosis.causes[0].confusable_with = ["a", "b"].map(str::to_owned).to_vec();
        let said = verdict_sentence(&diagnosis);
        let wanted = "The data cannot tell capstan-compliance at joint 2 (probability 98 %) from a \
                      or b.";
        assert!(said.starts_with(wanted), "{said}");
    }

    #[test]
    fn an_unknown_verdict_says_where_it_is_and_what_was_left_out() {
        let mut diagnosis = unknown_example();
        diagnosis.provenance.without = vec!["backlash".to_owned()];
        assert_eq!(
            verdict_sentence(&diagnosis),
            "There is a gap in out2 (joint 2) that no effect of the catalogue explains; it \
             depends on theta2_rad. Left out of the catalogue on request: backlash."
        );
        assert_eq!(
            place_sentence(&diagnosis).unwrap(),
            "out2, joint 2; depends on theta2_rad (explains 88 % alone); near theta2 = 0.25 rad"
        );
    }

    #[test]
    fn without_a_gap_nothing_is_to_be_done() {
        let diagnosis = no_gap();
        assert!(verdict_sentence(&diagnosis).contains("than noise in every channel and depends on no frequency, time or posture; not tested: direction of \
                       approach (87 effects"));
        assert_eq!(place_sentence(&diagnosis), None);
    }

    #[test]
    fn percentages_do_not_claim_certainty() {
        let said: Vec<String> = [0.0, 0.001, 0.424, 0.996, 1.0].map(percent).to_vec();
        assert_eq!(said, ["0 %", "< 1 %", "42 %", "> 99 %", "100 %"]);
        assert_eq!(probability(1.0), "> 99 %");
    }
}
