//! The last lines of what was read, for what must be looked at again.

use std::collections::VecDeque;

/// The last lines under one header.
#[derive(Debug, Clone)]
pub(super) struct Kept {
    most: usize,
    header: String,
    lines: VecDeque<String>,
    /// Rows before the first line kept.
    before: u64,
}

impl Kept {
    pub(super) fn new(most: usize) -> Self {
        Self {
            most,
            header: String::new(),
            lines: VecDeque::new(),
            before: 0,
        }
    }

    pub(super) fn len(&self) -> usize {
        self.lines.len()
    }

    pub(super) fn header(&self) -> &str {
        &self.header
    }

    /// Takes lines; those under another header cannot be read together with the earlier ones, which go.
    pub(super) fn extend(&mut self, header: &str, lines: impl IntoIterator<Item = String>) {
        if self.header != header {
            self.before += self.lines.len() as u64;
            self.lines.clear();
            header.clone_into(&mut self.header);
        }
        for line in lines {
            if self.lines.len() == self.most {
                self.lines.pop_front();
                self.before += 1;
            }
            self.lines.push_back(line);
        }
    }

    /// The last lines as a log.
    pub(super) fn last(&self, count: usize) -> String {
        let skipped = self.lines.len().saturating_sub(count);
        self.text(skipped)
    }

    /// The lines from a row on, counted from 1 over all rows ever taken, as a log, and how many.
    pub(super) fn since(&self, row: u64) -> (String, usize) {
        let skipped = row.saturating_sub(1).saturating_sub(self.before) as usize;
        let skipped = skipped.min(self.lines.len());
        (self.text(skipped), self.lines.len() - skipped)
    }

    fn text(&self, skipped: usize) -> String {
        let lines = self.lines.iter().skip(skipped);
        let all = std::iter::once(&self.header).chain(lines);
        all.flat_map(|line| [line, "\n"]).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_lines_are_kept_and_found_by_their_row() {
        let mut kept = Kept::new(3);
        kept.extend("a", (1..=5).map(|row| row.to_string()));
        assert_eq!((kept.len(), kept.last(2)), (3, "a\n4\n5\n".to_owned()));
        assert_eq!(kept.since(4), ("a\n4\n5\n".to_owned(), 2));
        assert_eq!(kept.since(1), ("a\n3\n4\n5\n".to_owned(), 3));
        assert_eq!(kept.since(9), ("a\n".to_owned(), 0));
        kept.extend("b", ["6".to_owned()]);
        assert_eq!(kept.since(1), ("b\n6\n".to_owned(), 1));
        assert_eq!(kept.since(6).1, 1);
    }
}
