//! A page of text, tables and figures as one HTML file that refers to nothing outside itself.

use maud::{DOCTYPE, Markup, PreEscaped, html};

use crate::table::Table;
use crate::text::clean;

/// The style sheet in the head of every document.
const STYLE: &str = include_str!("document.css");
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
    /// Sections, listed in a table of contents when there are several.
    pub sections: Vec<Section>,
}

/// A part of a page under a heading.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Section {
    /// Heading of the section.
    pub heading: String,
    /// What is under it.
    pub blocks: Vec<Block>,
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

impl Section {
    /// A section.
    pub fn new(heading: impl Into<String>, blocks: Vec<Block>) -> Self {
        Self {
            heading: heading.into(),
            blocks,
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

    /// The page as one HTML file: style and figures inside, no script, no outside reference.
    ///
    /// All text is escaped. A figure that is more than a drawing (a script, a link, a reference, an
    /// event handler) is left out, and a sentence in its place says so.
    pub fn to_html(&self) -> String {
        let page = html! {
            (DOCTYPE)
            html lang="en" {
                head {
                    meta charset="utf-8";
                    meta name="viewport" content="width=device-width, initial-scale=1";
                    // Belt and braces: the browser is told to load and run nothing.
                    meta http-equiv="Content-Security-Policy"
                        content="default-src 'none'; style-src 'unsafe-inline'";
                    title { (clean(&self.title)) }
                    style { (PreEscaped(STYLE)) }
                }
                body {
                    header {
                        h1 { (clean(&self.title)) }
                        @if !self.lead.is_empty() { p.lead { (clean(&self.lead)) } }
                    }
                    @if self.sections.len() > 1 { (self.contents()) }
                    main {
                        @for (index, section) in self.sections.iter().enumerate() {
                            section id=(anchor(index)) {
                                h2 { (clean(&section.heading)) }
                                @for block in &section.blocks { (block.to_html()) }
                            }
                        }
                    }
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

impl Block {
    fn to_html(&self) -> Markup {
        match self {
            Self::Paragraph(text) => html! { p { (clean(text)) } },
            Self::Table(table) => table.to_html(),
            Self::Svg { caption, svg } => html! {
                figure.drawing {
                    @if is_drawing(svg) {
                        div.card tabindex="0" { (PreEscaped(svg)) }
                    } @else {
                        p.note { "A figure was left out here: it is not a plain SVG drawing." }
                    }
                    @if !caption.is_empty() { figcaption { (clean(caption)) } }
                }
            },
            Self::List(items) => html! { ul { @for item in items { li { (clean(item)) } } } },
            Self::Links(links) => html! { ul { @for link in links { li { (link.to_html()) } } } },
            Self::Verdict { good: true, text } => notice(Tone::Good, "✓ met", text),
            Self::Verdict { good: false, text } => notice(Tone::Bad, "✗ not met", text),
            Self::Notice { tone, label, text } => notice(*tone, label, text),
            Self::Folded { summary, blocks } => html! {
                details {
                    summary { (clean(summary)) }
                    @for block in blocks { (block.to_html()) }
                }
            },
        }
    }
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
            @if !self.text.is_empty() { ": " (clean(&self.text)) }
        }
    }
}

fn notice(tone: Tone, label: &str, text: &str) -> Markup {
    html! {
        p.verdict.good[tone == Tone::Good].bad[tone == Tone::Bad] {
            @if !label.is_empty() { b { (clean(label)) } }
            (clean(text))
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
