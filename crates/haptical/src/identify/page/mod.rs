//! identify.html: the result in words, tables and figures.

mod channel_figures;
mod outliers;
mod parameter_tables;
mod transmission_figures;

use std::path::Path;

use haptical_calibration::Calibration;
use haptical_model::Recording;
use haptical_report::{Block, Cell, Table, Tone};

use super::moved;
use super::result::Identified;
use super::summary::{channel_table, effect_line, force_sentence, judged_table};
use crate::device::is_urdf;
use crate::error::Error;
use crate::files::{FIT_FLAGS, shell_word};
use crate::page::{Page, arm, facts, next};
use crate::units::Shown;

/// The whole page.
pub(super) fn page(
    result: &Identified,
    calibration: &Calibration,
    recording: &Recording,
) -> Result<String, Error> {
    let mut figures = channel_figures::blocks(calibration, recording)?;
    let (given, found) = (&calibration.nominal, &calibration.device);
    let arm = arm::picture(given, found, recording, "as identified")?;
    let main = arm.or_else(|| {
        let is_drawn = |block: &Block| matches!(block, Block::Svg { .. });
        let first = figures.iter().position(is_drawn);
        first.map(|index| figures.remove(index))
    });
    let mut page = Page::new(answer(result, calibration, main)?);
    page.fold("Residuals in numbers", residuals(result)?);
    page.fold("Residuals in figures", figures);
    if !result.outliers.is_empty() {
        page.fold("Outliers", outliers::blocks(result)?);
    }
    let transmissions = transmission_figures::blocks(result, calibration, recording)?;
    page.fold("Transmissions", transmissions);
    if !result.effects.is_empty() {
        let lines = result.effects.iter().map(effect_line);
        page.fold("Effects", vec![Block::List(lines.collect())]);
    }
    if result.moved.len() > moved::LISTED {
        let table = moved::table("", &result.moved)?;
        page.fold("All that moved", vec![table.into()]);
    }
    let mut parameters = vec![parameter_tables::identified(result)?.into()];
    parameters.extend(parameter_tables::combinations(result)?);
    page.fold("Parameters", parameters);
    let refused = parameter_tables::not_identified(result)?;
    page.fold("What was not identified", refused);
    let correlations = parameter_tables::correlations(result)?;
    page.fold("Correlations", vec![correlations]);
    page.warnings(&result.warnings);
    page.fold("Provenance", provenance(result)?);
    Ok(page.into_html(format!("Identification of {}", calibration.nominal.name)))
}

/// What came out, the picture of it, what moved most, and what to do next.
fn answer(
    result: &Identified,
    calibration: &Calibration,
    picture: Option<Block>,
) -> Result<Vec<Block>, Error> {
    let (tone, label) = match (&result.rejected, &result.next) {
        (Some(_), _) => (Tone::Bad, "Not kept."),
        (None, Some(_)) => (Tone::Neutral, "Identified, but more than noise is left."),
        (None, None) => (Tone::Good, "Identified."),
    };
    let mut blocks = vec![Block::notice(tone, label, &result.answer)];
    blocks.extend(force_sentence(result).map(Block::Paragraph));
    blocks.extend(picture);
    if let Some(table) = moved::most(&result.moved)? {
        let note = moved::note(&result.moved, result.next.is_some());
        blocks.push(table.with_note(note).into());
    }
    let words = result.next.clone().unwrap_or_else(|| {
        "nothing is left above the noise on rows that the fit did not see: use identified.toml, which is in this folder".to_owned()
    });
    blocks.extend(next(&words, commands(result, calibration)));
    Ok(blocks)
}

/// Commands that go on from here, as one would type them where this one was typed.
fn commands(result: &Identified, calibration: &Calibration) -> Vec<(String, String)> {
    let record = &result.provenance;
    let logs = record.inputs.iter().filter(|input| input.flag == "log");
    let logs = logs.map(|log| format!(" --log {}", shell_word(&log.file)));
    let diagnose = match result.effects.is_empty() {
        true => format!("haptical diagnose{} --out gap", record.typed(&FIT_FLAGS)),
        // the given device lacks the effects, and the gap that they were found in is kept
        false => format!(
            "haptical diagnose --device identified.toml{} --out gap-after",
            logs.collect::<String>()
        ),
    };
    let mut commands = vec![(
        "Which effect causes what is left, or that none does:".to_owned(),
        diagnose,
    )];
    if calibration.nominal.has_links() {
        let description = record.inputs.iter().find(|input| input.flag == "device");
        let urdf = description.filter(|input| is_urdf(Path::new(&input.file)));
        let export = match urdf {
            Some(input) => format!(
                "haptical export --device identified.toml --format urdf --urdf {}{} --out calibrated.urdf",
                shell_word(&input.file),
                record.typed(&["--base", "--tip"])
            ),
            None => {
                "haptical export --device identified.toml --format mjcf --out model.xml".to_owned()
            }
        };
        commands.push(("The identified device for a simulator:".to_owned(), export));
        let controller = "haptical export --device identified.toml --format rust --out model.rs";
        commands.push((
            "The same for a control loop (or c-header, json):".to_owned(),
            controller.to_owned(),
        ));
    }
    commands
}

fn residuals(result: &Identified) -> Result<Vec<Block>, Error> {
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
    Ok(blocks)
}

fn provenance(result: &Identified) -> Result<Vec<Block>, Error> {
    let convergence = result.convergence.map(|own| own.to_string());
    let convergence = convergence.unwrap_or("no parameter was fitted".to_owned());
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
    Ok(tables.map(Block::Table).into())
}
