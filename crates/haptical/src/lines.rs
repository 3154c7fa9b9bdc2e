//! Words in lines for a terminal or a file.

/// Longest line, in characters; a longer word has a line of its own.
pub(crate) const WIDTH: usize = 100;

/// The words of a text in lines that leave `indent` characters of [`WIDTH`] free.
pub(crate) fn lines_of(said: &str, indent: usize) -> Vec<String> {
    let room = WIDTH.saturating_sub(indent);
    let mut lines: Vec<String> = Vec::new();
    for word in said.split_whitespace() {
        match lines.last_mut() {
            Some(line) if line.chars().count() + 1 + word.chars().count() <= room => {
                *line += " ";
                *line += word;
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}

/// A text behind a label that is as wide as the indent of its further lines.
pub(crate) fn labelled(label: &str, said: &str, indent: usize) -> String {
    let lines = lines_of(said, indent).into_iter().enumerate();
    let lines = lines.map(|(index, line)| {
        let label = if index == 0 { label } else { "" };
        format!("{label:<indent$}{line}\n")
    });
    lines.collect()
}

/// The first few of some texts, a line each, and how many more a file has.
pub(crate) fn first_of(
    texts: impl ExactSizeIterator<Item = impl std::fmt::Display>,
    most: usize,
    file: &str,
) -> String {
    let more = texts.len().saturating_sub(most);
    let lines = texts.take(most).map(|text| format!("  {text}\n"));
    let more = (more > 0).then(|| format!("  and {more} more, see {file}\n"));
    lines.chain(more).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_word_is_there_whole() {
        let said = "word ".repeat(60) + &"x".repeat(120) + " end";
        let text = labelled("next", &said, 9);
        let lines: Vec<&str> = text.lines().collect();
        assert!(lines[0].starts_with("next     word") && lines[1].starts_with("         word"));
        assert!(
            lines
                .iter()
                .all(|line| line.chars().count() <= WIDTH || line.trim().len() == 120)
        );
        let words =
            |text: &str| -> Vec<String> { text.split_whitespace().map(str::to_owned).collect() };
        assert_eq!(words(&text)[1..], words(&said)[..]);
    }
}
