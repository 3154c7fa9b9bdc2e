//! Prefixes of names in XML, which nothing here is told by: ROS and its simulators take `sensor:camera` as it is written, whether
//! somebody declares `sensor` or not.

use std::borrow::Cow;

/// Stands in a name where the colon was: a letter of names as long as it, so that every byte keeps its place.
const PLAIN: char = '.';

/// A text whose names have no prefixes, byte by byte in the place where it was; values, comments and content stay.
///
/// The parser refuses a prefix that nobody declares, and drops one that somebody does: `<drake:joint>` is no `<joint>`.
pub(crate) fn without_prefixes(text: &str) -> Cow<'_, str> {
    let colons = colons_in_names(text);
    if colons.is_empty() {
        return Cow::Borrowed(text);
    }
    let mut plain = String::with_capacity(text.len());
    let mut done = 0;
    for colon in colons {
        plain.push_str(text.get(done..colon).unwrap_or_default());
        plain.push(PLAIN);
        done = colon + 1;
    }
    plain.push_str(text.get(done..).unwrap_or_default());
    Cow::Owned(plain)
}

/// Bytes of the colons in tags, but for those in values. What is not well-formed is left to the parser.
fn colons_in_names(text: &str) -> Vec<usize> {
    let mut colons = Vec::new();
    let mut from = 0;
    while let Some(start) = after(text, from, "<") {
        let rest = text.get(start..).unwrap_or_default();
        // comments, sections of text, instructions and document types have no names of elements
        let skipped = [("!--", "-->"), ("![CDATA[", "]]>"), ("?", "?>"), ("!", ">")];
        if let Some((_, close)) = skipped.iter().find(|(open, _)| rest.starts_with(open)) {
            match after(text, start, close) {
                Some(end) => from = end,
                None => break,
            }
            continue;
        }
        let mut quote = None;
        from = text.len();
        for (offset, byte) in rest.bytes().enumerate() {
            match (quote, byte) {
                (Some(open), _) if byte == open => quote = None,
                (Some(_), _) => {}
                (None, b'"' | b'\'') => quote = Some(byte),
                (None, b':') => colons.push(start + offset),
                (None, b'>') => {
                    from = start + offset + 1;
                    break;
                }
                (None, _) => {}
            }
        }
    }
    colons
}

/// The byte behind the next one of some characters.
fn after(text: &str, from: usize, what: &str) -> Option<usize> {
    let found = text.get(from..)?.find(what)?;
    Some(from + found + what.len())
}

#[cfg(test)]
mod tests {
    use super::without_prefixes;

    #[test]
    fn colons_of_names_alone_are_replaced() {
        let text = "<?xml a:b?><!-- <a:b> --><r xmlns:s=\"u:v\" s:k='a:b\"c:d'><s:é t=\"<:>\">x:y<![CDATA[<a:b>]]></s:é><a/></r>";
        let plain = "<?xml a:b?><!-- <a:b> --><r xmlns.s=\"u:v\" s.k='a:b\"c:d'><s.é t=\"<:>\">x:y<![CDATA[<a:b>]]></s.é><a/></r>";
        assert_eq!(without_prefixes(text), plain);
        assert_eq!(text.len(), plain.len());
        // no end, no panic
        for broken in ["<a:b", "<!--", "<a:b c=\":", "<!x", "a:b", "<?", "<é:"] {
            assert_eq!(without_prefixes(broken).len(), broken.len());
        }
    }
}
