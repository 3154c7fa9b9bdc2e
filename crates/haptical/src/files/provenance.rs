//! The provenance that every result carries: version, command, hashes of inputs, seeds, thresholds.

use std::collections::BTreeMap;

use haptical_calibration::Options;
use haptical_identification::{IdentifiabilityRules, Settings};
use haptical_report::Table;
use serde::{Deserialize, Serialize};

use super::{Fingerprint, InputFile, NewFile};
use crate::error::Error;
use crate::page::facts;

/// Version of the library and of the command.
pub const VERSION: &str = env!("CARGO_PKG_VERSION");

/// Begins each line of it in a TOML file, in which it is a comment: older readers warn of tables that
/// they do not know.
const COMMENT: &str = "# provenance: ";

/// What the lines of provenance at the head of a TOML file say; none where it has none.
pub(crate) fn provenance_of(text: &str) -> impl Iterator<Item = &str> {
    text.lines().map_while(|line| line.strip_prefix(COMMENT))
}

/// Behind the writer of a sealed text, before its SHA-256.
const SEAL: &str = "`; SHA-256 of this file with 64 zeros here: ";

/// Placeholder of the SHA-256 of a result while it is worked out: the value of `result_sha256` before [`sealed_json`].
pub const UNSEALED: &str = "0000000000000000000000000000000000000000000000000000000000000000";

/// How a result came about. The number of threads is not in it: it changes nothing.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Record {
    /// Version of the command that wrote the result.
    pub haptical_version: String,
    /// Subcommand.
    pub command: &'static str,
    /// Its flags as `--flag=value`, defaults included; those that change nothing in the result
    /// (`--out`, `--json`) are left out.
    pub arguments: Vec<String>,
    /// Files that it was made from.
    pub inputs: Vec<InputFile>,
    /// Seeds of random numbers by what they are for; empty where none are drawn.
    pub seeds: BTreeMap<&'static str, u64>,
    /// Those of an identification; a diagnosis states the version of its own.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub thresholds: Option<Thresholds>,
    /// The other files of the result.
    pub outputs: Vec<OutputFile>,
    /// SHA-256 of the file that this is in, with 64 zeros in its place.
    pub result_sha256: String,
}

/// A file of the result.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct OutputFile {
    /// Name.
    pub file: String,
    /// Size.
    pub bytes: u64,
    /// SHA-256.
    pub sha256: String,
}

/// Thresholds of an identification.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Thresholds {
    /// When a parameter counts as identifiable.
    pub identifiability: IdentifiabilityRules,
    /// When a search ends.
    pub search: Settings,
}

impl Thresholds {
    /// Those of an identification with these options.
    pub fn from_options(options: &Options) -> Self {
        Self {
            identifiability: options.rules,
            search: options.search.clone(),
        }
    }
}

impl Record {
    /// A record without outputs and hash.
    pub fn new(
        version: &str,
        command: &'static str,
        arguments: Vec<String>,
        inputs: Vec<InputFile>,
    ) -> Self {
        Self {
            haptical_version: version.to_owned(),
            command,
            arguments,
            inputs,
            seeds: BTreeMap::new(),
            thresholds: None,
            outputs: Vec::new(),
            result_sha256: UNSEALED.to_owned(),
        }
    }

    /// The record of what is made from these files: their flags come before the further ones.
    pub fn of(
        version: &str,
        command: &'static str,
        inputs: Vec<InputFile>,
        flags: impl IntoIterator<Item = String>,
    ) -> Self {
        let named = inputs.iter().map(InputFile::argument);
        Self::new(version, command, named.chain(flags).collect(), inputs)
    }

    /// The same with the other files of the result.
    pub fn with_outputs(&self, files: &[NewFile<'_>]) -> Self {
        let outputs = files.iter();
        let outputs = outputs.map(|(name, content)| Fingerprint::from_bytes(content).output(name));
        Self {
            outputs: outputs.collect(),
            ..self.clone()
        }
    }

    /// The record in words: what, and its value, each on one line.
    ///
    /// # Errors
    /// A fault of this library alone.
    pub fn lines(&self) -> Result<Vec<(String, String)>, Error> {
        let version = format!("haptical {}", self.haptical_version);
        let command = format!("haptical {}{}", self.command, typed(&self.arguments));
        let mut lines = vec![
            ("version".to_owned(), version),
            ("command line".to_owned(), command),
        ];
        lines.extend(self.inputs.iter().map(|input| {
            let (file, bytes, sha256) = (&input.file, input.bytes, &input.sha256);
            let value = format!("{file}, {bytes} bytes, SHA-256 {sha256}");
            (input.flag.clone(), value)
        }));
        let seeds = self.seeds.iter();
        let seeds = seeds.map(|(purpose, seed)| format!("{purpose} {seed}"));
        let seeds = match seeds.collect::<Vec<_>>().as_slice() {
            [] => "none, no random numbers are drawn".to_owned(),
            seeds => seeds.join(", "),
        };
        lines.push(("seeds".to_owned(), seeds));
        if let Some(thresholds) = &self.thresholds {
            let named = [
                ("identifiability", words(&thresholds.identifiability)?),
                ("search settings", words(&thresholds.search)?),
            ];
            lines.extend(named.map(|(name, words)| (name.to_owned(), words)));
        }
        for (_, value) in &mut lines {
            *value = value.replace(|c: char| c.is_control(), " ");
        }
        Ok(lines)
    }

    /// Those of its flags that another command of the same device takes, as one would type them, a blank before each.
    pub(crate) fn typed(&self, flags: &[&str]) -> String {
        let is_wanted = |argument: &&String| {
            let flag = argument.split('=').next().unwrap_or_default();
            flags.contains(&flag)
        };
        typed(self.arguments.iter().filter(is_wanted))
    }

    /// The record for a page.
    ///
    /// # Errors
    /// A fault of this library alone.
    pub fn table(&self) -> Result<Table, Error> {
        facts("", self.lines()?)
    }

    /// The record as comments at the head of a TOML file.
    ///
    /// # Errors
    /// A fault of this library alone.
    pub fn toml_comments(&self) -> Result<String, Error> {
        let lines = self.lines()?.into_iter();
        Ok(lines
            .map(|(what, value)| format!("{COMMENT}{what}: {value}\n"))
            .collect())
    }
}

/// A TOML text without the comments of an earlier result at its head, or of an export at its end.
pub(crate) fn without_comments(text: &str) -> &str {
    let mut rest = without_seal(text);
    while rest.starts_with(COMMENT) {
        rest = rest.split_once('\n').map_or("", |(_, after)| after);
    }
    rest
}

/// `name value, name value` of a struct of numbers.
fn words(numbers: &impl Serialize) -> Result<String, Error> {
    let value = serde_json::to_value(numbers).map_err(Error::internal)?;
    let fields = value.as_object().into_iter().flatten();
    let words = fields.map(|(name, value)| match value.as_str() {
        Some(text) => format!("{name} {text}"),
        None => format!("{name} {value}"),
    });
    Ok(words.collect::<Vec<_>>().join(", "))
}

/// Arguments as one would type them, a blank before each.
fn typed<'a>(arguments: impl IntoIterator<Item = &'a String>) -> String {
    let word = |argument: &String| match argument.split_once('=') {
        Some((flag, value)) => format!(" {flag} {}", shell_word(value)),
        None => format!(" {argument}"),
    };
    arguments.into_iter().map(word).collect()
}

/// Flags of a device: its file, its rig, its chain.
pub(crate) const DEVICE_FLAGS: [&str; 4] = ["--device", "--rig", "--base", "--tip"];
/// The same with logs, and what a fit holds.
pub(crate) const FIT_FLAGS: [&str; 7] = [
    "--device",
    "--rig",
    "--base",
    "--tip",
    "--log",
    "--hold",
    "--deviation",
];

/// A result as JSON, with its own SHA-256 in it.
///
/// # Errors
/// A fault of this library alone.
pub fn sealed_json(result: &impl Serialize) -> Result<String, Error> {
    let mut json = serde_json::to_string_pretty(result).map_err(Error::internal)?;
    json.push('\n');
    let sha256 = Fingerprint::from_bytes(json.as_bytes()).sha256;
    Ok(json.replacen(&seal(UNSEALED), &seal(&sha256), 1))
}

/// Whether a result as JSON has the SHA-256 that is written in it.
pub fn is_seal_whole(json: &str, sha256: &str) -> bool {
    let unsealed = json.replacen(&seal(sha256), &seal(UNSEALED), 1);
    Fingerprint::from_bytes(unsealed.as_bytes()).sha256 == sha256
}

/// A text with the SHA-256 of itself in a comment at its end, in the place of an earlier one; `by` wrote it.
pub fn sealed_text(text: &str, by: &str, [open, close]: [&str; 2]) -> String {
    let text = without_seal(text);
    let end = if text.ends_with('\n') { "" } else { "\n" };
    let text = format!("{text}{end}{open}{}{UNSEALED}{close}\n", seal_head(by));
    let sha256 = Fingerprint::from_bytes(text.as_bytes()).sha256;
    let (head, tail) = text.rsplit_once(UNSEALED).unwrap_or((&text, ""));
    format!("{head}{sha256}{tail}")
}

/// Whether a text is as `by` wrote it with [`sealed_text`].
pub fn is_sealed_by(text: &str, by: &str) -> bool {
    let sealed = || {
        let (head, tail) = text.rsplit_once(&seal_head(by))?;
        let (sha256, tail) = tail.split_at_checked(UNSEALED.len())?;
        let unsealed = format!("{head}{}{UNSEALED}{tail}", seal_head(by));
        Some(Fingerprint::from_bytes(unsealed.as_bytes()).sha256 == sha256)
    };
    sealed().unwrap_or(false)
}

fn seal_head(by: &str) -> String {
    format!("Written by `{by}{SEAL}")
}

/// A text without the last line, where that is the comment of [`sealed_text`].
fn without_seal(text: &str) -> &str {
    let lines = text.strip_suffix('\n').unwrap_or(text);
    let last = lines.rfind('\n').map_or(0, |end| end + 1);
    match lines[last..].contains(SEAL) {
        true => &text[..last],
        false => text,
    }
}

fn seal(sha256: &str) -> String {
    format!("\"result_sha256\": \"{sha256}\"")
}

/// A text as one word of a command line.
pub fn shell_word(text: &str) -> String {
    let plain = |c: char| c.is_alphanumeric() || "/._-+,".contains(c);
    match !text.is_empty() && text.chars().all(plain) {
        true => text.to_owned(),
        false => format!("'{}'", text.replace('\'', "'\\''")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn record() -> Record {
        let input = InputFile {
            flag: "device".to_owned(),
            file: "my\ndevice.toml".to_owned(),
            bytes: 3,
            sha256: "ab".to_owned(),
        };
        let arguments = vec!["--device=my device.toml".to_owned()];
        let mut record = Record::new("1.2", "identify", arguments, vec![input]);
        record.thresholds = Some(Thresholds::from_options(&Options::default()));
        record
    }

    #[test]
    fn comments_stay_comments_and_go_again() {
        let comments = record().toml_comments().unwrap();
        assert!(comments.lines().all(|line| line.starts_with(COMMENT)));
        assert!(comments.contains("# provenance: device: my device.toml, 3 bytes, SHA-256 ab\n"));
        assert!(comments.contains("haptical identify --device 'my device.toml'\n"));
        assert!(comments.contains("rank_tolerance 1e-9"), "{comments}");
        let text = "# a comment of the user\na = 1\n";
        assert_eq!(without_comments(&format!("{comments}{text}")), text);
        assert_eq!(without_comments(text), text);
    }

    #[test]
    fn a_changed_digit_breaks_the_seal() {
        let json = sealed_json(&record()).unwrap();
        let value: serde_json::Value = serde_json::from_str(&json).unwrap();
        let sha256 = value["result_sha256"].as_str().unwrap();
        assert_ne!(sha256, UNSEALED);
        assert!(is_seal_whole(&json, sha256));
        assert!(!is_seal_whole(&json.replacen("0.5", "0.6", 1), sha256));
        assert!(!is_seal_whole(&json, UNSEALED));
    }

    #[test]
    fn a_sealed_text_is_known_by_its_writer_until_it_is_changed() {
        let text = sealed_text("a = 1\n", "haptical export", ["# ", ""]);
        assert_eq!(text.lines().count(), 2);
        assert!(text.starts_with("a = 1\n# Written by `haptical export`; SHA-256 "));
        assert!(is_sealed_by(&text, "haptical export"));
        assert!(!is_sealed_by(&text, "haptical play"));
        for changed in [
            text.replacen('1', "2", 1),
            format!("{text}\n"),
            String::new(),
        ] {
            assert!(!is_sealed_by(&changed, "haptical export"), "{changed}");
        }
        let head = "Written by `x`; SHA-256 of this file with 64 zeros here: é";
        assert!(!is_sealed_by(head, "x"));
        let again = sealed_text(&text, "haptical play", ["# ", ""]);
        assert_eq!(again.lines().count(), 2, "one seal");
        assert!(is_sealed_by(&again, "haptical play"));
        assert_eq!(without_comments(&again), "a = 1\n");
    }
}
