//! The largest torque of a joint's drive: what the joint takes of its actuators, and what these give.

use std::collections::BTreeMap;

use crate::robot::mjcf::classes::Classes;
use crate::robot::mjcf::{Attributes, Mjcf};
use crate::robot::xml::{Element, Reader, Result, elements};

/// Actuators whose defaults are one and the same in MuJoCo.
pub(crate) const KINDS: [&str; 9] = [
    "general",
    "motor",
    "position",
    "velocity",
    "intvelocity",
    "damper",
    "cylinder",
    "muscle",
    "adhesion",
];

/// What the actuators of each joint give together \[N m\], \[N\]; none where one of them has no limit.
pub(crate) type Efforts<'d> = BTreeMap<&'d str, Option<f64>>;

/// The larger end of a range of forces.
fn larger(text: &str) -> Option<f64> {
    let words = text.split_ascii_whitespace();
    let ends: Option<Vec<f64>> = words.map(|word| word.parse().ok()).collect();
    match ends?[..] {
        [lower, upper] if lower < upper => {
            Some(f64::max(lower.abs(), upper.abs())).filter(|end| end.is_finite())
        }
        _ => None,
    }
}

fn is_limited(stated: Option<&str>, is_automatic: bool) -> bool {
    match stated.unwrap_or("auto") {
        "true" => true,
        "false" => false,
        _ => is_automatic,
    }
}

/// Reads the force ranges of all actuators of joints.
pub(crate) fn efforts<'d>(
    reader: &Reader<'d, '_>,
    classes: &Classes<'d>,
    is_automatic: bool,
) -> Result<Efforts<'d>> {
    let mut efforts = Efforts::new();
    let root = reader.document.root_element();
    let actuators = elements(root, "actuator").flat_map(|section| section.children());
    for node in actuators.filter(Element::is_element) {
        let joint = ["joint", "jointinparent"].into_iter();
        let Some(joint) = joint.filter_map(|key| node.attribute(key)).next() else {
            continue;
        };
        let class = classes.named(reader, node, "class", Classes::OUTERMOST)?;
        let stated = |key: &str| -> Option<&'d str> {
            node.attribute(key)
                .or_else(|| classes.stated_of(class, &KINDS, key))
        };
        let range =
            stated("forcerange").filter(|_| is_limited(stated("forcelimited"), is_automatic));
        let gear = stated("gear").and_then(|text| text.split_ascii_whitespace().next());
        let gear = gear.map_or(Some(1.0), |word| word.parse::<f64>().ok());
        let own = range.and_then(larger).zip(gear);
        let own = own.map(|(force, gear)| force * gear.abs());
        let sum = efforts.entry(joint).or_insert(Some(0.0));
        *sum = sum.zip(own).map(|(sum, own)| sum + own);
    }
    Ok(efforts)
}

impl<'d> Mjcf<'d, '_> {
    /// The largest torque of a joint's drive: the smaller of what its actuators give and of its own range.
    pub(crate) fn effort(&self, own: &Attributes<'d, '_>) -> Option<f64> {
        let is_automatic = self.compiler.has_automatic_limits;
        let range = self.attribute(own, "actuatorfrcrange");
        let range =
            range.filter(|_| is_limited(self.attribute(own, "actuatorfrclimited"), is_automatic));
        let taken = range.and_then(larger);
        let name = own.node.attribute("name");
        let given = name.and_then(|name| self.efforts.get(name).copied().flatten());
        let efforts = [taken, given].into_iter().flatten();
        efforts.reduce(f64::min).filter(|effort| *effort > 0.0)
    }
}
