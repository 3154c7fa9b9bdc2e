//! A plan as a page and as a picture.

use haptical_design::{NextPoses, ParameterStatus};
use haptical_identification::Status;
use haptical_report::{Block, Cell, Document, HeatCell, HeatMap, Section, Table};

use super::{Planned, text};
use crate::error::Error;

/// Widths of the picture: for the names, and for each rig.
const NAMES_PX: u32 = 220;
const RIG_PX: u32 = 170;

/// Parameters against rigs, shaded by the decades that the standard deviation lies below the plausible size.
pub(super) fn picture(plan: &Planned) -> Result<String, Error> {
    let title = format!("What {} poses tell, rig by rig", plan.plan.poses);
    let mut map = HeatMap::new(title, plan.rig_names().collect());
    for (name, unit) in text::parameters(plan) {
        let cell = |entry: &ParameterStatus| HeatCell {
            shade: shade(entry),
            text: text::word(entry),
        };
        let cells = plan
            .rigs()
            .iter()
            .map(|rig| text::find(rig, &name).map(cell));
        let cells = cells.collect();
        let unit = match unit.as_str() {
            "1" => String::new(),
            unit => format!(" [{unit}]"),
        };
        map.rows.push((format!("{name}{unit}"), cells));
    }
    let rigs = u32::try_from(plan.rigs().len()).unwrap_or(u32::MAX);
    let width = rigs.saturating_mul(RIG_PX).saturating_add(NAMES_PX);
    Ok(map.to_svg(width.clamp(640, 4000))?)
}

/// Decades of the standard deviation below the plausible size that make the full colour.
const DECADES: f64 = 3.0;

fn shade(entry: &ParameterStatus) -> f64 {
    match entry.status {
        Status::Identifiable { standard_deviation } => {
            let decades = (entry.plausible_size / standard_deviation).log10();
            0.25 + 0.75 * (decades / DECADES).clamp(0.0, 1.0)
        }
        Status::Weak { .. } => 0.12,
        Status::Invisible | Status::Dependent { .. } => 0.0,
    }
}

/// plan.html.
pub(super) fn page(plan: &Planned, picture: &str) -> Result<String, Error> {
    let caption = "A standard deviation: the parameter is identified. Weak: fixed no better than half its \
                   plausible size. Dependent: it acts like a combination of others. Invisible: it moves no reading.";
    let picture = Block::Svg {
        caption: caption.to_owned(),
        svg: picture.to_owned(),
    };
    let mut sections = vec![Section::new(
        "Which rig tells which parameters",
        vec![picture],
    )];
    for rig in plan.rigs() {
        let mut lines = text::lines(rig).into_iter();
        let mut blocks = vec![Block::Paragraph(lines.next().unwrap_or_default())];
        let open: Vec<String> = lines.map(|line| line.trim().to_owned()).collect();
        blocks.push(match open.is_empty() {
            true => Block::Paragraph("Every parameter is identified.".to_owned()),
            false => Block::List(open),
        });
        sections.push(Section::new(format!("Rig {}", rig.measure), blocks));
    }
    if let Some(next) = plan.next_poses() {
        let said = text::said(next, plan.plan.measured_poses);
        let lines = said.lines().map(|line| line.trim().to_owned()).collect();
        let blocks = vec![Block::List(lines), predicted(next)?.into()];
        sections.push(Section::new("Next poses", blocks));
    }
    let record = vec![plan.provenance.table()?.into()];
    sections.push(Section::new("How this came about", record));
    let lead = format!("{}: before anything is measured.", plan.device);
    Ok(Document::new("Plan", lead, sections).to_html())
}

fn predicted(next: &NextPoses) -> Result<Table, Error> {
    let columns = "parameter | unit | plausible size | standard deviation";
    let rows = next.parameters.iter().map(|parameter| {
        vec![
            (&parameter.name).into(),
            (&parameter.unit).into(),
            Cell::scientific(parameter.plausible_size, 2),
            Cell::scientific(parameter.standard_deviation, 3),
        ]
    });
    Ok(Table::with_heads("What the chosen poses will tell", columns).with_rows(rows)?)
}
