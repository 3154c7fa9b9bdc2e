//! Collects tables, figures and words, and writes them: terminal, Markdown, CSV, JSON, SVG, HTML.

use std::path::Path;

use anyhow::{Context, Result};
use haptical_report::{
    Block, Document, Figure, FigureGrid, HeatMap, Section, Table, write_atomically,
};
use serde_json::{Value, json};

/// Where the files of a report go.
#[derive(Debug, Clone, Copy, Default)]
pub struct Layout {
    /// File name of the Markdown and of the JSON, without extension.
    pub stem: &'static str,
    /// Folder of the figures with a slash behind it; empty for that of the report.
    pub figures: &'static str,
    /// The same of the tables.
    pub tables: &'static str,
}

impl Layout {
    /// A file name, with folders for figures and tables.
    pub fn in_folders(stem: &'static str) -> Self {
        Self {
            stem,
            figures: "figures/",
            tables: "tables/",
        }
    }
}

/// Names with commas between, or `none`.
pub fn or_none<S: std::borrow::Borrow<str>>(names: &[S]) -> String {
    match names.is_empty() {
        true => "none".to_owned(),
        false => names.join(", "),
    }
}

/// A report that grows section by section.
#[derive(Debug, Default)]
pub struct Output {
    layout: Layout,
    sections: Vec<Section>,
    markdown: String,
    files: Vec<(String, Vec<u8>)>,
    json: Vec<(String, Value)>,
    /// Tables that a terminal shows.
    terminal: Vec<String>,
}

impl Output {
    /// An empty report.
    pub fn new(layout: Layout) -> Self {
        Self {
            layout,
            ..Self::default()
        }
    }

    /// Starts a section.
    pub fn section(&mut self, heading: &str) {
        self.sections.push(Section::new(heading, Vec::new()));
        self.markdown.push_str(&format!("## {heading}\n\n"));
    }

    fn block(&mut self, block: Block) {
        if self.sections.is_empty() {
            self.section("Summary");
        }
        if let Some(section) = self.sections.last_mut() {
            section.blocks.push(block);
        }
    }

    /// A paragraph.
    pub fn words(&mut self, text: impl Into<String>) {
        let text = text.into();
        self.markdown.push_str(&format!("{text}\n\n"));
        self.block(Block::Paragraph(text));
    }

    /// A sentence that is true or false of this run.
    pub fn verdict(&mut self, good: bool, text: impl Into<String>) {
        let text = text.into();
        let mark = if good { "yes" } else { "NO" };
        self.markdown.push_str(&format!("- **{mark}**: {text}\n\n"));
        self.terminal.push(format!("{mark:>3}: {text}"));
        self.block(Block::Verdict { good, text });
    }

    /// Lines for the terminal alone.
    pub fn terminal(&mut self, lines: String) {
        self.terminal.push(lines);
    }

    /// Some columns of a table, for the terminal: all of them would be wider than it.
    pub fn terminal_table(&mut self, table: &Table, columns: &[usize]) {
        self.terminal.push(table.narrowed(columns).to_terminal());
    }

    /// A table under a file name without extension.
    pub fn table(&mut self, file: &str, table: Table) -> Result<()> {
        self.markdown.push_str(&table.to_markdown());
        self.markdown.push('\n');
        self.files
            .push((self.table_path(file), table.to_csv()?.into_bytes()));
        self.json.push((file.to_owned(), table.to_json()));
        self.block(Block::Table(table));
        Ok(())
    }

    fn table_path(&self, file: &str) -> String {
        format!("{}{file}.csv", self.layout.tables)
    }

    /// A table that a reader unfolds; Markdown has a heading in its place.
    pub fn folded_table(&mut self, file: &str, summary: &str, table: Table) -> Result<()> {
        self.markdown
            .push_str(&format!("### {summary}\n\n{}\n", table.to_markdown()));
        self.files
            .push((self.table_path(file), table.to_csv()?.into_bytes()));
        self.block(Block::Folded {
            summary: summary.to_owned(),
            blocks: vec![Block::Table(table)],
        });
        Ok(())
    }

    /// A grid of shaded cells under a file name without extension.
    pub fn heat_map(&mut self, file: &str, caption: &str, map: &HeatMap) -> Result<()> {
        let svg = map.to_svg(1400).context(file.to_owned())?;
        self.svg(file, caption, svg);
        Ok(())
    }

    /// A figure under a file name without extension.
    pub fn figure(&mut self, file: &str, caption: &str, figure: &Figure) -> Result<()> {
        let names = figure.categories.as_ref();
        let is_wide = names.is_some_and(|names| names.len() > 8);
        let svg = figure.to_svg(if is_wide { 1100 } else { 860 }, 460);
        self.svg(file, caption, svg.context(file.to_owned())?);
        Ok(())
    }

    /// A grid of figures under a file name without extension.
    pub fn grid(&mut self, file: &str, caption: &str, grid: &FigureGrid) -> Result<()> {
        let columns = grid.columns.max(1);
        let rows = grid.figures.len().div_ceil(columns);
        let height_px = 820.max(60 + 180 * rows as u32);
        let svg = grid.to_svg(960, height_px).context(file.to_owned())?;
        self.svg(file, caption, svg);
        Ok(())
    }

    fn svg(&mut self, file: &str, caption: &str, svg: String) {
        let path = format!("{}{file}.svg", self.layout.figures);
        self.markdown.push_str(&format!("![{caption}]({path})\n\n"));
        self.files.push((path, svg.clone().into_bytes()));
        self.block(Block::Svg {
            caption: caption.to_owned(),
            svg,
        });
    }

    /// A figure of JSON only.
    pub fn value(&mut self, name: &str, value: Value) {
        self.json.push((name.to_owned(), value));
    }

    /// Writes everything below `directory`, and shows the terminal its part; nothing is added that depends on time or place.
    pub fn write(self, directory: &Path, title: &str, lead: &str) -> Result<()> {
        let document = Document::new(title, lead, self.sections);
        let mut files = self.files;
        files.push(("report.html".to_owned(), document.to_html().into_bytes()));
        let markdown = format!("# {title}\n\n{lead}\n\n{}", self.markdown);
        let stem = self.layout.stem;
        files.push((format!("{stem}.md"), markdown.into_bytes()));
        let mut all = json!({ "title": title, "lead": lead });
        for (name, value) in self.json {
            all[name] = value;
        }
        files.push((format!("{stem}.json"), serde_json::to_vec_pretty(&all)?));
        for (name, bytes) in &files {
            write_atomically(&directory.join(name), bytes)?;
        }
        for text in self.terminal {
            println!("{text}");
        }
        println!("report: {}", directory.join("report.html").display());
        Ok(())
    }
}
