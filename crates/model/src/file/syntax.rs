//! Explains why a text is not TOML, and how to correct it.

use toml::de::DeTable;

use crate::DeviceFileError;
use crate::file::reader::Source;

/// Longest part of a line that an error repeats \[characters\].
const LONGEST_QUOTE: usize = 60;

/// Refuses a text that is not TOML; `file` names it in the error.
///
/// ```
/// use haptical_model::check_toml_syntax;
///
/// check_toml_syntax("width_rad = 0.25\n", "effects.toml")?;
/// let error = check_toml_syntax("width_rad = 0,25\n", "effects.toml").unwrap_err();
/// assert_eq!(error.position().map(|at| (at.line, at.column)), Some((1, 14)));
/// assert!(error.to_string().ends_with("correct `width_rad = 0,25`: the decimal sign is a point"));
/// # Ok::<(), haptical_model::DeviceFileError>(())
/// ```
///
/// # Errors
/// [`DeviceFileError::Syntax`] with line and column.
pub fn check_toml_syntax(text: &str, file: &str) -> Result<(), DeviceFileError> {
    let source = Source { file, text };
    DeTable::parse(text)
        .map(|_| ())
        .map_err(|error| syntax_error(&source, error.span(), error.message()))
}

/// The error for what a parser says of a place in the text.
pub(crate) fn syntax_error(
    source: &Source<'_>,
    span: Option<std::ops::Range<usize>>,
    message: &str,
) -> DeviceFileError {
    let offset = span.map_or(0, |span| span.start);
    DeviceFileError::Syntax {
        at: source.position(offset),
        message: message.to_owned(),
        advice: advice(source.text, offset, message),
    }
}

fn advice(text: &str, offset: usize, message: &str) -> String {
    let first = text
        .lines()
        .map(str::trim)
        .find(|line| !line.is_empty() && !line.starts_with('#'))
        .unwrap_or_default();
    if first.starts_with('{') {
        return "it looks like JSON: give the TOML file, such as identified.toml".to_owned();
    }
    if first.contains(',') && !first.contains(['=', '[']) {
        return "it looks like a log: a device file is TOML, see `haptical init`".to_owned();
    }
    let rest = text.get(offset..).unwrap_or_default();
    let hint = if message.contains("duplicate key") {
        "a key or [table] is there once; joints, links and further cables are lists: [[joint]], \
         [[link]], [[cable]]"
    } else if message.contains("recurs") {
        "lists and tables are nested too deep, no device needs that"
    } else if rest.starts_with(',') && rest[1..].starts_with(|next: char| next.is_ascii_digit()) {
        "the decimal sign is a point"
    } else if message.contains("must be quoted") || message.contains("basic string") {
        "text goes between two quotation marks"
    } else if message.contains("expected `=`") {
        "each line is `key = value`, or a heading in brackets"
    } else {
        "it is not TOML from this place on"
    };
    let start = text
        .get(..offset)
        .and_then(|before| before.rfind('\n'))
        .map_or(0, |end| end + 1);
    let line = text.get(start..).unwrap_or_default();
    let line = line.lines().next().unwrap_or_default().trim();
    let quote: String = line.chars().take(LONGEST_QUOTE).collect();
    let cut = if quote.len() < line.len() { "..." } else { "" };
    format!("correct `{quote}{cut}`: {hint}")
}
