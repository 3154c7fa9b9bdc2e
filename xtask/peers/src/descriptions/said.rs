//! Which words of haptical name a part of a description that it does not read.

use super::ask::Feature;
use super::findings::Part;

/// Words of which one has to be in what haptical says of such a part; `equality connect` is of the kind `equality`.
const WORDS: [(&str, &[&str]); 10] = [
    ("springs", &["stiffness of", "springdamper of"]),
    ("damping", &["damping of"]),
    ("gravcomp", &["gravcomp of"]),
    ("fluid", &["density", "viscosity"]),
    ("geoms", &["from their geoms"]),
    ("inertiafromgeom", &["inertiafromgeom"]),
    ("settotalmass", &["settotalmass"]),
    ("equality", &["<equality>", "is bound by more than"]),
    ("tendon", &["tendon"]),
    ("actuator", &["of actuators"]),
];

/// Words that name what changes torques of a whole model.
const OF_TORQUES: [&str; 3] = [
    LEFT_OUT,
    "a blank before or behind it is none",
    "springdamper of",
];

/// Words that name bodies which are not read.
const LEFT_OUT: &str = "is left out, and what it makes";

/// What a corrected export says of masses that are not those of the device.
const MOVED: [&str; 4] = [
    "move with their corrected origins",
    "masses are not put in",
    "is not put in",
    "was not put into",
];
/// What an export says where it has masses that the device does not have.
const PLAUSIBLE: [&str; 2] = ["plausible mass", "plausible inertia"];

/// Words of an export that say why its torques are others.
pub(crate) fn explained(said: &[String], part: Part) -> Option<String> {
    match part {
        Part::Corrected => with_any(said, &MOVED),
        Part::NewUrdf | Part::NewMjcf => with_any(said, &PLAUSIBLE),
        Part::Given => None,
    }
}

/// What haptical says of a part; none where it does not.
pub(crate) fn of_feature(feature: &Feature, said: &[String]) -> Option<String> {
    let kind = feature.kind.split(' ').next().unwrap_or_default();
    let (_, words) = WORDS.iter().find(|(own, _)| *own == kind)?;
    with_any(said, words)
}

/// What haptical says that makes torques differ, and poses too where these differ.
pub(crate) fn of_all(said: &[String], has_equal_poses: bool) -> Option<String> {
    match has_equal_poses {
        true => with_any(said, &OF_TORQUES),
        false => with_any(said, &[LEFT_OUT]),
    }
}

/// The first sentence with one of some words.
pub(crate) fn with_any(said: &[String], words: &[&str]) -> Option<String> {
    let mut said = said.iter();
    said.find(|own| words.iter().any(|word| own.contains(word)))
        .cloned()
}
