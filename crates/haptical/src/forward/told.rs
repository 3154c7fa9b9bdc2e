//! Drifts as a table, a page and a CSV.

use std::fmt::Write;

use haptical_report::{Block, Cell, Document, Figure, Mark, Section, Series, Table};

use super::{Forward, KEPT_HORIZON_S};
use crate::device::Device;
use crate::error::Error;
use crate::log::Log;
use crate::page::{drawn, thinned};
use crate::units::Shown;

/// A size; one of a thousand of its small units in the SI unit.
fn sized(unit: Shown, size: f64) -> Cell {
    let is_large = size * unit.per_si >= 1e3 && unit.per_si > 1.0;
    match (is_large, unit.name) {
        (false, _) => unit.text(size),
        (true, "mrad") => format!("{size:.3} rad"),
        (true, _) => format!("{size:.3} m"),
    }
    .into()
}

impl Forward {
    /// Root mean squares of prediction minus log, horizon by horizon and joint by joint; torques of a controller too.
    ///
    /// # Errors
    /// A number that is not finite.
    pub fn table(&self, device: &Device) -> Result<Table, Error> {
        let has_torques = self.has_torques();
        let mut heads = "from the log's state every | joint".to_owned();
        for own in &self.devices {
            let _ = write!(heads, " | {} | at its end | largest", own.name);
            if has_torques {
                let _ = write!(heads, " | torque");
            }
        }
        let mut rows = Vec::new();
        let horizons = self.devices.first().map_or(0, |own| own.drifts.len());
        for horizon in 0..horizons {
            for (joint, own) in device.model.joints.iter().enumerate() {
                let mut row: Vec<Cell> = Vec::new();
                for (place, told) in self.devices.iter().enumerate() {
                    let drift = &told.drifts[horizon];
                    if place == 0 {
                        let horizon = drift.horizon_s;
                        row.push(horizon.map_or("run".into(), |s| format!("{s} s").into()));
                        row.push(own.name.as_str().into());
                    }
                    let unit = Shown::fine(own.unit());
                    let gap = &drift.joints[joint];
                    let sizes = [gap.rms, gap.end_rms, gap.largest];
                    row.extend(sizes.map(|size| sized(unit, size)));
                    if has_torques {
                        let unit = Shown::fine(own.torque_unit());
                        row.push(
                            gap.torque_rms
                                .map_or("".into(), |rms| unit.text(rms).into()),
                        );
                    }
                }
                rows.push(row);
            }
        }
        let title = "Prediction minus log, root mean square";
        Ok(Table::with_heads(title, &heads).with_rows(rows)?)
    }

    /// `t_s,run,start`, the log's `theta1_rad`, ..., then for each device its `before_theta1_rad`, ... with a controller
    /// also `before_torque1_nm`, ...; `start` is 1 where a prediction begins again, every [`KEPT_HORIZON_S`].
    pub fn csv(&self, device: &Device, log: &Log) -> String {
        let recording = log.recording.as_ref();
        let joints = &device.model.joints;
        let mut columns: Vec<(String, &[f64])> = Vec::new();
        let names = device.joint_columns();
        for (name, column) in names.iter().zip(&recording.joint) {
            columns.push((name.clone(), column));
        }
        for told in &self.devices {
            for (name, column) in names.iter().zip(&told.theta) {
                columns.push((format!("{}_{name}", told.name), column));
            }
            for (joint, column) in told.torque.iter().enumerate() {
                let name = joints[joint].torque_column(joint + 1);
                columns.push((format!("{}_{name}", told.name), column));
            }
        }
        let names: Vec<&str> = columns.iter().map(|(name, _)| name.as_str()).collect();
        let mut text = format!("t_s,run,start,{}\n", names.join(","));
        let mut starts = self.starts.iter().peekable();
        for row in 0..recording.len() {
            let is_start = starts.next_if_eq(&&row).is_some();
            let time_s = recording.time_s.as_ref().map_or(0.0, |time_s| time_s[row]);
            let run = recording.run_at(row);
            let _ = write!(text, "{time_s},{run},{}", u8::from(is_start));
            for (_, column) in &columns {
                let value = column[row];
                let _ = match value.is_finite() {
                    true => write!(text, ",{value}"),
                    false => write!(text, ","),
                };
            }
            text.push('\n');
        }
        text
    }

    /// A page with the table and, joint by joint, what is predicted minus what the log has.
    ///
    /// # Errors
    /// A number that cannot be drawn.
    pub fn page(&self, device: &Device, log: &Log) -> Result<String, Error> {
        let recording = log.recording.as_ref();
        let mut blocks = vec![Block::Table(self.table(device)?)];
        for (joint, own) in device.model.joints.iter().enumerate() {
            let unit = Shown::fine(own.unit());
            let mut figure = Figure::new(
                format!("Joint {}", own.name),
                "time [s]",
                format!("prediction minus log [{}]", unit.name),
            );
            for (colour, told) in self.devices.iter().enumerate() {
                let rows = told.theta[joint].iter().zip(&recording.joint[joint]);
                let times = recording.time_s.iter().flatten();
                let points = times.zip(rows).filter_map(|(time_s, (predicted, read))| {
                    let gap = (predicted - read) * unit.per_si;
                    gap.is_finite().then_some((*time_s, gap))
                });
                let series = Series::new(&told.name, Mark::Line, colour, thinned(points));
                figure.series.push(series);
            }
            let name = &own.name;
            let caption =
                format!("Joint {name}: begun again from the log's state every {KEPT_HORIZON_S} s.");
            blocks.push(drawn(&figure, caption)?);
        }
        let title = format!("Forward prediction: {}", device.model.name);
        let lead = "How far the equations of motion of a device drift from a log, from whose state they begin again after each time.";
        let sections = vec![Section::new("Drift", blocks)];
        Ok(Document::new(title, lead, sections).to_html())
    }

    /// Whether a controller's torques are compared.
    fn has_torques(&self) -> bool {
        let mut drifts = self.devices.iter().flat_map(|own| &own.drifts);
        drifts.any(|drift| drift.joints.iter().any(|own| own.torque_rms.is_some()))
    }
}
