//! Shared by the pages of all results: figures, tables of facts, the arm, what to do next.

pub(crate) mod arm;

use haptical_report::{Block, Cell, Document, Figure, Section, Table, Tone};

use crate::error::Error;

/// Width of a figure, and height of one with two axes \[px\]: small enough for a phone to show it whole, where two stand
/// side by side on a desk.
pub(crate) const FIGURE_PX: (u32, u32) = (440, 330);
/// Most points of a series; of longer ones every k-th is drawn.
pub(crate) const MOST_POINTS: usize = 800;

/// At most [`MOST_POINTS`] points, evenly chosen.
pub(crate) fn thinned(points: impl Iterator<Item = (f64, f64)>) -> Vec<(f64, f64)> {
    let points: Vec<(f64, f64)> = points.collect();
    let step = points.len().div_ceil(MOST_POINTS).max(1);
    points.into_iter().step_by(step).collect()
}

/// A figure with two axes.
pub(crate) fn drawn(figure: &Figure, caption: impl Into<String>) -> Result<Block, Error> {
    Ok(Block::Svg {
        caption: caption.into(),
        svg: figure.to_svg(FIGURE_PX.0, FIGURE_PX.1)?,
    })
}

/// A page that begins with an answer; the other sections are folded.
pub(crate) struct Page(Vec<Section>);

impl Page {
    pub(crate) fn new(answer: Vec<Block>) -> Self {
        Self(vec![Section::new("", answer)])
    }

    /// Adds a section, unless there is nothing to say in it.
    pub(crate) fn fold(&mut self, heading: impl Into<String>, blocks: Vec<Block>) {
        if !blocks.is_empty() {
            self.0.push(Section::new(heading, blocks).folded());
        }
    }

    /// Adds what is odd, where anything is.
    pub(crate) fn warnings(&mut self, warnings: &[String]) {
        if !warnings.is_empty() {
            self.fold("Warnings", vec![Block::List(warnings.to_vec())]);
        }
    }

    pub(crate) fn into_html(self, title: String) -> String {
        Document::new(title, "", self.0).to_html()
    }
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
    let words = format!("{}.", words.trim_end_matches('.'));
    let mut blocks = vec![Block::notice(Tone::Neutral, "What to do next:", words)];
    let own = ["identified.toml", "gap.json", "corrected.toml"];
    let of_page = own.into_iter().filter(|name| {
        let mut words = commands.iter().flat_map(|(_, command)| command.split(' '));
        words.any(|word| word == *name)
    });
    let of_page: Vec<&str> = of_page.collect();
    let commands = commands.into_iter();
    blocks.extend(commands.map(|(purpose, command)| Block::Command { purpose, command }));
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
