//! The findings of a check as text for a terminal.

use std::fmt::{Display, Error, Formatter, Result, Write};

use haptical_report::{Cell, ReportError, Table};

use super::{Checked, CheckedDevice, CheckedJoint, CheckedLog};
use crate::identify::refused;
use crate::lines::labelled;

/// Names per line of the list of identifiable parameters.
const NAMES_PER_LINE: usize = 8;

impl Display for Checked {
    fn fmt(&self, text: &mut Formatter<'_>) -> Result {
        let CheckedDevice {
            file,
            name,
            links,
            cables,
            joints,
        } = &self.device;
        let count = joints.len();
        writeln!(
            text,
            "{file}: {name}; joints: {count}, links: {links}, cable encoders: {cables}"
        )?;
        if let Some(log) = &self.log {
            describe_log(text, log)?;
        }
        let joints = joint_table(joints).map_err(|_| Error)?;
        writeln!(text, "{}", joints.to_terminal())?;
        match &self.log {
            Some(log) => {
                describe_identifiability(text, log)?;
                match log.good_for.is_empty() {
                    true => text.write_str(&labelled("", &self.named_rows, 0)),
                    false => Ok(()),
                }
            }
            None => writeln!(text, "The device file is valid."),
        }
    }
}

fn describe_log(text: &mut impl Write, log: &CheckedLog) -> Result {
    write!(text, "{}: {} rows", log.file, log.rows)?;
    if log.runs > 1 {
        write!(text, " in {} runs", log.runs)?;
    }
    match log.rate_hz {
        Some(rate) => writeln!(text, ", {rate:.1} Hz")?,
        None => writeln!(text, ", no times")?,
    }
    let channels = log.channels.iter();
    let channels = channels.map(|channel| format!("{} ({})", channel.channel, channel.readings));
    let channels: Vec<String> = channels.collect();
    writeln!(text, "channels (readings): {}", channels.join(", "))?;
    if !log.covariates.is_empty() {
        writeln!(text, "covariates: {}", log.covariates.join(", "))?;
    }
    Ok(())
}

/// Never refused but for a number that is none.
fn joint_table(joints: &[CheckedJoint]) -> std::result::Result<Table, ReportError> {
    let heads =
        "joint | transmission | ratio | readings from | to | lower limit | upper limit | unit";
    let rows = joints.iter().map(|joint| {
        vec![
            (&joint.name).into(),
            joint.transmission.into(),
            Cell::number(joint.ratio, 3),
            Cell::number_or_missing(joint.readings.map(|range| range[0]), 3),
            Cell::number_or_missing(joint.readings.map(|range| range[1]), 3),
            Cell::number_or_missing(joint.lower, 3),
            Cell::number_or_missing(joint.upper, 3),
            joint.unit.into(),
        ]
    });
    Table::with_heads("", heads).with_rows(rows)
}

fn describe_identifiability(text: &mut impl Write, log: &CheckedLog) -> Result {
    if !log.good_for.is_empty() {
        return writeln!(text, "\n{}", log.good_for.join("\n"));
    }
    writeln!(
        text,
        "\nAt the nominal device this log could identify {} of {} parameters:",
        log.identifiable.len(),
        log.identifiable.len() + log.not_identified.len()
    )?;
    for names in log.identifiable.chunks(NAMES_PER_LINE) {
        writeln!(text, "  {}", names.join(" "))?;
    }
    if !log.not_identified.is_empty() {
        writeln!(text, "Not these:")?;
    }
    text.write_str(&refused::lines(&log.not_identified))
}
