//! The table of all descriptions, its summary, and the silent differences.

use std::collections::BTreeMap;

use super::findings::{Part, Row, State, Verdict};

/// Most letters of a verdict in the table.
const LONGEST: usize = 240;

/// Markdown: a line for each row, then how many of each verdict there are.
pub(crate) fn table(rows: &[Row]) -> String {
    let mut text = String::from(
        "| file | joints | compared with | worst pose [m], [rad] | worst torque | round trips | verdict |\n\
         | --- | --- | --- | --- | --- | --- | --- |\n",
    );
    let mut counts: BTreeMap<Verdict, usize> = BTreeMap::new();
    for row in rows {
        let (verdict, words) = row.verdict();
        *counts.entry(verdict).or_insert(0) += 1;
        let worst = row.worst();
        let number =
            |own: Option<f64>| own.map_or_else(|| "-".to_owned(), |own| format!("{own:.1e}"));
        let words = shortened(&words.replace('|', "/").replace('\n', " "));
        let verdict = match words.is_empty() {
            true => name(verdict).to_owned(),
            false => format!("{}: {words}", name(verdict)),
        };
        text.push_str(&format!(
            "| {} | {} | {} | {} | {} | {} | {verdict} |\n",
            row.file,
            row.joints,
            with(row),
            number(worst.pose),
            number(worst.torque),
            round_trips(row)
        ));
    }
    let count = |verdict| counts.get(&verdict).copied().unwrap_or(0);
    let as_they_are = rows.iter().filter(|row| row.is_equal_as_it_is()).count();
    text.push_str(&format!(
        "\n{as_they_are} are equal as they are, but for exports\n{} descriptions: {} equal, {} said, {} refused, {} peer refused, \
         {} silent differences\n",
        rows.len(),
        count(Verdict::Equal),
        count(Verdict::Said),
        count(Verdict::Refused),
        count(Verdict::PeerRefused),
        count(Verdict::Different)
    ));
    text
}

/// A line for each silent difference.
pub(crate) fn silent(rows: &[Row]) -> Vec<String> {
    let lines = rows.iter().filter_map(|row| match row.verdict() {
        (Verdict::Different, words) => Some(format!("silent: {}: {words}", row.file)),
        _ => None,
    });
    lines.collect()
}

fn name(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Equal => "equal",
        Verdict::Said => "said",
        Verdict::Refused => "refused",
        Verdict::PeerRefused => "peer refused",
        Verdict::Different => "DIFFERENT",
    }
}

fn shortened(text: &str) -> String {
    match text.char_indices().nth(LONGEST) {
        Some((end, _)) => format!("{}...", &text[..end]),
        None => text.to_owned(),
    }
}

/// Peers of the file itself, and which of them refused.
fn with(row: &Row) -> String {
    let mut peers: BTreeMap<&str, bool> = BTreeMap::new();
    let given = row.findings.iter().filter(|own| own.part == Part::Given);
    for own in given.filter(|own| own.with != "haptical") {
        let is_refused = matches!(own.state, State::PeerRefused(_));
        *peers.entry(own.with.as_str()).or_insert(false) |= is_refused;
    }
    let words: Vec<String> = peers
        .into_iter()
        .map(|(name, is_refused)| match is_refused {
            true => format!("{name} refused"),
            false => name.to_owned(),
        })
        .collect();
    match words.is_empty() {
        true => "-".to_owned(),
        false => words.join(", "),
    }
}

/// Of each export what came of it with haptical and with the peers.
fn round_trips(row: &Row) -> String {
    let mut words = Vec::new();
    for part in [Part::Corrected, Part::NewUrdf, Part::NewMjcf] {
        let own: Vec<&State> = row
            .findings
            .iter()
            .filter(|own| own.part == part)
            .map(|own| &own.state)
            .collect();
        let has = |state: fn(&State) -> bool| own.iter().any(|own| state(own));
        let word = match () {
            () if own.is_empty() => continue,
            () if has(|own| matches!(own, State::Different(..))) => "DIFFERENT",
            () if has(|own| matches!(own, State::Refused(_))) => "refused",
            () if has(|own| matches!(own, State::Said(_))) => "said",
            () if has(|own| matches!(own, State::Equal(_))) => "equal",
            () => "peer refused",
        };
        words.push(format!("{} {word}", part.name()));
    }
    words.join(", ")
}
