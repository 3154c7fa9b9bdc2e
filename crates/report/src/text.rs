//! Text of figures and tables: unprintable characters, estimated widths and line breaks.

/// Text on one line: control characters and characters that XML forbids become spaces.
pub(crate) fn clean(text: &str) -> String {
    let forbidden = |c: char| c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}');
    text.chars()
        .map(|c| if forbidden(c) { ' ' } else { c })
        .collect()
}

/// Width of a text, in px, in a sans-serif face of `size_px`.
///
/// The reader's machine chooses the face, so the widths are those of DejaVu Sans, which is wider
/// than Helvetica, Arial and Liberation Sans; true widths are at most these.
pub(crate) fn width_px(text: &str, size_px: f64) -> f64 {
    text.chars().map(relative_width).sum::<f64>() * size_px
}

/// Width of the widest text, in px.
pub(crate) fn widest_px<'a>(texts: impl Iterator<Item = &'a String>, size_px: f64) -> f64 {
    let widths = texts.map(|text| width_px(text, size_px));
    widths.fold(0.0, f64::max)
}

/// How much wider the bold face is than the plain one.
pub(crate) const BOLD_FACTOR: f64 = 1.12;

/// Width of one character over the size of the face.
fn relative_width(character: char) -> f64 {
    match character {
        'i' | 'j' | 'l' | '\'' | '|' => 0.29,
        ' ' | '.' | ',' | ':' | ';' | 'I' | '-' => 0.37,
        '(' | ')' | '[' | ']' | '/' | '\\' | 'f' | 't' | 'r' | '!' | 'J' => 0.42,
        '⁰' | '¹' | '²' | '³' | '⁴' | '⁵' | '⁶' | '⁷' | '⁸' | '⁹' | '⁻' => 0.45,
        's' | 'c' | 'k' | 'v' | 'x' | 'y' | 'z' | 'L' | '_' | '"' => 0.60,
        'm' | 'w' | 'M' | 'W' | '@' | '%' => 1.0,
        'A'..='Z' | '+' | '=' | '<' | '>' | '±' | '×' | '~' => 0.84,
        'a'..='z' | '0'..='9' | '*' | '#' | '$' | '?' | '{' | '}' => 0.64,
        'α'..='ω' => 0.70,
        // Ideographs and everything unknown: as wide as high.
        _ => 1.0,
    }
}

/// The text broken into lines of at most `limit_px`, at spaces where possible, else behind hyphens.
pub(crate) fn wrap(text: &str, size_px: f64, limit_px: f64) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    let mut line = String::new();
    for word in clean(text).split_whitespace() {
        let joined = if line.is_empty() {
            word.to_owned()
        } else {
            format!("{line} {word}")
        };
        if width_px(&joined, size_px) <= limit_px {
            line = joined;
            continue;
        }
        if !line.is_empty() {
            lines.push(std::mem::take(&mut line));
        }
        for part in word.split_inclusive('-') {
            if width_px(&format!("{line}{part}"), size_px) > limit_px && !line.is_empty() {
                lines.push(std::mem::take(&mut line));
            }
            for character in part.chars() {
                let mut longer = line.clone();
                longer.push(character);
                if width_px(&longer, size_px) > limit_px && !line.is_empty() {
                    lines.push(std::mem::take(&mut line));
                    longer = character.to_string();
                }
                line = longer;
            }
        }
    }
    if !line.is_empty() {
        lines.push(line);
    }
    lines
}

/// A whole number as superscript digits.
pub(crate) fn superscript(number: i32) -> String {
    const DIGITS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    number
        .to_string()
        .chars()
        .map(|c| {
            c.to_digit(10)
                .and_then(|d| DIGITS.get(d as usize).copied())
                .unwrap_or('⁻')
        })
        .collect()
}
