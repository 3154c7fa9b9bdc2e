//! Bytes that arrive to whole lines under a header: CSV, or JSON lines made into it. Half a line waits for its rest.

use serde_json::{Map, Value};

/// Longest line; a longer one is left out.
const LONGEST_BYTES: usize = 1 << 20;

/// Whole lines of one header.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub(super) struct Lines {
    /// Names of the columns, with commas.
    pub(super) header: String,
    /// Line of the first one in its file; 1 is the header of a CSV file.
    pub(super) first_line: u64,
    pub(super) lines: Vec<String>,
}

/// How a text says its columns.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
enum Kind {
    #[default]
    Unknown,
    Csv(String),
    Json(Vec<String>),
}

/// Cuts a text that arrives in pieces.
#[derive(Debug, Clone, Default)]
pub(super) struct Cutter {
    rest: Vec<u8>,
    too_long: bool,
    kind: Kind,
    line: u64,
    /// Lines that were longer than a line may be, or no object, since this was last asked.
    pub(super) left_out: u64,
}

impl Cutter {
    /// Of a text that goes on behind so many rows, with its header again.
    pub(super) fn behind(rows: usize) -> Self {
        Self {
            line: rows as u64,
            ..Self::default()
        }
    }

    /// Bytes of a line whose end has not come.
    pub(super) fn waiting(&self) -> usize {
        self.rest.len()
    }

    /// The lines that a piece completes, in parts of one header each.
    pub(super) fn take(&mut self, piece: &[u8]) -> Vec<Lines> {
        let mut parts: Vec<Lines> = Vec::new();
        let mut pieces = piece.split_inclusive(|byte| *byte == b'\n');
        for part in &mut pieces {
            let is_whole = part.ends_with(b"\n");
            self.too_long |= self.rest.len() + part.len() > LONGEST_BYTES;
            match self.too_long {
                true => self.rest.clear(),
                false => self.rest.extend_from_slice(part),
            }
            if !is_whole {
                break;
            }
            self.line += 1;
            if std::mem::take(&mut self.too_long) {
                self.left_out += 1;
                continue;
            }
            let text = String::from_utf8_lossy(&self.rest);
            let text = text.trim_start_matches('\u{feff}').trim_end().to_owned();
            self.rest.clear();
            if !text.is_empty() {
                self.take_line(&text, &mut parts);
            }
        }
        parts
    }

    fn take_line(&mut self, text: &str, parts: &mut Vec<Lines>) {
        let (header, line) = match &mut self.kind {
            Kind::Unknown if text.starts_with('{') => {
                self.kind = Kind::Json(Vec::new());
                return self.take_line(text, parts);
            }
            Kind::Unknown => {
                self.kind = Kind::Csv(text.to_owned());
                return;
            }
            // a file that was written anew begins with its header again
            Kind::Csv(header) if text == header => return,
            Kind::Csv(header) => (header.clone(), text.to_owned()),
            Kind::Json(names) => match from_json(text, names) {
                Some(line) => {
                    let quoted: Vec<String> = names.iter().map(|name| quoted(name)).collect();
                    (quoted.join(","), line)
                }
                None => {
                    self.left_out += 1;
                    return;
                }
            },
        };
        match parts.last_mut() {
            Some(last) if last.header == header => last.lines.push(line),
            _ => parts.push(Lines {
                header,
                first_line: self.line,
                lines: vec![line],
            }),
        }
    }
}

/// The cells of an object in the order of the names, to which its new names are added; none of what is no flat object.
fn from_json(text: &str, names: &mut Vec<String>) -> Option<String> {
    let object: Map<String, Value> = serde_json::from_str(text).ok()?;
    let is_nested = |value: &Value| value.is_object() || value.is_array();
    if object.values().any(is_nested) {
        return None;
    }
    for name in object.keys() {
        if !names.contains(name) {
            names.push(name.clone());
        }
    }
    let cell = |name: &String| match object.get(name) {
        None | Some(Value::Null) => String::new(),
        Some(Value::String(text)) => quoted(text),
        Some(other) => other.to_string(),
    };
    let cells: Vec<String> = names.iter().map(cell).collect();
    Some(cells.join(","))
}

fn quoted(text: &str) -> String {
    if !text.contains([',', '"', '\n', '\r']) {
        return text.to_owned();
    }
    let text = text.replace('"', "\"\"").replace(['\n', '\r'], " ");
    format!("\"{text}\"")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_a_line_waits_for_its_rest() {
        let mut cutter = Cutter::default();
        assert_eq!(cutter.take(b"\xef\xbb\xbft_s,theta1_rad\r\n0.0,0."), []);
        assert_eq!(cutter.waiting(), 6);
        let parts = cutter.take(b"125\r\n\n1.0,0.2\n2.0");
        assert_eq!(parts.len(), 1);
        assert_eq!(
            (parts[0].header.as_str(), parts[0].first_line),
            ("t_s,theta1_rad", 2)
        );
        assert_eq!(parts[0].lines, ["0.0,0.125", "1.0,0.2"]);
        assert_eq!(cutter.take(b",0.3\n")[0].first_line, 5);
    }

    #[test]
    fn json_lines_become_cells_and_new_names_a_new_header() {
        let mut cutter = Cutter::default();
        let text = b"{\"t_s\":0,\"theta1_rad\":0.5}\n{\"theta1_rad\":null,\"t_s\":1e-3}\nno\n{\"t_s\":[1]}\n{\"t_s\":2,\"tool\":\"a,b\"}\n";
        let parts = cutter.take(text);
        assert_eq!(parts[0].header, "t_s,theta1_rad");
        assert_eq!(parts[0].lines, ["0,0.5", "0.001,"]);
        assert_eq!(
            (parts[1].header.as_str(), &parts[1].lines[..]),
            ("t_s,theta1_rad,tool", &["2,,\"a,b\"".to_owned()][..])
        );
        assert_eq!(cutter.left_out, 2);
    }

    #[test]
    fn a_line_without_end_takes_no_memory() {
        let mut cutter = Cutter::default();
        cutter.take(b"t_s,theta1_rad\n");
        for _ in 0..40 {
            assert_eq!(cutter.take(&[b'1'; 1 << 16]), []);
        }
        assert_eq!(cutter.waiting(), 0);
        assert_eq!(cutter.take(b"\n0,1\n")[0].lines, ["0,1"]);
        assert_eq!(cutter.left_out, 1);
    }
}
