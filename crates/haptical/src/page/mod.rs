//! Shared by the pages of all results: sizes of figures, tables of facts, the arm, what to do next.

pub(crate) mod arm;

use haptical_report::{Block, Cell, Table, Tone};

use crate::error::Error;

/// Width of a figure, and height of one with two axes \[px\]: small enough for a phone to show it whole, where two stand
/// side by side on a desk.
pub(crate) const FIGURE_PX: (u32, u32) = (440, 330);
/// Most points of a series; of longer ones every k-th is drawn.
pub(crate) const MOST_POINTS: usize = 800;

/// At most [`MOST_POINTS`] points, evenly chosen.
pub(crate) fn thinned(points: impl Iterator<Item = (f64, f64)> + Clone) -> Vec<(f64, f64)> {
    let step = points.clone().count().div_ceil(MOST_POINTS).max(1);
    points.step_by(step).collect()
}

/// A table of facts: what, and its value.
pub(crate) fn facts(
    title: &str,
    facts: impl IntoIterator<Item = (impl Into<Cell>, String)>,
) -> Result<Table, Error> {
    let rows = facts.into_iter();
    let rows = rows.map(|(what, value)| vec![what.into(), value.into()]);
    Ok(Table::with_heads(title, "what | value").with_rows(rows)?)
}

/// What to do next: in words, and as commands with what each is for.
pub(crate) fn next(words: &str, commands: Vec<(String, String)>) -> Vec<Block> {
    let mut blocks = vec![Block::Notice {
        tone: Tone::Neutral,
        label: "What to do next:".to_owned(),
        text: format!("{}.", words.trim_end_matches('.')),
    }];
    let own = ["identified.toml", "gap.json", "corrected.toml"];
    let of_page = own.into_iter().filter(|name| {
        let mut words = commands.iter().flat_map(|(_, command)| command.split(' '));
        words.any(|word| word == *name)
    });
    let of_page: Vec<&str> = of_page.collect();
    blocks.extend(
        commands
            .into_iter()
            .map(|(purpose, command)| Block::Command { purpose, command }),
    );
    if !of_page.is_empty() {
        blocks.push(Block::Paragraph(format!(
            "Paths of the device file and the logs begin where this run was started; {} in the folder of this page.",
            match of_page.as_slice() {
                [only] => format!("{only} is"),
                several => format!("{} are", several.join(" and ")),
            }
        )));
    }
    blocks
}
