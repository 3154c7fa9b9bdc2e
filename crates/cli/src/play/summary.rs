//! The summary that `haptical play` prints of its page.

use std::path::Path;

use haptical_report::{Cell, Table};
use serde::Serialize;

use super::recorded::{ChannelErrors, Recorded};
use crate::failure::Failure;
use haptical::units::{Shown, decimals};

/// What was written; `--json` prints it.
#[derive(Debug, Serialize)]
pub(crate) struct Written {
    page: String,
    bytes: usize,
    rows: usize,
    rows_shown: usize,
    every: usize,
    /// `t_s` or `row`.
    axis: &'static str,
    channels: Vec<WrittenChannel>,
    warnings: Vec<String>,
}

#[derive(Debug, Serialize)]
struct WrittenChannel {
    channel: String,
    unit: &'static str,
    readings: usize,
    rms_nominal: Option<f64>,
    rms_calibrated: Option<f64>,
}

impl Written {
    pub(super) fn new(
        recorded: &Recorded,
        page: &Path,
        bytes: usize,
        warnings: Vec<String>,
    ) -> Self {
        let channels = recorded.channels.iter().map(|channel| WrittenChannel {
            channel: channel.name.clone(),
            unit: channel.si_unit,
            readings: channel.nominal.iter().flatten().count(),
            rms_nominal: channel.rms_nominal,
            rms_calibrated: channel.rms_calibrated,
        });
        Self {
            page: page.display().to_string(),
            bytes,
            rows: recorded.rows,
            rows_shown: recorded.len(),
            every: recorded.every,
            axis: if recorded.axis.is_time { "t_s" } else { "row" },
            channels: channels.collect(),
            warnings,
        }
    }

    pub(super) fn text(&self) -> Result<String, Failure> {
        let (shown, all) = (self.rows_shown, self.rows);
        let title = format!("Errors, root mean square over the {shown} of {all} rows on the page");
        let rows = self.channels.iter().map(|channel| {
            let unit = Shown::fine(channel.unit);
            let rms = |rms: Option<f64>| rms.map_or(Cell::Missing, |rms| unit.cell(rms));
            vec![
                (&channel.channel).into(),
                unit.name.into(),
                Cell::number(channel.readings as f64, 0),
                rms(channel.rms_nominal),
                rms(channel.rms_calibrated),
            ]
        });
        let columns = "channel | unit | readings | nominal | calibrated";
        let table = Table::with_heads(title, columns).with_rows(rows)?;
        let table = match self.channels.is_empty() {
            true => format!("{shown} of {all} rows, no errors to show"),
            false => table.to_terminal(),
        };
        let (page, megabytes) = (&self.page, 1e-6 * self.bytes as f64);
        Ok(format!(
            "{table}\n\nWritten:\n  {page} ({megabytes:.1} MB)\n"
        ))
    }
}

/// The two sizes of a channel for the page, in the channel's unit for people.
pub(super) fn rms_texts(channel: &ChannelErrors) -> [String; 2] {
    let shown = Shown::fine(channel.si_unit);
    [channel.rms_nominal, channel.rms_calibrated].map(|rms| match rms {
        Some(rms) => format!("{:.*}", decimals(rms * shown.per_si), rms * shown.per_si),
        None => "–".to_owned(),
    })
}
