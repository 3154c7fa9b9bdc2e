//! Compares a file of a result with what its inputs give.

use haptical::files::ResultKind;
use serde::Serialize;
use serde_json::Value;

/// Largest difference of two numbers of a file, as a share of the larger one, that another machine may make. A diagnosis
/// compares fits whose searches stop early (docs/equations.md "Searches"), and keeps fewer digits.
fn tolerance(file: &str) -> f64 {
    match ResultKind::DIAGNOSIS.files.contains(&file) {
        true => 1e-6,
        false => 1e-9,
    }
}
/// Differences that are listed; all are counted.
const MOST_LISTED: usize = 1000;
/// Characters of a text that are shown.
const SHOWN: usize = 60;
/// Hashes of a result's own files: on another machine they are others.
const HASHES: [&str; 2] = ["provenance.outputs", "provenance.result_sha256"];

/// The result in a line.
const ANSWER: &str = "answer";

/// How a file agrees with what its inputs give.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum Agreement {
    SameBytes,
    /// Within [`tolerance`], and not changed since it was written.
    SameNumbers,
    Differs,
    Missing,
    /// It is not there and need not be.
    NotKept,
    /// Of a folder: a result in it could not be checked.
    Undecided,
}

/// The findings on one file.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(super) struct FileVerdict {
    pub(super) file: String,
    pub(super) agreement: Agreement,
    /// Its SHA-256 is not the one that was recorded when it was written.
    pub(super) changed_since_written: bool,
    /// Of the numbers that agree without having the same bytes.
    pub(super) largest_relative_difference: Option<f64>,
    pub(super) difference_count: usize,
    /// At most 1000.
    pub(super) differences: Vec<Difference>,
}

/// A value that differs.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(super) struct Difference {
    #[serde(rename = "where")]
    pub(super) place: String,
    pub(super) recorded: String,
    pub(super) recomputed: String,
}

/// A file as it was found.
pub(super) struct Written {
    pub(super) bytes: Vec<u8>,
    pub(super) is_changed: bool,
}

/// Compares a file, if it is there, with its recomputed bytes.
pub(super) fn compare(name: &str, written: Option<Written>, recomputed: &[u8]) -> FileVerdict {
    let mut verdict = FileVerdict::new(name, Agreement::Missing);
    let Some(Written { bytes, is_changed }) = written else {
        return verdict;
    };
    if bytes == recomputed {
        return FileVerdict::new(name, Agreement::SameBytes);
    }
    verdict.changed_since_written = is_changed;
    match (values(name, &bytes), values(name, recomputed)) {
        (Ok(Some(was)), Ok(Some(is))) => verdict.walk("", Some(&was), Some(&is)),
        (Err(why), _) | (_, Err(why)) => verdict.push("the file", &why, "a file of its kind"),
        _ => verdict.compare_texts(&bytes, recomputed),
    }
    if is_changed && verdict.difference_count == 0 {
        // Spacing, comments, or how a number is written.
        verdict.push_first_line(&bytes, recomputed);
    }
    verdict.agreement = if verdict.difference_count == 0 {
        verdict.largest_relative_difference.get_or_insert(0.0);
        Agreement::SameNumbers
    } else {
        verdict.largest_relative_difference = None;
        Agreement::Differs
    };
    verdict
}

impl FileVerdict {
    pub(super) fn new(file: &str, agreement: Agreement) -> Self {
        Self {
            file: file.to_owned(),
            agreement,
            changed_since_written: false,
            largest_relative_difference: None,
            difference_count: 0,
            differences: Vec::new(),
        }
    }

    /// Whether the file is what its inputs give.
    pub(super) fn holds(&self) -> bool {
        !matches!(self.agreement, Agreement::Differs | Agreement::Missing)
    }

    fn push(&mut self, place: &str, recorded: &str, recomputed: &str) {
        self.difference_count += 1;
        if self.differences.len() < MOST_LISTED {
            self.differences.push(Difference {
                place: place.to_owned(),
                recorded: shortened(recorded),
                recomputed: shortened(recomputed),
            });
        }
    }

    /// Whether two numbers agree. A file that was changed after it was written is no other machine's.
    fn agree(&mut self, was: f64, is: f64) -> bool {
        let relative = relative_difference(was, is);
        let tolerance = match self.changed_since_written {
            true => 0.0,
            false => tolerance(&self.file),
        };
        if relative <= tolerance {
            let largest = self.largest_relative_difference.unwrap_or(0.0);
            self.largest_relative_difference = Some(largest.max(relative));
        }
        relative <= tolerance
    }

    /// Compares two values and all that are in them.
    fn walk(&mut self, place: &str, was: Option<&Value>, is: Option<&Value>) {
        if !self.changed_since_written && HASHES.contains(&place) {
            return;
        }
        let numbers = was.and_then(Value::as_f64).zip(is.and_then(Value::as_f64));
        match (was, is) {
            (Some(Value::Object(was)), Some(Value::Object(is))) => {
                let new = is.keys().filter(|key| !was.contains_key(*key));
                for key in was.keys().chain(new) {
                    let dot = if place.is_empty() { "" } else { "." };
                    self.walk(&format!("{place}{dot}{key}"), was.get(key), is.get(key));
                }
            }
            (Some(Value::Array(was)), Some(Value::Array(is))) => {
                for index in 0..was.len().max(is.len()) {
                    self.walk(&format!("{place}[{index}]"), was.get(index), is.get(index));
                }
            }
            // rounded numbers in a sentence
            (Some(Value::String(was)), Some(Value::String(is)))
                if place == ANSWER && self.texts_agree(was, is) => {}
            _ if was == is || numbers.is_some_and(|(was, is)| self.agree(was, is)) => {}
            _ => self.push(place, &shown(was), &shown(is)),
        }
    }

    /// Pages, pictures and tables hold numbers between texts: the texts must be the same, and the numbers agree
    /// within one unit of their last digit, where another machine may have rounded the other way.
    fn compare_texts(&mut self, was: &[u8], is: &[u8]) {
        let (was_text, is_text) = (String::from_utf8_lossy(was), String::from_utf8_lossy(is));
        if !self.texts_agree(&was_text, &is_text) {
            self.push_first_line(was, is);
        }
    }

    fn texts_agree(&mut self, was: &str, is: &str) -> bool {
        let (was, is) = (parts(was), parts(is));
        !self.changed_since_written
            && was.len() == is.len()
            && was.iter().zip(&is).all(|(was, is)| {
                let numbers = was.parse::<f64>().ok().zip(is.parse::<f64>().ok());
                let agree =
                    |(a, b): (f64, f64)| self.agree(a, b) || (a - b).abs() <= 1.01 * last_digit(is);
                was == is || numbers.is_some_and(agree)
            })
    }

    /// Puts down the first line that differs, from shortly before the first character that does.
    fn push_first_line(&mut self, was: &[u8], is: &[u8]) {
        let (was, is) = (String::from_utf8_lossy(was), String::from_utf8_lossy(is));
        let (mut was, mut is) = (was.split('\n'), is.split('\n'));
        for line in 1_usize.. {
            let (was, is) = (was.next(), is.next());
            if was == is && was.is_some() {
                continue;
            }
            let (was, is) = (was.unwrap_or("nothing"), is.unwrap_or("nothing"));
            let pairs = was.chars().zip(is.chars());
            let from = pairs
                .take_while(|(a, b)| a == b)
                .count()
                .saturating_sub(SHOWN / 3);
            let tail = |text: &str| text.chars().skip(from).collect::<String>();
            return self.push(&format!("line {line}"), &tail(was), &tail(is));
        }
    }
}

/// The values of a JSON or TOML text, none of another file; an error says why it has none.
fn values(name: &str, bytes: &[u8]) -> Result<Option<Value>, String> {
    let text = std::str::from_utf8(bytes).map_err(|_| "not a text in UTF-8".to_owned())?;
    if name.ends_with(".json") {
        return serde_json::from_str(text).map_err(|error| error.to_string());
    }
    if !name.ends_with(".toml") {
        return Ok(None);
    }
    // It refuses what would take the other reader too deep.
    haptical_model::check_toml_syntax(text, name).map_err(|error| error.to_string())?;
    toml::from_str(text).map_err(|_| "not TOML".to_owned())
}

/// A value with the shortest digits that give it back.
fn shown(value: Option<&Value>) -> String {
    match value {
        None => "nothing".to_owned(),
        Some(Value::Number(number)) => format!("{:?}", number.as_f64().unwrap_or(f64::NAN)),
        Some(other) => other.to_string(),
    }
}

fn relative_difference(was: f64, is: f64) -> f64 {
    if was == is {
        return 0.0;
    }
    // Halves, so that numbers of opposite signs do not overflow.
    let half = (0.5 * was - 0.5 * is).abs();
    2.0 * (half / was.abs().max(is.abs()))
}

/// A text as numbers and the texts between them.
fn parts(text: &str) -> Vec<&str> {
    let is_digit = |byte: u8| byte.is_ascii_digit() || byte == b'.';
    text.as_bytes()
        .chunk_by(|a, b| is_digit(*a) == is_digit(*b))
        .scan(0, |start, chunk| {
            let from = *start;
            *start += chunk.len();
            text.get(from..*start)
        })
        .collect()
}

/// One unit of the last digit of a number without exponent.
fn last_digit(number: &str) -> f64 {
    let decimals = number.split_once('.').map_or(0, |(_, after)| after.len());
    10_f64.powi(-i32::try_from(decimals).unwrap_or(i32::MAX))
}

fn shortened(text: &str) -> String {
    let mut characters = text.chars().map(|c| if c.is_control() { ' ' } else { c });
    let shown: String = characters.by_ref().take(SHOWN).collect();
    shown + characters.next().map_or("", |_| "…")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn verdict(name: &str, was: &str, is: &str, is_changed: bool) -> FileVerdict {
        let bytes = was.as_bytes().to_vec();
        compare(name, Some(Written { bytes, is_changed }), is.as_bytes())
    }

    #[test]
    fn another_machine_may_differ_in_the_last_digits() {
        let is = r#"{"a": [1.0, -2.0e-7], "provenance": {"result_sha256": "12"}}"#;
        let with = |a: &str| is.replace("1.0", a).replace("12", "34");
        let cases = [
            ("plan.json", "1.0000000009", "1.0000000011", 9e-10),
            ("gap.json", "1.0000009", "1.0000011", 9e-7),
        ];
        for (file, close, far, difference) in cases {
            let was = with(close);
            let agrees = verdict(file, &was, is, false);
            assert_eq!(agrees.agreement, Agreement::SameNumbers, "{file}");
            let largest = agrees.largest_relative_difference.unwrap();
            assert!((largest / difference - 1.0).abs() < 1e-5, "{largest}");
            let found = verdict(file, &with(far), is, false);
            assert_eq!(found.agreement, Agreement::Differs, "{file}");
            assert_eq!(found.difference_count, 1);
            assert_eq!(found.differences[0].place, "a[0]");
            assert_eq!(found.differences[0].recorded, far);
            assert_eq!(found.differences[0].recomputed, "1.0");
            // The same digits in a file that somebody changed are no other machine's.
            let changed = verdict(file, &was, is, true);
            assert_eq!(changed.difference_count, 2);
            assert!(!changed.holds() && agrees.holds());
        }
    }

    #[test]
    fn an_answer_may_round_the_other_way_and_another_text_may_not() {
        let json = |key: &str, value: &str| format!(r#"{{"{key}": "after {value} mm"}}"#);
        let agrees = |key: &str, was: &str, is_changed| {
            verdict("gap.json", &json(key, was), &json(key, "0.124"), is_changed).holds()
        };
        assert!(agrees("answer", "0.125", false));
        assert!(!agrees("answer", "0.126", false));
        assert!(!agrees("answer", "0.125", true));
        assert!(!agrees("device", "0.125", false));
    }

    #[test]
    fn relative_to_the_larger_and_without_overflow() {
        assert_eq!(relative_difference(0.0, 0.0), 0.0);
        assert_eq!(relative_difference(0.0, 1e-300), 1.0);
        assert_eq!(relative_difference(f64::MAX, -f64::MAX), 2.0);
        assert_eq!(relative_difference(1.0, 4.0), 0.75);
    }

    #[test]
    fn what_one_side_has_alone_differs() {
        let found = verdict("x.toml", "a = 1\nb = 2\n", "a = 1\nc = 3\n", false);
        let shown: Vec<String> = found
            .differences
            .iter()
            .map(|d| format!("{} {} {}", d.place, d.recorded, d.recomputed))
            .collect();
        assert_eq!(shown, ["b 2.0 nothing", "c nothing 3.0"]);
    }

    #[test]
    fn what_is_no_text_of_its_kind_says_so() {
        for (name, text) in [("x.json", "{"), ("x.toml", "a = =")] {
            let found = verdict(name, text, "{}", false);
            assert_eq!(found.differences[0].place, "the file", "{name}");
        }
    }

    #[test]
    fn a_changed_comment_is_a_change() {
        let found = verdict("x.toml", "# me\na = 1\n", "# you\na = 1\n", true);
        assert_eq!(found.differences[0].place, "line 1");
        assert_eq!(found.differences[0].recorded, "# me");
        assert_eq!(found.agreement, Agreement::Differs);
    }

    #[test]
    fn a_page_may_round_the_other_way() {
        let agrees =
            |was: &str, is: &str, is_changed| verdict("report.html", was, is, is_changed).holds();
        assert!(agrees("<td>12.35 µm</td>", "<td>12.34 µm</td>", false));
        assert!(!agrees("<td>12.36 µm</td>", "<td>12.34 µm</td>", false));
        assert!(!agrees("<td>12.34 mm</td>", "<td>12.34 µm</td>", false));
        assert!(!agrees("<td>12.35 µm</td>", "<td>12.34 µm</td>", true));
    }

    #[test]
    fn a_file_that_is_not_there_is_missing() {
        let missing = compare("x.toml", None, b"a = 1\n");
        assert_eq!(missing.agreement, Agreement::Missing);
        assert!(!missing.holds());
    }
}
