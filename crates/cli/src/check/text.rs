//! The findings of `haptical check` as text for a terminal.

use std::fmt::Write as _;

use haptical_report::{Cell, Column, Table};

use super::{Findings, JointFindings, LogFindings};
use crate::failure::Failure;

/// Names per line of the list of identifiable parameters.
const NAMES_PER_LINE: usize = 8;

/// The findings as text.
pub(crate) fn text(findings: &Findings) -> Result<String, Failure> {
    let device = &findings.device;
    let mut text = String::new();
    let _ = writeln!(
        text,
        "{}: {}; joints: {}, links: {}, cable encoders: {}",
        device.file,
        device.name,
        device.joints.len(),
        device.links,
        device.cables
    );
    if let Some(log) = &findings.log {
        describe_log(&mut text, log);
    }
    let _ = writeln!(text, "{}", joint_table(&device.joints)?.to_terminal());
    if let Some(log) = &findings.log {
        describe_identifiability(&mut text, log);
    } else {
        let _ = writeln!(text, "The device file is valid.");
    }
    Ok(text)
}

fn describe_log(text: &mut String, log: &LogFindings) {
    let _ = write!(text, "{}: {} rows", log.file, log.rows);
    if log.runs > 1 {
        let _ = write!(text, " in {} runs", log.runs);
    }
    let _ = match log.rate_hz {
        Some(rate) => writeln!(text, ", {rate:.1} Hz"),
        None => writeln!(text, ", no times"),
    };
    let channels: Vec<String> = log
        .channels
        .iter()
        .map(|channel| format!("{} ({})", channel.channel, channel.readings))
        .collect();
    let _ = writeln!(text, "channels (readings): {}", channels.join(", "));
    if !log.covariates.is_empty() {
        let _ = writeln!(text, "covariates: {}", log.covariates.join(", "));
    }
}

fn joint_table(joints: &[JointFindings]) -> Result<Table, Failure> {
    let columns = [
        "joint",
        "transmission",
        "ratio",
        "readings from",
        "to",
        "lower limit",
        "upper limit",
        "unit",
    ];
    let columns = columns.map(|name| Column::new(name, "")).to_vec();
    let mut table = Table::new("", columns);
    for joint in joints {
        table.push(vec![
            joint.name.as_str().into(),
            joint.transmission.into(),
            Cell::number(joint.ratio, 3),
            Cell::number_or_missing(joint.readings.map(|range| range[0]), 3),
            Cell::number_or_missing(joint.readings.map(|range| range[1]), 3),
            Cell::number_or_missing(joint.lower, 3),
            Cell::number_or_missing(joint.upper, 3),
            joint.unit.into(),
        ])?;
    }
    Ok(table)
}

fn describe_identifiability(text: &mut String, log: &LogFindings) {
    let _ = writeln!(
        text,
        "\nAt the nominal device this log could identify {} of {} parameters:",
        log.identifiable.len(),
        log.identifiability.candidates
    );
    for names in log.identifiable.chunks(NAMES_PER_LINE) {
        let _ = writeln!(text, "  {}", names.join(" "));
    }
    if !log.not_identified.is_empty() {
        let _ = writeln!(text, "Not these:");
    }
    for refused in &log.not_identified {
        let _ = writeln!(text, "  {:<10} {}", refused.status, refused.reason);
    }
}
