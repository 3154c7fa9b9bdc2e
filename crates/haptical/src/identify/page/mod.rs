//! identify.html: the result in words, tables and figures.

mod channel_figures;
mod outliers;
mod parameter_tables;
mod transmission_figures;

use haptical_calibration::Calibration;
use haptical_model::Recording;
use haptical_report::{Block, Cell, Document, Section, Table};

use super::result::Identified;
use super::summary::{channel_table, effect_line, force_sentence, judged_table, main_channel};
use crate::error::Error;
use crate::page::facts;
use crate::units::Shown;

/// The whole page.
pub(super) fn page(
    result: &Identified,
    calibration: &Calibration,
    recording: &Recording,
) -> Result<String, Error> {
    let figures = channel_figures::blocks(calibration, recording)?;
    let mut sections = vec![residuals(result)?, Section::new("Residuals", figures)];
    if !result.outliers.is_empty() {
        sections.push(outliers::section(result)?);
    }
    let transmissions = transmission_figures::blocks(result, calibration, recording)?;
    if !transmissions.is_empty() {
        sections.push(Section::new("Transmissions", transmissions));
    }
    if !result.effects.is_empty() {
        let lines = result.effects.iter().map(effect_line);
        let list = vec![Block::List(lines.collect())];
        sections.push(Section::new("Effects", list));
    }
    let mut parameters = vec![parameter_tables::identified(result)?.into()];
    parameters.extend(parameter_tables::combinations(result)?);
    sections.push(Section::new("Parameters", parameters));
    let refused = parameter_tables::not_identified(result)?;
    sections.push(Section::new("What was not identified", refused));
    let correlations = vec![parameter_tables::correlations(result)?];
    sections.push(Section::new("Correlations", correlations));
    if !result.warnings.is_empty() {
        let list = vec![Block::List(result.warnings.clone())];
        sections.push(Section::new("Warnings", list));
    }
    sections.push(provenance(result)?);
    let title = format!("Identification of {}", calibration.nominal.name);
    Ok(Document::new(title, lead(result), sections).to_html())
}

/// The result in words, by the channel that matters most.
fn lead(result: &Identified) -> String {
    let Some(channel) = main_channel(result) else {
        return format!("The result is {}.", result.held_out);
    };
    let shown = Shown::fine(&channel.unit);
    let fixed = result.parameters.len() - result.not_identified.len();
    let outliers = match channel.outliers {
        0 => String::new(),
        1 => "; 1 outlier is left out of these figures".to_owned(),
        count => format!("; {count} outliers are left out of these figures"),
    };
    let force = force_sentence(result).map_or_else(String::new, |force| format!(" {force}"));
    format!(
        "The root mean square residual of {} is {} before and {} after identification; the noise \
         floor is {}{outliers}. Rows that this is measured on: {}. {fixed} of {} parameters were identified \
         from {} rows.{force}",
        channel.channel,
        shown.text(channel.rms_before_good),
        shown.text(channel.rms_after_good),
        shown.text(channel.noise_floor),
        result.held_out,
        result.parameters.len(),
        result.rows,
    ) + &result
        .next
        .as_ref()
        .map_or_else(String::new, |next| format!(" {next}"))
}

fn residuals(result: &Identified) -> Result<Section, Error> {
    let mut table = judged_table("Root mean square of model minus measurement", result)?;
    table.notes = vec![
        format!("Rows: {}.", result.held_out),
        "Noise floor: root mean square of the stated noise, the motor encoders' quantization \
         included. Reduction: share of the gap between residual and floor that was closed."
            .to_owned(),
    ];
    let mut blocks = vec![table.into()];
    if result.held_out != "nothing held out" {
        let title = "The same on the rows of the fit";
        blocks.push(channel_table(title, &result.channels_fit)?.into());
    }
    Ok(Section::new("Result", blocks))
}

fn provenance(result: &Identified) -> Result<Section, Error> {
    let convergence = result.convergence.map_or_else(
        || "no parameter was fitted".to_owned(),
        |convergence| convergence.to_string(),
    );
    let search = format!("{convergence}, {} steps", result.iterations);
    let fitted = [
        ("rows", result.rows.to_string()),
        ("method", result.method.to_owned()),
        ("held out", result.held_out.clone()),
        ("search", search),
    ];
    let fitted = facts("What was fitted", fitted)?;
    let noise = result.noise.iter().map(|(name, entry)| {
        let shown = Shown::fine(result.unit(name));
        vec![
            name.into(),
            shown.name.into(),
            shown.cell(entry.stated),
            Cell::number(entry.factor, 3),
        ]
    });
    let columns = "channel | unit | stated noise | factor";
    let noise =
        Table::with_heads("Noise that the fit was weighted by", columns).with_rows(noise)?;
    let noise = noise.with_note(
        "The factor is estimated from the residuals, 1 where the stated noise was taken.",
    );
    let tables = [result.provenance.table()?, fitted, noise];
    Ok(Section::new("Provenance", tables.map(Block::Table).into()))
}
