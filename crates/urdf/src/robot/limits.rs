//! Bounds what the parser of XML compares pair by pair: the attributes of one element, and the namespaces of a document.

/// Most attributes of one element; a URDF's has up to ten.
const MOST_ATTRIBUTES: usize = 256;
/// Most namespaces that a document declares; xacro leaves a few.
const MOST_NAMESPACES: usize = 256;

/// Byte and complaint of the first element with too many attributes or namespaces. One pass over the text; what is not
/// well-formed is left to the parser.
pub(crate) fn too_many(text: &str) -> Option<(usize, String)> {
    let mut namespaces = 0;
    let mut from = 0;
    while let Some(start) = text.get(from..)?.find('<').map(|offset| from + offset) {
        let rest = text.get(start..)?;
        let skipped = [("<!--", "-->"), ("<![CDATA[", "]]>"), ("<?", "?>")];
        if let Some((open, close)) = skipped.iter().find(|(open, _)| rest.starts_with(open)) {
            let end = rest.get(open.len()..)?.find(close)?;
            from = start + open.len() + end + close.len();
            continue;
        }
        let mut attributes = 0;
        let mut quote = None;
        let mut length = rest.len();
        for (offset, byte) in rest.bytes().enumerate() {
            match (quote, byte) {
                (Some(open), _) if byte == open => quote = None,
                (Some(_), _) => {}
                (None, b'"' | b'\'') => quote = Some(byte),
                (None, b'=') => {
                    attributes += 1;
                    namespaces += usize::from(declares_namespace(rest.as_bytes(), offset));
                }
                (None, b'>') => {
                    length = offset + 1;
                    break;
                }
                (None, _) => {}
            }
            if attributes > MOST_ATTRIBUTES {
                let message = format!("an element has more than {MOST_ATTRIBUTES} attributes");
                return Some((start, message));
            }
            if namespaces > MOST_NAMESPACES {
                let message = format!("more than {MOST_NAMESPACES} namespaces are declared");
                return Some((start, message));
            }
        }
        from = start + length;
    }
    None
}

/// Whether the attribute before the sign of equality at `sign` is `xmlns` or `xmlns:PREFIX`.
fn declares_namespace(tag: &[u8], sign: usize) -> bool {
    let before = tag.get(..sign).unwrap_or_default().trim_ascii_end();
    let start = before.iter().rposition(u8::is_ascii_whitespace);
    let name = before.get(start.map_or(0, |place| place + 1)..);
    name.is_some_and(|name| name.starts_with(b"xmlns"))
}
