//! identify.html of an identification of the dynamics.

use haptical_report::{Block, Cell, Figure, Mark, Series, Table, Tone};

use super::result::{IdentifiedDynamics, TorqueEntry};
use super::text::{bodies, in_words, joints, noise, torques};
use crate::error::Error;
use crate::files::FIT_FLAGS;
use crate::page::{Page, drawn, facts, next};

/// The whole page.
pub(super) fn page(result: &IdentifiedDynamics) -> Result<String, Error> {
    let mut sums = Table::with_heads(
        "Sums of numbers that the motion fixes".to_owned(),
        "sum | unit | before | found, with half the width of its 95 % interval | determined",
    );
    for own in &result.combinations {
        sums.push(vec![
            own.sum.as_str().into(),
            own.found.unit.into(),
            Cell::number(own.nominal, 4),
            in_words(&own.found).into(),
            if own.determined { "yes" } else { "no" }.into(),
        ])?;
    }
    sums.notes = vec![
        "m: mass; mx, my, mz: mass times centre; ixx ... iyz: inertia about the frame's origin; the number behind is the row's. \
         Not determined: the motion says no more of it than was known before."
            .to_owned(),
    ];
    let settings = [
        ("rows", result.rows.to_string()),
        ("band", format!("up to {} Hz", result.band_hz)),
        ("noise of positions kept out by", noise(result)),
        (
            "torques are logged after their positions by",
            format!("{:.2} ms", 1e3 * result.torque_delay_s.value),
        ),
    ];
    let mut blocks = vec![Block::notice(Tone::Good, "Identified.", &result.answer)];
    blocks.extend(left(result)?);
    let words = "use identified.toml, which is in this folder, and see which effects the torques show besides";
    blocks.extend(next(words, commands(result)));
    let mut page = Page::new(blocks);
    page.fold("Torques", vec![torques(result)?.into()]);
    page.fold("Joints", vec![joints(result)?.into()]);
    page.fold("Bodies", vec![bodies(result)?.into()]);
    page.fold("Sums", vec![sums.into()]);
    page.fold("What was fitted", vec![facts("", settings)?.into()]);
    page.warnings(&result.warnings);
    page.fold("Provenance", vec![result.provenance.table()?.into()]);
    Ok(page.into_html(format!("Dynamics of {}", result.device)))
}

/// The share of each torque that is not explained, before and after.
fn left(result: &IdentifiedDynamics) -> Result<Option<Block>, Error> {
    if result.torques.is_empty() {
        return Ok(None);
    }
    let names = result.torques.iter().map(|own| own.channel.clone());
    let mut figure = Figure::new("Torques not explained", "", "||tau - model|| / ||tau|| [%]");
    figure.categories = Some(names.collect());
    let percents = |of: fn(&TorqueEntry) -> f64| {
        let each = result.torques.iter().enumerate();
        each.map(|(index, own)| (index as f64, of(own))).collect()
    };
    let before = percents(|own| own.percent.before);
    let after = percents(|own| own.percent.after);
    figure.series = vec![
        Series::new("before", Mark::Bars, Series::BEFORE, before),
        Series::new("after", Mark::Bars, Series::AFTER, after),
    ];
    let caption = "On the log that was fitted: by the given device, and by the identified one.";
    drawn(&figure, caption).map(Some)
}

fn commands(result: &IdentifiedDynamics) -> Vec<(String, String)> {
    let flags = result.provenance.typed(&FIT_FLAGS);
    let diagnose = format!("haptical diagnose{flags} --out gap");
    let export = "haptical export --device identified.toml --format mjcf --out model.xml";
    vec![
        (
            "Which effects the torques show besides:".to_owned(),
            diagnose,
        ),
        (
            "The identified device for a simulator:".to_owned(),
            export.to_owned(),
        ),
    ]
}
