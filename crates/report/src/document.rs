//! A page of text, tables and figures as one HTML file that refers to nothing outside itself.

use maud::{DOCTYPE, Markup, PreEscaped, html};

use crate::colour::{dark_rules, style_element};
use crate::table::Table;
use crate::text::clean;

/// The style sheet in the head of every document.
const STYLE: &str = include_str!("document.css");
/// Puts a button behind each command that copies it: there is none without script.
const COPY: &str = include_str!("copy.js");
/// The only script that a browser is told to run, by its SHA-256 in base64.
const COPY_SHA256: &str = "jjhaLN7fxABdtnNEoyG8QgWrYAk9yRPFZebi3aurreI=";
/// Widest figure that a phone shows whole, in px; a wider one scrolls in its box there, with a sentence that says so.
const PHONE_PX: u32 = 480;
/// Elements that a figure may hold; none of them runs or loads anything.
const DRAWING_ELEMENTS: [&str; 13] = [
    "svg", "g", "title", "desc", "text", "tspan", "rect", "circle", "ellipse", "line", "polyline",
    "polygon", "path",
];

/// A page with sections.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Document {
    /// Title of the page and of the browser window.
    pub title: String,
    /// Paragraph under the title; may be empty.
    pub lead: String,
    /// Sections, listed in a table of contents when there are several and none is folded.
    pub sections: Vec<Section>,
}

/// A part of a page under a heading.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Section {
    /// Heading of the section.
    pub heading: String,
    /// What is under it.
    pub blocks: Vec<Block>,
    /// Whether all but the heading is folded away until the reader opens it.
    pub is_folded: bool,
}

/// A piece of a section.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Block {
    /// Running text.
    Paragraph(String),
    /// A table.
    Table(Table),
    /// A figure with a caption.
    Svg {
        /// Sentence under the figure.
        caption: String,
        /// The figure, as [`crate::Figure::to_svg`] returns it.
        svg: String,
    },
    /// A list of points.
    List(Vec<String>),
    /// A command to type, with a button that copies it.
    Command {
        /// What it is for; may be empty.
        purpose: String,
        /// The command, on one line.
        command: String,
    },
    /// Files in the folder of the page, a line each.
    Links(Vec<Link>),
    /// A sentence that answers a question, marked as met or not met.
    Verdict {
        /// True for met.
        good: bool,
        /// The sentence.
        text: String,
    },
    /// A highlighted sentence behind a word or two that say its kind.
    Notice {
        /// How it is coloured.
        tone: Tone,
        /// The word or two.
        label: String,
        /// The sentence.
        text: String,
    },
    /// Blocks that are folded away until the reader opens them; in print they are open, where the
    /// browser can.
    Folded {
        /// The line that stays visible.
        summary: String,
        /// What is folded away.
        blocks: Vec<Block>,
    },
}

/// A file in the folder of the page.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Link {
    /// Its name; one with other characters than ASCII letters, digits, `.`, `-` and `_` is shown without a link.
    pub file: String,
    /// What it is.
    pub text: String,
}

/// Colour of a [`Block::Notice`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Tone {
    /// All is well.
    Good,
    /// Something is wrong.
    Bad,
    /// Neither.
    Neutral,
}

impl From<Table> for Block {
    fn from(table: Table) -> Self {
        Self::Table(table)
    }
}

impl Block {
    /// A notice: its colour, the words that stand out, and the rest.
    pub fn notice(tone: Tone, label: impl Into<String>, text: impl Into<String>) -> Self {
        Self::Notice {
            tone,
            label: label.into(),
            text: text.into(),
        }
    }
}

impl Section {
    /// A section.
    pub fn new(heading: impl Into<String>, blocks: Vec<Block>) -> Self {
        Self {
            heading: heading.into(),
            blocks,
            is_folded: false,
        }
    }

    /// The same section, folded away behind its heading.
    #[must_use]
    pub fn folded(self) -> Self {
        Self {
            is_folded: true,
            ..self
        }
    }
}

impl Document {
    /// A page.
    ///
    /// # Examples
    /// ```
    /// use haptical_report::{Block, Document, Section};
    /// let text = Block::Paragraph("RMS < 1 mm".to_owned());
    /// let page = Document::new("Calibration", "", vec![Section::new("Result", vec![text])]);
    /// assert!(page.to_html().contains("RMS &lt; 1 mm"));
    /// ```
    pub fn new(title: impl Into<String>, lead: impl Into<String>, sections: Vec<Section>) -> Self {
        Self {
            title: title.into(),
            lead: lead.into(),
            sections,
        }
    }

    /// The page as one HTML file: style and figures inside, no outside reference, no script but the one that copies a
    /// command.
    ///
    /// All text is escaped. A figure that is more than a drawing (a script, a link, a reference, an
    /// event handler) is left out, and a sentence in its place says so.
    pub fn to_html(&self) -> String {
        let has_commands = self
            .sections
            .iter()
            .any(|section| has_command(&section.blocks));
        let scripts = match has_commands {
            true => format!("; script-src 'sha256-{COPY_SHA256}'"),
            false => String::new(),
        };
        // Belt and braces: the browser is told to load nothing, and to run nothing else.
        let policy = format!("default-src 'none'; style-src 'unsafe-inline'{scripts}");
        let is_folded = self.sections.iter().any(|section| section.is_folded);
        let page = html! {
            (DOCTYPE)
            html lang="en" {
                head {
                    meta charset="utf-8";
                    meta name="viewport" content="width=device-width, initial-scale=1";
                    meta http-equiv="Content-Security-Policy" content=(policy);
                    title { (clean(&self.title)) }
                    style { (PreEscaped(STYLE)) (PreEscaped(dark_rules(".card "))) }
                }
                body {
                    header {
                        h1 { (clean(&self.title)) }
                        @if !self.lead.is_empty() { p.lead { (with_code(&self.lead)) } }
                    }
                    @if self.sections.len() > 1 && !is_folded { (self.contents()) }
                    main {
                        @for (index, section) in self.sections.iter().enumerate() {
                            (section.to_html(&anchor(index)))
                        }
                    }
                    @if has_commands { script { (PreEscaped(COPY)) } }
                }
            }
        };
        page.into_string()
    }

    fn contents(&self) -> Markup {
        html! {
            nav aria-label="Contents" { ol {
                @for (index, section) in self.sections.iter().enumerate() {
                    li { a href=(format!("#{}", anchor(index))) { (clean(&section.heading)) } }
                }
            } }
        }
    }
}

impl Section {
    fn to_html(&self, anchor: &str) -> Markup {
        html! {
            @if self.is_folded {
                details.section {
                    summary { h2 { (clean(&self.heading)) } }
                    section id=(anchor) { (in_order(&self.blocks)) }
                }
            } @else {
                section id=(anchor) {
                    @if !self.heading.is_empty() { h2 { (clean(&self.heading)) } }
                    (in_order(&self.blocks))
                }
            }
        }
    }
}

/// Blocks under each other; figures that follow one another, and a narrow table behind a figure, side by side where there is
/// room.
fn in_order(blocks: &[Block]) -> Markup {
    let is_figure = |block: &Block| matches!(block, Block::Svg { .. });
    let is_narrow = |block: &Block| matches!(block, Block::Table(table) if table.is_narrow());
    let groups =
        blocks.chunk_by(|one, next| is_figure(one) && (is_figure(next) || is_narrow(next)));
    html! {
        @for group in groups {
            @if group.len() > 1 {
                div.figures { @for block in group { (block.to_html()) } }
            } @else {
                @for block in group { (block.to_html()) }
            }
        }
    }
}

/// Text whose pieces between backticks are names of files, columns and flags.
pub(crate) fn with_code(text: &str) -> Markup {
    let text = clean(text);
    // a line does not end between a number and its sign
    let prose = |piece: &str| piece.replace(" %", "\u{a0}%");
    let pieces: Vec<&str> = text.split('`').collect();
    let is_paired = pieces.len() % 2 == 1;
    html! {
        @if is_paired {
            @for (index, piece) in pieces.iter().enumerate() {
                @if index % 2 == 1 { code { (piece) } } @else { (prose(piece)) }
            }
        } @else {
            (prose(&text))
        }
    }
}

/// A command whose lines are broken between words alone.
fn by_word(command: &str) -> Markup {
    html! {
        @for (index, word) in clean(command).split(' ').enumerate() {
            @if index > 0 { " " }
            span { (word) }
        }
    }
}

/// Whether there is a command among the blocks.
fn has_command(blocks: &[Block]) -> bool {
    blocks.iter().any(|block| match block {
        Block::Command { .. } => true,
        Block::Folded { blocks, .. } => has_command(blocks),
        _ => false,
    })
}

impl Block {
    fn to_html(&self) -> Markup {
        match self {
            Self::Paragraph(text) => html! { p { (with_code(text)) } },
            Self::Table(table) => table.to_html(),
            Self::Svg { caption, svg } => drawing(caption, svg),
            Self::Command { purpose, command } => html! {
                div.run {
                    @if !purpose.is_empty() { p { (with_code(purpose)) } }
                    div.row { pre.command tabindex="0" { (by_word(command)) } }
                }
            },
            Self::List(items) => html! { ul { @for item in items { li { (with_code(item)) } } } },
            Self::Links(links) => html! { ul { @for link in links { li { (link.to_html()) } } } },
            Self::Verdict { good: true, text } => notice(Tone::Good, "✓ met", text),
            Self::Verdict { good: false, text } => notice(Tone::Bad, "✗ not met", text),
            Self::Notice { tone, label, text } => notice(*tone, label, text),
            Self::Folded { summary, blocks } => html! {
                details {
                    summary { (clean(summary)) }
                    (in_order(blocks))
                }
            },
        }
    }
}

/// A figure in its box. The rules of its dark colours are those of the page.
fn drawing(caption: &str, svg: &str) -> Markup {
    let svg = svg.replacen(&style_element(), "", 1);
    let is_wide = width_px(&svg).is_some_and(|width| width > PHONE_PX);
    html! {
        figure.drawing.wide[is_wide] {
            @if is_drawing(&svg) {
                div.card tabindex="0" { (PreEscaped(&svg)) }
                @if is_wide { p.sign { "The picture goes on to the right: swipe it." } }
            } @else {
                p.note { "A figure was left out here: it is not a plain SVG drawing." }
            }
            @if !caption.is_empty() { figcaption { (clean(caption)) } }
        }
    }
}

/// The width that a figure states.
fn width_px(svg: &str) -> Option<u32> {
    let (_, rest) = svg.split_once(" width=\"")?;
    rest.split_once('"')?.0.parse().ok()
}

impl Link {
    fn to_html(&self) -> Markup {
        let is_plain = |c: char| c.is_ascii_alphanumeric() || "._-".contains(c);
        html! {
            @if self.file.chars().all(is_plain) {
                a href=(self.file) { (self.file) }
            } @else {
                (clean(&self.file))
            }
            @if !self.text.is_empty() { ": " (with_code(&self.text)) }
        }
    }
}

fn notice(tone: Tone, label: &str, text: &str) -> Markup {
    html! {
        p.verdict.good[tone == Tone::Good].bad[tone == Tone::Bad] {
            @if !label.is_empty() { b { (clean(label)) } }
            (with_code(text))
        }
    }
}

fn anchor(index: usize) -> String {
    format!("section-{}", index + 1)
}

/// True for an SVG text whose tags are drawing elements without links, references and handlers.
fn is_drawing(svg: &str) -> bool {
    let svg = svg.trim();
    if !svg.starts_with("<svg") || !svg.ends_with("</svg>") {
        return false;
    }
    let mut open = 0_usize;
    let mut tags = svg.split('<').skip(1);
    let plain = tags.all(|piece| {
        let Some((tag, _)) = piece.split_once('>') else {
            return false;
        };
        let name_end = |c: char| c.is_whitespace() || c == '/';
        let name = tag.trim_start_matches('/').split(name_end).next();
        if tag.starts_with('/') {
            let Some(left) = open.checked_sub(1) else {
                return false;
            };
            open = left;
        } else if !tag.ends_with('/') {
            open += 1;
        }
        let lower = tag.to_ascii_lowercase();
        let suspicious = [
            "href", "url(", "style", " on", "\ton", "\non", "\ron", "/on", "\"on", "'on",
        ];
        name.is_some_and(|name| DRAWING_ELEMENTS.contains(&name))
            && !suspicious.iter().any(|word| lower.contains(word))
    });
    plain && open == 0
}
