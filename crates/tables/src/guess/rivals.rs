//! Columns that may be the same of a log: one of them is taken, the others are left out with the reason.

use std::collections::BTreeMap;

use super::letters::TURN;
use super::lists::COMMAND;
use super::names::{Meaning, OfJoint, of_device, words};
use super::{Joint, Proposal};
use crate::table::Table;

/// Words that say that a field is a place.
const PLACE: [&str; 5] = ["position", "pos", "translation", "trans", "p"];

/// A column that is left out: its file, its place there, and why.
pub(super) type LeftOut = (usize, usize, String);

/// Keeps one column of each meaning: what is measured before what was commanded, whole places before parts, the turn of what has
/// the place, then the first.
pub(super) fn resolve(found: &mut Vec<Proposal>, run: &[Table], joints: &[Joint]) -> Vec<LeftOut> {
    let mut left_out = numbered_from_zero(found, run, joints);
    let name = |own: &Proposal| run[own.file].columns[own.column].name.as_str();
    let mut taken: BTreeMap<Meaning, (Rank, usize)> = BTreeMap::new();
    for (index, rank) in ranks(found, run).into_iter().enumerate() {
        let own = (rank, index);
        let best = taken.entry(found[index].meaning.clone()).or_insert(own);
        // of equals the first
        *best = own.min(*best);
    }
    let names: Vec<String> = found.iter().map(|own| name(own).to_owned()).collect();
    let mut index = 0..;
    found.retain(|own| {
        let index = index.next().unwrap_or_default();
        let best = taken.get(&own.meaning).map_or(index, |(_, best)| *best);
        if best != index {
            let why = format!("`{}` is {} already", names[best], own.meaning);
            left_out.push((own.file, own.column, why));
        }
        best == index
    });
    left_out
}

/// Whether a column was commanded, is a part of a place alone, or is the turn of something else than what has the place: the least
/// is taken.
type Rank = (bool, bool, bool);

fn ranks(found: &[Proposal], run: &[Table]) -> Vec<Rank> {
    let all: Vec<(usize, Vec<String>)> = found
        .iter()
        .map(|own| (own.file, words(&run[own.file].columns[own.column].name)))
        .collect();
    let front = |index: usize| {
        let (file, words) = &all[index];
        (*file, &words[..words.len().saturating_sub(1)])
    };
    let is_place = |own: &Proposal| matches!(own.meaning, Meaning::Position(_));
    let is_turn = |own: &Proposal| {
        matches!(
            own.meaning,
            Meaning::Quaternion(_) | Meaning::Vector(_) | Meaning::Angle(_)
        )
    };
    // a place is whole if its three parts have the same words before their letters
    let mut parts: BTreeMap<(usize, &[String]), usize> = BTreeMap::new();
    for index in (0..found.len()).filter(|&index| is_place(&found[index])) {
        *parts.entry(front(index)).or_default() += 1;
    }
    let of = |index: usize| -> Rank {
        let is_command = all[index].1.iter().any(|word| COMMAND.contains(&&**word));
        let is_part = is_place(&found[index]) && parts.get(&front(index)) != Some(&3);
        (is_command, is_part, false)
    };
    let mut ranks: Vec<Rank> = (0..found.len()).map(of).collect();
    // whose place or turn it is: the words but those that say which of both
    let body = |index: usize| {
        let (file, words) = front(index);
        let says_which = |word: &&String| TURN.contains(&&***word) || PLACE.contains(&&***word);
        let words = words.iter().filter(|word| !says_which(word));
        (file, words.collect::<Vec<_>>())
    };
    let places = (0..found.len()).filter(|&index| found[index].meaning == Meaning::Position(0));
    if let Some(place) = places.min_by_key(|&index| ranks[index]).map(body) {
        for index in (0..found.len()).filter(|&index| is_turn(&found[index])) {
            ranks[index].2 = body(index) != place;
        }
    }
    ranks
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
