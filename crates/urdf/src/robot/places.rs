//! Lines and columns of a text, of included files too: a mark in the text says from which file what follows it is.

use haptical_model::Position;

/// Target of the instructions to XML's programs that are such marks.
const MARK: &str = "<?included-from ";
/// Their end.
const END: &str = "?>";

/// A mark: what follows it is at this place of a file.
pub(crate) fn mark(at: &Position) -> String {
    format!("{MARK}{} {} {}{END}", at.line, at.column, at.file)
}

/// Whether a text holds parts of other files.
pub(crate) fn has_includes(text: &str) -> bool {
    text.contains(MARK)
}

/// File, line and column of a byte, from 1.
pub(crate) fn place_of(text: &str, file: &str, byte: usize) -> Box<Position> {
    let before = text.get(..byte).unwrap_or(text);
    let marked = before.rfind(MARK).and_then(|start| {
        let (entry, after) = before.get(start + MARK.len()..)?.split_once(END)?;
        let mut words = entry.splitn(3, ' ');
        let at = Position {
            line: words.next()?.parse().ok()?,
            column: words.next()?.parse().ok()?,
            file: words.next()?.to_owned(),
        };
        Some((at, after))
    });
    let (mut at, after) = marked.unwrap_or_else(|| {
        let start = Position {
            file: file.to_owned(),
            line: 1,
            column: 1,
        };
        (start, before)
    });
    if let Some((lines, last)) = after.rsplit_once('\n') {
        at.line += lines.matches('\n').count() + 1;
        at.column = last.chars().count() + 1;
    } else {
        at.column += after.chars().count();
    }
    Box::new(at)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_move_places_to_their_file() {
        let at = |file: &str, line, column| Position {
            file: file.to_owned(),
            line,
            column,
        };
        let marked = [mark(&at("a b.xml", 7, 3)), mark(&at("m.xml", 2, 9))];
        let text = format!("é\n{}x\nyy{}z", marked[0], marked[1]);
        let place = |what: char| *place_of(&text, "m.xml", text.rfind(what).unwrap_or(0));
        assert_eq!(*place_of(&text, "m.xml", "é".len()), at("m.xml", 1, 2));
        assert_eq!(
            *place_of(&text, "m.xml", text.find("x\n").unwrap_or(0)),
            at("a b.xml", 7, 3)
        );
        assert_eq!(place('y'), at("a b.xml", 8, 2));
        assert_eq!(place('z'), at("m.xml", 2, 9));
        assert!(has_includes(&text) && !has_includes("<a/>"));
    }
}
