//! A plan as a page and as a picture.

use haptical_design::{NextPoses, ParameterStatus};
use haptical_identification::Status;
use haptical_report::{BarRow, BarRows, Block, Cell, HeatCell, HeatMap, Series, Table, Tone};

use super::{Planned, text};
use crate::error::Error;
use crate::files::DEVICE_FLAGS;
use crate::page::{FIGURE_PX, Page, next};

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
        let rigs = plan.rigs().iter();
        let cells = rigs.map(|rig| text::find(rig, &name).map(cell)).collect();
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
    let answer = Block::notice(Tone::Good, "Before anything is measured:", &plan.answer);
    let mut blocks = vec![answer, told(plan)?];
    blocks.extend(after(plan));
    let mut page = Page::new(blocks);
    page.fold("Which rig tells which parameters", vec![picture]);
    if let Some(chosen) = plan.next_poses() {
        let said = text::said(chosen, plan.plan.measured_poses);
        let lines = said.lines().map(|line| line.trim().to_owned()).collect();
        let blocks = vec![Block::List(lines), predicted(chosen)?.into()];
        page.fold("Next poses", blocks);
    }
    for rig in plan.rigs() {
        let mut lines = text::lines(rig).into_iter();
        let mut blocks = vec![Block::Paragraph(lines.next().unwrap_or_default())];
        let open: Vec<String> = lines.map(|line| line.trim().to_owned()).collect();
        blocks.push(match open.is_empty() {
            true => Block::Paragraph("Every parameter is identified.".to_owned()),
            false => Block::List(open),
        });
        page.fold(format!("Rig {}", rig.measure), blocks);
    }
    page.fold("How this came about", vec![plan.provenance.table()?.into()]);
    Ok(page.into_html(format!("Plan for {}", plan.device)))
}

/// How many parameters each rig tells.
fn told(plan: &Planned) -> Result<Block, Error> {
    let mut bars = BarRows::new("What each rig tells", "parameters");
    bars.rows.extend(plan.rigs().iter().map(|rig| BarRow {
        name: rig.measure.clone(),
        from: 0.0,
        to: rig.rank as f64,
        colour: Series::AFTER,
        value: format!("{} of {}", rig.rank, rig.parameters.len()),
    }));
    Ok(Block::Svg {
        caption: "Parameters that poses with the rig would identify; below, which, and how well."
            .to_owned(),
        svg: bars.to_svg(FIGURE_PX.0)?,
    })
}

/// What to do next: choose poses, or drive to those that were chosen.
fn after(plan: &Planned) -> Vec<Block> {
    let record = &plan.provenance;
    let device = record.typed(&DEVICE_FLAGS);
    let (words, purpose, command) = match plan.next_poses() {
        None => {
            let measure = record.typed(&["--measure"]);
            (
                "choose the rig, then let the poses be chosen",
                "Poses for the first rig:",
                format!("haptical plan{device}{measure} --poses 50 --out plan"),
            )
        }
        Some(_) => (
            "drive to the poses of poses.csv, which is in this folder, and measure at each",
            "From the log of what was measured there:",
            format!("haptical identify{device} --log measured.csv --out result"),
        ),
    };
    next(words, vec![(purpose.to_owned(), command)])
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
