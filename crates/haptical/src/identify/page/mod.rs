//! report.html: the result in words, tables and figures.

mod channel_figures;
mod outliers;
mod parameter_tables;
mod transmission_figures;

use haptical_calibration::{Calibration, ChannelReport};
use haptical_model::{Device, Recording};
use haptical_report::{Block, Cell, Document, Section, Table};

use super::result::Identified;
use super::summary::{channel_table, force_sentence, judged_table};
use crate::error::Error;
use crate::units::Shown;

/// Size of a figure \[px\].
const FIGURE_PX: (u32, u32) = (860, 340);
/// Most points of a series; of longer ones every k-th is drawn.
const MOST_POINTS: usize = 800;

/// The whole page.
pub(super) fn page(
    result: &Identified,
    calibration: &Calibration,
    nominal: &Device,
    recording: &Recording,
) -> Result<String, Error> {
    let mut sections = vec![residuals(result)?];
    sections.push(Section::new(
        "Residuals",
        channel_figures::blocks(calibration, recording)?,
    ));
    if !result.outliers.is_empty() {
        sections.push(outliers::section(result)?);
    }
    let transmissions = transmission_figures::blocks(result, calibration, recording)?;
    if !transmissions.is_empty() {
        sections.push(Section::new("Transmissions", transmissions));
    }
    sections.push(Section::new(
        "Parameters",
        parameter_tables::identified(result)?,
    ));
    sections.push(Section::new(
        "What was not identified",
        parameter_tables::not_identified(result)?,
    ));
    sections.push(Section::new(
        "Correlations",
        parameter_tables::correlations(result)?,
    ));
    if !result.warnings.is_empty() {
        sections.push(Section::new(
            "Warnings",
            vec![Block::List(result.warnings.clone())],
        ));
    }
    sections.push(provenance(result)?);
    let title = format!("Identification of {}", nominal.name);
    Ok(Document::new(title, lead(result), sections).to_html())
}

/// The result in words, by the channel that matters most: one that sees the whole chain, else the
/// external encoder with the largest residual.
fn lead(result: &Identified) -> String {
    let by_size = |a: &&ChannelReport, b: &&ChannelReport| a.rms_before.total_cmp(&b.rms_before);
    let chain = result
        .channels
        .iter()
        .find(|channel| channel.joint.is_none());
    let outputs = result.channels.iter().max_by(by_size);
    let Some(channel) = chain.or(outputs) else {
        return format!("The result is {}.", result.held_out);
    };
    let shown = Shown::fine(&channel.unit);
    let fixed = result.parameters.len() - result.not_identified.len();
    let outliers = match channel.outliers {
        0 => String::new(),
        1 => "; 1 outlier is left out of these figures".to_owned(),
        count => format!("; {count} outliers are left out of these figures"),
    };
    let mut text = format!(
        "The root mean square residual of {} is {} before and {} after identification; the noise \
         floor is {}{outliers}. Rows that this is measured on: {}. {fixed} of {} parameters were identified \
         from {} rows.",
        channel.channel,
        shown.text(channel.rms_before_good),
        shown.text(channel.rms_after_good),
        shown.text(channel.noise_floor),
        result.held_out,
        result.parameters.len(),
        result.rows,
    );
    if let Some(force) = force_sentence(result) {
        text = format!("{text} {force}");
    }
    text
}

fn residuals(result: &Identified) -> Result<Section, Error> {
    let mut table = judged_table("Root mean square of model minus measurement", result)?;
    table.notes = vec![
        format!("Rows: {}.", result.held_out),
        "Noise floor: root mean square of the stated noise, the motor encoders' quantization \
         included. Reduction: share of the gap between residual and floor that was closed."
            .to_owned(),
    ];
    let mut blocks = vec![Block::Table(table)];
    if result.held_out != "nothing held out" {
        blocks.push(Block::Table(channel_table(
            "The same on the rows of the fit",
            &result.channels_fit,
        )?));
    }
    Ok(Section::new("Result", blocks))
}

fn provenance(result: &Identified) -> Result<Section, Error> {
    let columns = "what | value";
    let mut table = Table::with_heads("What was fitted", columns);
    let convergence = result.convergence.map_or_else(
        || "no parameter was fitted".to_owned(),
        |convergence| convergence.to_string(),
    );
    for (what, value) in [
        ("rows", result.rows.to_string()),
        ("method", result.method.to_owned()),
        ("held out", result.held_out.clone()),
        (
            "search",
            format!("{convergence}, {} steps", result.iterations),
        ),
    ] {
        table.push(vec![what.into(), value.into()])?;
    }
    let mut blocks = vec![result.provenance.table()?, Block::Table(table)];
    let columns = "channel | unit | stated noise | factor";
    let mut noise = Table::with_heads("Noise that the fit was weighted by", columns);
    noise.notes = vec![
        "The factor is estimated from the residuals, 1 where the stated noise was taken."
            .to_owned(),
    ];
    for (name, entry) in &result.noise {
        let all = result.channels.iter().chain(&result.channels_fit);
        let unit = all
            .filter(|channel| channel.channel == *name)
            .map(|channel| channel.unit.as_str())
            .next();
        let shown = Shown::fine(unit.unwrap_or_default());
        noise.push(vec![
            name.as_str().into(),
            shown.name.into(),
            shown.cell(entry.stated),
            Cell::number(entry.factor, 3),
        ])?;
    }
    blocks.push(Block::Table(noise));
    Ok(Section::new("Provenance", blocks))
}

/// At most [`MOST_POINTS`] points, evenly chosen.
fn thinned(points: Vec<(f64, f64)>) -> Vec<(f64, f64)> {
    let step = points.len().div_ceil(MOST_POINTS).max(1);
    points.into_iter().step_by(step).collect()
}
