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
        Self {
            page: page.display().to_string(),
            bytes,
            rows: recorded.rows,
            rows_shown: recorded.len(),
            every: recorded.every,
            axis: if recorded.axis.is_time { "t_s" } else { "row" },
            channels: recorded
                .channels
                .iter()
                .map(|channel| WrittenChannel {
                    channel: channel.name.clone(),
                    unit: channel.si_unit,
                    readings: channel.nominal.iter().flatten().count(),
                    rms_nominal: channel.rms_nominal,
                    rms_calibrated: channel.rms_calibrated,
                })
                .collect(),
            warnings,
        }
    }

    pub(super) fn json(&self) -> Result<String, Failure> {
        let mut json = serde_json::to_string_pretty(self).map_err(Failure::internal)?;
        json.push('\n');
        Ok(json)
    }

    pub(super) fn text(&self) -> Result<String, Failure> {
        let title = format!(
            "Errors, root mean square over the {} of {} rows on the page",
            self.rows_shown, self.rows
        );
        let columns = "channel | unit | readings | nominal | calibrated";
        let mut table = Table::with_heads(title, columns);
        for channel in &self.channels {
            let shown = Shown::fine(channel.unit);
            table.push(vec![
                channel.channel.as_str().into(),
                shown.name.into(),
                Cell::number(channel.readings as f64, 0),
                rms_cell(channel.rms_nominal, shown),
                rms_cell(channel.rms_calibrated, shown),
            ])?;
        }
        let table = if self.channels.is_empty() {
            format!(
                "{} of {} rows, no errors to show",
                self.rows_shown, self.rows
            )
        } else {
            table.to_terminal()
        };
        Ok(format!(
            "{table}\n\nWritten:\n  {} ({:.1} MB)\n",
            self.page,
            1e-6 * self.bytes as f64
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

fn rms_cell(rms: Option<f64>, shown: Shown) -> Cell {
    rms.map_or(Cell::Missing, |rms| shown.cell(rms))
}
