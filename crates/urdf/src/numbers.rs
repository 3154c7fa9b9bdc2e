//! Numbers of a URDF: read from attributes with limits, written so that they come back bit by bit.

/// Largest magnitude of a number: no length, angle or mass of a robot is beyond it.
const LARGEST: f64 = 1e6;

/// What is allowed instead of a number that was refused.
pub(crate) const ONE_NUMBER: &str = "a finite number of at most 1e6 in size is expected";
/// As [`ONE_NUMBER`], for three.
pub(crate) const THREE_NUMBERS: &str =
    "three finite numbers of at most 1e6 in size are expected, separated by blanks";

/// One number.
pub(crate) fn number(text: &str) -> Option<f64> {
    let value: f64 = text.trim().parse().ok()?;
    (value.abs() <= LARGEST).then_some(value)
}

/// Exactly three numbers.
pub(crate) fn three(text: &str) -> Option<[f64; 3]> {
    exactly(text)
}

/// Exactly `N` numbers.
pub(crate) fn exactly<const N: usize>(text: &str) -> Option<[f64; N]> {
    let mut words = text.split_ascii_whitespace();
    let mut numbers = [0.0; N];
    for own in &mut numbers {
        *own = number(words.next()?)?;
    }
    words.next().is_none().then_some(numbers)
}

/// Numbers as the value of an attribute.
pub(crate) fn written(numbers: &[f64]) -> String {
    let word = |number: &f64| {
        // adding 0 turns -0 into 0; the shortest digits that give the number back, small ones as 1.2e-17
        let word = format!("{:?}", number + 0.0);
        word.strip_suffix(".0").map_or(word.clone(), str::to_owned)
    };
    let words: Vec<String> = numbers.iter().map(word).collect();
    words.join(" ")
}

/// A number for a sentence, to four digits.
pub(crate) fn rounded(number: f64) -> String {
    let size = libm::floor(libm::log10(number.abs().max(1e-9)));
    let decimals = (3.0 - size).clamp(0.0, 9.0) as usize;
    let word = format!("{number:.decimals$}");
    match word.contains('.') {
        true => word.trim_end_matches('0').trim_end_matches('.').to_owned(),
        false => word,
    }
}

/// Text as the value of an attribute.
pub(crate) fn escaped(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            // XML has no other control characters, and folds these
            c if c.is_control() => escaped.push(' '),
            c => escaped.push(c),
        }
    }
    escaped
}

/// Text as part of a line of a comment, which it cannot end.
pub(crate) fn commented(text: &str) -> String {
    let plain: String = text
        .chars()
        .map(|c| if c.is_control() { ' ' } else { c })
        .collect();
    let mut plain = plain.replace("--", "- -").replace("--", "- -");
    if plain.ends_with('-') {
        plain.push(' ');
    }
    plain
}
