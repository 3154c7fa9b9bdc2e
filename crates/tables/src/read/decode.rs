//! Bytes of a text to characters: UTF-8, UTF-16 with its mark, Latin-1.

use crate::error::TableError;

/// The characters, and whether they were read as Latin-1. Without `encoding` a text that is no UTF-8 is Latin-1, in which every
/// byte is a character (ISO/IEC 8859-1, the first 256 of Unicode).
pub(super) fn text(
    bytes: &[u8],
    encoding: Option<&str>,
    name: &str,
) -> Result<(String, bool), TableError> {
    let refuse = |what: &str, next: &str| Err(TableError::new("not-text", what, name, next));
    if bytes.starts_with(b"\xff\xfe") || bytes.starts_with(b"\xfe\xff") {
        let order: fn([u8; 2]) -> u16 = match bytes[0] {
            0xff => u16::from_le_bytes,
            _ => u16::from_be_bytes,
        };
        let units = bytes[2..]
            .chunks_exact(2)
            .map(|pair| order([pair[0], pair[1]]));
        let text: Result<String, _> = char::decode_utf16(units).collect();
        return match text {
            Ok(text) => Ok((text, false)),
            Err(_) => refuse("the text begins as UTF-16 and is none", "save it as UTF-8"),
        };
    }
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    if let Some(place) = bytes.iter().position(|&byte| byte == 0) {
        let what = format!("byte {place} is zero, so this is no text");
        return refuse(
            &what,
            "give a table: text, .npy, .npz, .mat, .xlsx or JSON lines",
        );
    }
    let latin1 = || {
        bytes
            .iter()
            .map(|&byte| char::from(byte))
            .collect::<String>()
    };
    match (encoding, std::str::from_utf8(bytes)) {
        (Some("latin-1"), _) => Ok((latin1(), true)),
        (_, Ok(text)) => Ok((text.to_owned(), false)),
        (None, Err(_)) => Ok((latin1(), true)),
        (Some(_), Err(error)) => {
            let what = format!("byte {} is not UTF-8", error.valid_up_to());
            refuse(
                &what,
                "say `encoding = \"latin-1\"` in [table], or save it as UTF-8",
            )
        }
    }
}
