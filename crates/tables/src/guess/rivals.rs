//! Columns that may be the same of a log: one of them is taken, the others are left out with the reason.

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
    let list = |own: &Proposal| match own.meaning {
        Meaning::Joint(kind, number) => {
            let name = &run[own.file].columns[own.column].name;
            let stem: Vec<String> = match of_device(name, joints) {
                Some(_) => Vec::new(),
                None => {
                    let words = words(name).into_iter();
                    words
                        .filter(|word| word.parse::<usize>().is_err())
                        .collect()
                }
            };
            Some((kind, stem, number))
        }
        _ => None,
    };
    let lists: Vec<Option<(OfJoint, Vec<String>, usize)>> = found.iter().map(list).collect();
    let size = |kind: OfJoint, stem: &[String]| {
        let own = lists.iter().flatten();
        own.filter(|list| list.0 == kind && list.1 == stem).count()
    };
    let mut left_out = Vec::new();
    for (kind, stem, _) in lists.iter().flatten().filter(|list| list.2 == 0) {
        let others = lists.iter().flatten();
        let others = others.filter(|list| list.0 == *kind && list.1 != *stem);
        let longest = others.max_by_key(|list| size(*kind, &list.1));
        let Some(longest) = longest else {
            continue;
        };
        let loser = match size(*kind, &longest.1) >= size(*kind, stem) || longest.1.is_empty() {
            true => stem,
            false => &longest.1,
        };
        for (place, list) in lists.iter().enumerate() {
            let is_loser = list
                .as_ref()
                .is_some_and(|list| list.0 == *kind && list.1 == *loser);
            if is_loser {
                let own = &found[place];
                let why = "other columns are numbered as the joints".to_owned();
                left_out.push((own.file, own.column, why));
            }
        }
    }
    found.retain(|own| {
        let mut gone = left_out.iter();
        !gone.any(|(file, column, _)| (*file, *column) == (own.file, own.column))
    });
    left_out
}
