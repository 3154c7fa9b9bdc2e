//! identify.html of an identification of the dynamics.

use haptical_report::{Block, Cell, Document, Section, Table};

use super::result::IdentifiedDynamics;
use super::text::{bodies, in_words, joints, noise, torques};
use crate::error::Error;
use crate::page::facts;

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
    let mut sections = vec![
        Section::new("Torques", vec![torques(result)?.into()]),
        Section::new("Joints", vec![joints(result)?.into()]),
        Section::new("Bodies", vec![bodies(result)?.into()]),
        Section::new("Sums", vec![sums.into()]),
        Section::new("What was fitted", vec![facts("", settings)?.into()]),
    ];
    if !result.warnings.is_empty() {
        let list = vec![Block::List(result.warnings.clone())];
        sections.push(Section::new("Warnings", list));
    }
    sections.push(Section::new(
        "Provenance",
        vec![result.provenance.table()?.into()],
    ));
    let title = format!("Dynamics of {}", result.device);
    Ok(Document::new(title, result.answer.clone(), sections).to_html())
}
