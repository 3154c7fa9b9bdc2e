//! The findings as a page: the answer, a picture of each finding, the episodes, the joints.

use haptical::servo::{EpisodeFinding, Fault};
use haptical_report::{Block, Document, Section, Tone};

use super::pictures::{HEIGHT_PX, WIDTH_PX, picture};
use super::{Examined, text, words};
use crate::failure::Failure;
use crate::flags::word;

/// Findings with a picture, at most.
const MOST_PICTURES: usize = 40;

pub(super) fn page(examined: &Examined) -> Result<String, Failure> {
    let sound = examined.report.is_sound();
    let (tone, label) = match sound {
        true => (Tone::Good, "Sound as far as tested:"),
        false => (Tone::Bad, "Found:"),
    };
    let mut sections = vec![Section::new(
        "Answer",
        vec![Block::notice(tone, label, text::headline(examined))],
    )];
    let findings = findings(examined)?;
    if !findings.is_empty() {
        sections.push(Section::new("Findings", findings));
    }
    let episodes = text::episodes(examined)?;
    if !episodes.rows().is_empty() {
        sections.push(Section::new("Episodes", vec![episodes.into()]));
    }
    sections.push(Section::new(
        "Not tested",
        vec![Block::List(words::not_tested(examined))],
    ));
    sections.push(Section::new("Joints", vec![text::joints(examined)?.into()]));
    let path = word(&examined.path);
    let command = |purpose: &str, command: String| Block::Command {
        purpose: purpose.to_owned(),
        command,
    };
    sections.push(Section::new(
        "Next",
        vec![
            command(
                "The same again:",
                format!("haptical doctor {path} --out doctor"),
            ),
            command(
                "To paste into the data set's page:",
                format!("haptical doctor {path} --comment"),
            ),
        ],
    ));
    let lead = format!(
        "{}: {} of {} joints, {} episodes, {} rows.",
        examined.path.display(),
        examined.recorded.kind,
        examined.recorded.names.len(),
        examined.recorded.episodes.len(),
        examined.recorded.time_s.len()
    );
    Ok(Document::new("Is this recording sound?", lead, sections).to_html())
}

fn findings(examined: &Examined) -> Result<Vec<Block>, Failure> {
    let all: Vec<(usize, &EpisodeFinding)> = (examined.report.joints.iter().enumerate())
        .flat_map(|(joint, report)| report.findings.iter().map(move |finding| (joint, finding)))
        .collect();
    let mut blocks = Vec::new();
    for (joint, finding) in all.iter().take(MOST_PICTURES) {
        let name = &examined.recorded.names[*joint];
        let what = words::what(*joint, finding, &examined.recorded);
        let place = words::place(finding, &examined.recorded);
        let svg = picture(examined, *joint, finding).to_svg(WIDTH_PX, HEIGHT_PX)?;
        blocks.push(Block::Svg {
            caption: format!("{name}, {place}: {what}. {}", remedy(&finding.fault)),
            svg,
        });
    }
    if all.len() > MOST_PICTURES {
        blocks.push(Block::Paragraph(format!(
            "The first {MOST_PICTURES} of {} findings have a picture; doctor.json has all.",
            all.len()
        )));
    }
    Ok(blocks)
}

/// What to do about a fault.
fn remedy(fault: &Fault) -> &'static str {
    match fault {
        Fault::Offset { .. } => {
            "Look for a joint that was homed anew, a horn or a coupling that slipped, or another calibration file."
        }
        Fault::Gain { .. } => {
            "Look for another calibrated range, another unit, or another gear ratio in the driver."
        }
        Fault::Latency { .. } => {
            "Look for another control rate, a filter, or a bus that another device shares."
        }
        Fault::Dead { .. } => {
            "Look for a motor without torque, an encoder cable, or a driver that repeats its last reading."
        }
        Fault::Swapped { .. } => "Look for motor numbers or names in another order.",
        Fault::Clipped { .. } => "Look for a limit in the driver or in the calibrated range.",
        _ => "",
    }
}
