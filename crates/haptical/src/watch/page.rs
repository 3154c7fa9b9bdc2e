//! The page of a watch, which asks the browser to load it again.

use haptical_report::{Block, Cell, Document, Section, Table, Tone};

use super::state::{WatchState, WatchVerdict, when};
use super::{COMMAND, WatchChannel, WatchEvent};
use crate::error::Error;
use crate::files::sealed_text;
use crate::units::Shown;

impl WatchState {
    /// The page as HTML; the browser loads it again every so many seconds, 0 for never.
    ///
    /// # Errors
    /// A fault of this library alone.
    pub fn page(&self, refresh_s: u32) -> Result<String, Error> {
        let (tone, label) = match self.verdict {
            WatchVerdict::NotJudged if self.reference.is_some() => (Tone::Neutral, "not judged"),
            WatchVerdict::NotJudged => (Tone::Neutral, "reference"),
            WatchVerdict::True => (Tone::Good, "✓ true"),
            WatchVerdict::Untrue => (Tone::Bad, "✗ not true"),
        };
        let text = match (&self.alarm, self.verdict) {
            (Some(alarm), _) => WatchEvent::Alarm(alarm.clone()).line(),
            (None, WatchVerdict::NotJudged) => format!("{}.", self.why_not_judged()),
            _ => "The residuals are what they were in the reference.".to_owned(),
        };
        let label = label.to_owned();
        let mut answer = vec![Block::Notice { tone, label, text }];
        if let Some(cause) = &self.cause {
            let lines = WatchEvent::Cause(cause.clone()).line();
            answer.extend(lines.lines().map(|line| Block::Paragraph(line.to_owned())));
        }
        answer.extend(self.ceased.iter().map(|own| Block::Paragraph(own.line())));
        let mut facts = vec![
            format!(
                "{} rows, the last at {}",
                self.rows,
                self.last_s.map_or("no time".to_owned(), when)
            ),
            format!("evidence: {:.1e} of what an alarm needs", self.evidence),
            format!(
                "left out: {} lines that are no rows, {} rows out of order; {} readings beyond eight scales, which count as eight",
                self.left_out.unreadable, self.left_out.out_of_order, self.wild_readings
            ),
        ];
        if let Some(reference) = &self.reference {
            facts.push(WatchEvent::Reference(reference.clone()).line());
        }
        let mut sections = vec![Section::new("Is the calibration true?", answer)];
        if !self.channels.is_empty() {
            let table = channels(&self.channels)?;
            sections.push(Section::new("Channels", vec![table.into()]));
        }
        sections.push(Section::new("What was read", vec![Block::List(facts)]));
        let lead = format!("{}: the rows of its log as they come.", self.device);
        let html = Document::new("Watch", lead, sections).to_html();
        let again = format!("<meta http-equiv=\"refresh\" content=\"{refresh_s}\"></head>");
        let html = match refresh_s {
            0 => html,
            _ => html.replacen("</head>", &again, 1),
        };
        let by = format!("haptical {COMMAND}");
        Ok(sealed_text(&html, &by, ["<!-- ", " -->"]))
    }
}

fn channels(channels: &[WatchChannel]) -> Result<Table, Error> {
    let heads = "channel | mean residual since the reference, last blocks | 95 % interval | unit";
    let rows = channels.iter().map(|own| {
        let shown = Shown::fine(&own.unit);
        let [low, high] = own.shift_ci95.map(|end| end * shown.per_si);
        vec![
            (&own.channel).into(),
            shown.cell(own.shift),
            Cell::interval(low, high, 3),
            shown.name.into(),
        ]
    });
    let title = "How far the channels stand from the reference";
    Ok(Table::with_heads(title, heads).with_rows(rows)?)
}
