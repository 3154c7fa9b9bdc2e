//! gap.html: a page that a lab engineer reads in two minutes.

mod figures;
mod tables;

use std::collections::BTreeSet;

use haptical_diagnosis::{Diagnosis, Verdict};
use haptical_report::{Block, Table};

use crate::diagnose::absorbed::absorbed_sentence;
use crate::diagnose::commands::commands;
use crate::diagnose::next::next_step;
use crate::diagnose::words::{
    not_in_file, parameters, percent, place_sentence, placed, verdict_mark, verdict_sentence,
};
use crate::error::Error;
use crate::files::Record;
use crate::page::{Page, facts, next};

/// Figures of residuals that are not folded away.
const OPEN_FIGURES: usize = 2;

/// What goes onto the page besides the diagnosis.
#[derive(Debug, Clone, Copy)]
pub(in crate::diagnose) struct Besides<'a> {
    /// Name of the log without its faults.
    pub(in crate::diagnose) repaired: Option<&'a str>,
    /// The arm as given and as corrected.
    pub(in crate::diagnose) arm: Option<&'a Block>,
    /// Names of the joints of the answer.
    pub(in crate::diagnose) joints: Option<&'a str>,
    /// How the diagnosis came about.
    pub(in crate::diagnose) record: &'a Record,
}

/// The whole page.
pub(in crate::diagnose) fn page(
    diagnosis: &Diagnosis,
    besides: Besides<'_>,
) -> Result<String, Error> {
    let mut page = Page::new(answer(diagnosis, besides)?);
    let channels = tables::channels(diagnosis)?.into();
    let rests_on = Block::Paragraph(rests_on(diagnosis));
    page.fold("Channel by channel", vec![rests_on, channels]);
    page.fold(
        "May there be a verdict?",
        vec![tables::admission(diagnosis)?.into()],
    );
    if let Some(adjusted) = tables::adjusted(diagnosis)? {
        page.fold("Adjusted before the verdict", vec![adjusted.into()]);
    }
    page.fold("Where the gap lies", place(diagnosis)?);
    if !diagnosis.causes.is_empty() {
        page.fold("Causes", causes(diagnosis)?);
    }
    page.fold(
        "The arm as corrected",
        besides.arm.cloned().into_iter().collect(),
    );
    if !diagnosis.candidates.is_empty() {
        page.fold("Candidates", candidates(diagnosis)?);
    }
    page.fold("What cannot be seen", unseen(diagnosis)?);
    page.warnings(&diagnosis.warnings);
    if !diagnosis.noise.is_empty() {
        page.fold("Noise", vec![tables::noise(diagnosis)?.into()]);
    }
    let tables = [besides.record.table()?, provenance(diagnosis)?];
    page.fold("Provenance", tables.map(Block::Table).into());
    Ok(page.into_html(format!("Diagnosis of {}", diagnosis.device.name)))
}

/// What the answer rests on, in a sentence.
fn rests_on(diagnosis: &Diagnosis) -> String {
    let from = &diagnosis.provenance;
    let checked = match diagnosis.held_out.as_str() {
        "" => String::new(),
        rows => format!(" Checked on {rows}."),
    };
    format!(
        "{} rows; {} of {} parameters of the model fixed by them; {} effects at their places tested.{checked}",
        from.rows, from.base_identifiable, from.base_parameters, from.tested
    )
}

/// Verdict, the gap as a figure beside the first view of the residual, and the next step with its commands.
fn answer(diagnosis: &Diagnosis, besides: Besides<'_>) -> Result<Vec<Block>, Error> {
    let (tone, label) = verdict_mark(diagnosis.verdict);
    let mut blocks = vec![Block::notice(tone, label, verdict_sentence(diagnosis))];
    let joints = besides.joints;
    let joints = joints.map(|names| format!("In the robot description {names}."));
    blocks.extend(joints.map(Block::Paragraph));
    let causes = diagnosis.causes.iter();
    let changed = causes.filter(|own| !own.changed.is_empty());
    blocks.extend(changed.map(|cause| {
        let place = placed(cause);
        Block::Paragraph(format!("{place}: {}.", parameters(cause)))
    }));
    blocks.extend(figures::gap(diagnosis)?);
    let not_held = not_in_file(diagnosis).map(|words| format!("In a file: {words}."));
    blocks.extend(not_held.map(Block::Paragraph));
    let words = next_step(diagnosis, besides.repaired);
    let commands = commands(diagnosis, besides.record, besides.repaired).into_iter();
    let commands = commands.map(|step| (step.purpose.to_owned(), step.command));
    blocks.extend(next(&words, commands.collect()));
    Ok(blocks)
}

/// Where the residual lies and how it looks there.
fn place(diagnosis: &Diagnosis) -> Result<Vec<Block>, Error> {
    let mut blocks = Vec::new();
    if let Some(sentence) = place_sentence(diagnosis) {
        blocks.push(Block::Paragraph(format!("{sentence}.")));
    }
    blocks.extend(tables::dependence(diagnosis)?.map(Block::Table));
    let mut traces = figures::traces(diagnosis)?;
    let folded = traces.split_off(OPEN_FIGURES.min(traces.len()));
    blocks.extend(traces);
    if !folded.is_empty() {
        blocks.push(Block::Folded {
            summary: format!("{} further views of the residual", folded.len()),
            blocks: folded,
        });
    }
    Ok(blocks)
}

/// What each cause is, how sure it is, and its numbers.
fn causes(diagnosis: &Diagnosis) -> Result<Vec<Block>, Error> {
    let mut blocks = Vec::new();
    let words = diagnosis.causes.iter().filter_map(|cause| {
        let spec = haptical_effects::spec(&cause.effect)?;
        let (name, meaning) = (&cause.effect, spec.meaning);
        Some(format!("{name}: {meaning}. Check {}.", spec.inspect))
    });
    let mut words: Vec<String> = words.collect();
    // an effect at several joints is explained once
    let mut told = BTreeSet::new();
    words.retain(|own| told.insert(own.clone()));
    if !words.is_empty() {
        blocks.push(Block::List(words));
    }
    blocks.push(tables::causes(diagnosis)?.into());
    blocks.push(tables::parameters(diagnosis)?.into());
    blocks.extend(absorbed_sentence(diagnosis, usize::MAX).map(Block::Paragraph));
    Ok(blocks)
}

/// How far the data tell the candidates for the first cause apart.
fn candidates(diagnosis: &Diagnosis) -> Result<Vec<Block>, Error> {
    let mut blocks: Vec<Block> = figures::candidates(diagnosis)?.into_iter().collect();
    let (open, folded) = tables::candidates(diagnosis)?;
    blocks.push(open.into());
    blocks.extend(folded.map(|table| Block::Folded {
        summary: "all candidates".to_owned(),
        blocks: vec![table.into()],
    }));
    Ok(blocks)
}

/// Effects that these data could not have shown.
fn unseen(diagnosis: &Diagnosis) -> Result<Vec<Block>, Error> {
    let mut blocks = Vec::new();
    if diagnosis.verdict == Verdict::NoGap {
        let means = match diagnosis.detectable.is_empty() {
            true => {
                "No gap means: what the model leaves is no larger than noise. From which size on each effect would have been noticed was \
                 not worked out for this kind of log."
            }
            false => {
                "No gap means: nothing larger than the sizes under \"what would have been noticed\"."
            }
        };
        blocks.push(Block::Paragraph(means.to_owned()));
    }
    if !diagnosis.plausibility.is_empty() {
        blocks.push(tables::plausibility(diagnosis)?.into());
    }
    let noticed = "What would have been noticed, and from which size on";
    let invisible = "Invisible: the model takes them for its own parameters";
    let untestable = "Untestable: this log lacks what they need";
    let counts = [
        (noticed, diagnosis.detectable.len()),
        (invisible, diagnosis.invisible.len()),
        (untestable, diagnosis.untestable.len()),
    ];
    let all = [
        tables::detectable(diagnosis)?,
        tables::invisible(diagnosis)?,
        tables::untestable(diagnosis)?,
    ];
    for ((summary, count), table) in counts.into_iter().zip(all) {
        if count > 0 {
            blocks.push(Block::Folded {
                summary: format!("{summary} ({count})"),
                blocks: vec![table.into()],
            });
        }
    }
    if blocks.is_empty() {
        blocks.push(Block::Paragraph("Nothing is listed.".to_owned()));
    }
    Ok(blocks)
}

fn provenance(diagnosis: &Diagnosis) -> Result<Table, Error> {
    let from = &diagnosis.provenance;
    let (all, fixed) = (from.base_parameters, from.base_identifiable);
    let mut rows = vec![
        ("rows", from.rows.to_string()),
        ("held out", diagnosis.held_out.clone()),
        (
            "parameters of the model",
            format!("{all}, {fixed} fixed by the log"),
        ),
        (
            "last step of its fit",
            format!(
                "{:.1e} standard deviations of the residuals",
                from.last_step
            ),
        ),
        ("effects at their places tested", from.tested.to_string()),
        ("left out on request", from.without.join(", ")),
        ("thresholds", from.thresholds.clone()),
        (
            "probability of none of the catalogue",
            percent(diagnosis.probability_unknown),
        ),
    ];
    rows.retain(|(_, value)| !value.is_empty());
    facts("What the answer rests on", rows)
}

#[cfg(test)]
mod tests {
    use super::*;
    use haptical_diagnosis::NoReduction;

    use crate::diagnose::example_tests::{named, no_gap, unknown};
    use crate::files::InputFile;
    use crate::files::Record;

    fn html(diagnosis: &Diagnosis) -> String {
        let input = |flag: &str, file: &str| InputFile {
            flag: flag.to_owned(),
            file: file.to_owned(),
            bytes: 1,
            sha256: "0".to_owned(),
        };
        let inputs = vec![input("log", "log.csv"), input("validate", "log2.csv")];
        let record = Record::new("0", "diagnose", Vec::new(), inputs);
        let (repaired, arm, joints, record) = (None, None, Some("joint 2 is elbow"), &record);
        let besides = Besides {
            repaired,
            arm,
            joints,
            record,
        };
        page(diagnosis, besides).unwrap()
    }

    /// Positions of texts in the page, all present.
    fn positions(page: &str, texts: &[&str]) -> Vec<usize> {
        let find = |text: &&str| page.find(text).unwrap_or_else(|| panic!("no `{text}`"));
        texts.iter().map(find).collect()
    }

    #[test]
    fn a_named_page_answers_in_the_order_of_the_questions() {
        let page = html(&named());
        let order = positions(
            &page,
            &[
                "explains the gap",
                "In the robot description joint 2 is elbow.",
                "Gap of out2",
                "What to do next:",
                "Channel by channel",
                "before and after",
                "stretches with the torque",
                "258 [243, 273] N m/rad",
                "nats behind the best",
                "What would have been noticed",
                "Invisible: the model takes",
                "Untestable: this log lacks",
                "correlation of successive rows",
                "log2.csv",
            ],
        );
        assert!(order.is_sorted(), "{order:?}");
        assert_eq!(page.matches("<svg").count(), 3);
        assert!(!page.contains("was left out"), "a figure is missing");
        assert!(!page.contains("not finite"));
    }

    /// Of a channel that leaves less than its noise floor no share is known: the picture shows one whose share is.
    #[test]
    fn the_picture_is_of_a_channel_whose_closed_share_is_known() {
        let mut diagnosis = named();
        let out2 = &mut diagnosis.gap.channels[1];
        (out2.reduction_percent, out2.reduction_ci95) = (None, None);
        out2.no_reduction = Some(NoReduction::FloorContradicted);
        out2.noise_floor_ci95[1] = 1e4 * out2.noise_floor;
        let known = &mut diagnosis.gap.channels[2];
        known.reduction_percent = Some(99.0);
        let page = html(&diagnosis);
        assert!(page.contains(&format!("Gap of {}", diagnosis.gap.channels[2].channel)));
        assert!(!page.contains("Gap of out2"));
        // nor is an upper end written that says nothing
        assert!(page.contains("or more"));
    }

    #[test]
    fn a_page_without_a_gap_shows_what_could_have_been_noticed() {
        let page = html(&no_gap());
        positions(
            &page,
            &["No gap.", "nothing larger than", "20.0 µrad", "30.0 µrad"],
        );
        assert!(!page.contains("Causes") && !page.contains("Candidates"));
        assert_eq!(page.matches("<svg").count(), 1);
    }

    #[test]
    fn an_unknown_page_shows_where_it_is() {
        let page = html(&unknown());
        positions(
            &page,
            &[
                "no effect of the catalogue",
                "near theta2 = 0.25 rad",
                "residual over torque2",
            ],
        );
        assert!(!page.contains("Causes"));
    }

    #[test]
    fn the_same_diagnosis_gives_the_same_page() {
        assert_eq!(html(&named()), html(&named()));
    }
}
