//! A plan as a page and as a picture.

use haptical_design::{NextPoses, ParameterStatus};
use haptical_identification::Status;
use haptical_report::{
    BarRow, BarRows, Block, Cell, Document, HeatCell, HeatMap, Section, Series, Table, Tone,
};

use super::{Planned, text};
use crate::error::Error;
use crate::files::DEVICE_FLAGS;
use crate::page::{FIGURE_PX, next};

/// Widest picture.
const WIDEST_PX: u32 = 4000;

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
    Ok(map.to_svg(map.width_px(FIGURE_PX.0).min(WIDEST_PX))?)
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
    let mut blocks = vec![Block::Notice {
        tone: Tone::Good,
        label: "Before anything is measured:".to_owned(),
        text: plan.answer.clone(),
    }];
    blocks.push(told(plan)?);
    let (words, commands) = after(plan);
    blocks.extend(next(words, commands));
    let mut sections = vec![Section::new("", blocks)];
    let mut fold = |heading: String, blocks: Vec<Block>| {
        sections.push(Section::new(heading, blocks).folded());
    };
    let heading = "Which rig tells which parameters";
    fold(heading.to_owned(), vec![picture]);
    if let Some(chosen) = plan.next_poses() {
        let said = text::said(chosen, plan.plan.measured_poses);
        let lines = said.lines().map(|line| line.trim().to_owned()).collect();
        let blocks = vec![Block::List(lines), predicted(chosen)?.into()];
        fold("Next poses".to_owned(), blocks);
    }
    for rig in plan.rigs() {
        let mut lines = text::lines(rig).into_iter();
        let mut blocks = vec![Block::Paragraph(lines.next().unwrap_or_default())];
        let open: Vec<String> = lines.map(|line| line.trim().to_owned()).collect();
        blocks.push(match open.is_empty() {
            true => Block::Paragraph("Every parameter is identified.".to_owned()),
            false => Block::List(open),
        });
        fold(format!("Rig {}", rig.measure), blocks);
    }
    let record = vec![plan.provenance.table()?.into()];
    fold("How this came about".to_owned(), record);
    Ok(Document::new(format!("Plan for {}", plan.device), "", sections).to_html())
}

/// How many parameters each rig tells.
fn told(plan: &Planned) -> Result<Block, Error> {
    let mut bars = BarRows::new("What each rig tells", "parameters");
    let rigs = plan.rigs().iter();
    bars.rows = rigs
        .map(|rig| BarRow {
            name: rig.measure.clone(),
            from: 0.0,
            to: rig.rank as f64,
            colour: Series::AFTER,
            value: format!("{} of {}", rig.rank, rig.parameters.len()),
        })
        .collect();
    Ok(Block::Svg {
        caption: "Parameters that poses with the rig would identify; below, which, and how well."
            .to_owned(),
        svg: bars.to_svg(FIGURE_PX.0)?,
    })
}

/// What to do next: choose poses, or drive to those that were chosen.
fn after(plan: &Planned) -> (&'static str, Vec<(String, String)>) {
    let record = &plan.provenance;
    let device = record.typed(&DEVICE_FLAGS);
    match plan.next_poses() {
        None => {
            let measure = record.typed(&["--measure"]);
            let command = format!("haptical plan{device}{measure} --poses 50 --out plan");
            let purpose = "Poses for the first rig:".to_owned();
            (
                "choose the rig, then let the poses be chosen",
                vec![(purpose, command)],
            )
        }
        Some(_) => {
            let command = format!("haptical identify{device} --log measured.csv --out result");
            let purpose = "From the log of what was measured there:".to_owned();
            (
                "drive to the poses of poses.csv, which is in this folder, and measure at each",
                vec![(purpose, command)],
            )
        }
    }
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
