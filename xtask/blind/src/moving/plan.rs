//! Which trial comes at which index: clean ones, strong and weak effects, withheld and foreign ones, pairs, torques of
//! something else.

use crate::moving::kinds::{FOREIGN, Kind, NAMED, Site};
use crate::random::Random;

/// What a trial is about.
#[derive(Debug, Clone)]
pub(crate) struct Plan {
    pub(crate) stratum: Stratum,
    pub(crate) kinds: Vec<&'static Kind>,
}

/// A part of the suite.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Stratum {
    Clean,
    Strong,
    Weak,
    Foreign,
    Withheld,
    Pair,
    Sloppy,
}

/// Of twenty trials.
const ORDER: [Stratum; 20] = {
    use Stratum::{Clean, Foreign, Pair, Sloppy, Strong, Weak, Withheld};
    [
        Strong, Clean, Strong, Foreign, Clean, Strong, Weak, Strong, Withheld, Clean, Strong, Pair,
        Strong, Foreign, Clean, Strong, Weak, Strong, Withheld, Sloppy,
    ]
};

impl Stratum {
    /// Behind the label of an effect.
    pub(crate) fn suffix(self) -> &'static str {
        match self {
            Self::Weak => "-weak",
            Self::Withheld => "-withheld",
            Self::Clean | Self::Strong | Self::Foreign | Self::Pair | Self::Sloppy => "",
        }
    }

    /// Size of its effects over that of strong ones.
    pub(crate) fn size(self) -> f64 {
        if self == Self::Weak { 0.25 } else { 1.0 }
    }
}

/// The trial at an index: each stratum goes through its kinds in turn.
pub(crate) fn plan(index: u64, random: &mut Random) -> Plan {
    let length = ORDER.len() as u64;
    let place = (index % length) as usize;
    let stratum = ORDER[place];
    let in_order = |until: usize| ORDER[..until].iter().filter(|own| **own == stratum).count();
    let number = (index / length) as usize * in_order(ORDER.len()) + in_order(place);
    let all: Vec<&'static Kind> = NAMED.iter().collect();
    let scaling: Vec<&'static Kind> = NAMED.iter().filter(|kind| kind.scales).collect();
    let of = |kinds: &[&'static Kind], number: usize| kinds[number % kinds.len()];
    let kinds = match stratum {
        Stratum::Clean | Stratum::Sloppy => Vec::new(),
        Stratum::Strong => vec![of(&all, number)],
        // these begin elsewhere, so that a small batch does not try the same kinds twice
        Stratum::Weak => vec![of(&scaling, number + 14)],
        Stratum::Withheld => vec![of(&scaling, number + 7)],
        Stratum::Foreign => vec![&FOREIGN[number % FOREIGN.len()]],
        Stratum::Pair => pair(&scaling, number, random),
    };
    Plan { stratum, kinds }
}

/// Two kinds that need the same columns; two of the log as a whole are not drawn together.
fn pair(kinds: &[&'static Kind], number: usize, random: &mut Random) -> Vec<&'static Kind> {
    let first = kinds[number % kinds.len()];
    let fits = |other: &&&'static Kind| {
        let is_whole = |kind: &Kind| kind.site == Site::Whole;
        other.label != first.label
            && family(other) != family(first)
            && !(is_whole(other) && is_whole(first))
    };
    let others: Vec<&'static Kind> = kinds.iter().filter(fits).copied().collect();
    let second = random.choose(&others).unwrap_or(first);
    vec![first, second]
}

/// Effects of a family overlap too much to be put into one recording.
fn family(kind: &Kind) -> &'static str {
    match kind.label {
        "payload" | "link-inertia" | "gravity-direction" | "gravity-spring" => "weight",
        "stribeck-friction" | "load-friction" | "friction-asymmetry" | "friction-drift"
        | "presliding" => "friction",
        "elastic-second-encoder" | "backlash-second-encoder" | "elastic" => "drive",
        label if label.starts_with("torque") => "reading",
        label if label.starts_with("sampling") => "recorder",
        other => other,
    }
}
