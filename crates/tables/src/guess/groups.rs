//! Columns that belong together as the elements of one list, and what their numbers show it to be: a quaternion has length 1, a
//! rotation's rows are perpendicular, the last row of a pose is 0, 0, 0, 1.

use std::collections::BTreeMap;

use super::names::{Meaning, OfJoint, kind_of, words};
use crate::rotation::from_matrix;
use crate::table::Table;

/// Rows that are looked at.
const ROWS: usize = 50;
/// Deviation of a quaternion's norm from 1, as in a log.
const NORM: f64 = 1e-3;

/// The columns of a list, in the order of their numbers.
struct List<'t> {
    stem: Vec<String>,
    columns: Vec<usize>,
    numbers: Vec<&'t [f64]>,
}

impl<'t> List<'t> {
    /// Of columns; none where one has no numbers.
    fn of_columns(table: &'t Table, stem: Vec<String>, columns: Vec<usize>) -> Option<Self> {
        let numbers = columns.iter();
        let numbers = numbers.map(|&column| table.columns[column].cells.numbers());
        Some(Self {
            stem,
            numbers: numbers.collect::<Option<_>>()?,
            columns,
        })
    }

    fn says(&self, word: &str) -> bool {
        self.stem.iter().any(|own| own == word)
    }

    /// Whether it holds for these elements at the rows that are looked at; at one at least.
    fn shows(&self, elements: &[usize], holds: impl Fn(&[f64]) -> bool) -> bool {
        let rows = self.numbers.first().map_or(0, |numbers| numbers.len());
        let mut seen = 0;
        for row in 0..rows {
            let cells: Vec<f64> = elements
                .iter()
                .map(|&element| self.numbers[element][row])
                .collect();
            if cells.iter().any(|cell| cell.is_nan()) {
                continue;
            }
            if !holds(&cells) {
                return false;
            }
            seen += 1;
            if seen == ROWS {
                break;
            }
        }
        seen > 0
    }

    fn is_quaternion(&self, elements: [usize; 4]) -> bool {
        self.shows(&elements, |cells| {
            let norm = cells.iter().map(|cell| cell * cell).sum::<f64>().sqrt();
            (norm - 1.0).abs() < NORM
        })
    }

    /// Whether these elements are a rotation row by row; then they are one column by column too.
    fn is_rotation(&self, elements: [usize; 9]) -> bool {
        self.shows(&elements, |cells| {
            let row = |row: usize| [cells[3 * row], cells[3 * row + 1], cells[3 * row + 2]];
            from_matrix([row(0), row(1), row(2)]).is_ok()
        })
    }

    /// A quaternion's parts from element `first` on, w first, and how sure that order is.
    fn quaternion(&self, first: usize, usual: [usize; 4]) -> (Vec<(usize, Meaning)>, &'static str) {
        const W_LAST: [usize; 4] = [1, 2, 3, 0];
        const W_FIRST: [usize; 4] = [0, 1, 2, 3];
        let (order, why) = match (self.says("xyzw"), self.says("wxyz")) {
            (true, _) => (W_LAST, "x, y, z, w by its name"),
            (_, true) => (W_FIRST, "w, x, y, z by its name"),
            _ if usual == W_LAST => (
                W_LAST,
                "UNSURE whether w is last, as ROS and SciPy have it, or first: CHECK",
            ),
            _ => (
                W_FIRST,
                "UNSURE whether w is first, as ABB and Eigen's constructor have it, or last: CHECK",
            ),
        };
        let parts = order.iter().enumerate();
        let parts =
            parts.map(|(part, own)| (self.columns[first + part], Meaning::Quaternion(*own)));
        (parts.collect(), why)
    }

    /// What each column is, with the reason; nothing where the numbers do not show it.
    fn meaning(&self) -> Option<(Vec<(usize, Meaning)>, String)> {
        let all = |meaning: fn(usize) -> Meaning| {
            let columns = self.columns.iter().enumerate();
            columns
                .map(|(element, column)| (*column, meaning(element)))
                .collect::<Vec<_>>()
        };
        let place = || {
            (0..3)
                .map(|part| (self.columns[part], Meaning::Position(part)))
                .collect::<Vec<_>>()
        };
        match self.columns.len() {
            4 if self.is_quaternion([0, 1, 2, 3]) => {
                let (parts, why) = self.quaternion(0, [0, 1, 2, 3]);
                Some((
                    parts,
                    format!("four numbers of length 1, a quaternion, {why}"),
                ))
            }
            // a robot's own pose
            6 if self.says("pose") => {
                let mut parts = place();
                parts.extend((0..3).map(|part| (self.columns[3 + part], Meaning::Vector(part))));
                Some((parts, "six numbers of a pose".to_owned()))
            }
            7 if self.is_quaternion([3, 4, 5, 6]) => {
                let mut parts = place();
                let (turn, why) = self.quaternion(3, [1, 2, 3, 0]);
                parts.extend(turn);
                Some((
                    parts,
                    format!("seven numbers, a place and a quaternion, {why}"),
                ))
            }
            9 if self.is_rotation([0, 1, 2, 3, 4, 5, 6, 7, 8]) => Some((
                all(Meaning::Matrix),
                "nine numbers of a rotation".to_owned(),
            )),
            12 if self.is_rotation([0, 1, 2, 4, 5, 6, 8, 9, 10]) => Some((
                all(Meaning::Pose),
                "three rows of a pose, four numbers each".to_owned(),
            )),
            16 if self.is_rotation([0, 1, 2, 4, 5, 6, 8, 9, 10]) => {
                let ends_with = |elements: [usize; 4]| {
                    self.shows(&elements, |cells| cells == [0.0, 0.0, 0.0, 1.0])
                };
                (ends_with([12, 13, 14, 15]) || ends_with([3, 7, 11, 15]))
                    .then(|| (all(Meaning::Pose), "sixteen numbers of a pose".to_owned()))
            }
            _ => None,
        }
    }
}

/// The words of a name before its last numbers, and these: `T_1_2` is `t` and 1, 2.
pub(super) fn stem_and_numbers(name: &str) -> Option<(Vec<String>, Vec<usize>)> {
    let words = words(name);
    let is_number = |word: &String| word.parse::<usize>().is_ok();
    let front = words.len()
        - words
            .iter()
            .rev()
            .take_while(|word| is_number(word))
            .count();
    let numbers = words[front..].iter().filter_map(|word| word.parse().ok());
    let numbers: Vec<usize> = numbers.collect();
    (front > 0 && !numbers.is_empty()).then(|| (words[..front].to_vec(), numbers))
}

/// What columns are as the elements of a list, by their place in the file.
pub(super) fn of(table: &Table) -> BTreeMap<usize, (Meaning, String)> {
    let mut lists: BTreeMap<Vec<String>, Vec<(Vec<usize>, usize)>> = BTreeMap::new();
    for (column, own) in table.columns.iter().enumerate() {
        // where a handle should be is no measurement
        if let Some((stem, numbers)) = stem_and_numbers(&own.name)
            && kind_of(&stem) != Some(OfJoint::Command)
        {
            lists.entry(stem).or_default().push((numbers, column));
        }
    }
    let mut found = quaternions_by_letter(table);
    for (stem, mut elements) in lists {
        elements.sort();
        let columns: Vec<usize> = elements.into_iter().map(|(_, column)| column).collect();
        let list = List::of_columns(table, stem, columns);
        let Some((meanings, why)) = list.and_then(|list| list.meaning()) else {
            continue;
        };
        for (column, meaning) in meanings {
            found.insert(column, (meaning, why.clone()));
        }
    }
    found
}

/// `x`, `y`, `z`, `w` with the same words before them, of length 1: the first three are no place.
fn quaternions_by_letter(table: &Table) -> BTreeMap<usize, (Meaning, String)> {
    let mut fronts: BTreeMap<Vec<String>, [Option<usize>; 4]> = BTreeMap::new();
    for (column, own) in table.columns.iter().enumerate() {
        let mut front = words(&own.name);
        let last = front.pop();
        let letters = ["w", "x", "y", "z"].map(Some);
        let letter = letters.iter().position(|letter| *letter == last.as_deref());
        if let Some(letter) = letter
            && kind_of(&front) != Some(OfJoint::Command)
        {
            fronts.entry(front).or_default()[letter].get_or_insert(column);
        }
    }
    let mut found = BTreeMap::new();
    for (stem, columns) in fronts {
        let [Some(w), Some(x), Some(y), Some(z)] = columns else {
            continue;
        };
        let columns = [w, x, y, z];
        let list = List::of_columns(table, stem, columns.to_vec());
        if list.is_some_and(|list| list.is_quaternion([0, 1, 2, 3])) {
            let parts = columns.into_iter().enumerate();
            found.extend(parts.map(|(part, column)| {
                let why = "x, y, z and w are of length 1, a quaternion".to_owned();
                (column, (Meaning::Quaternion(part), why))
            }));
        }
    }
    found
}
