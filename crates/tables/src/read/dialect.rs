//! The separator and the decimal sign of a text, from how its first lines fall into cells.

use csv::StringRecord;

use super::grid::list;
use super::number::{is_missing, is_number};

/// Separators in the order of preference where two fit alike.
pub(super) const SEPARATORS: [char; 5] = ['\t', ';', ',', '|', ' '];

/// The cells of a line, blanks at their ends left out.
pub(super) fn cells(line: &str, separator: char) -> Vec<String> {
    if separator == ' ' {
        return line.split_whitespace().map(str::to_owned).collect();
    }
    // nothing to quote: a tenth of the time
    if !line.contains('"') {
        let cells = line.split(separator).map(|cell| cell.trim().to_owned());
        return match line.trim_end_matches(['\r', '\n']).is_empty() {
            true => Vec::new(),
            false => cells.collect(),
        };
    }
    let mut reader = csv::ReaderBuilder::new()
        .has_headers(false)
        .flexible(true)
        .delimiter(separator as u8)
        .from_reader(line.as_bytes());
    let mut record = StringRecord::new();
    match reader.read_record(&mut record) {
        Ok(true) => record.iter().map(|cell| cell.trim().to_owned()).collect(),
        _ => Vec::new(),
    }
}

/// The rows of lines: with quotation marks a cell may go over several.
fn rows(lines: &[&str], separator: char) -> Vec<Vec<String>> {
    if separator == ' ' || !lines.iter().any(|line| line.contains('"')) {
        return lines.iter().map(|line| cells(line, separator)).collect();
    }
    let text = lines.join("\n");
    let mut reader = csv::ReaderBuilder::new()
        .has_headers(false)
        .flexible(true)
        .delimiter(separator as u8)
        .from_reader(text.as_bytes());
    let records = reader.records().map_while(Result::ok);
    let trimmed = |record: StringRecord| record.iter().map(|cell| cell.trim().to_owned()).collect();
    records.map(trimmed).collect()
}

/// The separator under which most lines have the same number of cells, and most cells are numbers.
pub(super) fn separator(sample: &[&str]) -> char {
    let mut best = (0.0, 0, ',');
    for separator in SEPARATORS {
        let rows = rows(sample, separator);
        let count = usual(rows.iter().map(Vec::len));
        let alike = rows.iter().filter(|row| row.len() == count).count();
        // a comma in a cell between commas was in quotation marks
        let is_number = |cell: &&String| is_number(cell) || list(cell).is_some();
        // lines above the first number are names
        let is_name = |row: &&Vec<String>| !row.iter().any(|cell| is_number(&cell));
        let data = || rows.iter().skip_while(is_name);
        let filled = || data().flatten().filter(|cell| !is_missing(cell));
        let numbers = filled().filter(is_number).count();
        let share = numbers as f64 / filled().count().max(1) as f64;
        let mut score = share * alike as f64 / rows.len().max(1) as f64;
        // one column whose first line has a separator is more likely a table of that separator with a short row
        let first = sample.first().copied().unwrap_or_default();
        if count == 1 && first.contains(&SEPARATORS[..4]) {
            score *= 0.5;
        }
        let is_better = score > best.0 + 1e-9 || (score > best.0 - 1e-9 && count > best.1);
        if is_better {
            best = (score, count, separator);
        }
    }
    best.2
}

/// The decimal sign: a comma where cells have commas between digits, and none has a point.
pub(super) fn decimal<'c>(cells: impl Iterator<Item = &'c str> + Clone) -> char {
    let numbers = cells.filter(|cell| is_number(cell));
    let has = |sign: char| numbers.clone().any(|cell| cell.contains(sign));
    match has(',') && !has('.') {
        true => ',',
        false => '.',
    }
}

/// The count that is there most often; of several the largest.
pub(super) fn usual(counts: impl Iterator<Item = usize>) -> usize {
    let mut times = std::collections::BTreeMap::new();
    counts.for_each(|count| *times.entry(count).or_insert(0) += 1);
    let most = times.iter().max_by_key(|&(&count, &times)| (times, count));
    most.map_or(0, |(&count, _)| count)
}
