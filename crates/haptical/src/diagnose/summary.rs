//! A diagnosis in words: whole, and in fewer than 25 lines for a terminal.

use std::fmt::Write as _;

use haptical_diagnosis::{CauseAnswer, ChannelGap, Diagnosis};

use crate::diagnose::absorbed::absorbed_sentence;
use crate::diagnose::adjusted::adjusted;
use crate::diagnose::next::next_step;
use crate::diagnose::words::{
    closed, held_out_answer, held_out_sizes, listed, not_in_file, parameters, percent,
    place_sentence, placed, probability, record, rivals, verdict_mark, verdict_sentence,
};
use crate::lines::{WIDTH, lines_of};
use crate::units::Shown;

/// Lines that channels and causes have together; gap.json has all of both.
const LISTED: usize = 9;
/// Causes that are listed where there are more than one more.
const MOST_CAUSES: usize = 5;
/// Lines of the whole summary: what is to be done next has the room that is left, two lines at least.
const MOST_LINES: usize = 23;
/// Numbers listed of those that move with a cause.
const MOVED: usize = 2;
/// Width of the word before a text.
const INDENT: usize = 9;

/// How much room a summary has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Room {
    /// What does not fit in a line or two of a terminal is cut, with a mark.
    Terminal,
    /// Every word is there.
    Any,
}

/// A summary in the making.
struct Summary {
    text: String,
    room: Room,
}

/// The summary: verdict, gap, place, causes, what cannot be seen, next step, `repaired` the name of the log that was
/// written without its faults.
pub(super) fn text(diagnosis: &Diagnosis, repaired: Option<&str>, room: Room) -> String {
    let text = String::new();
    let mut said = Summary { text, room };
    said.push("", &answer(diagnosis), 4);
    said.text.push('\n');
    channels(&mut said.text, diagnosis);
    if let Some(place) = place_sentence(diagnosis) {
        said.push("where", &place, 2);
    }
    said.causes(&diagnosis.causes);
    if let Some(absorbed) = absorbed_sentence(diagnosis, MOVED) {
        said.push("absorbed", &absorbed, 3);
    }
    said.held_out(diagnosis);
    if let Some(words) = adjusted(diagnosis) {
        said.push("adjusted", &words, 3);
    }
    if let Some(words) = not_in_file(diagnosis) {
        said.push("file", &words, 1);
    }
    said.push("unseen", &unseen(diagnosis), 1);
    let left = MOST_LINES.saturating_sub(said.text.lines().count());
    said.push("next", &next_step(diagnosis, repaired), left.max(2));
    said.text
}

/// The verdict in a sentence or two.
pub(super) fn answer(diagnosis: &Diagnosis) -> String {
    let (_, mark) = verdict_mark(diagnosis.verdict);
    format!("{mark} {}", verdict_sentence(diagnosis))
}

/// Before, after and floor of the channels that show most of the gap.
fn channels(text: &mut String, diagnosis: &Diagnosis) {
    let mut order: Vec<&ChannelGap> = diagnosis.gap.channels.iter().collect();
    let listed = LISTED.saturating_sub(cause_lines(diagnosis));
    let mut kept = listed;
    if order.len() > listed {
        // Adding zero makes one of the two zeros.
        order.sort_by(|a, b| (b.share_of_gap + 0.0).total_cmp(&(a.share_of_gap + 0.0)));
        kept = listed.saturating_sub(1);
    }
    let mut line = |name: &str, [before, after, floor]: [&str; 3], closed: &str| {
        let _ = writeln!(
            text,
            "{name:<12}{before:>15}{after:>15}{floor:>15}   {closed}"
        );
    };
    line("channel", ["before", "after", "noise floor"], "gap closed");
    for channel in order.iter().take(kept) {
        let sizes = [channel.rms_before, channel.rms_after, channel.noise_floor];
        let sizes = sizes.map(|size| Shown::fine(&channel.unit).text(size));
        line(
            &channel.channel,
            sizes.each_ref().map(String::as_str),
            &closed(channel),
        );
    }
    let others = order.iter().skip(kept);
    if others.len() > 0 {
        let more = others.len();
        let share = percent(others.map(|channel| channel.share_of_gap).sum());
        let _ = writeln!(
            text,
            "and {more} more with {share} of the gap, see gap.json"
        );
    }
    text.push('\n');
}

/// Most lines of the causes: one each; the only one may take two, and what a calibration had taken up three.
fn cause_lines(diagnosis: &Diagnosis) -> usize {
    let absorbed = if diagnosis.absorbed.is_some() { 3 } else { 0 };
    let file = usize::from(!diagnosis.not_in_file.is_empty());
    let causes = match diagnosis.causes.len() {
        1 => 2,
        count => count.min(MOST_CAUSES + 1),
    };
    absorbed + file + causes
}

impl Summary {
    /// Name, probability, numbers and rivals of each cause.
    fn causes(&mut self, causes: &[CauseAnswer]) {
        if let [only] = causes {
            return self.push("cause", &cause(only), 2);
        }
        let listed = match causes.len() {
            count if count > MOST_CAUSES + 1 => MOST_CAUSES,
            count => count,
        };
        for (index, cause) in causes.iter().take(listed).enumerate() {
            let label = format!("cause {}", index + 1);
            self.push(&label, &self::cause(cause), 1);
        }
        if listed < causes.len() {
            let more = causes.len() - listed;
            let _ = writeln!(self.text, "and {more} more causes, see gap.json");
        }
    }

    fn held_out(&mut self, diagnosis: &Diagnosis) {
        let Some(held_out) = held_out_answer(diagnosis) else {
            return;
        };
        let closed = match record(diagnosis, &held_out.channel) {
            Some(channel) if channel.reduction_percent.is_some() => {
                format!("{} of the gap closed", closed(channel))
            }
            Some(channel) if channel.has_gap => format!("share of the gap {}", closed(channel)),
            _ => "no gap there".to_owned(),
        };
        let (sizes, rows) = (held_out_sizes(held_out), &diagnosis.held_out);
        self.push("held out", &format!("{closed} ({sizes}); on {rows}"), 2);
    }

    /// A text behind a word, on a terminal in at most `most` lines.
    fn push(&mut self, label: &str, said: &str, most: usize) {
        let indent = if label.is_empty() { 0 } else { INDENT };
        let mut lines = lines_of(said, indent);
        if self.room == Room::Terminal && lines.len() > most {
            lines.truncate(most);
            if let Some(last) = lines.last_mut() {
                while last.chars().count() + 2 > WIDTH - indent {
                    last.pop();
                }
                last.push_str(" …");
            }
        }
        for (index, line) in lines.iter().enumerate() {
            let label = if index == 0 { label } else { "" };
            let _ = writeln!(self.text, "{label:<indent$}{line}");
        }
    }
}

/// Name, place, probability, numbers and rivals of one cause.
pub(super) fn cause(cause: &CauseAnswer) -> String {
    let mut said = format!(
        "{}, probability {}: {}",
        placed(cause),
        probability(cause.probability),
        parameters(cause)
    );
    if !cause.confusable_with.is_empty() {
        let rivals: Vec<String> = rivals(cause).collect();
        let _ = write!(said, "; confusable with {}", listed(&rivals));
    }
    if !cause.plausible {
        said.push_str("; not a size that a sound device has");
    }
    said
}

/// What cannot be seen, in counts.
fn unseen(diagnosis: &Diagnosis) -> String {
    let mut parts = vec![
        format!("invisible effects: {}", diagnosis.invisible.len()),
        format!("untestable: {}", diagnosis.untestable.len()),
        format!(
            "visible above a size in gap.json: {}",
            diagnosis.detectable.len()
        ),
    ];
    if !diagnosis.plausibility.is_empty() {
        let odd = diagnosis.plausibility.len();
        parts.push(format!("odd values of the model: {odd}"));
    }
    parts.join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::example_tests::{named, no_gap, unknown};
    use haptical_diagnosis::{AbsorbedAnswer, MovedNumber, ParameterAnswer};

    #[test]
    fn the_summary_says_all_that_the_brief_wants() {
        let said = text(&named(), None, Room::Terminal);
        for wanted in [
            "Named. capstan-compliance at joint 2 (probability 98 %)",
            "out2             1.200 mrad    0.1100 mrad    0.1050 mrad   97.3 % (95 % interval 96.1 \
             to 98.0 %)",
            "cable              90.00 µm",
            "where    out2, joint 2; depends on torque2_nm (explains 95 % alone)",
            "cause    capstan-compliance at joint 2, probability 98 %: stiffness 258 [243, 273]",
            "held out 97.3 %",
            "unseen   invisible effects: 1, untestable: 1, visible above a size in gap.json: 2",
            "next     check the pre-tension",
        ] {
            assert!(said.contains(wanted), "{wanted}: {said}");
        }
    }

    #[test]
    fn it_stays_below_25_lines_whatever_there_is_to_say() {
        let mut full = named();
        let words = "a very long sentence about what there is to do ".repeat(20);
        full.next_experiment = Some(words.clone());
        full.held_out = words.clone();
        full.provenance.without = vec![words.replace(' ', "-"); 3];
        if let Some(place) = &mut full.place {
            place.region = words.clone();
        }
        let cause = full.causes[0].clone();
        full.causes = vec![cause; 4];
        let channel = full.gap.channels[1].clone();
        full.gap.channels = vec![channel; 23];
        full.absorbed = Some(absorbed());
        full.not_in_file = vec![words];
        full.plausibility = vec![haptical_diagnosis::Hint {
            parameter: "output_drum_x1".to_owned(),
            why: "3 mm".to_owned(),
        }];
        for diagnosis in [full, named(), no_gap(), unknown()] {
            let said = text(&diagnosis, None, Room::Terminal);
            assert!(
                said.lines().count() < 24,
                "{} lines: {said}",
                said.lines().count()
            );
            // in a file every word is there
            let whole = text(&diagnosis, None, Room::Any);
            assert!(!whole.contains('…'));
            let next = next_step(&diagnosis, None);
            let words =
                |text: &str| -> String { text.split_whitespace().collect::<Vec<_>>().join(" ") };
            assert!(words(&whole).ends_with(&words(&next)), "{whole}");
        }
    }

    /// Of four numbers in four units.
    fn absorbed() -> AbsorbedAnswer {
        let number = |parameter: &str, unit: &str, value: f64| MovedNumber {
            parameter: parameter.to_owned(),
            unit: unit.to_owned(),
            earlier: 0.0,
            value: ParameterAnswer {
                value,
                ci95: [0.9 * value, 1.1 * value],
            },
        };
        AbsorbedAnswer {
            share: Some(0.93),
            moved: vec![
                number("a3", "m", 0.002),
                number("joint_compliance2", "rad/(N m)", 0.0025),
                number("alpha1", "rad", -0.0012),
                number("ratio_deviation1", "1", 0.05),
            ],
        }
    }

    #[test]
    fn what_a_calibration_had_taken_up_is_one_line_with_units() {
        let mut diagnosis = named();
        diagnosis.absorbed = Some(absorbed());
        let said = text(&diagnosis, None, Room::Terminal);
        let said: Vec<&str> = said.split_whitespace().collect();
        let said = said.join(" ");
        let wanted = "absorbed The earlier model took up 93 % of capstan-compliance at joint 2: identify it again. With the \
                      cause in the model 4 numbers move: a3 by 2000 µm, joint_compliance2 by 2.50e-3 rad/(N m), others in \
                      gap.json.";
        assert!(said.contains(wanted), "{said}");
        let all = absorbed_sentence(&diagnosis, usize::MAX).unwrap();
        assert!(
            all.ends_with("alpha1 by -1.200 mrad, ratio_deviation1 by 5.00e-2."),
            "{all}"
        );
    }

    #[test]
    fn the_channels_with_the_largest_share_are_kept() {
        let mut many = named();
        let quiet = many.gap.channels[0].clone();
        for index in 0..8 {
            let mut channel = quiet.clone();
            channel.channel = format!("out{}", 10 + index);
            many.gap.channels.insert(0, channel);
        }
        let said = text(&many, None, Room::Terminal);
        assert!(
            said.contains("\nout2 ") && said.contains("\ncable "),
            "{said}"
        );
        assert!(said.contains("and 5 more with 0 % of the gap"), "{said}");
    }

    #[test]
    fn long_texts_are_cut_with_a_mark() {
        let (text, room) = (String::new(), Room::Terminal);
        let mut summary = Summary { text, room };
        summary.push("next", &"word ".repeat(100), 2);
        let lines: Vec<&str> = summary.text.lines().collect();
        assert_eq!(lines.len(), 2);
        assert!(lines.iter().all(|line| line.chars().count() <= WIDTH));
        assert!(lines[0].starts_with("next     word") && lines[1].starts_with("         word"));
        assert!(lines[1].ends_with(" …"));
    }
}
