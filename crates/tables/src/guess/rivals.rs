//! Columns that may be the same of a log: one of them is taken, the others are left out with the reason.

use std::collections::BTreeMap;

use super::lists::COMMAND;
use super::names::{Meaning, OfJoint, of_device, words};
use super::{Joint, Proposal};
use crate::table::Table;

/// A column that is left out: its file, its place there, and why.
pub(super) type LeftOut = (usize, usize, String);

/// Keeps one column of each meaning: what is measured before what was commanded, then the first.
pub(super) fn resolve(found: &mut Vec<Proposal>, run: &[Table], joints: &[Joint]) -> Vec<LeftOut> {
    let mut left_out = numbered_from_zero(found, run, joints);
    let name = |own: &Proposal| run[own.file].columns[own.column].name.as_str();
    let is_command = |own: &Proposal| {
        let words = words(name(own));
        words.iter().any(|word| COMMAND.contains(&word.as_str()))
    };
    let all = found.clone();
    found.retain(|own| {
        let rivals = all.iter().filter(|other| other.meaning == own.meaning);
        // of equals the first
        let Some(taken) = rivals.min_by_key(|rival| is_command(rival)) else {
            return true;
        };
        let is_taken = (taken.file, taken.column) == (own.file, own.column);
        if !is_taken {
            let why = format!("`{}` is {} already", name(taken), own.meaning);
            left_out.push((own.file, own.column, why));
        }
        is_taken
    });
    left_out
}

/// `J1` to `J6` beside `Q0` are the joints, and `Q0` is none: a list that is counted from 0 stands alone, or is the longest.
fn numbered_from_zero(found: &mut Vec<Proposal>, run: &[Table], joints: &[Joint]) -> Vec<LeftOut> {
    // of each kind the lists by their words; those that the device names are one list, without words
    let mut kinds: BTreeMap<OfJoint, BTreeMap<Vec<String>, Joints>> = BTreeMap::new();
    for (place, own) in found.iter().enumerate() {
        if let Meaning::Joint(kind, number) = own.meaning {
            let name = &run[own.file].columns[own.column].name;
            let mut stem = match of_device(name, joints) {
                Some(_) => Vec::new(),
                None => words(name),
            };
            stem.retain(|word| word.parse::<usize>().is_err());
            let list = kinds.entry(kind).or_default().entry(stem).or_default();
            list.is_from_zero |= number == 0;
            list.places.push(place);
        }
    }
    let mut is_left_out = vec![false; found.len()];
    for lists in kinds.values().filter(|lists| lists.len() > 1) {
        // of equals one that is counted from 1
        let size = |(stem, list): &(&Vec<String>, &Joints)| {
            (stem.is_empty(), list.places.len(), !list.is_from_zero)
        };
        let Some((longest, first)) = lists.iter().max_by_key(size) else {
            continue;
        };
        for (stem, list) in lists.iter().filter(|(stem, _)| *stem != longest) {
            if list.is_from_zero || (first.is_from_zero && !stem.is_empty()) {
                list.places
                    .iter()
                    .for_each(|place| is_left_out[*place] = true);
            }
        }
    }
    let mut left_out = Vec::new();
    let mut is_left_out = is_left_out.into_iter();
    found.retain(|own| {
        let is_kept = !is_left_out.next().unwrap_or_default();
        if !is_kept {
            let why = "other columns are numbered as the joints".to_owned();
            left_out.push((own.file, own.column, why));
        }
        is_kept
    });
    left_out
}

/// Joints of one list: places among the proposals.
#[derive(Default)]
struct Joints {
    is_from_zero: bool,
    places: Vec<usize>,
}
